# SPDX-License-Identifier: BSD-3-Clause
"""Energy, resultant forces and nodal forces on unlike meshes against those of meshes refined twice."""
import numpy as np

from pages import Page, table
from runs import contact, displacement, material, solve
from haptos_grids import brick, divided, graded

TOLERANCE = 0.03     # of the meshes refined once, to those refined twice
RADIUS = 20.0


def split(axis, times):
    """Every step in `times` equal ones."""
    return np.interp(np.arange(times * (len(axis) - 1) + 1) / times, np.arange(len(axis)), axis)


def cap(times, shapes, steps):
    """A cap pressed on a block, both 4 x 4 x 2; steps: up to 1 from the middle above, up to 0.8 below."""
    def curved(p):
        return p + np.outer((p[:, 0] ** 2 + p[:, 1] ** 2) / (2 * RADIUS) * (1 - p[:, 2] / 2), [0, 0, 1])

    def axes(count, even):
        half = split(graded(count, even, 2.0, 1.3), times)
        axis = np.concatenate([-half[:0:-1], half])
        return axis, axis, half
    x, y, depth = axes(steps[1], 0.8)
    return {"upper": brick(shapes[0], axes(steps[0], 1.0), {"z-": "secondary", "z+": "driven"}, curved),
            "lower": brick(shapes[1], [x, y, -depth[::-1]], {"z+": "primary", "z-": "held"})}


def beams(times, shapes, steps):
    """Two cantilevers 4 x 1 x 1, the upper one over the half of the lower one; steps a length of 1."""
    def body(shape, n, start, bottom, sides):
        return brick(shape, [divided(4, 3 * n, start), divided(1, n), divided(1, n, bottom)], sides)
    return {"upper": body(shapes[0], times * steps[0], 0, 0, {"x-": "driven", "z-": "secondary"}),
            "lower": body(shapes[1], times * steps[1], 2, -1, {"x+": "held", "z+": "primary"})}


SCENES = {"cap, HEX8": (cap, ("HEX8", "HEX8"), (1, 1), (2, 4, 8), (0, 0, -0.05), None),
          "cap, HEX20 on TET10, friction": (cap, ("HEX20", "TETRA10"), (1, 1), (1, 2, 4), (0.01, 0.005, -0.05), (0.3, 0.15)),
          "cantilevers, HEX8 on TET10, friction": (beams, ("HEX8", "TETRA10"), (3, 2), (1, 2, 4), (0, 0.02, -0.1), (0.2, 0.2))}


def run(folder, scene, times):
    make, shapes, steps, _, moved, friction = SCENES[scene]
    bodies = make(times, shapes, steps)
    conditions = {"held": displacement(["held"]), "driven": displacement(["driven"], [float(c) for c in moved])}
    return solve(folder, bodies, {"upper": material(["upper"], 1000, 0.3), "lower": material(["lower"], 2000, 0.3)}, conditions,
                 {"joint": contact("secondary", "primary", friction, Sides="As Given")}, 1e-8)


def quantities(result, scene):
    """Energy (half the work of what drives), resultant of the contact, and nodal forces gathered by hat functions."""
    moved = np.array(SCENES[scene][4], float)
    force = result.contact_force(0)            # what drives holds it: the upper body has no other load where it is driven alone
    at = np.flatnonzero(result.body == 0)
    f, x = result.vector("contact_force")[at], result.x[at]
    hats = []
    for axis in (0, 1):
        loaded = np.array([0.5, 1.5, 2.5, 3.5]) if SCENES[scene][0] is beams and axis == 0 else np.linspace(-1, 1, 3)
        step = loaded[1] - loaded[0]
        hats.append(np.clip(1 - np.abs(x[:, axis, None] - loaded) / step, 0, None))
    return {"energy": -0.5 * moved @ force, "force": force, "nodal": np.einsum("ia,ib,ic->abc", hats[0], hats[1], f)}


def measure(folder, scene):
    found = []
    for times in SCENES[scene][3]:
        result = run(folder / f"{scene.replace(' ', '_').replace(',', '')}_{times}", scene, times)
        found.append({**quantities(result, scene), "times": times, "unknowns": result.unknowns, "multiplications": result.multiplications})
    rows, last = [], found[-1]
    for item in found:
        row = {"scene": scene, "order": "", "force order": "", "nodal order": "", **{key: item[key] for key in ("times", "unknowns", "energy", "multiplications")}}
        for key in ("energy", "force", "nodal"):
            row[f"{key} error"] = "" if item is last else np.linalg.norm(item[key] - last[key]) / np.linalg.norm(last[key])
        rows.append(row)
    for key, name in (("energy", "order"), ("force", "force order"), ("nodal", "nodal order")):
        first, second = (np.linalg.norm(found[i][key] - found[i + 1][key]) for i in (0, 1))
        rows[-1][name] = np.log2(first / second)
    return rows


def page(folder, pictures):
    rows = [row for scene in SCENES for row in measure(folder, scene)]
    once = [row for row in rows if row["times"] == SCENES[row["scene"]][3][1]]
    return Page("refinement", "Energy and forces on refined meshes", "energy, resultant, nodal forces of meshes refined once and twice",
                max(row[key] for row in once for key in ("energy error", "force error", "nodal error")), TOLERANCE, f"""
Three scenes without a closed form, on meshes that do not match, and the same refined once and twice: a cap (radius {RADIUS:g}) that is pressed on a block, with
HEX8 and without friction; the same with HEX20 on TET10 and orthotropic friction, moved sideways too; two cantilevers that overlap by half, the clamp of the
upper one (HEX8) driven down and sideways on the lower one (TET10), with friction. One face of the upper body is driven, one of the lower held.

- Reference: OWN, the discretisation refined twice, which shares no node with the first on the contact surfaces.
- Values: energy, half the work of what drives over the displacement (with the contact's resultant); resultant of the contact; nodal forces, gathered by hat
  functions on a fixed grid of places, as meshes share no nodes. Differences are relative norms; orders are those of energy, resultant and nodal forces, from differences between
  the three meshes, of which the coarse ones are often outside of the range where orders hold.
- Tolerance: {TOLERANCE:.0%} of the values on meshes refined once.

{table(rows, {"scene": "scene", "times": "steps split in", "unknowns": "unknowns", "energy": "energy .5e", "energy error": "difference .2%", "force error": "resultant .2%",
              "nodal error": "nodal forces .2%", "order": "order .2f", "force order": "of the resultant .2f", "nodal order": "of nodal forces .2f", "multiplications": "multiplications"})}
""")
