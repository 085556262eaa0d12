#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Blocks that supports drag across the direction that they leave free: multiplications by F and seconds, as a table.

    tests/scenes/driven.py --haptos build/release/bin/haptos [--seed 1] [--scenes 12] [--only N ...] [--most 40]

On a rigid plane, on a clamped block with the same mesh, or with another one (mortar).  All nodes are moved across, or those of the contact surface alone;
coefficients, their axes (along x, along y, oblique), loads and how far is dragged are drawn from the seed.  Forces and slips of the result file must obey
the law to 1e-5 by the certificate's own rows: exit status 1 where they do not, where a scene is not solved, or takes more multiplications than --most.
"""
import json
import math
import pathlib
import sys

import corners  # ends with 77 where modules are missing
import numpy as np
import random_scenes
from certificate import _contact_errors, _multipliers, exchanged_sides, read_fields
from corners import array, coulomb, hold, listed, material, parameter, problem, rigid_plane, tresca
from haptos_exodus import Block, ExodusMesh, NodeSet
from interfaces import interfaces_of
from random_scenes import BodyMesh, Written

KINDS = ("plane", "matching", "mortar")


class Driven(Written):
    """One scene of a seed, as `aspects.solve` takes it."""

    def __init__(self, seed, index):
        rng = np.random.default_rng([seed, index])
        self.kind, self.whole = KINDS[index % 3], bool(rng.random() < 0.6)
        self.shape = str(rng.choice(["HEX8", "HEX8", "TETRA4", "TETRA10"])) if self.kind != "matching" else "HEX8"
        n = int(rng.integers(4, 13 if self.shape != "TETRA10" else 6))
        self.divisions = [(n, max(2, n // 2), max(2, n // 2))]
        if self.kind != "plane":
            self.divisions.insert(0, self.divisions[0] if self.kind == "matching" else (n + 2, max(2, n // 2 - 1), max(2, n // 3)))
        self.young = [float(2e5 * 10 ** rng.uniform(-1, 1)) for _ in self.divisions]
        coefficient, ratio = 10 ** rng.uniform(-1.3, 0), 10 ** rng.choice([0.2, 0.5, 1, 2, 4])
        self.friction = tuple(float(x) for x in rng.permutation([coefficient, coefficient / ratio]))
        self.angle = float(rng.choice([0, 0, 90, rng.uniform(0, 180)]))
        self.far = float(10 ** rng.uniform(-4, 1) * rng.choice([-1, 1]))
        self.is_free, along, part = bool(rng.random() < 0.5), math.radians(self.angle), rng.uniform(-0.95, 0.95)
        self.pull = float(part * min(0.3, math.hypot(self.friction[0] * math.cos(along), self.friction[1] * math.sin(along))))     # tips beyond .3
        self.gap, self.plane, self.bodies = 0.0, self.kind == "plane", len(self.divisions)
        self.law, self.slip_bound = ("Tresca", float(rng.uniform(0.5, 2))) if rng.random() < 0.2 and not self.is_free else ("Coulomb", 0.0)

    def is_mortar(self, _body):
        return self.kind == "mortar" or self.shape == "TETRA10"

    def describe(self):
        divisions = " on ".join("x".join(map(str, d)) for d in reversed(self.divisions))
        return (f"{self.shape} {divisions}, {self.kind}{'' if self.whole else ', the surface alone'}, {self.law} ({self.friction[0]:.2g}, {self.friction[1]:.2g}) "
                f"at {self.angle:.0f}, {self.far:.2g} of the strain{f', pulled by {self.pull:.2g}' if self.is_free else ''}")

    def mesh(self):
        points, blocks, sides, sets, numbers = [], [], [], [], 0
        for body, divisions in enumerate(self.divisions):
            x, connectivity = random_scenes._body(BodyMesh(self.shape, divisions), (1, 0.5, 0.5))
            first = sum(map(len, points))
            corners.add_sides(sides, f"{{}}{body}".format, x * (1, 2, 2), connectivity, self.shape, numbers)
            sets.append(NodeSet(body + 1, f"all{body}", np.arange(first, first + len(x))))
            blocks.append(Block(body + 1, f"body{body}", self.shape, connectivity + first))
            points.append(x + (0, 0, 0.5 * body))
            numbers += len(connectivity)
        return ExodusMesh(np.concatenate(points), blocks, sides, sets)

    def input(self, name):
        upper = len(self.divisions) - 1
        materials = [material(f"material{b}", f"body{b}", E, 0.3) for b, E in enumerate(self.young)]
        primary = rigid_plane((0, 0, 1)) if self.plane else parameter("Primary Side Set", "string", "top0")
        axis = [round(math.cos(math.radians(self.angle)), 15), round(math.sin(math.radians(self.angle)), 15), 0]
        friction = tresca(self.friction, axis, self.slip_bound) if self.law == "Tresca" else coulomb(self.friction, axis)
        contact = listed("dragged", parameter("Secondary Side Set", "string", f"bottom{upper}"), primary, friction)
        return problem(name, 8, materials, self.conditions(upper), [contact])

    def conditions(self, upper):
        top, dragged = f"top{upper}", f"all{upper}" if self.whole else f"bottom{upper}"
        along = hold("along", [top], "x", self.pull / min(self.young))
        if self.is_free:
            along = listed("along", parameter("Type", "string", "Traction"), parameter("Sets", "Array(string)", f"{{{top}}}"),
                           parameter("Value", "Array(double)", array([self.pull, 0.0, 0.0])))
        press = listed("press", parameter("Type", "string", "Pressure"), parameter("Value", "double", "1.0"), parameter("Sets", "Array(string)", f"{{{top}}}"))
        conditions = [press, along, hold("drag", [dragged], "y", self.far / min(self.young))]
        return conditions + [hold("clamp", ["bottom0"], "xyz"), hold("across", ["all0"], "y")] * (upper > 0)

    def error(self, folder):
        """max | T - P(T + l_ref / u_ref s) | / l_ref of the result file, by rows of the certificate's own."""
        u, force = read_fields(pathlib.Path(folder) / "result.exo")
        mesh, summary = self.mesh(), json.loads((pathlib.Path(folder) / "summary.json").read_text())
        found = [(item, *_multipliers(item, force)) for item in interfaces_of(self, mesh, np.zeros(len(u), bool), exchanged_sides(summary))]
        u_ref, l_ref = np.linalg.norm(u, axis=1).max(), max(np.linalg.norm(l, axis=1).max() for _, l, _ in found)
        return max(_contact_errors(self, found, u, l_ref, u_ref).values())


def check(scene, folder):
    error = scene.error(folder)
    return [f"the law is missed by {error:.1e}"] * (not error <= 1e-5)


if __name__ == "__main__":
    sys.exit(corners.main(Driven, __doc__, check))
