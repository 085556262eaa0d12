# SPDX-License-Identifier: BSD-3-Clause
"""Spheres under normal and tangential load: Cattaneo and Mindlin, and an oblique load on orthotropic friction."""
import numpy as np

import half_spaces
from half_spaces import Load, fitted
from pages import Page, figure, save, table

# Cattaneo by half-space theory: G, nu, mu, Q / (mu P)
SHEAR, POISSON, MU, PART = 200.0, 0.42, 0.4, 0.875
CATTANEO_TOLERANCE, OBLIQUE_TOLERANCE = 0.01, 0.02
# Q / limit: (c / a, shift) with E* = a = p0 = 1, nu = 0, F = (0.3, 0.15), Q at 45 degrees
F, LIMIT = (0.3, 0.15), 0.189737
OBLIQUE = {0.75: (0.631, (0.1188, 0.1302)), 0.5: (0.793, (0.0752, 0.0790))}


def cattaneo_load():
    still = Load(2 * SHEAR * (1 + POISSON), POISSON)
    compliance = 3 * MU * still.normal * 2 * (2 - POISSON) / SHEAR / 16
    shift = compliance * (1 - (1 - PART) ** (2 / 3))
    return Load(still.young, POISSON, (MU, MU), (PART * MU * still.normal, 0.0), (shift, 0.0))


def oblique_load(part):
    still = Load(2.0, 0.0)
    scale = still.peak / still.modulus
    force = part * LIMIT * still.normal / np.sqrt(2)
    return Load(2.0, 0.0, F, (force, force), tuple(scale * s for s in OBLIQUE[part][1]))


def stick_radius(result, mirrored):
    """Of the circle with the area of the nodes that stick."""
    at = result.pressures(body=0)
    stick = at[result.fields["contact_status"][at] > 2.5]
    area = np.sum(result.fields["contact_normal_force"][stick] / result.fields["contact_pressure"][stick])
    return np.sqrt(area * 4 / 2 ** len(mirrored) / np.pi)


def measure(folder, load, shape, n, mirrored):
    """A row: forces over those of the theory, of which the shift is given, and the radius of the stick zone."""
    result = half_spaces.press(folder / f"{shape}_{n}", shape, n, load, mirrored, tolerance=1e-6)
    found = fitted(result, mirrored)
    wanted = np.array(load.tangential)
    row = {"shape": shape, "n": n, "unknowns": result.unknowns, "force": found.forces[2] / load.normal - 1, "peak": found.peak / load.peak - 1,
           "stick": stick_radius(result, mirrored), "multiplications": result.multiplications, "found": found, "result": result}
    for axis, name in enumerate("xy"):
        row[name] = -found.forces[axis] / found.forces[2] / (wanted[axis] / load.normal) - 1 if wanted[axis] else 0.0
    return row


def traction_along_x(result):
    """Nodes of the line y = 0: places and tangential force over normal force times pressure."""
    at = result.pressures(body=0)
    at = at[(np.abs(result.x[at, 1]) < 1e-9) & (result.fields["contact_pressure"][at] > 0)]
    ratio = -result.fields["contact_force_x"][at] / np.maximum(result.fields["contact_normal_force"][at], 1e-300)
    return result.x[at, 0], ratio * result.fields["contact_pressure"][at]


def draw(rows, load, path):
    drawn, axes = figure()
    x = np.linspace(-1, 1, 801)
    c = (1 - PART) ** (1 / 3)
    q = np.sqrt(1 - x ** 2) - c * np.sqrt(np.clip(1 - x ** 2 / c ** 2, 0, None))
    axes.plot(x, q, color="black", linewidth=1, label="Cattaneo, Mindlin")
    for row, mark in zip(rows[-2:], "so"):
        at, traction = traction_along_x(row["result"])
        axes.plot(at, traction / (MU * load.peak), mark, markersize=3, markerfacecolor="none", label=f"{row['shape']}, n = {row['n']:g}")
    axes.set(xlabel="x / a (y = 0)", ylabel="q / (mu p0)", title="Tangential traction")
    axes.legend(frameon=False)
    save(drawn, path)


COLUMNS = {"shape": "element", "n": "n .3g", "unknowns": "unknowns", "force": "P .2%", "peak": "p0 .2%", "x": "Qx / P .2%"}


def cattaneo(folder, pictures):
    load = cattaneo_load()
    rows = [measure(folder, load, shape, n, "x") for shape, n in (("HEX8", 3), ("HEX8", 6), ("HEX20", 2), ("HEX20", 4))]
    draw([rows[1], rows[3]], load, pictures / "cattaneo.svg")
    last = rows[-1]
    error = max(abs(last[key]) for key in ("force", "peak", "x"))
    return Page("cattaneo", "Cattaneo and Mindlin: a sphere in partial slip", "P, p0 and Q/P at given approach and shift", error, CATTANEO_TOLERANCE, f"""
Half spaces as on the page of [Hertz' sphere](hertz_sphere.md), G = 200, nu = 0.42, mu = 0.4; the upper one is moved down and sideways at once by what the
theory gives for Q = 0.875 mu P. A half is modelled (symmetry about y = 0).

- Reference: ANALYTIC, half-space theory [johnson-1985]: shift = 3 mu P (2 - nu) / (8 G a) (1 - (1 - q)^(2/3)), q = Q / (mu P), c / a = (1 - q)^(1/3) = 0.5
  (with R = 50, a = 1: P 9.1954, p0 4.393, approach 1.998e-2, shift 8.172e-3). The theory takes slip as parallel to x; that part of slip along y that nu > 0 brings
  is neglected in it.
- Mesh: as there, n elements a contact radius above, 0.75 n below.
- Values: errors of the forces at given approach and shift, c from the area of the nodes that stick.
- Tolerance: 1 % for P, p0 and Q / P with HEX20, n = 4. The stick zone grows by whole nodes: c is shown, not checked. The test is the same (label slow).

![Tangential traction](cattaneo.svg)

{table(rows, {**COLUMNS, "stick": "c / a (0.5) .3f", "multiplications": "multiplications"})}
""")


def oblique(folder, pictures):
    rows = []
    for part in OBLIQUE:
        for shape, n in (("HEX8", 3), ("HEX8", 6), ("HEX20", 2), ("HEX20", 3)):
            rows.append({"part": part, "c": OBLIQUE[part][0], **measure(folder / str(part), oblique_load(part), shape, n, "xy")})
    error = max(abs(row[key]) for row in rows if (row["shape"], row["n"]) == ("HEX20", 3) for key in ("force", "x", "y"))
    draw_oblique(rows, pictures / "oblique.svg")
    return Page("oblique", "Orthotropic friction under an oblique load", "P, Qx/P and Qy/P at given approach and shift", error, OBLIQUE_TOLERANCE, f"""
Half spaces as on the page of [Hertz' sphere](hertz_sphere.md), nu = 0, F = (0.3, 0.15) along x and y; the upper one is moved down and sideways at once by what the
theory gives for a tangential force at 45 degrees of 0.75 and 0.5 of its limit 0.189737 P. The whole is modelled: there is no plane of symmetry.

- Reference: OWN, half-space theory with the associated law (a computation by influence functions of the half space): shift (0.1188, 0.1302) and (0.0752, 0.0790),
  c / a = 0.631 and 0.793 with E* = a = p0 = 1. The stick zone is a circle for any law; it is the shift that tells laws apart.
- Mesh: as there, n elements a contact radius above, 0.75 n below.
- Tolerance: 2 % for P, Qx / P and Qy / P with HEX20, n = 3 (what the reference allows). The test is the same (label slow).

![Force over shift](oblique.svg)

{table(rows, {"part": "Q / limit", **COLUMNS, "y": "Qy / P .2%", "stick": "c / a .3f", "c": "theory", "multiplications": "multiplications"})}
""")


def draw_oblique(rows, path):
    drawn, axes = figure((4.2, 4.2))
    t = np.linspace(0, np.pi / 2, 100)
    axes.plot(F[0] * np.cos(t), F[1] * np.sin(t), color="black", linewidth=1, label="limit of sliding")
    for part in OBLIQUE:
        axes.plot(*[part * LIMIT / np.sqrt(2)] * 2, "k+", markersize=9)
        for row in [r for r in rows if r["part"] == part and r["n"] >= 3]:
            force = -row["found"].forces / row["found"].forces[2]
            axes.plot(force[0], force[1], "so"[row["shape"] == "HEX20"], markersize=4, markerfacecolor="none", label=f"{row['shape']}, {part:g} of the limit, n = {row['n']:g}")
    axes.set(xlabel="Qx / P", ylabel="Qy / P", title="Forces at the shifts of the theory (+)")
    axes.legend(frameon=False, fontsize=7)
    save(drawn, path)
