#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Thin bodies, bent and flat, on thick ones: multiplications by F and seconds, as a table.

    tests/scenes/shells.py --haptos build/release/bin/haptos [--seed 1] [--scenes 12] [--only N ...] [--most 40]

Belts around a drum, held at one end or by contact and friction alone, flat strips, closed rings that a pressure holds, clips, and domes under a plate; a
tenth to a two-hundredth as thick as their radius, in meshes of their own.  Divisions, elements, stiffnesses, coefficients, axes and loads are drawn from the seed.
Exit status 1 where one is not solved, or takes more multiplications than --most.
"""
import math
import sys

import corners  # ends with 77 where modules are missing
import numpy as np
import random_scenes
from corners import add_sides, array, coulomb, hold, listed, material, parameter, problem
from haptos_exodus import Block, ExodusMesh
from random_scenes import BodyMesh, Written


def arc(angle, radius, thickness, width, middle=0.0, start=0.0):
    """Part of a pipe about the y axis; along its circumference, across, and outward."""
    def place(u, v, w):
        r = radius + thickness * w
        return r * np.cos(start + angle * u), middle + width * (0.5 - v), r * np.sin(start + angle * u)
    return place


def dome(angle, radius, thickness):
    """A square that becomes a disk, on a sphere."""
    def place(u, v, w):
        a, b = 2 * u - 1, 2 * v - 1
        x, y = a * np.sqrt(1 - b * b / 2), b * np.sqrt(1 - a * a / 2)
        r, polar = radius + thickness * w, angle * np.hypot(x, y)
        return r * angle * np.sinc(polar / math.pi) * x, r * angle * np.sinc(polar / math.pi) * y, r * np.cos(polar)
    return place


def box(x, y, z):
    def place(u, v, w):
        return tuple(low + (high - low) * t for (low, high), t in zip((x, y, z), (u, v, w)))
    return place


class Shell(Written):
    """One scene of a seed, as `aspects.solve` takes it; bodies by their names, each a divided cube that is put in place."""

    KINDS = ("belt", "free belt", "strip", "ring", "clip", "dome")

    def __init__(self, seed, index):
        rng = np.random.default_rng([seed, index])
        self.kind = self.KINDS[index % len(self.KINDS)]
        self.shape = str(rng.choice(["HEX8", "HEX8", "TETRA4", "HEX20", "TETRA10"]))
        self.thickness = float(10 ** rng.uniform(-2.3, -1))
        along, across = int(rng.integers(10, 33)), int(rng.integers(2, 6))
        if self.shape in ("HEX20", "TETRA10"):
            along, across = along // 2, max(1, across // 2)
        self.along, self.across, self.layers = along, across, 1 if self.shape in ("HEX20", "TETRA10") else 2
        self.other = along + int(rng.integers(-2, 4))
        coefficient, ratio = 10 ** rng.uniform(-1.2, -0.2), 10 ** rng.uniform(0, 1.5)
        self.friction = tuple(float(x) for x in rng.permutation([coefficient, coefficient / ratio]))
        self.young = [2e5, float(2e5 * 10 ** rng.uniform(-2, 1))]
        self.subdomains = int(rng.choice([0, 0, 8]))
        self.angle, self.draws = math.pi * float(rng.choice([0.5, 0.75, 1])), rng.uniform(-1, 1, 4)
        self.bodies, contact, self.held, self.loads = getattr(self, self.kind.replace(" ", "_"))()
        self.contacts, self.axis = [contact], (1, 0, 0) if self.kind == "dome" else (0, 1, 0)

    def describe(self):
        return (f"{self.kind}, {self.shape} {self.along}x{self.across} on {self.other}, thickness {self.thickness:.2g}, contrast {self.young[0] / self.young[1]:.2g}, "
                f"({self.friction[0]:.2g}, {self.friction[1]:.2g})")

    # Bodies: name, divisions, place, whether its ends are one; the sides in contact; held sides, components; loads: type, side, value.
    def drum(self, angle, closes=False):
        return "drum", (self.other, self.across + 1, 2), arc(angle, 0.6, 0.4, 0.6, start=math.pi / 2 - angle / 2), closes

    def belt(self):
        thin = "thin", (self.along, self.across, self.layers), arc(self.angle, 1, self.thickness, 0.5, start=math.pi / 2 - self.angle / 2), False
        pulls = self.end_pull(1, 1)
        return [self.drum(self.angle), thin], ("thin_bottom", "drum_top"), [("drum_bottom", "xyz"), ("thin_left", "xyz")], [("Traction", "thin_right", pulls)]

    def free_belt(self):
        bodies, contact, held, loads = self.belt()
        axis = self.friction[1]     # along the circumference, see `input`
        more = math.exp(0.7 * axis * self.angle * self.draws[0])
        return bodies, contact, held[:1], loads + [("Traction", "thin_left", self.end_pull(0, more))]

    def end_pull(self, end, size):
        at = math.pi / 2 + (end - 0.5) * self.angle
        outward = 1 if end else -1
        return [-outward * size * math.sin(at), 0.0, outward * size * math.cos(at)]

    def strip(self):
        thick = "drum", (self.other, self.across + 1, 2), box((0, 3), (-0.05, 0.55), (-0.4, 0)), False
        thin = "thin", (self.along, self.across, self.layers), box((0, 3), (0, 0.5), (0, self.thickness)), False
        side = 0.5 * min(self.friction) * self.draws[0]
        return ([thick, thin], ("thin_bottom", "drum_top"), [("drum_bottom", "xyz"), ("thin_left", "xyz")],
                [("Pressure", "thin_top", 1.0), ("Traction", "thin_top", [side, 0.5 * side, 0.0]), ("Traction", "thin_right", [self.draws[1], 0.0, self.draws[2] / 10])])

    def ring(self):
        self.along = self.other     # polygons that do not fit would touch in a few places, and what holds the ring is not known
        thin = "thin", (self.along, self.across, self.layers), arc(2 * math.pi, 1, self.thickness, 0.5, start=-math.pi / 2), True
        turn = 0.5 * min(self.friction) * self.draws[0]
        return ([self.drum(2 * math.pi, True), thin], ("thin_bottom", "drum_top"), [("drum_bottom", "xyz")],
                [("Pressure", "thin_top", 1.0), ("Traction", "thin_top", [f"{-turn}*z", "0", f"{turn}*x"])])

    def clip(self):
        thin = "thin", (self.along + 4, self.across, self.layers), arc(1.6 * math.pi, 1, self.thickness, 0.5, start=0.2 * math.pi), False
        return [self.drum(2 * math.pi, True), thin], ("thin_bottom", "drum_top"), [("drum_bottom", "xyz"), ("thin_left", "xyz")], [("Pressure", "thin_top", 1.0)]

    def dome(self):
        n = max(4, self.along // 2)
        thin = "thin", (n, n, self.layers), dome(0.5 + self.angle / 6, 1 - self.thickness, self.thickness), False
        plate = "drum", (n + 1, n, 2), box((-0.6, 0.6), (-0.6, 0.6), (1, 1.2)), False
        rim = [(f"thin_{side}", "xyz") for side in ("left", "right", "front", "back")]
        return [plate, thin], ("thin_top", "drum_bottom"), rim + [("drum_top", "xy")], [("Pressure", "drum_top", 0.1)]

    def mesh(self):
        points, blocks, sides, numbers = [], [], [], 0
        for name, divisions, place, closes in self.bodies:
            x, connectivity = random_scenes._body(BodyMesh(self.shape, divisions), (1, 1, 1))
            add_sides(sides, f"{name}_{{}}".format, x, connectivity, self.shape, numbers)
            x = np.stack(place(*x.T), axis=1)
            if closes:
                x, to = np.unique(np.round(x, 12), axis=0, return_inverse=True)
                connectivity = to.ravel()[connectivity]
            blocks.append(Block(len(blocks) + 1, name, self.shape, connectivity + sum(map(len, points))))
            points.append(x)
            numbers += len(connectivity)
        return ExodusMesh(np.concatenate(points), blocks, sides)

    def input(self, name):
        materials = [material(body[0], body[0], E, 0.3) for body, E in zip(self.bodies, self.young)]
        contacts = [listed(f"contact{n}", parameter("Secondary Side Set", "string", secondary), parameter("Primary Side Set", "string", primary),
                           coulomb(self.friction, self.axis)) for n, (secondary, primary) in enumerate(self.contacts)]
        return problem(name, self.subdomains, materials, self.conditions(), contacts)

    def conditions(self):
        conditions = [hold(side, [side], components) for side, components in self.held]
        for kind, side, value in self.loads:
            if kind == "Pressure":
                given = parameter("Value", "double", value)
            else:
                given = parameter("Value", "Array(string)" if isinstance(value[0], str) else "Array(double)", array(value))
            conditions.append(listed(f"{kind} of {side}", parameter("Type", "string", kind), parameter("Sets", "Array(string)", f"{{{side}}}"), given))
        return conditions


if __name__ == "__main__":
    sys.exit(corners.main(Shell, __doc__))
