#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Two plates of any aspect, in contact and tied, by elements along an edge: multiplications by F and seconds, as a table.

    tests/scenes/aspects.py --haptos build/release/bin/haptos [--aspects 3 10 30 100] [--elements 20 31 44] [--layers 2] [--parts N]

Plates 1 : 1 : 1 / aspect, one above the other, of E x E x layers HEX8, contrast 3, coefficients .3 and .15 at 30 degrees, pressed and pulled; both are
held at x = 0, or the lower one alone.  Stiffness grows with the cube of the aspect, so that they bend about as far.  Exit status 1 where
one is not solved, or takes more multiplications than --most (60) or, tied, --most-tied (30).
"""
import argparse
import dataclasses
import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "sweep"))
try:
    import random_scenes
    from random_scenes import BodyMesh, Scene
except ImportError as missing:
    print(f"not run: {missing}")
    sys.exit(77)


def plates(aspect, elements, layers, held, parts=None):
    mesh = BodyMesh("HEX8", (elements, elements, layers))
    young = [E * aspect ** 3 for E in (2e5, 7e4)]
    subdomains = parts or max(4, 2 * elements * elements * layers // 150)
    return Scene("plates", (1, 1, 1 / aspect), [mesh] * 2, young, [0.3, 0.3], "Coulomb", (0.3, 0.15), 30.0, 1.0, 0.0, False, held, (0.05, 0.05, 0), 0.5,
                 subdomains, 1, family="aspects")


def solve(options, scene, folder):
    """Status, multiplications, seconds of the solve, pairs."""
    path = scene.write(folder, "scene")
    summary = pathlib.Path(folder) / "summary.json"
    summary.unlink(missing_ok=True)
    run = subprocess.run([*options.launcher.split(), options.haptos, path, "--output", f"{folder}/result.exo", "--summary", summary],
                         stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if not summary.exists():
        raise SystemExit(f"{scene.describe()}: exit status {run.returncode}: {run.stderr[-500:]}")
    read = json.loads(summary.read_text())
    return run.returncode, read["solver"]["hessian_multiplications"], read["time"]["solve"], read["model"]["contact_pairs"]


def main():
    parser = argparse.ArgumentParser(allow_abbrev=False, description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--haptos", required=True)
    parser.add_argument("--launcher", default="", help="as in 'mpirun -n 2'")
    parser.add_argument("--aspects", nargs="+", type=float, default=[3, 10, 30, 100])
    parser.add_argument("--elements", nargs="+", type=int, default=[20, 31, 44])
    parser.add_argument("--layers", type=int, default=2)
    parser.add_argument("--parts", type=int, help="subdomains of both (one for 150 elements)")
    parser.add_argument("--most", type=int, default=60)
    parser.add_argument("--most-tied", type=int, default=30)
    options = parser.parse_args()
    print("| aspect of the plates | of elements | pairs | held | F | seconds | F tied | seconds tied | remarks |")
    print("|---|---|---|---|---|---|---|---|---|")
    failed = 0
    for aspect in options.aspects:
        for elements in options.elements:
            for held in ("all bodies", "lowest body"):
                scene = plates(aspect, elements, options.layers, held, options.parts)
                with tempfile.TemporaryDirectory(prefix="haptos_") as folder:
                    status, count, seconds, pairs = solve(options, scene, folder)
                    tied_status, tied, tied_seconds, _ = solve(options, dataclasses.replace(scene, law="Tied"), folder)
                wrong = [f"status {status}"] * (status != 0) + [f"tied: status {tied_status}"] * (tied_status != 0)
                wrong += [f"more than {options.most}"] * (count > options.most) + [f"tied: more than {options.most_tied}"] * (tied > options.most_tied)
                failed += bool(wrong)
                print(f"| {aspect:g} | {aspect * options.layers / elements:.2g} | {pairs} | {held} | {count} | {seconds:.2g} | {tied} | {tied_seconds:.2g} | {', '.join(wrong)} |",
                      flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
