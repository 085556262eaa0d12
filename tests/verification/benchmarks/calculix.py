#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The mortar contact of CalculiX on the same meshes: a cap that is pressed on a block, linear and quadratic.

    calculix.py --haptos PROGRAM        ends with status 77 where ccx is missing (Debian: calculix-ccx)
"""
import argparse
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import numpy as np

from pages import Page, table
from runs import contact, displacement, material, programs, solve
from haptos_exodus import SIDES
from haptos_grids import brick, graded

YOUNG, POISSON, RADIUS, APPROACH, SIZE = 1000.0, 0.3, 100.0, 0.02, 4.0
TOLERANCE = 0.02
CASES = {"TETRA4": (4, 3), "HEX20": (2, 1.5), "TETRA10": (2, 1.5)}     # elements a length above and below
TYPES = {"TETRA4": "C3D4", "TETRA10": "C3D10", "HEX20": "C3D20"}
ORDER = {"HEX20": [*range(12), *range(16, 20), *range(12, 16)]}            # of CalculiX: middles of the upper face before those between
FACES = {4: (2, 3, 4, 1), 8: (3, 4, 5, 6, 1, 2)}                             # of CalculiX by Exodus' sides
METHOD = "MORTAR"


def bodies_of(shape):
    result = {}
    for name, n in zip(("upper", "lower"), CASES[shape]):
        axis, depth = graded(round(1.5 * n), 1.5, SIZE), graded(round(n), 1.0, SIZE)
        axis = np.concatenate([-axis[:0:-1], axis])
        if name == "upper":
            def cap(p):
                return p + np.outer((p[:, 0] ** 2 + p[:, 1] ** 2) / (2 * RADIUS) * (1 - p[:, 2] / SIZE), [0, 0, 1])
            result[name] = brick(shape, [axis, axis, depth], {"z-": "cap", "z+": "top"}, cap)
        else:
            result[name] = brick(shape, [axis, axis, -depth[::-1]], {"z+": "table", "z-": "floor"})
    return result


def haptos(folder, shape, bodies):
    conditions = {"floor": displacement(["floor"]), "top": displacement(["top"], (0.0, 0.0, -APPROACH))}
    return solve(folder, bodies, {"one": material(bodies, YOUNG, POISSON)}, conditions, {"joint": contact("cap", "table", Sides="As Given")}, 1e-8)


def nodes_of(body, side):
    return np.unique(np.concatenate([body.connectivity[e, list(SIDES[body.shape][s - 1])] for e, s in body.sides[side]]))


def write_deck(path, bodies):
    lines, first, held, element = [], 1, [], 1
    for name, body in bodies.items():
        lines.append(f"*NODE, NSET=N{name}")
        lines += [f"{first + i},{x[0]:.12g},{x[1]:.12g},{x[2]:.12g}" for i, x in enumerate(body.coordinates)]
        lines.append(f"*ELEMENT, TYPE={TYPES[body.shape]}, ELSET=E{name}")
        for e, row in enumerate(body.connectivity):
            numbers = [str(first + i) for i in row[ORDER.get(body.shape, range(len(row)))]]
            lines += [f"{element + e}," + ",".join(numbers[:15]) + ("," if len(numbers) > 15 else ""), *([",".join(numbers[15:])] if len(numbers) > 15 else [])]
        corners = 8 if body.shape == "HEX20" else 4
        side = "cap" if name == "upper" else "table"
        lines.append(f"*SURFACE, NAME=S{side}, TYPE=ELEMENT")
        lines += [f"{element + e},S{FACES[corners][s - 1]}" for e, s in body.sides[side]]
        lines.append(f"*SOLID SECTION, ELSET=E{name}, MATERIAL=ONE")
        side, z = ("top", -APPROACH) if name == "upper" else ("floor", 0)
        for axis, value in ((1, 0), (2, 0), (3, z)):
            held += [f"{first + i},{axis},{axis},{value}" for i in nodes_of(body, side)]
        first, element = first + len(body.coordinates), element + len(body.connectivity)
    lines += ["*MATERIAL, NAME=ONE", "*ELASTIC", f"{YOUNG},{POISSON}", "*SURFACE INTERACTION, NAME=I", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{1e5 * YOUNG}",
              f"*CONTACT PAIR, INTERACTION=I, TYPE={METHOD}", "Scap,Stable", "*STEP, INC=100", "*STATIC", "1.,1.", "*BOUNDARY", *held,
              "*CONTACT FILE", "CSTR", "*NODE FILE", "RF", "*END STEP"]
    path.write_text("\n".join(lines) + "\n")


def calculix(folder, bodies):
    """Pressures and normal reactions of its last increment, by node [0-based]."""
    program = shutil.which("ccx")
    folder.mkdir(parents=True, exist_ok=True)
    write_deck(folder / "cap.inp", bodies)
    run = subprocess.run([program, "cap"], cwd=folder, capture_output=True, text=True, check=False, timeout=900)
    if "Job finished" not in run.stdout:
        raise RuntimeError("CalculiX did not finish:\n" + run.stdout[-3000:] + run.stderr[-1000:])
    return read_frd((folder / "cap.frd").read_text())


def read_frd(text):
    blocks = {}
    for block in re.split(r"\n(?= -4  )", text)[1:]:
        name = block.split()[1]
        rows = re.findall(r"^ -1 *(\d+)((?: *-?\d\.\d+E[+-]\d+)+)", block, flags=re.M)
        blocks[name] = {int(node) - 1: [float(v) for v in re.findall(r"-?\d\.\d+E[+-]\d+", values)] for node, values in rows}
    return blocks


def values_at_nodes(body, pressure):
    """Of the pressure sum p_j N'_j (doc/theory.md, section 2): at middles 0.6 p_m + 0.2 (p_c1 + p_c2), as CalculiX prints it."""
    values = dict(pressure)
    corners = 4 if body.shape.startswith("HEX") else 3
    for e, side in body.sides["cap"]:
        face = body.connectivity[e, list(SIDES[body.shape][side - 1])]
        for k, middle in enumerate(face[corners:]):
            values[middle] = 0.6 * pressure[middle] + 0.2 * (pressure[face[k]] + pressure[face[(k + 1) % corners]])
    return values


def measure(folder, shape):
    """A row: both largest pressures, the largest difference of the pressures at a node over the largest pressure, and of the forces."""
    bodies = bodies_of(shape)
    ours, theirs = haptos(folder / f"{shape}_haptos", shape, bodies), calculix(folder / f"{shape}_ccx", bodies)
    force = -sum(theirs["FORC"][i][2] for i in nodes_of(bodies["upper"], "top"))
    cap = nodes_of(bodies["upper"], "cap")
    pressure = values_at_nodes(bodies["upper"], {i: ours.fields["contact_pressure"][i] for i in cap})
    p, q = (np.array([values.get(i, 0.0) for i in cap]) for values in (pressure, {i: v[3] for i, v in theirs["CONTACT"].items()}))
    return {"shape": shape, "unknowns": ours.unknowns, "ours": p.max(), "theirs": q.max(), "peak": p.max() / q.max() - 1,
            "nodes": np.abs(p - q).max() / q.max(), "force": ours.summary["contact"]["joint"]["normal_force"] / force - 1,
            "multiplications": ours.multiplications}


def page(folder, pictures):
    rows = [measure(folder, shape) for shape in CASES]
    return Page("calculix", "CalculiX's mortar contact on the same meshes", "peak pressure", max(abs(row["peak"]) for row in rows), TOLERANCE, f"""
A cap (radius {RADIUS:g}) on a block of {2 * SIZE:g} x {2 * SIZE:g} x {SIZE:g} is pressed on a block of the same size, held on its floor: E = {YOUNG:g}, nu = {POISSON:g}, without friction, by
{APPROACH:g} at its top.

- Reference: EXTERNAL, CalculiX 2.20 (Debian's calculix-ccx), contact of TYPE={METHOD} (dual mortar; on quadratic faces with transformed functions), elements C3D4,
  C3D20, C3D10 on the same nodes. Its HARD behaviour is by default a spring of 50 E a length; here {1e5:g} E.
- Mesh: {", ".join(f"{shape} with {n:g} and {m:g} elements a length above and below" for shape, (n, m) in CASES.items())}: the meshes do not match. C3D8 is left out: it takes B-bar at any nu.
- Values: pressures at the nodes; at middles of edges CalculiX prints the value of the field, 0.6 p_m + 0.2 (p_c1 + p_c2) of what `contact_pressure` holds, its
  coefficient; so they are compared as values.
- Tolerance: 2 % of the peak pressure. (With planes of symmetry through the secondary surface CalculiX finds its matrix singular: the whole is modelled.)

{table(rows, {"shape": "element", "unknowns": "unknowns", "ours": "peak, Haptos .5f", "theirs": "CalculiX .5f", "peak": "difference .1e",
              "nodes": "largest at a node, over the peak .1e", "force": "force .1e", "multiplications": "multiplications"})}
""")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--haptos", required=True)
    programs.haptos = parser.parse_args().haptos
    if not shutil.which("ccx"):
        print("skipped: no ccx")
        return 77
    with tempfile.TemporaryDirectory(prefix="haptos_") as folder:
        rows = [measure(pathlib.Path(folder), shape) for shape in CASES]
    print(*rows, sep="\n")
    return int(max(max(abs(row["peak"]), row["nodes"], abs(row["force"])) for row in rows) > TOLERANCE)


if __name__ == "__main__":
    sys.exit(main())
