# SPDX-License-Identifier: BSD-3-Clause
"""A closed crack that slides: both sides of a slit in one body, which share the nodes of its tips."""
import numpy as np

from pages import Page, figure, order, save, table
from runs import contact, displacement, material, solve
from haptos_grids import brick, graded, joined

YOUNG, POISSON, PRESS, ANGLE, MU = 25000.0, 0.25, 100.0, np.radians(20), 0.57735   # MPa; K = 16.67 GPa, G = 10 GPa
WIDTH = 30.0                             # half width of the plate, half lengths of the crack
NORMAL = PRESS * np.sin(ANGLE) ** 2
SHEAR = PRESS * np.sin(ANGLE) * np.cos(ANGLE)
SLIP = 4 * (1 - POISSON ** 2) / YOUNG * (SHEAR - MU * NORMAL)      # largest; slip = SLIP sqrt(1 - x^2)
TOLERANCE = 0.01
SMALL = 0.06     # HEX8, n = 8
SIZES = {"HEX8": (8, 16, 32), "HEX20": (4, 8, 16)}


def along(n):
    """-1 to 1 in 2 n elements, finer towards the tips."""
    return np.sin(0.5 * np.pi * np.linspace(-1, 1, 2 * n + 1))


def half(shape, n, count, upper):
    """One side of the crack: count elements along half of it, and outside as the other side has them."""
    away = graded(1, 1 / n, WIDTH - 1, 1.5)
    height = graded(2, 2 / n, WIDTH, 1.5)
    height = height if upper else -height[::-1]
    parts, thickness = [], [0, 0.5]
    for name, axis in (("left", -1 - away[::-1]), ("crack", along(count)), ("right", 1 + away)):
        sides = {"z-": "faces", "z+": "faces", "y+" if upper else "y-": "top" if upper else "bottom"}
        sides |= {"left": {"x-": "left"}, "right": {"x+": "right"}, "crack": {"y-": "upper_side"} if upper else {"y+": "lower_side"}}[name]
        parts.append(brick(shape, [axis, height, thickness], sides))
    body = joined(parts)
    x = body.coordinates
    body.label[(np.abs(x[:, 1]) < 1e-9) & (np.abs(x[:, 0]) < 1 - 1e-6)] = 1 if upper else 2     # apart; the tips are shared
    return body


def run(folder, shape, n):
    plate = joined([half(shape, n, n, True), half(shape, n, max(2, round(0.75 * n)), False)])
    d = np.array([np.cos(ANGLE), np.sin(ANGLE), 0])
    stress = -PRESS * np.outer(d, d)
    normals = {"left": (-1, 0, 0), "right": (1, 0, 0), "bottom": (0, -1, 0), "top": (0, 1, 0)}
    conditions = {name: {"Type": "Traction", "Sets": [name], "Value": [float(v) for v in stress @ np.array(normal)]} for name, normal in normals.items()}
    conditions |= {"plane strain": displacement(["faces"], (0.0,), "z"), "left point": displacement(["left_point"], (0.0, 0.0), "xy"),
                   "right point": displacement(["right_point"], (0.0,), "y")}
    points = {"left_point": lambda x: np.hypot(x[:, 0] + WIDTH, x[:, 1]) < 1e-9, "right_point": lambda x: np.hypot(x[:, 0] - WIDTH, x[:, 1]) < 1e-9}
    return solve(folder, {"plate": plate}, {"rock": material(["plate"], YOUNG, POISSON)}, conditions,
                 {"crack": contact("upper_side", "lower_side", (MU, MU), Sides="As Given")}, tolerance=1e-6, node_sets=points)


def measure(folder, shape, n):
    result = run(folder / f"{shape}_{n}", shape, n)
    at = np.flatnonzero((result.fields["contact_status"] > 0.5) & (np.abs(result.vector("contact_slip")).max(axis=1) > 0))
    x, slip = result.x[at, 0], np.linalg.norm(result.vector("contact_slip")[at], axis=1)
    exact = SLIP * np.sqrt(1 - x ** 2)
    # by force: total over the crack's area, and the mean of p over the middle half
    inner = at[np.abs(x) < 0.5]
    force = result.summary["contact"]["crack"]
    return {"shape": shape, "n": n, "unknowns": result.unknowns, "slip": np.interp(0, *_sorted(x, slip)) / SLIP - 1,
            "rms": np.sqrt(np.mean((slip - exact) ** 2)) / SLIP, "normal": np.mean(result.fields["contact_pressure"][inner]) / NORMAL - 1,
            "stick": force["stick"], "multiplications": result.multiplications, "x": x, "u": slip}


def _sorted(x, y):
    by = np.argsort(x)
    return x[by], y[by]


def page(folder, pictures):
    rows = [{**measure(folder, shape, n), "order": ""} for shape, sizes in SIZES.items() for n in sizes]
    for shape in SIZES:
        mine = [row for row in rows if row["shape"] == shape]
        mine[-1]["order"] = order([1 / row["n"] for row in mine], [row["rms"] for row in mine])
    drawn, axes = figure()
    x = np.linspace(-1, 1, 801)
    axes.plot(x, SLIP * 1e3 * np.sqrt(1 - x ** 2), color="black", linewidth=1, label="theory")
    for row in rows:
        if row["n"] == SIZES[row["shape"]][-1]:
            axes.plot(row["x"], row["u"] * 1e3, "sxo^"[len(row["shape"]) % 4], markersize=3, markerfacecolor="none", label=f"{row['shape']}, n = {row['n']}")
    axes.set(xlabel="x", ylabel="slip [mm]", title="Slip along the crack")
    axes.legend(frameon=False)
    save(drawn, pictures / "crack.svg")
    last = [row for row in rows if (row["shape"], row["n"]) == ("HEX20", 16)][0]
    return Page("crack", "A closed crack that slides", "slip in the middle and normal traction", max(abs(last["slip"]), abs(last["normal"])), TOLERANCE, f"""
A wide plate in plane strain (K = 16.67 GPa, G = 10 GPa) with a crack of half length 1 m is compressed by 100 MPa at 20 degrees to the crack; mu = 0.57735. The crack is a
slit in one body: nodes of its two sides are apart, those of the tips are shared.

- Reference: ANALYTIC, a crack in an infinite plate: t_N = -sigma sin^2 psi = -{NORMAL:.3f} MPa, slip 4 (1 - nu^2) / E (sigma sin psi cos psi - mu |t_N|) sqrt(b^2 - x^2),
  largest {SLIP:.4e} m [jaeger-cook-1979].
- Mesh: half width {WIDTH:g} b; n elements of even cosine on half of the upper side, 0.75 n of the lower one: the sides do not match, outside of the crack one mesh.
- Values: slip in the middle, root-mean-square error of the slip over its largest value, mean of t_N over |x| < b / 2.
- Tolerance: 1 % for slip in the middle and t_N with HEX20, n = 16 (the finite width makes about 0.1 %); the test asks for {SMALL:.0%} of the slip and 1e-4 of t_N
  with HEX8, n = 8.

![Slip](crack.svg)

{table(rows, {"shape": "element", "n": "n", "unknowns": "unknowns", "slip": "largest slip .2%", "rms": "rms of slip .4f", "order": "order .2f", "normal": "t_N .2%",
              "stick": "stick", "multiplications": "multiplications"})}
""")
