#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Checks inputs/dovetail.exo by netCDF4 alone.  Exit status 77 (skipped) where it is missing."""
import pathlib
import sys
import unittest

try:
    import numpy as np
    from exodus_arrays import Exodus
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)

SOURCE = pathlib.Path(__file__).resolve().parents[2]


class Dovetail(unittest.TestCase):
    """The shipped mesh, by netCDF4 alone."""
    path = SOURCE / "inputs" / "dovetail.exo"

    @classmethod
    def setUpClass(cls):
        cls.mesh = Exodus(cls.path)

    def test_size_and_blocks(self):
        self.assertLess(self.path.stat().st_size, 3_000_000)
        self.assertLess(len(self.mesh.x), 35_000)
        self.assertEqual({n: s for n, (s, _) in self.mesh.blocks.items()}, {"root": "HEX8", "disc": "HEX8"})
        for name in ("disc_cut_left", "disc_cut_right", "disc_inner", "root_top", "root_front", "root_back"):
            self.assertGreater(len(self.mesh.side_sets[name][0]), 10, name)

    def test_volumes_are_positive_and_nodes_used(self):
        for name in self.mesh.blocks:
            self.assertGreater(self.mesh.volumes(name).min(), 0, name)
        used = np.unique(np.concatenate([rows.ravel() for _, rows in self.mesh.blocks.values()]))
        self.assertEqual(len(used), len(self.mesh.x))
        root, disc = (np.unique(rows) for _, rows in self.mesh.blocks.values())
        self.assertEqual(len(np.intersect1d(root, disc)), 0, "root and disc must not be glued")

    def test_flanks_match_node_by_node(self):
        for side, x in (("left", -1), ("right", 1)):
            root, disc = (self.mesh.set_nodes(f"{body}_flank_{side}") for body in ("root", "disc"))
            self.assertGreater(len(root), 100)
            self.assertEqual(len(root), len(disc))
            a, b = (self.mesh.x[n][np.lexsort(self.mesh.x[n].round(9).T)] for n in (root, disc))
            np.testing.assert_allclose(a, b, atol=1e-12)
            outward, area = self.mesh.area_vector(f"root_flank_{side}")
            inward, _ = self.mesh.area_vector(f"disc_flank_{side}")
            np.testing.assert_allclose(outward, -inward, atol=1e-9)
            self.assertAlmostEqual(np.linalg.norm(outward) / area, 1, places=9)      # plane
            # 6 mm flank at 40 degrees to the radial direction, 30 mm long, sheared by 8 degrees along z
            np.testing.assert_allclose(outward[:2], 180 * np.array([x * np.cos(np.radians(40)), np.sin(np.radians(40))]), rtol=1e-9)
            self.assertAlmostEqual(outward[2] / outward[0], -np.tan(np.radians(8)), places=9)

    def test_flanks_continue_as_fillets(self):
        """Past the flank's edges root and disc part: no other node of the root lies on the disc, the gap opens from zero."""
        flank = np.concatenate([self.mesh.set_nodes(f"root_flank_{s}") for s in ("left", "right")])
        disc = self.mesh.x[np.unique(self.mesh.blocks["disc"][1])]
        root = np.setdiff1d(np.unique(self.mesh.blocks["root"][1]), flank)
        middle = root[np.abs(self.mesh.x[root, 2] - self.mesh.x[:, 2].min()) < 1e-9]
        face = disc[np.abs(disc[:, 2] - self.mesh.x[:, 2].min()) < 1e-9]
        gaps = np.array([np.linalg.norm(face - p, axis=1).min() for p in self.mesh.x[middle]])
        self.assertGreater(gaps.min(), 0.005)
        self.assertGreater(np.sum(gaps < 0.3), 4)      # the arcs leave each other slowly

    def test_supports_are_planes_across_the_axes(self):
        for name, axis in (("disc_cut_left", 0), ("disc_cut_right", 0), ("disc_inner", 1), ("root_front", 2)):
            values = self.mesh.x[self.mesh.set_nodes(name), axis]
            self.assertLess(np.ptp(values), 1e-9, name)


if __name__ == "__main__":
    unittest.main()
