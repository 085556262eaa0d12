#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Needles 1 : .01 of TETRA10 on a plane, held by friction alone, in parts about 12 times as long as wide: multiplications by F, as a table.

    tests/scenes/needles.py --haptos build/release/bin/haptos [--lengths 10 12 14] [--widths 1] [--subdomains 5 7 8 10] [--factors 1 5] [--most 24]

Number 9 of seed 34622 of the wide scenes, with so many elements along and across it and its coefficients times the factors.  Full steps of its condensed
model go too far (doc/decisions/052).  Exit status 1 where one is not solved, or takes more multiplications than --most.
"""
import argparse
import dataclasses
import itertools
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "sweep"))
try:
    import wide_scenes
    from aspects import solve
except ImportError as missing:
    print(f"not run: {missing}")
    sys.exit(77)


def needle(length, width, subdomains, factor):
    scene = wide_scenes.draw(34622, 9)
    mesh = dataclasses.replace(scene.meshes[0], elements=(length, width, width))
    return dataclasses.replace(scene, meshes=[mesh], subdomains=subdomains, seed=1, friction=tuple(factor * f for f in scene.friction))


def main():
    parser = argparse.ArgumentParser(allow_abbrev=False, description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--haptos", required=True)
    parser.add_argument("--launcher", default="", help="as in 'mpirun -n 2'")
    parser.add_argument("--lengths", nargs="+", type=int, default=[10, 12, 14])
    parser.add_argument("--widths", nargs="+", type=int, default=[1])
    parser.add_argument("--subdomains", nargs="+", type=int, default=[5, 7, 8, 10])
    parser.add_argument("--factors", nargs="+", type=float, default=[1, 5])
    parser.add_argument("--most", type=int, default=24)
    options = parser.parse_args()
    print("| elements | subdomains | pairs | coefficients times | F | seconds | remarks |")
    print("|---|---|---|---|---|---|---|")
    failed = 0
    for length, width, subdomains, factor in itertools.product(options.lengths, options.widths, options.subdomains, options.factors):
        with tempfile.TemporaryDirectory(prefix="haptos_") as folder:
            status, count, seconds, pairs = solve(options, needle(length, width, subdomains, factor), folder)
        wrong = [f"status {status}"] * (status != 0) + [f"more than {options.most}"] * (count > options.most)
        failed += bool(wrong)
        print(f"| {length}x{width}x{width} | {subdomains} | {pairs} | {factor:g} | {count} | {seconds:.2g} | {', '.join(wrong)} |", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
