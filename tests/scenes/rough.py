#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Rough surfaces pressed on one another, held along both tangents at one end: multiplications by F and seconds, as a table.

    tests/scenes/rough.py --haptos build/release/bin/haptos [--seed 1] [--scenes 12] [--only N ...] [--most 40]

A block on a clamped one, or on a rigid plane; from a few spots in contact to all.  Waves of the surfaces, divisions of both blocks (mortar where they differ),
coefficients, axes and loads are drawn from the seed.  Exit status 1 where one is not solved, or takes more multiplications than --most.
"""
import math
import sys

import corners  # ends with 77 where modules are missing
import numpy as np
import random_scenes
from corners import array, coulomb, hold, listed, material, parameter, problem, rigid_plane
from haptos_exodus import Block, ExodusMesh, SideSet
from random_scenes import BodyMesh, Written


def surface(rng, length):
    """Heights over x, y of waves in all directions, three of the shortest on `length`; their mean square is 1."""
    waves = 40
    directions, phases = rng.uniform(0, 2 * math.pi, (2, waves))
    numbers = 2 * math.pi / length * rng.uniform(0.5, 3, waves)
    heights = numbers ** -1.8
    heights *= math.sqrt(2 / (heights ** 2).sum())
    return lambda x, y: sum(h * np.cos(k * (np.cos(d) * x + np.sin(d) * y) + p) for h, k, d, p in zip(heights, numbers, directions, phases))


class Rough(Written):
    """One scene of a seed, as `aspects.solve` takes it."""

    def __init__(self, seed, index):
        rng = np.random.default_rng([seed, index])
        self.on_plane, self.is_held = index % 4 == 3, index % 4 != 2
        n = int(rng.integers(6, 21))
        self.shape = str(rng.choice(["HEX8", "HEX8", "TETRA4", "TETRA10"])) if index % 2 else "HEX8"
        n = max(4, n // 2) if self.shape == "TETRA10" else n
        self.divisions = [(n, n, max(2, n // 4))]
        if not self.on_plane:
            self.divisions.insert(0, self.divisions[0] if rng.random() < 0.3 else (max(3, n - 3), max(3, n - 2), max(2, n // 4)))
        self.height, self.length = float(10 ** rng.uniform(-5, -2)), float(rng.uniform(0.15, 1))
        self.surfaces = [surface(rng, self.length) for _ in self.divisions]
        self.young = [float(2e5 * 10 ** rng.uniform(-1, 1)) for _ in self.divisions]
        coefficient, ratio = 10 ** rng.uniform(-1.3, 0), 10 ** rng.uniform(0, 2)
        self.friction = tuple(float(x) for x in rng.permutation([coefficient, coefficient / ratio]))
        self.angle, self.pressure = float(rng.uniform(0, math.pi)), float(10 ** rng.uniform(0, 3))
        along, part = rng.uniform(0, 2 * math.pi), rng.uniform(0, 0.9)
        carries = 1 / math.hypot(math.cos(along - self.angle) / self.friction[0], math.sin(along - self.angle) / self.friction[1])
        pull = self.pressure * part * min(carries, 0.05 if not self.is_held else 1)     # a block that is not held must not tip
        self.pull = [float(pull * math.cos(along)), float(pull * math.sin(along)), 0.0]

    def describe(self):
        divisions = " on ".join("x".join(map(str, d)) for d in reversed(self.divisions))
        return (f"{self.shape} {divisions}{' on a plane' if self.on_plane else ''}{', held' if self.is_held else ''}, height {self.height:.1e} on "
                f"{self.length:.2f}, pressure {self.pressure:.2g}, ({self.friction[0]:.2g}, {self.friction[1]:.2g})")

    def mesh(self):
        points, blocks, sides, numbers = [], [], [], 0
        for body, (divisions, heights) in enumerate(zip(self.divisions, self.surfaces)):
            x, connectivity = random_scenes._body(BodyMesh(self.shape, divisions), (1, 1, 0.5))
            for name, axis, value in (("bottom", 2, 0.0), ("top", 2, 0.5), ("left", 0, 0.0)):
                elements, faces = random_scenes._sides_at(x, connectivity, self.shape, axis, value)
                sides.append(SideSet(len(sides) + 1, f"{name}{body}", elements + numbers, faces))
            share = x[:, 2] / 0.5 if body == 0 and not self.on_plane else 1 - x[:, 2] / 0.5     # of the side in contact
            x[:, 2] += share * self.height * heights(x[:, 0], x[:, 1]) + 0.5 * body
            blocks.append(Block(body + 1, f"body{body}", self.shape, connectivity + sum(map(len, points))))
            points.append(x)
            numbers += len(connectivity)
        points[-1][:, 2] += self.lift(points)
        return ExodusMesh(np.concatenate(points), blocks, sides)

    def lift(self, points):
        """What brings the surfaces together at their nearest."""
        if self.on_plane:
            return -points[0][:, 2].min()
        x, y = np.meshgrid(np.linspace(0, 1, 101), np.linspace(0, 1, 101))
        return self.height * (self.surfaces[0](x, y) - self.surfaces[1](x, y)).max()

    def input(self, name):
        upper = len(self.divisions) - 1
        materials = [material(f"material{b}", f"body{b}", E, 0.3) for b, E in enumerate(self.young)]
        friction = coulomb(self.friction, (math.cos(self.angle), math.sin(self.angle), 0))
        primary = rigid_plane((0, 0, 1)) if self.on_plane else parameter("Primary Side Set", "string", "top0")
        contact = listed("rough", parameter("Secondary Side Set", "string", f"bottom{upper}"), primary, friction)
        return problem(name, 6, materials, self.conditions(upper), [contact])

    def conditions(self, upper):
        top = parameter("Sets", "Array(string)", f"{{top{upper}}}")
        conditions = [listed("press", parameter("Type", "string", "Pressure"), parameter("Value", "double", repr(self.pressure)), top),
                      listed("pull", parameter("Type", "string", "Traction"), parameter("Value", "Array(double)", array(self.pull)), top)]
        return conditions + [hold("clamp", ["bottom0"], "xyz")] * (not self.on_plane) + [hold("hold", [f"left{upper}"], "xy")] * self.is_held


if __name__ == "__main__":
    sys.exit(corners.main(Rough, __doc__))
