#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Mesh of Code_Aster's test SSNV128: writes ssnv128.exo beside this script (needs numpy and netCDF4).

    ssnv128.py [ELEMENTS_PER_EDGE]        (default 64)

Square plate 0 <= x, y <= 0.04 m, one layer of cubes in z; bottom is y = 0, left is x = 0.
"""
import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "drivers"))
from haptos_exodus import Block, ExodusMesh, SideSet, write_exodus  # noqa: E402

EDGE = 0.04


def plate(n):
    """n x n x 1 hexahedra; node (i, j, k) is number i + (n+1) (j + (n+1) k)."""
    h = EDGE / n
    k, j, i = np.meshgrid([0, 1], np.arange(n + 1), np.arange(n + 1), indexing="ij")
    coordinates = h * np.stack([i.ravel(), j.ravel(), k.ravel()], axis=1)
    row = n + 1
    corner = (np.arange(n)[None, :] + row * np.arange(n)[:, None]).ravel()
    below = np.stack([corner, corner + 1, corner + row + 1, corner + row], axis=1)
    cubes = Block(1, "plate", "HEX8", np.hstack([below, below + row * row]))
    element = np.arange(n * n).reshape(n, n)   # [j, i]
    chosen = {"bottom": (element[0], 1), "right": (element[:, -1], 2), "top": (element[-1], 3), "left": (element[:, 0], 4),
              "back": (element.ravel(), 5), "front": (element.ravel(), 6)}
    sides = [SideSet(id, name, elements, np.full(len(elements), side))
             for id, (name, (elements, side)) in enumerate(chosen.items(), start=1)]
    return ExodusMesh(coordinates, [cubes], sides, title=f"SSNV128, {n} x {n} x 1 elements")


if __name__ == "__main__":
    write_exodus(HERE / "ssnv128.exo", plate(int(sys.argv[1]) if len(sys.argv) > 1 else 64))
