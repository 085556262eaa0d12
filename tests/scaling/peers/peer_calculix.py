# SPDX-License-Identifier: BSD-3-Clause
"""CalculiX on the frictional two beams: surface-to-surface penalty contact, friction 0.3; prints one line of JSON."""
import json
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile

import numpy as np

from beams import ALUMINIUM, FRICTION, PRESSURE, STEEL, grid, loads

STIFFNESS = 1e7  # contact penalty, pressure per length: about 50 E / 1 unit
STICK = 1e6      # of friction


def write_nodes(out, nodes, first):
    out.write("*NODE, NSET=NALL\n")
    for i, x in enumerate(nodes.reshape(-1, 3)):
        out.write("%d,%.9g,%.9g,%.9g\n" % ((first + i,) + tuple(x)))


def write_set(out, kind, name, numbers):
    out.write("*%s, %s=%s\n" % (kind, kind, name))
    out.writelines("%d,\n" % i for i in numbers)


def write_body(out, name, n, z0, first_node, first_element, material):
    nodes, hexes = grid(n, n, z0)
    write_nodes(out, nodes, first_node)
    out.write("*ELEMENT, TYPE=C3D8, ELSET=%s\n" % name)
    for e, row in enumerate(hexes):
        out.write("%d,%s\n" % (first_element + e, ",".join(str(first_node + i) for i in row)))
    out.write("*MATERIAL, NAME=M%s\n*ELASTIC\n%g,%g\n*SOLID SECTION, ELSET=%s, MATERIAL=M%s\n" % ((name,) + material + (name, name)))
    write_set(out, "NSET", "C" + name, first_node + np.arange((n + 1) ** 2))  # nodes at x = 0 come first
    cells = np.arange(len(hexes)).reshape(2 * n, n, n) + first_element
    layer, side = (cells[:, :, 0], "S1") if z0 >= 0 else (cells[:, :, -1], "S2")
    out.write("*SURFACE, NAME=S%s, TYPE=ELEMENT\n" % name)
    out.writelines("%d,%s\n" % (e, side) for e in layer.reshape(-1))
    return nodes, len(hexes)


def write_deck(path, n):
    with open(path, "w") as out:
        upper, count = write_body(out, "UP", n, 0.0, 1, 1, STEEL)
        number = upper.size // 3
        write_body(out, "LOW", n, -1.0, 1 + number, 1 + count, ALUMINIUM)
        out.write("*BOUNDARY\nCUP,1,3\nCLOW,1,3\n")
        out.write("*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n%g\n*FRICTION\n%g,%g\n" %
                  (STIFFNESS, FRICTION, STICK))
        out.write("*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nSUP,SLOW\n")
        out.write("*STEP, INC=200\n*STATIC\n0.25,1.\n*CLOAD\n")
        for i, f in enumerate(loads(upper, n, 0).reshape(-1, 3)):
            out.writelines("%d,%d,%.9g\n" % (i + 1, d + 1, f[d]) for d in range(3) if f[d] != 0)
        out.write("*NODE PRINT, NSET=NALL, FREQUENCY=1000\nU\n*NODE PRINT, NSET=CUP, TOTALS=ONLY, FREQUENCY=1000\nRF\n*END STEP\n")


def read_results(text, n):
    number = 2 * (2 * n + 1) * (n + 1) ** 2
    u = [line.split() for line in text.split("displacements")[-1].splitlines()[1:number + 3]]
    u = np.array([[float(v) for v in row[1:]] for row in u if len(row) == 4])
    totals = re.findall(r"total force.*?\n\s*\n\s*(\S+)\s+(\S+)\s+(\S+)", text)
    reaction = np.array([float(v) for v in totals[-1]])
    return u, reaction


def main():
    n = int(sys.argv[1])
    program = next(filter(None, map(shutil.which, ("ccx", "ccx_2.20"))))
    with tempfile.TemporaryDirectory() as folder:
        deck = pathlib.Path(folder) / "beams.inp"
        write_deck(deck, n)
        run = subprocess.run([program, "beams"], cwd=folder, capture_output=True, text=True, check=False)
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        if "Job finished" not in run.stdout:
            sys.exit("CalculiX did not finish:\n" + run.stdout[-2000:])
        u, reaction = read_results(deck.with_suffix(".dat").read_text(), n)
    applied = np.array([20.0, 20.0, -PRESSURE * 2.0])
    contact = -(applied + reaction)  # force of the lower beam on the upper one
    print(json.dumps({"total": usage.ru_utime + usage.ru_stime, "max_displacement": float(np.sqrt((u ** 2).sum(1)).max()),
                      "normal_force": float(contact[2]), "tangential_force": float(np.hypot(*contact[:2]))}))


if __name__ == "__main__":
    main()
