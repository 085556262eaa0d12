#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What pairing surfaces that do not match costs beside assembling stiffnesses: instructions of one rank, counted by valgrind.

    pairing_cost.py [--elements 24] [--shapes HEX8 TETRA4 HEX20 TETRA10] [--haptos PROGRAM]

Two beams of 2 x 1 x 1, N elements a unit length, the upper one shifted by up to half an element, which bends its edges.  Nothing is
solved.  Pairing is all that is done to surfaces, the attempt to pair nodes among it; of the assembly the stiffnesses, and all of it.
Exit status: 0, 1 if pairing takes more than the assembly.  Not part of ctest, which does without valgrind.
"""
import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "verification" / "benchmarks"))
from runs import contact, displacement, material, write_mesh, xml_of  # noqa: E402
from haptos_grids import brick, divided  # noqa: E402

COUNTED = {"pairing": "pairSurfaces", "stiffnesses": "ElasticStiffness::assemble", "assembly": "FetiSystem::assemble"}


def beam(shape, n, low, shift, names):
    def to(p):
        moved = p.copy()
        moved[:, 0] += 2 * shift / n * p[:, 0] * (2 - p[:, 0]) / 2
        moved[:, 1] += 4 * shift / n * p[:, 1] * (1 - p[:, 1])
        return moved
    return brick(shape, [divided(2, 2 * n), divided(1, n), divided(1, n, low)], names, to)


def write_scene(folder, shape, n):
    write_mesh(folder / "mesh.exo", {"lower": beam(shape, n, -1, 0, {"x-": "left", "z+": "lower_contact"}),
                                     "upper": beam(shape, n, 0, 0.5, {"x-": "upper_left", "z-": "upper_contact", "z+": "top"})})
    scene = {"Mesh": {"File": "mesh.exo"}, "Materials": {"all": material(["lower", "upper"], 1e5, 0.3)},
             "Boundary Conditions": {"clamp": displacement(["left", "upper_left"], (0.0, 0.0, 0.0)),
                                     "press": {"Type": "Pressure", "Sets": ["top"], "Value": "100"}},
             "Contact": {"joint": contact("upper_contact", "lower_contact", (0.3, 0.3))}, "Output": {"File": "result.exo"}}
    (folder / "scene.xml").write_text(xml_of(scene))


def instructions(program, folder):
    """{name: instructions} of what is COUNTED, with all that it calls."""
    profile = folder / "profile"
    environment = dict(os.environ, OPENBLAS_NUM_THREADS="1", OPENBLAS_CORETYPE="Haswell")
    subprocess.run(["valgrind", "-q", "--tool=callgrind", f"--callgrind-out-file={profile}", program, "scene.xml", "--validate-only"], cwd=folder,
                   env=environment, check=True, stdout=subprocess.DEVNULL)
    text = subprocess.run(["callgrind_annotate", "--inclusive=yes", "--threshold=100", str(profile)], check=True, capture_output=True,
                          text=True).stdout
    counts = {}
    for name, function in COUNTED.items():
        found = re.search(rf"^\s*([\d,]+) .*:Haptos::{function}\(", text, re.MULTILINE)
        if not found:
            sys.exit(f"pairing_cost.py: the profile knows no {function}; is {program} stripped, or was it inlined?")
        counts[name] = int(found[1].replace(",", ""))
    return counts


def main():
    parser = argparse.ArgumentParser(allow_abbrev=False, description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--elements", type=int, default=24)
    parser.add_argument("--shapes", nargs="+", default=["HEX8", "TETRA4", "HEX20", "TETRA10"])
    parser.add_argument("--haptos", default=str(ROOT / "build/release/bin/haptos"))
    options = parser.parse_args()
    if not shutil.which("valgrind"):
        sys.exit("pairing_cost.py: valgrind is not installed, and it counts the instructions; try: apt install valgrind")
    print("| element | elements an edge | pairing [1e9 instructions] | stiffnesses | assembly | pairing / assembly |\n|---|---|---|---|---|---|")
    worst = 0.0
    for shape in options.shapes:
        with tempfile.TemporaryDirectory() as folder:
            write_scene(pathlib.Path(folder), shape, options.elements)
            counts = instructions(os.path.abspath(options.haptos), pathlib.Path(folder))
        ratio = counts["pairing"] / counts["assembly"]
        worst = max(worst, ratio)
        print(f"| {shape} | {options.elements} | " + " | ".join(f"{counts[name] / 1e9:.2f}" for name in COUNTED) + f" | {ratio:.2f} |", flush=True)
    return int(worst > 1)


if __name__ == "__main__":
    sys.exit(main())
