# SPDX-License-Identifier: BSD-3-Clause
"""Places that are no files, files that change, disks that are full, ranks that die: one message and an end within seconds."""
import os
import pathlib
import signal
import subprocess
import sys
import threading
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "regression"))
import haptos_runs
from haptos_runs import INPUTS, SceneTest, programs, run_haptos, stack


class NoFile(SceneTest):
    def refuse_input(self, *parts):
        """As the parameters and as the mesh."""
        for name in ("scene.xml", "stack.exo"):
            with self.subTest(name=name):
                path = self.folder / name
                (self.folder / "right.xml").write_text(haptos_runs.xml_of(stack()))
                good = path.read_bytes() if path.exists() else None
                path.unlink(missing_ok=True)
                self.make(path)
                outcome = run_haptos(["scene.xml" if name == "scene.xml" else "right.xml"], 2, self.folder, timeout=60)
                self.assert_one_message(outcome, 1, name)
                self.assertTrue(any(part in outcome.err for part in parts), outcome)
                self.unmake(path)
                if good is not None:
                    path.write_bytes(good)

    def test_folder(self):
        self.make, self.unmake = pathlib.Path.mkdir, pathlib.Path.rmdir
        self.refuse_input("folder")

    def test_pipe(self):
        self.make, self.unmake = os.mkfifo, os.unlink
        self.refuse_input("not a regular file")

    def test_link_to_itself(self):
        self.make, self.unmake = lambda path: path.symlink_to(path.name), os.unlink
        self.refuse_input("no such file", "does not exist")


class Disk(SceneTest):
    def test_no_space_for_results(self):
        """Files may have so many bytes: writing fails as on a full disk, at the beginning and near the end."""
        (self.folder / "scene.xml").write_text(haptos_runs.xml_of(stack()))
        for most in (0, 1024, 10000):
            with self.subTest(most=most):
                with subprocess.Popen([programs.server, "60", str(most)], cwd=self.folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                      stderr=subprocess.PIPE, env={**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1",
                                                                   "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}) as server:
                    answer, _ = server.communicate(b"scene.xml".hex().encode() + b",\n", timeout=60)
                self.assertEqual(answer.split()[0], b"1")
                self.assertFalse((self.folder / "result.exo").exists())
                self.assertFalse((self.folder / "summary.json").exists())
                if most:  # else the message finds no room either
                    err = (self.folder / "err").read_text()
                    self.assertEqual(err.count("\n"), 1, err)
                    self.assertIn("space", err)

    def test_folder_that_cannot_be_written_to(self):
        for option in ("--output", "--summary"):
            outcome = self.run_scene(stack(), option, "/proc/result")
            self.assert_one_message(outcome, 1, "/proc/result")


class Changes(SceneTest):
    def test_mesh_changes_while_it_is_read(self):
        """A writer that cuts the mesh off and puts it back, all the time."""
        path, running = self.folder / "stack.exo", True
        whole = path.read_bytes()
        (self.folder / "scene.xml").write_text(haptos_runs.xml_of(stack()))

        def change():
            while running:
                for part in (whole[: len(whole) // 2], whole[: len(whole) // 5], whole):
                    path.write_bytes(part)
                    time.sleep(0.002)

        writer = threading.Thread(target=change)
        writer.start()
        statuses = set()
        for _ in range(20):
            outcome = run_haptos(["scene.xml", "--validate-only"], 1, self.folder, timeout=60)
            statuses.add(outcome.status)
            if outcome.status != 0:
                self.assert_one_message(outcome, 1, "stack.exo")
        running = False
        writer.join()
        self.assertLessEqual(statuses, {0, 1})


class LostRank(SceneTest):
    def ranks_below(self, process):
        """Process numbers of the program's ranks, children of mpirun."""
        ranks = []
        for entry in pathlib.Path("/proc").iterdir():
            try:
                if entry.name.isdigit() and int((entry / "stat").read_text().rsplit(")", 1)[1].split()[1]) == process.pid:
                    if (entry / "exe").resolve() == pathlib.Path(programs.haptos).resolve():
                        ranks.append(int(entry.name))
            except OSError:
                pass
        return ranks

    def test_killed_rank_ends_the_others(self):
        sets = ["--set", "Mesh->Two Beams->Subdomains Per Edge=4", "--set", "Mesh->Two Beams->Elements Per Subdomain Edge=6"]
        start = haptos_runs.start_of(programs.haptos, [INPUTS / "table31.xml", *sets], 3, self.folder)
        with subprocess.Popen(**start, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as run:
            line = run.stdout.readline()  # the model is there, so all ranks are at work
            self.assertIn(b"subdomains", line)
            victims = self.ranks_below(run)
            self.assertEqual(len(victims), 3)
            os.kill(victims[1], signal.SIGKILL)
            began = time.monotonic()
            _, err = run.communicate(timeout=60)
            self.assertLess(time.monotonic() - began, 30)  # a hang would last for ever
            self.assertNotEqual(run.returncode, 0)
            self.assertIn(b"signal 9", err)
        self.assertFalse(any(path.suffix == ".json" for path in self.folder.glob("table31*")))


if __name__ == "__main__":
    haptos_runs.main()
