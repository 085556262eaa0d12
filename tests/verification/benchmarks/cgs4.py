# SPDX-License-Identifier: BSD-3-Clause
"""A block that is pushed up a slope: NAFEMS CGS-4."""
import numpy as np

from pages import Page, table
from runs import contact, displacement, material, solve
from haptos_grids import brick, divided

SLOPE, YOUNG, WEIGHT = 0.1, 1100.0, 1.0     # tan of the angle; force per volume
MUS = (0.0, 0.1, 0.2, 0.3)
TOLERANCE = 1e-8
SIZES = {"HEX8": ((6, 3, 2), (10, 2, 3)), "HEX20": ((3, 2, 1), (5, 1, 2)), "TETRA10": ((3, 2, 1), (5, 1, 2))}


def turned(x):
    """From the axes of the slope to the global ones, z upwards."""
    c, s = 1 / np.hypot(1, SLOPE), SLOPE / np.hypot(1, SLOPE)
    return np.stack([c * x[:, 0] - s * x[:, 2], x[:, 1], s * x[:, 0] + c * x[:, 2]], axis=1)


def ratio(folder, shape, mu, push=0.2):
    """F / G where the block, pushed by a horizontal displacement of its back, slips as a whole; and the run."""
    block_n, slope_n = SIZES[shape]
    block = brick(shape, [divided(4, block_n[0], 1), divided(1, block_n[2]), divided(2, block_n[1])],
                  {"x-": "back", "y-": "sides", "y+": "sides", "z-": "foot"}, turned)
    slope = brick(shape, [divided(6, slope_n[0]), divided(1, slope_n[2]), divided(1, slope_n[1], -1)],
                  {"z-": "ground", "y-": "sides", "y+": "sides", "z+": "slope"}, turned)
    conditions = {"ground": displacement(["ground"]), "sides": displacement(["sides"], (0.0,), "y"),
                  "push": displacement(["back"], (push,), "x"),
                  "weight": {"Type": "Body Force", "Element Blocks": ["block"], "Value": [0.0, 0.0, -WEIGHT]}}
    contacts = {"joint": contact("foot", "slope", (mu, mu), Discretization="Mortar")}
    result = solve(folder, {"block": block, "slope": slope}, {"rubber": material(["block", "slope"], YOUNG, 0.0)},
                   conditions, contacts, tolerance=1e-11)
    force = result.contact_force(0)             # of the slope on the block; what pushes holds it horizontally
    return -force[0] / (WEIGHT * 8.0), result


def exact(mu):
    return (SLOPE + mu) / (1 - mu * SLOPE)


def measure(folder, shapes=tuple(SIZES)):
    """Rows of the table; asserts nothing."""
    rows = []
    for shape in shapes:
        for mu in MUS:
            value, result = ratio(folder / f"{shape}_{mu}", shape, mu)
            counts = result.summary["contact"]["joint"]
            rows.append({"shape": shape, "mu": mu, "value": value, "error": abs(value - exact(mu)) / exact(mu), "stick": counts["stick"],
                         "open": counts["open"], "multiplications": result.multiplications})
    return rows


def page(folder, pictures):
    rows = measure(folder)
    return Page("cgs4", "Block on a slope (NAFEMS CGS-4)", "F/G of a sliding block", max(r["error"] for r in rows), TOLERANCE, f"""
A block of 4 x 1 x 2 lies on a slope, tan a = 0.1, by its weight G, and is pushed upwards by a horizontal displacement of its back (which
may slide along the back, so that the push is horizontal). E = 1100, nu = 0. Once all of the foot slips, F/G = (tan a + mu) / (1 - mu tan a).

- Reference: ANALYTIC, equilibrium of a rigid block; NAFEMS, Benchmark Tests for Finite Element Modelling of Contact, Gapping and Sliding,
  CGS-4 [nafems-r0081].
- Mesh: block 6 x 3 x 2, slope 10 x 2 x 3 (HEX8), 3 x 2 x 1 on 5 x 1 x 2 (HEX20, TET10): no nodes match, in either direction of the foot.
- Tolerance: {TOLERANCE:g} relative; the runs are at 1e-11. The test has the rows of HEX8 and TET10.

{table(rows, {"shape": "element", "mu": "mu", "value": "F/G .9f", "error": "error .1e", "stick": "stick", "open": "open", "multiplications": "multiplications"})}
""")
