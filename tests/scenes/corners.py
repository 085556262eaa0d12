#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Blocks pressed into edges and corners, where nodes are in several contacts with friction: multiplications by F and seconds, as a table.

    tests/scenes/corners.py --haptos build/release/bin/haptos [--seed 1] [--scenes 12] [--only N ...] [--most 40]

Boxes on rigid planes: in an edge or a corner of these, on one another in a corner, or in a groove of another body.  Shapes of elements, stiffnesses,
coefficients from .05 to 1, axes and loads are drawn from the seed.  Exit status 1 where one is not solved, or takes more multiplications than --most.
"""
import argparse
import math
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "sweep"))
try:
    import numpy as np
    import random_scenes
    from aspects import solve
    from haptos_exodus import Block, ExodusMesh, SideSet
    from random_scenes import BodyMesh, Written
    from random_scenes import _array as array, _list as listed, _parameter as parameter
except ImportError as missing:
    print(f"not run: {missing}")
    sys.exit(77)

# Unit boxes of each body by their corners; the side of a box that lies on a plane, with its normal; sides of two boxes that are in contact.
KINDS = {"edge": ([[(0, 0, 0)]], ["bottom0", "left0"], []),
         "corner": ([[(0, 0, 0)]], ["bottom0", "left0", "front0"], []),
         "stack": ([[(0, 0, 0)], [(0, 0, 1)]], ["bottom0", "left0", "front0", "left1", "front1"], [("bottom1", "top0")]),
         "groove": ([[(0, 0, 0), (-1, 0, 0), (-1, 0, 1)], [(0, 0, 1)]], [], [("bottom3", "top0"), ("left3", "right2")])}
SIDES = {"left": (0, 0), "right": (0, 1), "front": (1, 0), "back": (1, 1), "bottom": (2, 0), "top": (2, 1)}


def add_sides(sides, name, x, connectivity, shape, first):
    """Side sets of a divided unit cube, by `name(side)`; its elements are counted from `first`."""
    for side, (axis, value) in SIDES.items():
        elements, faces = random_scenes._sides_at(x, connectivity, shape, axis, float(value))
        sides.append(SideSet(len(sides) + 1, name(side), elements + first, faces))


def material(name, block, young, poisson):
    return listed(name, parameter("Element Blocks", "Array(string)", f"{{{block}}}"), parameter("Young's Modulus", "double", repr(young)),
                  parameter("Poisson's Ratio", "double", repr(poisson)))


def coulomb(coefficients, axis):
    return _friction("Coulomb", coefficients, axis)


def tresca(coefficients, axis, bound):
    return _friction("Tresca", coefficients, axis, parameter("Slip Bound", "double", bound))


def _friction(law, coefficients, axis, *more):
    return listed("Friction", parameter("Law", "string", law), parameter("Coefficients", "Array(double)", array(coefficients)),
                  parameter("Principal Direction", "Array(double)", array(axis)), *more)


def hold(name, sets, components, value=0.0):
    return listed(name, parameter("Type", "string", "Displacement"), parameter("Sets", "Array(string)", array(sets)),
                  parameter("Components", "string", components), parameter("Value", "Array(double)", array([value] * len(components))))


def rigid_plane(normal):
    return listed("Rigid Plane", parameter("Point", "Array(double)", "{0.0, 0.0, 0.0}"), parameter("Normal", "Array(double)", array(normal)))


def problem(name, subdomains, materials, conditions, contacts):
    return listed("Haptos", listed("Mesh", parameter("File", "string", f"{name}.exo")), listed("Decomposition", parameter("Subdomains", "int", subdomains)),
                  listed("Materials", *materials), listed("Boundary Conditions", *conditions), listed("Contact", *contacts),
                  listed("Solver", parameter("Maximum Hessian Multiplications", "int", 1000)))


class Corner(Written):
    """One scene of a seed, as `aspects.solve` takes it."""

    def __init__(self, seed, index):
        rng = np.random.default_rng([seed, index])
        self.kind = list(KINDS)[index % len(KINDS)]
        self.bodies, self.planes, self.pairs = KINDS[self.kind]
        self.shape = str(rng.choice(["HEX8", "HEX8", "TETRA4", "TETRA10", "HEX20"]))
        n = int(rng.integers(2, 9 if self.shape in ("HEX8", "TETRA4") else 5))
        self.elements = (n, max(2, n - 1), n)
        self.young = [float(2e5 * 10 ** rng.uniform(-1.5, 1.5)) for _ in self.bodies]
        self.poisson = [float(rng.uniform(0, 0.45)) for _ in self.bodies]
        coefficient, ratio = 10 ** rng.uniform(math.log10(0.05), 0), 10 ** rng.uniform(0, 2)
        self.friction = tuple(float(x) for x in rng.permutation([coefficient, coefficient / ratio]))
        self.direction = [float(x) for x in rng.normal(size=3)]
        self.push = [float(x) for x in rng.uniform(0.2, 1, 2)]
        self.pull = float(rng.uniform(-0.5, 0.5)) * coefficient / ratio
        self.lean = float(rng.choice([0, 0, 0.4])) if self.kind in ("edge", "corner") else 0.0      # of x with z
        self.subdomains = min(int(rng.integers(4, 20)), n * n * max(2, n - 1))

    def describe(self):
        return f"{self.kind}{', leaning' if self.lean else ''}, {self.shape} {'x'.join(map(str, self.elements))}, ({self.friction[0]:.2g}, {self.friction[1]:.2g})"

    def mesh(self):
        points, blocks, sides, box, numbers = np.zeros((0, 3)), [], [], 0, 0
        for number, body in enumerate(self.bodies):
            first, cells = len(points), []
            for place in body:
                x, connectivity = random_scenes._body(BodyMesh(self.shape, self.elements), (1, 1, 1))
                add_sides(sides, f"{{}}{box}".format, x, connectivity, self.shape, numbers)
                cells.append(connectivity + len(points))
                points = np.concatenate([points, x + place])
                numbers += len(connectivity)
                box += 1
            own, to = np.unique(np.round(points[first:], 9), axis=0, return_inverse=True)     # boxes of a body share nodes
            points = np.concatenate([points[:first], own])
            blocks.append(Block(number + 1, f"body{number}", self.shape, first + to.ravel()[np.concatenate(cells) - first]))
        points[:, 0] += self.lean * points[:, 2]
        return ExodusMesh(points, blocks, sides)

    def input(self, name):
        materials = [material(f"material{b}", f"body{b}", self.young[b], self.poisson[b]) for b in range(len(self.bodies))]
        friction = coulomb(self.friction, self.direction)
        contacts = [listed(side, parameter("Secondary Side Set", "string", side), self.plane(side), friction) for side in self.planes]
        contacts += [listed(f"{secondary} on {primary}", parameter("Secondary Side Set", "string", secondary), parameter("Primary Side Set", "string", primary),
                            friction) for secondary, primary in self.pairs]
        return problem(name, self.subdomains, materials, self.conditions(), contacts)

    def plane(self, side):
        return rigid_plane({"left": (1, 0, -self.lean), "front": (0, 1, 0), "bottom": (0, 0, 1)}[side[:-1]])

    def conditions(self):
        boxes = [sum(map(len, self.bodies)) - 1] if self.kind == "groove" else range(len(self.bodies))
        pressed = {"top": 1.0, "right": self.push[0], **({"back": self.push[1]} if "front0" in self.planes else {})}
        conditions = [listed(side, parameter("Type", "string", "Pressure"), parameter("Value", "double", value),
                             parameter("Sets", "Array(string)", array(f"{side}{b}" for b in (boxes if side != "top" else [max(boxes)]))))
                      for side, value in pressed.items()]
        conditions.append(listed("pull", parameter("Type", "string", "Traction"), parameter("Sets", "Array(string)", f"{{top{max(boxes)}}}"),
                                 parameter("Value", "Array(double)", array((0, self.pull, 0)))))
        if self.kind == "groove":
            conditions.append(hold("clamp", ["bottom0", "bottom1"], "xyz"))
        return conditions


def main(scenes, text, check=lambda scene, folder: []):
    """:param check: what is wrong with the answer in a folder, as texts"""
    parser = argparse.ArgumentParser(allow_abbrev=False, description=text, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--haptos", required=True)
    parser.add_argument("--launcher", default="", help="as in 'mpirun -n 2'")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scenes", type=int, default=12)
    parser.add_argument("--only", nargs="+", type=int)
    parser.add_argument("--most", type=int, default=40)
    options = parser.parse_args()
    print("| number | scene | pairs | F | seconds | remarks |")
    print("|---|---|---|---|---|---|")
    failed = 0
    for index in options.only or range(options.scenes):
        scene = scenes(options.seed, index)
        with tempfile.TemporaryDirectory(prefix="haptos_") as folder:
            status, count, seconds, pairs = solve(options, scene, folder)
            wrong = [f"status {status}"] * (status != 0) + [f"more than {options.most}"] * (count > options.most) + check(scene, folder)
        failed += bool(wrong)
        print(f"| {index} | {scene.describe()} | {pairs} | {count} | {seconds:.2g} | {', '.join(wrong)} |", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(Corner, __doc__))
