# SPDX-License-Identifier: BSD-3-Clause
"""drivers/haptos_scaling.py: its table, its formulas against the counters, its messages."""
import csv
import json
import os
import pathlib
import shlex
import subprocess
import sys
import tempfile
import unittest

import haptos_runs
from haptos_runs import programs, run_haptos

DRIVERS = pathlib.Path(__file__).resolve().parents[2] / "drivers"
sys.path.insert(0, str(DRIVERS))
import haptos_scaling  # noqa: E402
import haptos_scaling_model as model  # noqa: E402


class Scaling(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="haptos_")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def run_driver(self, *arguments):
        command = [sys.executable, str(DRIVERS / "haptos_scaling.py"), "--haptos", programs.counting,
                   "--mpirun", programs.mpirun, *map(str, arguments)]
        return subprocess.run(command, capture_output=True, text=True, timeout=3000)

    def rows(self, name):
        return list(csv.DictReader((self.folder / name).read_text().splitlines()))

    def test_table_and_formulas(self):
        cells = [(1, 2, 1), (2, 2, 3), (2, 1, 8)]
        arguments = [word for cell in cells for word in ("--cell", *cell)]
        done = self.run_driver(*arguments, "--folder", self.folder)
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        rows = self.rows("scaling.csv")
        self.assertEqual([(int(r["k"]), int(r["p"]), int(r["ranks"])) for r in rows], cells)
        for row in rows:
            self.assertEqual(row["status"], "converged")
            self.assertGreater(int(row["multiplications"]), 5)
            self.assertEqual(int(row["reductions"]) > 0, int(row["ranks"]) > 1)
            self.assertEqual(float(row["mbytes_sent"]) > 0, int(row["ranks"]) > 1)
            self.assertEqual(int(row["oversubscribed"]), int(int(row["ranks"]) > haptos_scaling.processors()))
            self.assertGreater(float(row["total_seconds"]), 0)
        marked = [line for line in done.stdout.splitlines() if line.startswith("   8*")]
        self.assertEqual(len(marked), int(haptos_scaling.processors() < 8), done.stdout)
        formulas = self.rows("scaling_formulas.csv")
        self.assertEqual({row["agrees"] for row in formulas}, {"yes"}, done.stdout)
        bytes_of_B = [int(r["measured"]) for r in formulas if r["quantity"] == "bytes of B, all ranks"]
        self.assertEqual([number > 0 for number in bytes_of_B], [False, True, True])

    def test_a_shared_coarse_factor_keeps_to_its_formulas(self):
        done = self.run_driver("--cell", 4, 1, 8, "--set", "Coarse Problem->Replicated Up To=0", "--folder", self.folder)
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        formulas = {row["quantity"]: row for row in self.rows("scaling_formulas.csv")}
        self.assertEqual({row["agrees"] for row in formulas.values()}, {"yes"}, done.stdout)
        for quantity in ("bytes of the coarse solves <=", "reductions of the coarse solves <=", "coarse entries read, most of a rank <="):
            self.assertGreater(int(formulas[quantity]["measured"]), 0)

    def test_a_wrong_count_is_seen(self):
        path = self.folder / "summary.json"
        done = run_haptos([haptos_runs.INPUTS / "table31.xml", "--set", "Mesh->Two Beams->Elements Per Subdomain Edge=1",
                           "--output", self.folder / "result.exo", "--summary", path], ranks=4, counting=True)
        self.assertEqual(done.status, 0, done)
        summary = json.loads(path.read_text())
        self.assertTrue(all(model.agrees(row) for row in model.compare(summary, 2, 1)))
        for block, key in (("jump", "message_bytes"), ("jump_transposed", "messages")):
            summary["communication"][block][key][1] += 8
            self.assertFalse(all(model.agrees(row) for row in model.compare(summary, 2, 1)))
            summary["communication"][block][key][1] -= 8
        summary["coarse"]["blocks"] -= 1
        self.assertFalse(all(model.agrees(row) for row in model.compare(summary, 2, 1)))

    def test_closed_form_of_slabs(self):
        """Where ranks hold whole layers the lattice gives the formula of doc/scaling.md.

        The contact plane has no clamp, and there both sides own rows.
        """
        for k, p, ranks in ((1, 3, 2), (2, 1, 2), (2, 3, 4), (3, 2, 2), (3, 2, 6), (4, 2, 8)):
            rows = model.imports(k, p, ranks)
            self.assertTrue(all(abs(owner - user) == 1 for owner, user in rows), (k, p, ranks))
            for rank in range(ranks - 1):
                upwards, downwards = rows[rank, rank + 1], rows.get((rank + 1, rank), 0)
                contact = 2 * (rank + 1) == ranks  # the contact surface is above this rank
                self.assertGreater(downwards, 0, (k, p, ranks, rank))
                self.assertEqual(8 * (upwards + downwards), model.slab_bytes(k, p, touches_clamp=not contact), (k, p, ranks, rank))

    def test_wrong_input(self):
        for arguments, part in (
                (["--cell", 0, 2, 2, "--folder", self.folder], "--cell 0 2 2"),
                (["--cell", 1, 2, "x", "--folder", self.folder], "invalid int value: 'x'"),
                (["--study", "nothing"], "invalid choice: 'nothing'"),
                (["--quick"], "--quick and --cell need a --folder"),
                (["--time-limit", -1], "--time-limit -1: must be positive"),
                (["--haptos", "/no/such/program"], "--haptos /no/such/program: no such program"),
                (["--mpirun", "no-such-mpirun -x"], "--mpirun no-such-mpirun -x: no such program"),
                (["--unknown"], "unrecognized arguments: --unknown"),
                (["--cell", 1, 1, 1, "--folder", self.folder, "--input", self.folder / "none.xml"], "none.xml"),
                (["--cell", 1, 1, 1, "--folder", self.folder, "--set", "Solver->Methot=SMALSE"], "did you mean 'Method'?")):
            done = self.run_driver(*arguments)
            lines = done.stderr.strip().splitlines()
            self.assertEqual((done.returncode, len(lines)), (1, 1), (arguments, done.stderr))
            self.assertTrue(lines[0].startswith("haptos_scaling: "), lines)
            self.assertIn(part, lines[0])

    def test_help(self):
        done = self.run_driver("--help")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        for option in ("--study", "--cell", "--haptos", "--mpirun", "--folder", "--draw", "--redraw"):
            self.assertIn(option, done.stdout)


if __name__ == "__main__":
    haptos_runs.main()
