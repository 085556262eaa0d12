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
import haptos_scaling_model as model  # noqa: E402


class Scaling(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="haptos_")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def run_driver(self, *arguments):
        command = [sys.executable, str(DRIVERS / "haptos_scaling.py"), "--haptos", programs.counting,
                   "--launcher", programs.mpirun, *map(str, arguments)]
        return subprocess.run(command, capture_output=True, text=True, timeout=3000)

    def rows(self, name):
        return list(csv.DictReader((self.folder / name).read_text().splitlines()))

    def test_table_and_formulas(self):
        cells = [(1, 2, 1), (2, 2, 3), (2, 1, 8), (0, 6, 2)]
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
            self.assertEqual(int(row["oversubscribed"]), int(int(row["ranks"]) > os.cpu_count()))
            self.assertGreater(float(row["total_seconds"]), 0)
            self.assertEqual(bool(row["total_efficiency"]), row["oversubscribed"] == "0")
            for name in ("elements", "factor_bytes_read") if row["k"] == "0" else ("elements",):  # bricks share factors
                share = float(row[f"{name}_share"]) * int(row["ranks"])
                self.assertTrue(0.999 <= share <= (1.3 if int(row["ranks"]) < 8 else 2), (name, row))
        self.assertEqual(float(rows[0]["solve_efficiency"]), 1)
        marked = [line for line in done.stdout.splitlines() if line.startswith("   8*")]
        self.assertEqual(len(marked), int(os.cpu_count() < 8), done.stdout)
        formulas = self.rows("scaling_formulas.csv")
        self.assertEqual({row["agrees"] for row in formulas}, {"yes"}, done.stdout)
        bytes_of_B = [int(r["measured"]) for r in formulas if r["quantity"] == "bytes of B, all ranks"]
        self.assertEqual([number > 0 for number in bytes_of_B], [False, True, True])

    def test_a_shared_coarse_factor_keeps_to_its_formulas(self):
        done = self.run_driver("--cell", 4, 1, 8, "--set", "Coarse Problem->Replicated Up To=0", "--folder", self.folder)
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        formulas = {row["quantity"]: row for row in self.rows("scaling_formulas.csv")}
        self.assertEqual({row["agrees"] for row in formulas.values()}, {"yes"}, done.stdout)
        summary = json.loads((self.folder / "scaling.json").read_text())[-1]
        shared = ["coarse entries read, most of a rank <="] if model.counts_factors(summary) else []
        for quantity in ("bytes of the coarse solves <=", "reductions of the coarse solves <=", *shared):
            self.assertGreater(int(formulas[quantity]["measured"]), 0)

    def test_bounds_of_metis_parts(self):
        done = self.run_driver("--cell", 0, 12, 4, "--parts", 200, "--set", "Coarse Problem->Replicated Up To=0", "--folder", self.folder)
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        self.assertEqual(self.rows("scaling.csv")[0]["subdomains"], "200")
        formulas = {row["quantity"]: row for row in self.rows("scaling_formulas.csv")}
        self.assertEqual({row["agrees"] for row in formulas.values()}, {"yes"}, done.stdout)
        summary = json.loads((self.folder / "scaling.json").read_text())[-1]
        counts = model.counts_factors(summary)
        for name in ("bytes of factors read", "bytes of B", "bytes of B^T", "coarse entries held", *(["multiplications in coarse factors"] if counts else [])):
            row = formulas[f"{name}, most of a rank <="]
            self.assertTrue(0.1 * int(row["formula"]) < int(row["measured"]) <= int(row["formula"]), row)
        self.assertTrue(all(model.agrees(row) for row in model.compare(summary, 0, 12)))
        for block, key in ((summary["local"], "bytes_read"), (summary["coarse"], "entries_read" if counts else "solve_bytes"),
                           (summary["communication"]["jump"]["over_ranks"]["message_bytes"], "max")):
            block[key] *= 3
            self.assertFalse(all(model.agrees(row) for row in model.compare(summary, 0, 12)), key)
            block[key] /= 3

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

    def launcher(self, name):
        """A program that is told as mpirun is, writes down what it was told and leaves the rest to that."""
        path = self.folder / "programs" / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(f'#!/bin/sh\nprintf "%s\\n" "$*" >> {shlex.quote(str(self.folder / "told"))}\nexec {programs.mpirun} "$@"\n')
        path.chmod(0o755)
        return path

    def test_repeated_runs_by_another_launcher(self):
        cells = self.folder / "cells"
        cells.write_text("# k p ranks\n2 1 1\n\n2, 1, 2  # once more\n")
        done = self.run_driver("--cells", cells, "--repeat", 2, "--launcher", f"{self.launcher('start')} --quiet", "--folder", self.folder)
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        told = (self.folder / "told").read_text().splitlines()
        self.assertEqual([line.split()[:3] for line in told], [["--quiet", "-n", n] for n in "11112222"])  # the empty program, too
        runs = json.loads((self.folder / "scaling.json").read_text())
        self.assertEqual([(run["k"], run["haptos"]["ranks"]) for run in runs], [(1, 1)] * 2 + [(2, 1)] * 2 + [(1, 2)] * 2 + [(2, 2)] * 2)
        for run in runs:
            for key in ("mpi", "blas", "host", "trilinos"):
                self.assertTrue(run["machine"][key])
            seconds = run["time_over_ranks"]["solve"]
            self.assertTrue(0 < seconds["min"] <= seconds["max"] == run["time"]["solve"])
        costs = [min(run["time"]["total"] for run in runs[first:first + 2]) for first in (2, 6)]
        for row, cost, ranks in zip(self.rows("scaling.csv"), costs, (1, 2)):
            self.assertEqual((row["runs"], int(row["ranks"])), ("2", ranks))
            self.assertAlmostEqual(float(row["total_seconds"]), cost, 3)
            self.assertLessEqual(float(row["total_seconds"]), float(row["median_total_seconds"]))
            self.assertAlmostEqual(float(row["total_efficiency"]), costs[0] / (ranks * cost), 3)

    def test_batch_script(self):
        """What it writes does the same by srun, when it runs."""
        script, study = self.folder / "job.sh", self.folder / "by job"
        done = self.run_driver("--cell", 2, 1, 3, "--cell", 1, 1, 2, "--time-limit", 300, "--folder", study, "--slurm", script,
                               "--sbatch=--partition=short", "--sbatch=--exclusive")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(list(study.glob("*")), [])
        lines = script.read_text().splitlines()
        for option in ("--ntasks=3", "--time=10", "--partition=short", "--exclusive"):
            self.assertIn(f"#SBATCH {option}", lines)
        path = f"{self.launcher('srun').parent}{os.pathsep}{os.environ['PATH']}"
        done = subprocess.run(["bash", str(script)], capture_output=True, text=True, env={**os.environ, "PATH": path}, timeout=600)
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        told = (self.folder / "told").read_text().splitlines()
        self.assertEqual({line.split()[1] for line in told}, {"2", "3"})
        self.assertEqual(len(list(csv.DictReader((study / "scaling.csv").read_text().splitlines()))), 2)

    def test_counts_that_change_are_seen(self):
        """A launcher that starts one more rank the second time."""
        path = self.launcher("start")
        path.write_text(f'#!/bin/sh\necho >> {shlex.quote(str(self.folder / "told"))}\n[ $(wc -l < {shlex.quote(str(self.folder / "told"))}) = 2 ] && '
                        f'{{ shift 2; set -- -n 2 "$@"; }}\nexec {programs.mpirun} "$@"\n')
        done = self.run_driver("--cell", 2, 1, 1, "--repeat", 2, "--launcher", path, "--folder", self.folder)
        self.assertEqual(done.returncode, 1)
        self.assertIn("repeated", done.stderr)

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
        wrong, empty = self.folder / "wrong", self.folder / "empty"
        wrong.write_text("1 1 1\n2 1\n")
        empty.write_text("# nothing\n")
        for arguments, part in (
                (["--cell", 1, 0, 2, "--folder", self.folder], "--cell 1 0 2"),
                (["--cell", 1, 2, "x", "--folder", self.folder], "invalid int value: 'x'"),
                (["--study", "nothing"], "invalid choice: 'nothing'"),
                (["--quick"], "--quick, --cell and --cells need a --folder"),
                (["--cells", self.folder / "none", "--folder", self.folder], "none"),
                (["--cells", wrong, "--folder", self.folder], "line 2: '2 1' is not k, p and ranks"),
                (["--cells", empty, "--folder", self.folder], "no cell in it"),
                (["--repeat", 0], "--repeat 0: must be at least 1"),
                (["--parts", -1], "--parts -1: must not be negative"),
                (["--sbatch", "x"], "--sbatch tells what --slurm writes"),
                (["--time-limit", -1], "--time-limit -1: must be positive"),
                (["--haptos", "/no/such/program"], "--haptos /no/such/program: no such program"),
                (["--mpirun", "no-such-mpirun -x"], "--launcher no-such-mpirun -x: no such program"),
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
        for option in ("--study", "--cell", "--haptos", "--launcher", "--slurm", "--folder", "--draw", "--redraw"):
            self.assertIn(option, done.stdout)


if __name__ == "__main__":
    haptos_runs.main()
