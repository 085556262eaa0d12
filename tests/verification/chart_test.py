# SPDX-License-Identifier: BSD-3-Clause
"""drivers/haptos_chart.py on the smallest cells and a few scenes: rows, columns, pictures, and drawing anew."""
import argparse
import csv
import pathlib
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

try:
    import matplotlib  # noqa: F401
    import netCDF4  # noqa: F401
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "drivers" / "haptos_chart.py"
programs = argparse.Namespace()


def chart(folder, *arguments):
    command = [sys.executable, str(SCRIPT), "--haptos", programs.haptos, "--scenes-test", programs.scenes_test,
               "--quick", "--folder", str(folder), *arguments]
    return subprocess.run(command, capture_output=True, text=True)


def rows_of(path):
    return list(csv.DictReader(path.read_text().splitlines()))


class Chart(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory(prefix="haptos_")
        cls.folder = pathlib.Path(cls.temporary.name)
        done = chart(cls.folder, "--k", "1", "--only", "counts", "--only", "tied", "--only", "profile")
        assert done.returncode == 0, done.stderr

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def test_counts(self):
        rows = rows_of(self.folder / "counts.csv")
        self.assertEqual([(r["k"], r["p"], r["tolerance"]) for r in rows],
                         [("1", str(p), t) for p in (2, 3, 4, 5) for t in ("0.0001", "1e-06")])
        for row in rows:
            self.assertEqual(row["status"], "converged")
            self.assertLessEqual(float(row["kkt"]), float(row["tolerance"]))
            self.assertTrue(0 < int(row["multiplications"]) < int(row["published"]))

    def test_tied(self):
        rows = rows_of(self.folder / "tied.csv")
        self.assertEqual([r["p"] for r in rows], ["2", "3", "4", "5"])
        for row in rows:
            self.assertEqual((row["contact_status"], row["tied_status"], row["tied_method"]), ("converged", "converged", "PCPG"))
            ratio = int(row["contact_multiplications"]) / int(row["tied_multiplications"])
            self.assertAlmostEqual(float(row["ratio_multiplications"]), ratio, delta=1e-3)
            self.assertLessEqual(ratio, 2.5)
            self.assertGreater(float(row["ratio_seconds"]), 0)

    def test_profile(self):
        rows = rows_of(self.folder / "profile.csv")
        self.assertEqual(len(rows), 36)
        self.assertEqual({r["method"] for r in rows}, {"SMALSE", "Subspace Newton", "Automatic"})
        held = [r for r in rows if r["method"] == "Automatic" and r["status"] == "holds"]
        self.assertGreaterEqual(len(held), 8)

    def test_pictures_are_drawn_anew_from_the_tables(self):
        for name in ("counts", "tied", "profile"):
            before = (self.folder / f"{name}.svg").read_bytes()
            self.assertTrue(xml.etree.ElementTree.fromstring(before).tag.endswith("svg"))
            self.assertGreater(len(before), 5000)
            self.assertEqual(chart(self.folder, "--redraw", "--only", name).returncode, 0)
            self.assertEqual((self.folder / f"{name}.svg").read_bytes(), before)

    def test_quick_replaces_no_complete_chart(self):
        done = subprocess.run([sys.executable, str(SCRIPT), "--quick"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("--folder", done.stderr)


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--haptos", required=True)
    parser.add_argument("--scenes-test", required=True)
    _, rest = parser.parse_known_args(namespace=programs)
    unittest.main(argv=[sys.argv[0], *rest], verbosity=2)
