# SPDX-License-Identifier: BSD-3-Clause
"""Two rings in each other under a pressure that varies round them: curved contact without end."""
import numpy as np

from pages import Page, figure, order, save, table
from plane_faces import displacement_error
from runs import contact, displacement, material, solve
from ring_theory import CONTACT, INNER, MEAN, OUTER, POISSON, WAVE, YOUNG, Rings
from haptos_grids import brick, divided

TOLERANCE = 0.01     # rms of the pressure and largest error of the displacement, HEX20 and TET10 with n = 16
SMALL = (0.02, 0.0025)   # n = 8
SIZES = {"HEX8": (8, 16, 32, 64, 128), "HEX8, smoothed": (8, 16, 32, 64, 128), "HEX20": (4, 8, 16, 32, 64), "TETRA10": (4, 8, 16, 32),
         "HEX20, sticking": (4, 8, 16, 32, 64)}
OPTIONS = {"smoothed": {"Primary Smoothing": "Cylinder"},
           "sticking": {"Friction": {"Law": "Coulomb", "Coefficients": [5.0, 5.0], "Principal Direction": [0.0, 0.0, 1.0]}}}
ORDERS = {"HEX8": (0.5, 2.0), "HEX20": (1.0, 2.5), "TETRA10": (1.0, 2.5)}      # at least, of pressure and displacement
UP_TO = 32           # elements round the ring


def ring(shape, begin, end, radial, around, thickness, names):
    def to(p):
        return np.stack([p[:, 0] * np.cos(p[:, 1]), p[:, 0] * np.sin(p[:, 1]), p[:, 2]], axis=1)
    return brick(shape, [divided(end - begin, radial, begin), divided(np.pi / 2, around), [0, thickness]],
                 {"x-": names[0], "x+": names[1], "y-": "on_x", "y+": "on_y", "z-": "faces", "z+": "faces"}, to)


def run(folder, shape, n, **options):
    """n elements round the quarter of the outer ring, 3 n / 4 round the inner one."""
    radial, thickness = max(1, n // 4), 0.5 * np.pi * CONTACT / n
    bodies = {"inner": ring(shape, INNER, CONTACT, radial, 3 * n // 4, thickness, ("bore", "shaft")),
              "outer": ring(shape, CONTACT, OUTER, radial, n, thickness, ("hole", "rim"))}
    conditions = {"x": displacement(["on_y"], (0.0,), "x"), "y": displacement(["on_x"], (0.0,), "y"), "z": displacement(["faces"], (0.0,), "z"),
                  "press": {"Type": "Pressure", "Sets": ["rim"], "Value": f"{MEAN} + {WAVE}*(x*x - y*y)/(x*x + y*y)"}}
    return solve(folder, bodies, {"all": material(["inner", "outer"], YOUNG, POISSON)}, conditions,
                 {"joint": contact("hole", "shaft", Sides="As Given", **options)}, tolerance=1e-8)


def errors(result, theory):
    """Of the pressure, over its mean: largest and root-mean-square at its nodes, root-mean-square over the surface; largest of u_r at the rim,
    over the largest there; L2 norm of the displacement."""
    at = result.pressures(body=1)
    found, mean = result.fields["contact_pressure"][at], theory.pressure(np.array([[1.0, 1.0]]))
    pressure = (found - theory.pressure(result.x[at])) / mean
    shares = result.fields["contact_normal_force"][at] / found
    rim = np.abs(np.hypot(*result.x[:, :2].T) - OUTER) < 1e-9
    radial = np.einsum("ij,ij->i", result.vector("displacement")[rim, :2], result.x[rim, :2]) / OUTER
    exact = theory.displacement(result.x[rim], 1)[:, 0]
    return {"largest": np.abs(pressure).max(), "rms": np.sqrt(np.mean(pressure ** 2)), "surface": np.sqrt(np.average(pressure ** 2, weights=shares)),
            "shift": np.abs(radial - exact).max() / np.abs(exact).max(), "field": displacement_error(result, theory.displacement_xy)}


def observed(rows, key):
    """Order by least squares over meshes that halve their width."""
    return order([1 / row["n"] for row in rows], [row[key] for row in rows])


def draw(results, path):
    drawn, axes = figure()
    theta = np.radians(np.linspace(0, 90, 200))
    axes.plot(np.degrees(theta), Rings().pressure(np.stack([np.cos(theta), np.sin(theta)], axis=1)) / 1e6, color="black", linewidth=1, label="theory")
    for (shape, n), mark in ((("HEX20", 16), "o"), (("TETRA10", 16), "^")):
        result = results[shape, n]
        at = result.pressures(body=1)
        axes.plot(np.degrees(np.arctan2(result.x[at, 1], result.x[at, 0])), result.fields["contact_pressure"][at] / 1e6, mark, markersize=3,
                  markerfacecolor="none", label=f"{shape}, n = {n}")
    axes.set(xlabel="angle [degrees]", ylabel="pressure [MPa]", title="Pressure between the rings")
    axes.legend(frameon=False)
    save(drawn, path)


def measure(folder, variant, results):
    """Rows of the table of one element, each with its orders from the mesh before."""
    shape, _, kind = variant.partition(", ")
    rows = []
    for n in SIZES[variant]:
        result = results[variant, n] = run(folder / f"{variant.replace(', ', '_')}_{n}", shape, n, **OPTIONS.get(kind, {}))
        row = {"shape": variant, "n": n, "unknowns": result.unknowns, **errors(result, Rings(kind == "sticking")), "multiplications": result.multiplications}
        for key in ("surface", "field"):
            row[f"{key} order"] = observed([rows[-1], row], key) if rows else ""
        rows.append(row)
    return rows


def page(folder, pictures):
    results = {}
    tables = {variant: measure(folder, variant, results) for variant in SIZES}
    draw(results, pictures / "rings.svg")
    stated = [row for shape in ("HEX20", "TETRA10") for row in tables[shape] if row["n"] == 16]
    orders = []
    for shape, asked in ORDERS.items():
        rows = [row for row in tables[shape] if row["n"] <= UP_TO]
        orders.append({"shape": shape, "n": " ".join(str(row["n"]) for row in rows), "asked": f"{asked[0]:.1f}, {asked[1]:.1f}",
                       "surface": observed(rows, "surface"), "field": observed(rows, "field")})
    pressure, shift = (np.ptp(values) / 2 for values in (Rings().pressure(np.eye(2)), Rings().displacement(np.eye(2), 1)[:, 0]))
    means = Rings().pressure(np.ones((1, 2)))[0], Rings().displacement(np.full((1, 2), np.sqrt(0.5)), 1)[0, 0]
    return Page("rings", "Two rings under pressure", "rms of the pressure, largest displacement error", max(max(row["rms"], row["shift"]) for row in stated), TOLERANCE, f"""
A ring (radii 0.2 and 0.6) in another one (0.6 and 1), without friction, in plane strain; E = 1e9, nu = 0.2; outside the pressure 1e7 + 1e6 cos 2 theta.

- Reference: ANALYTIC (Lame; Airy's function of the second harmonic in two rings that slide on each other, or stick): pressure between them
  {means[0]:.6e} + {pressure:.6e} cos 2 theta, u_r = {means[1]:.6e} - {shift:.6e} cos 2 theta outside, where they slide.
- Mesh: a quarter, one layer; n elements round the outer ring, which carries the multipliers, 3 n / 4 round the inner one, n / 4 across each.
- Values: errors of the pressure over the mean pressure: largest and root-mean-square at its nodes, root-mean-square over the surface (every node with
  its share of the area); largest error of u_r outside over the largest u_r; L2 norm of the displacement's error over a side of the layer, over that of
  the displacement. Orders are those of the two norms, each from the mesh before.
- Tolerance: 1 % for the root-mean-square at nodes and for u_r, with HEX20 and TET10, n = 16; the test asks for {SMALL[0]:.0%} and {SMALL[1]:.2%} with
  n = 8, and for the orders below up to n = 16 (HEX8 32).

![Pressure](rings.svg)

{table([row for rows in tables.values() for row in rows], {"shape": "element", "n": "n", "unknowns": "unknowns", "largest": "pressure, largest .2e", "rms": "rms at nodes .2e", "surface": "over the surface .2e",
              "surface order": "order .2f", "shift": "u_r .2e", "field": "displacement .2e", "field order": "order .2f", "multiplications": "multiplications"})}

By least squares over these meshes (pressure, displacement):

{table(orders, {"shape": "element", "n": "n", "asked": "at least", "surface": "pressure .2f", "field": "displacement .2f"})}

Edges of linear elements are chords: gaps of kappa h^2 / 8 open between unlike facets, which is large beside a displacement of 1 % of the radius;
`Primary Smoothing` = Cylinder ("smoothed") measures gaps to the circle instead. Errors are smaller by ten then, and reach their order later.

Quadratic elements: a row takes the jumps at all of its nodes along the normal of one of them; on a bent surface, slip at a node beside has a part along
that normal. What is left of it in the row is slip' times the second moment of the dual function, of the order h^2, up and down from node to node. So the
pressure has the order 1 where surfaces slide, and about 2 where they stick ("sticking", coefficient 5). The displacement has 2.6 and 2.7 up to
n = {UP_TO}, but not beyond, where its error is below 1e-4 (HEX20, n = 64: 1.7; what is left in the rows is of the order 2). Where they stick it is 3.
""")

