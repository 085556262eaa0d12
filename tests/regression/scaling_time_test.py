# SPDX-License-Identifier: BSD-3-Clause
"""drivers/haptos_scaling_time.py: its formulas by hand and against counters, its tables and chart.  Status 77 without its packages."""
import csv
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import matplotlib  # noqa: F401
    import mpi4py  # noqa: F401
    import numpy  # noqa: F401
except ImportError as error:
    print(f"scaling_time_test: skipped, {error}")
    sys.exit(77)

import haptos_runs
from haptos_runs import programs, run_haptos

DRIVERS = pathlib.Path(__file__).resolve().parents[2] / "drivers"
sys.path.insert(0, str(DRIVERS))
import haptos_scaling_time as model  # noqa: E402
from haptos_scaling_model import counts_factors  # noqa: E402

WORK = model.Work(part=125, multiplications=20, unknowns=5, flops=1e5, bytes=1e4, mesh=1e-6, factor=0.1, solve=0.5)
RATES = {"bandwidth": 1e10, "flops": 4e10, "latency": 1e-6, "link": 1e9}


class ScalingTime(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="haptos_")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def run_driver(self, *arguments):
        command = [sys.executable, str(DRIVERS / "haptos_scaling_time.py"), "--haptos", programs.counting,
                   "--launcher", programs.mpirun, "--folder", str(self.folder), *map(str, arguments)]
        return subprocess.run(command, capture_output=True, text=True, timeout=600)

    def rows(self, name):
        return list(csv.DictReader((self.folder / name).read_text().splitlines()))

    def run_of(self, elements, ranks):
        path = self.folder / "summary.json"
        done = run_haptos([haptos_runs.INPUTS / "table31.xml", "--set", "Mesh->Two Beams->Subdomains Per Edge=1", "--set", "Decomposition->Method=METIS",
                           "--set", f"Mesh->Two Beams->Elements Per Subdomain Edge={elements}", "--output", self.folder / "result.exo",
                           "--summary", path], ranks=ranks, counting=True)
        self.assertEqual(done.status, 0, done)
        summary = json.loads(path.read_text())
        if not counts_factors(summary):
            self.assertRaises(model.Failure, model.work_of, summary, RATES)
            self.skipTest("a build without CHOLMOD does not count what the model is made from")
        return summary

    def test_one_rank_by_hand(self):
        """25,000 elements: 200 parts of 125, l = 1200."""
        parts = model.seconds(WORK, RATES, 25000, 1)
        expected = {"mesh": 0.025, "factor": 25000 * 1e5 / 4e9, "local": 20 * 25000 * 1e4 / 5e9, "neighbours": 0, "reductions": 0,
                    "coarse_work": 65 * 1200 ** 2 / 5e9 + 8 * 6 * 20 * 20 * 1200 ** (4 / 3) / 1e10, "coarse_payload": 0}
        for name, value in expected.items():
            self.assertAlmostEqual(parts[name], value, 12, name)

    def test_messages_by_hand(self):
        """Eight boxes of 8 subdomains of 5 x 5 x 5 elements, l = 384, a factor on every rank."""
        q = model.quantities(WORK, 8000, 8)
        self.assertAlmostEqual(q["bytes of B and B^T"], 2 * 2.2 * 20 * 3 * 72 / 2 * 4 * 6 ** 2)       # 1 - R^(-1/3) is 1/2, (s / R)^(2/3) is 4
        self.assertEqual(q["bytes of coarse solves"], 120 * 8 * 384)
        self.assertEqual(q["reductions"], 20 * 27)
        parts = model.seconds(WORK, RATES, 8000, 8)
        self.assertAlmostEqual(parts["reductions"], 20 * 27 * 6e-6)
        self.assertAlmostEqual(parts["neighbours"], q["bytes of B and B^T"] / 1e9 + 2 * 2.2 * 20 * 7e-6)

    def test_rates_act_on_their_parts(self):
        of_rate = {"latency": {"neighbours", "reductions"}, "link": {"neighbours", "coarse_payload"}, "flops": {"factor", "coarse_work"},
                   "bandwidth": {"local", "coarse_work"}}
        before = model.seconds(WORK, RATES, 1e7, 1000)
        for rate, expected in of_rate.items():
            after = model.seconds(WORK, {**RATES, rate: 2 * RATES[rate]}, 1e7, 1000)
            self.assertEqual({name for name in model.PARTS if after[name] != before[name]}, expected)

    def test_what_falls_with_the_ranks(self):
        """Work of one mesh does, what every rank gets of fronts does not: that is what ends."""
        few, many = (model.seconds(WORK, RATES, 1e8, ranks) for ranks in (64, 4096))
        for name in ("mesh", "factor", "local", "coarse_work"):
            self.assertLess(many[name], few[name] / 40)
        self.assertAlmostEqual(many["coarse_payload"], few["coarse_payload"])

    def test_formulas_and_counters(self):
        """Work an element comes from another mesh than the one that is compared, on four ranks that share the coarse factor."""
        work = model.work_of(self.run_of(12, 1), RATES)
        run = self.run_of(24, 4)
        ratios = {row["quantity"]: float(row["ratio"]) for row in model.check(work, lambda ranks: RATES, {(24, 4, 0): run}) if "seconds" not in row["quantity"]}
        self.assertEqual(set(ratios), set(model.quantities(work, 1, 1)))
        for name, ratio in ratios.items():
            allowed = 0.2 if name in ("elements", "factor flops", "factor bytes read", "coarse unknowns", "reductions") else 1.5
            self.assertTrue(1 / (1 + allowed) < ratio < 1 + allowed, (name, ratio))
        run["local"]["flops"] *= 2
        doubled = {row["quantity"]: float(row["ratio"]) for row in model.check(work, lambda ranks: RATES, {(24, 4, 0): run})}
        self.assertAlmostEqual(doubled["factor flops"], ratios["factor flops"] / 2, 1)

    def test_tables_and_chart(self):
        done = self.run_driver("--quick", "--link", 1e9)
        if done.returncode == 1 and "without CHOLMOD" in done.stderr:
            self.run_of(6, 1)  # skips where that is so
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        ratios = {(row["ranks"], row["quantity"]): float(row["ratio"]) for row in self.rows("scaling_model_check.csv")}
        for name in ("elements", "factor flops", "factor bytes read", "coarse unknowns", "seconds: mesh", "seconds: factor", "seconds: solve"):
            self.assertEqual(ratios["1", name], 1, name)             # the run that the rates come from
        self.assertIn(("2", "bytes of B and B^T"), ratios)
        rows = self.rows("scaling_model.csv")
        cases = list(dict.fromkeys(row["case"] for row in rows))
        self.assertEqual((len(cases), len(rows)), (4, 28))
        for row in rows:
            self.assertAlmostEqual(sum(float(row[name]) for name in model.PARTS), float(row["total"]), 3)
        growing = [row for row in rows if row["case"] == cases[0]]
        self.assertAlmostEqual(int(growing[-1]["unknowns"]) / int(growing[0]["unknowns"]), 100000 / 64, 1)
        chart = self.folder / "scaling_model.svg"
        drawn = chart.read_bytes()
        self.assertIn(b"<svg", drawn)
        chart.unlink()
        self.assertEqual(self.run_driver("--redraw").returncode, 0)
        self.assertEqual(chart.read_bytes(), drawn)

    def test_wrong_input(self):
        for arguments, part in ((["--latency", 0], "must be positive"), (["--redraw"], "scaling_model.csv"),
                                (["--quick", "--launcher", "no-such-mpirun"], "no-such-mpirun")):
            done = self.run_driver(*arguments)
            self.assertEqual((done.returncode, len(done.stderr.splitlines())), (1, 1), done.stderr)
            self.assertIn(part, done.stderr)

    def test_work_is_of_the_run(self):
        """The model of the run that it was made from tells that run's seconds."""
        run = self.run_of(6, 1)
        work = model.work_of(run, RATES)
        parts, told = model.seconds(work, RATES, run["local"]["elements_all"], 1), model.told_seconds(run)
        self.assertAlmostEqual(parts["mesh"], told["mesh"], 12)
        self.assertAlmostEqual(parts["factor"], told["factor"], 12)
        self.assertAlmostEqual(parts["local"], told["solve"], 12)


if __name__ == "__main__":
    haptos_runs.main()
