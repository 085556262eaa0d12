# SPDX-License-Identifier: BSD-3-Clause
"""The smallest variant of every benchmark against its closed form, and the examples with known answers.

    benchmarks_test.py --haptos PROGRAM [Small|Large|Examples]
"""
import pathlib
import sys
import tempfile
import unittest

try:
    import netCDF4  # noqa: F401
    import numpy as np
    import scipy.interpolate
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

import cgs4
import crack
import half_spaces
import hertz
import partial_slip
import refinement
import rings
import runs
from haptos_runs import INPUTS, main, run_haptos


class Benchmark(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="haptos_")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def assert_small(self, values, bound, what=""):
        self.assertLessEqual(max(abs(v) for v in np.atleast_1d(values)), bound, what)


class Small(Benchmark):
    def test_block_on_a_slope(self):
        for shape in ("HEX8", "TETRA10"):
            for row in cgs4.measure(self.folder, (shape,)):
                self.assert_small(row["error"], cgs4.TOLERANCE, row)
                self.assertEqual((row["stick"], row["open"]), (0, 0), row)

    def test_rings(self):
        theory = rings.Rings()
        self.assert_small(theory.pressure(np.eye(2)) / [9.259259e6 + 1.357179e6, 9.259259e6 - 1.357179e6] - 1, 1e-6)
        self.assert_small(theory.displacement(np.eye(2), 1)[:, 0] / [-10.240274e-3, -5.759726e-3] - 1, 1e-6)
        for shape, sizes in (("HEX8", (8, 16, 32)), ("HEX20", (4, 8, 16)), ("TETRA10", (4, 8, 16))):
            found = [{"n": n, **rings.errors(rings.run(self.folder / f"{shape}_{n}", shape, n), theory)} for n in sizes]
            for key, least in zip(("surface", "field"), rings.ORDERS[shape]):
                self.assertGreaterEqual(rings.observed(found, key), least, (shape, key))
            if shape != "HEX8":
                self.assert_small(found[1]["rms"], rings.SMALL[0], shape)
                self.assert_small(found[1]["shift"], rings.SMALL[1], shape)

    def test_hertz(self):
        for scene, shape, n in (("sphere", "HEX20", 3.2), ("cylinder", "HEX20", 8), ("cylinder", "TETRA10", 8)):
            row = hertz.measure(self.folder, scene, shape, n)
            self.assert_small([row["peak"], row["force"]], hertz.SMALL[0], row)
            self.assert_small(row["radius"], hertz.SMALL[1], row)
            result = runs.read(self.folder / f"{scene}_{shape}_{n}")     # nodes of the secondary side have the multipliers themselves
            total = np.sum(result.fields["contact_normal_force"][result.body == 0])
            self.assert_small(total / result.summary["contact"]["joint"]["normal_force"] - 1, 1e-9)
            if scene == "cylinder":
                self.assert_order(row)
        for shape in ("TETRA4", "HEX8"):
            self.assert_order(hertz.measure(self.folder, "cylinder", shape, 16))

    def assert_order(self, row):
        """Of the cylinder's pressure, from a mesh twice as wide."""
        coarse = hertz.measure(self.folder, "cylinder", row["shape"], row["n"] / 2)
        self.assertGreaterEqual(np.log2(coarse["inside"] / row["inside"]), hertz.ORDERS[row["shape"]], row)

    def test_counts_on_thin_graded_meshes(self):
        """One layer of flat and long elements on rollers: contact, tied."""
        for shape, thickness, most, tied in (("HEX8", 1.0, 18, 16), ("HEX20", 1.0, 36, 45), ("HEX20", 0.3, 30, 30), ("TETRA10", 1.0, 50, 70),
                                             ("TETRA10", 0.3, 60, 80)):
            for law, bound in (({}, most), ({"Friction": {"Law": "Tied"}}, tied)):
                with self.subTest(shape=shape, thickness=thickness, **law):
                    folder = self.folder / f"{shape}_{thickness}_{len(law)}"
                    result = half_spaces.press(folder, shape, 8, hertz.CYLINDER, tolerance=1e-6, thickness=thickness, **law)
                    self.assertLessEqual(result.multiplications, bound)

    def test_crack(self):
        row = crack.measure(self.folder, "HEX8", 8)
        self.assert_small(row["slip"], crack.SMALL, row)
        self.assert_small(row["normal"], 1e-4, row)

    def test_refinement(self):
        rows = refinement.measure(self.folder, "cantilevers, HEX8 on TET10, friction")
        self.assert_small([rows[1][key] for key in ("energy error", "force error", "nodal error")], refinement.TOLERANCE, rows)
        self.assertGreater(rows[-1]["order"], 1.5)


class Large(Benchmark):
    def test_cattaneo(self):
        row = partial_slip.measure(self.folder, partial_slip.cattaneo_load(), "HEX20", 4, "x")
        self.assert_small([row["force"], row["peak"], row["x"]], partial_slip.CATTANEO_TOLERANCE, row)
        self.assertAlmostEqual(row["stick"], 0.5, delta=0.5 / 4)       # grows by whole nodes

    def test_oblique(self):
        for part in partial_slip.OBLIQUE:
            row = partial_slip.measure(self.folder / str(part), partial_slip.oblique_load(part), "HEX20", 3, "xy")
            self.assert_small([row["force"], row["x"], row["y"]], partial_slip.OBLIQUE_TOLERANCE, row)


class Examples(Benchmark):
    def solved(self, name, *arguments):
        outcome = run_haptos([INPUTS / f"{name}.xml", "--output", f"{name}.exo", "--summary", f"{name}.json", *arguments], folder=self.folder)
        self.assertEqual(outcome.status, 0, outcome)
        return runs.read(self.folder, f"{name}.exo", f"{name}.json")

    def test_shrink_fit(self):
        result = self.solved("shrink_fit")
        fit = result.summary["contact"]["fit"]
        self.assert_small(fit["normal_force"] / 433056.5 - 1, 1e-3)             # Lame
        self.assertEqual((fit["slip"], fit["open"]), (0, 0))
        at = result.pressures(0)
        force = result.vector("contact_force")[at]
        moment = np.sum(result.x[at, 0] * force[:, 1] - result.x[at, 1] * force[:, 0])
        self.assert_small(-moment / (0.8 * 2598338.8) - 1, 1e-3)                # 0.8 of F2 p 2 pi b^2 L
        pressure = result.fields["contact_pressure"][at]
        self.assert_small(np.sqrt(np.mean((pressure / 34.4615 - 1) ** 2)), 0.06)

    def test_dovetail_meshed_apart(self):
        apart, matching = self.solved("dovetail_tet10"), self.solved("dovetail")
        self.assertEqual(apart.summary["model"]["discretization"], "Mortar")
        self.assertLessEqual(apart.summary["accuracy"]["kkt"], 1e-6)
        for flank, sign in (("left flank", -1), ("right flank", 1)):
            one, other = (r.summary["contact"][flank] for r in (apart, matching))
            self.assert_small(one["normal_force"] / other["normal_force"] - 1, 0.01)
            self.assert_small(np.subtract(one["tangential_force"], other["tangential_force"]) / np.linalg.norm(other["tangential_force"]), 0.01)
            self.assert_small(self.difference(apart, matching, sign), 0.05)

    def difference(self, apart, matching, sign, margin=1.5):
        """Of the pressures on the root, a quarter of the flank's width away from its edges, at the nodes of either mesh."""
        (x, p), (y, q) = (self.on_flank(result, sign) for result in (apart, matching))
        def inside(z):
            return (np.abs(z[:, 0]) < 3 * np.cos(np.radians(40)) - margin) & (np.abs(z[:, 1]) < 15 - 2 * margin)
        first, second = (scipy.interpolate.LinearNDInterpolator(*pair) for pair in ((x, p), (y, q)))
        here, there = x[inside(x)], y[inside(y)]
        self.assertGreater(min(len(here), len(there)), 30)
        return np.concatenate([p[inside(x)] / second(here) - 1, first(there) / q[inside(y)] - 1])

    @staticmethod
    def on_flank(result, sign):
        """Places (y, z) and pressures; the flanks are skewed by 8 degrees."""
        at = result.pressures(0)
        at = at[sign * (result.x[at, 0] - np.tan(np.radians(8)) * result.x[at, 2]) > 0]
        return result.x[at, 1:], result.fields["contact_pressure"][at]


if __name__ == "__main__":
    main()
