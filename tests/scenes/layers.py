#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Thin layers between two blocks, covered wholly or in part: multiplications by F and seconds, as a table.

    tests/scenes/layers.py --haptos build/release/bin/haptos [--seed 1] [--scenes 12] [--only N ...] [--most 40]

Shims a twentieth to a five-hundredth as thick as the blocks are wide, a tenth as stiff to ten times as stiff as these; the upper block covers all of them,
one half or the middle, all three in meshes of their own.  Divisions, elements, stiffnesses, coefficients, axes and loads are drawn from the seed.
Exit status 1 where one is not solved, or takes more multiplications than --most.
"""
import sys

import corners  # ends with 77 where modules are missing
import numpy as np
from shells import Shell, box


class Layer(Shell):
    """One scene of a seed, with a contact on either side of the layer."""

    KINDS = ("covered", "half covered", "covered in the middle")
    COVERED = {"covered": (0.0, 2.0), "half covered": (0.0, 1.0), "covered in the middle": (0.6, 1.4)}

    def __init__(self, seed, index):
        rng = np.random.default_rng([seed, index])
        self.kind = self.KINDS[index % len(self.KINDS)]
        self.shape = str(rng.choice(["HEX8", "TETRA4", "HEX20", "TETRA10"]))
        self.thickness = float(10 ** rng.uniform(-2.7, -1.3))
        is_quadratic = self.shape in ("HEX20", "TETRA10")
        self.along, self.across, self.layers = int(rng.integers(8, 17)), int(rng.integers(4, 9)), 1 if is_quadratic else 2
        if is_quadratic:
            self.along, self.across = self.along // 2, self.across // 2
        self.other = self.along + int(rng.integers(-2, 3))
        coefficient, ratio = 10 ** rng.uniform(-1.2, -0.2), 10 ** rng.uniform(0, 1.5)
        self.friction = tuple(float(x) for x in rng.permutation([coefficient, coefficient / ratio]))
        self.young = [2e5, float(2e5 * 10 ** rng.uniform(-1, 1)), 2e5]
        self.subdomains = int(rng.choice([0, 8]))
        self.axis = tuple(float(x) for x in rng.permutation([1.0, 0.5])) + (0.0,)
        self.held, side = [("low_bottom", "xyz"), ("thin_left", "xyz"), ("high_left", "xyz")], 0.3 * min(self.friction)
        self.loads = [("Traction", "high_top", [side * float(rng.uniform(-1, 1)), side * float(rng.uniform(-1, 1)), -1.0])]
        self.contacts = [("thin_bottom", "low_top"), ("thin_top", "high_bottom")]
        t, covered = self.thickness, self.COVERED[self.kind]
        self.bodies = [("low", (self.other, self.across + 1, 3), box((0, 2), (0, 1), (-0.5, 0)), False),
                       ("thin", (self.along, self.across, self.layers), box((0, 2), (0, 1), (0, t)), False),
                       ("high", (max(2, self.other // 2), self.across, 3), box(covered, (0, 1), (t, t + 0.5)), False)]


if __name__ == "__main__":
    sys.exit(corners.main(Layer, __doc__))
