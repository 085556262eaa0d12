# SPDX-License-Identifier: BSD-3-Clause
"""Hertz' contact of a sphere and of a cylinder."""
import numpy as np

import half_spaces
from pages import Page, figure, order, save, table
from half_spaces import Load, fitted
from runs import BenchmarkError

SPHERE, CYLINDER = Load(1.82, 0.3), Load(1.82, 0.3, line=True)
SIZES = {"sphere": {"TETRA4": (6, 12), "HEX8": (3, 6, 12), "HEX20": (1.6, 3.2, 6.4), "HEX27": (1.6, 3.2), "TETRA10": (1.6, 3.2, 6.4)},
         "cylinder": {"TETRA4": (8, 16, 32), "HEX8": (8, 16, 32), "HEX20": (4, 8, 16), "TETRA10": (4, 8, 16)}}
STATED = {"sphere": {"HEX8": 12, "HEX20": 6.4, "HEX27": 3.2, "TETRA10": 6.4}, "cylinder": {"HEX8": 32, "HEX20": 16, "TETRA10": 16}}
TOLERANCE = 0.01
INSIDE = 0.8             # of a: there the pressure is smooth
ORDERS = {"TETRA4": 0.5, "HEX8": 0.5, "HEX20": 1.0, "HEX27": 1.0, "TETRA10": 1.0}   # of the pressure inside, at least
SMALL = (0.005, 0.015)   # of p0 and force, of a, with HEX20: sphere n = 3.2, cylinder n = 8


def approach_by_force(scene):
    """d ln approach / d ln P: of P^(2/3), and of P (1/2 + ln(2 / a)) with a^2 by P."""
    return 2 / 3 if scene == "sphere" else 1 - 0.5 / (0.5 + np.log(2))


def measure(folder, scene, shape, n, ratio=0.75):
    """A row: relative errors of p0, a, the force at the given approach and the approach at that force, root-mean-square of p / p0."""
    load = CYLINDER if scene == "cylinder" else SPHERE
    result = half_spaces.press(folder / f"{scene}_{shape}_{n}", shape, n, load, ratio=ratio, tolerance=1e-6)
    found = fitted(result, line=load.line)
    exact = load.peak * np.sqrt(np.clip(1 - found.r ** 2, 0, None))
    inside = found.r < INSIDE
    force = found.forces[2] / load.normal - 1
    return {"shape": shape, "n": n, "unknowns": result.unknowns, "peak": found.peak / load.peak - 1, "radius": found.radius - 1,
            "force": force, "approach": -force * approach_by_force(scene), "rms": np.sqrt(np.mean((found.p - exact) ** 2)) / load.peak,
            "inside": np.sqrt(np.mean((found.p - exact)[inside] ** 2)) / load.peak,
            "multiplications": result.multiplications, "found": found}


def draw(scene, rows, path):
    drawn, axes = figure()
    load = CYLINDER if scene == "cylinder" else SPHERE
    r = np.linspace(0, 1, 400)
    axes.plot(r, np.sqrt(1 - r ** 2), color="black", linewidth=1, label="Hertz")
    for shape, mark in (("HEX8", "s"), ("HEX20", "o"), ("TETRA10", "^")):
        row = [x for x in rows if x["shape"] == shape][-1]
        near = row["found"].r < 1.3
        axes.plot(row["found"].r[near], row["found"].p[near] / load.peak, mark, markersize=3, markerfacecolor="none",
                  label=f"{shape}, {row['n']:g} elements a radius")
    axes.set(xlabel="r / a" if scene == "sphere" else "x / a", ylabel="p / p0", title=f"Pressure of the {scene}")
    axes.legend(frameon=False)
    save(drawn, path)


def page(scene, folder, pictures):
    rows = [measure(folder, scene, shape, n) for shape, sizes in SIZES[scene].items() for n in sizes]
    for shape in SIZES[scene]:
        mine = [row for row in rows if row["shape"] == shape]
        for row in mine:
            row["order"] = row["inside order"] = ""
        for key, name in (("rms", "order"), ("inside", "inside order")):
            mine[-1][name] = order([1 / row["n"] for row in mine], [row[key] for row in mine])
    draw(scene, rows, pictures / f"hertz_{scene}.svg")
    stated = [row for row in rows if STATED[scene].get(row["shape"]) == row["n"]]
    error = max(abs(row[key]) for row in stated for key in ("peak", "radius", "force", "approach"))
    slow = [row["shape"] for row in rows if row["inside order"] != "" and row["inside order"] < ORDERS[row["shape"]]]
    if slow:
        raise BenchmarkError(f"the pressure of the {scene} converges too slowly with {', '.join(slow)}")
    names = ", ".join(f"{shape} with {n:g} elements a contact {'radius' if scene == 'sphere' else 'half width'}" for shape, n in STATED[scene].items())
    theory = {"sphere": "P = 4/3 E* a^3 / R, p0 = 2 E* a / (pi R), approach a^2 / R, p = p0 sqrt(1 - r^2 / a^2)",
              "cylinder": "P = pi E* a^2 / (4 R) a length, p0 = E* a / (2 R), approach of points at the distance 1 "
                          "2 (1 - nu) P (1/2 + ln(2 / a)) / (pi G)"}[scene]
    return Page(f"hertz_{scene}", f"Hertz: {scene}", "p0, a, force at a given approach, approach at a given force", error, TOLERANCE, f"""
A slightly curved half space of the radius R = {half_spaces.CURVATURE:g} a is pressed on a flat one of the same material (nu = 0.3) by a given approach.
{"A quarter is modelled." if scene == "sphere" else "One half, one layer of elements in plane strain."}

- Reference: ANALYTIC, {theory} [johnson-1985].
- Mesh: {half_spaces.SIZE:g} a in every direction, even up to {half_spaces.REACH:g} a, then growing; n elements a contact radius in the upper body, which carries the
  multipliers, 0.75 n in the lower one, so that no meshes match. The outer faces are moved as the half spaces would be there by the resultant force
  ({"Boussinesq" if scene == "sphere" else "Flamant"}), the upper ones also by the approach.
- Values: p0 and a from p^2 = p0^2 (1 - r^2 / a^2) fitted over p > 0.3 p0 (counting nodes would jump by h); the force, at the given
  approach, is the sum of nodal forces; the approach at the given force differs by -{approach_by_force(scene):.2f} of that ({"P^(2/3)" if scene == "sphere" else "the derivative of the formula"}).
- Tolerance: 1 % for p0, a, force and approach with {names}. The others are shown for their convergence. The test asks for
  {SMALL[0]:.1%} of p0 and force and {SMALL[1]:.1%} of a with {"HEX20, n = 3.2" if scene == "sphere" else "HEX20 and TET10, n = 8"}.

![Pressure](hertz_{scene}.svg)

{table(rows, {"shape": "element", "n": "n .3g", "unknowns": "unknowns", "peak": "p0 .2%", "radius": "a .2%", "force": "force .2%", "approach": "approach .2%",
              "rms": "rms of p/p0 .4f", "order": "order .2f", "inside": f"rms for r < {INSIDE} a .4f",
              "inside order": "order inside .2f", "multiplications": "multiplications"})}

The slope of the pressure at r = a is infinite: over all nodes the pressure converges with an order near one at most, for any element. Orders of curved
surfaces, at least 0.5 for linear and 1 for quadratic elements, are asked of the pressure for r < {INSIDE} a, where it is smooth. What the size of the blocks cuts off
{"is below 0.1 % of the force" if scene == "sphere" else "is 0.2 % of the force, which bounds that order on the finest meshes"}.
""")
