#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Mesh of a hub that is shrunk on a hollow shaft: writes shrink_fit.exo beside this script (needs numpy, scipy and netCDF4).

Units: mm.  The axis is z.  Bricks of 20 nodes on circles, unlike numbers of them around and along in the two bodies.  Both are
drawn with the same radius; the interference is in shrink_fit.xml.
"""
import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "drivers"))
from haptos_grids import brick, divided, joined, write_mesh  # noqa: E402

BORE, FIT, OUTSIDE, LENGTH = 30.0, 50.0, 90.0, 40.0


def ring(inside, outside, divisions, names):
    """divisions: across, around, along; names: of the inner and the outer surface and of both ends."""
    def to(p):
        return np.stack([p[:, 0] * np.cos(p[:, 1]), p[:, 0] * np.sin(p[:, 1]), p[:, 2]], axis=1)
    axes = [divided(outside - inside, divisions[0], inside), divided(2 * np.pi, divisions[1]), divided(LENGTH, divisions[2])]
    return joined([brick("HEX20", axes, {"x-": names[0], "x+": names[1], "z-": names[2], "z+": names[2]}, to)])


def main():
    bodies = {"shaft": ring(BORE, FIT, (2, 56, 3), ("bore", "seat", "ends")),
              "hub": ring(FIT, OUTSIDE, (3, 40, 2), ("hole", "rim", "ends"))}
    points = {"on_x": lambda x: (np.abs(np.abs(x[:, 0]) - OUTSIDE) < 1e-9) & (np.abs(x[:, 1]) < 1e-9),
              "on_y": lambda x: (np.abs(x[:, 1] - OUTSIDE) < 1e-9) & (np.abs(x[:, 0]) < 1e-9)}
    mesh = write_mesh(HERE / "shrink_fit.exo", bodies, points)
    print(f"shrink_fit.exo: {len(mesh.coordinates)} nodes, {sum(len(b.connectivity) for b in mesh.blocks)} elements")


if __name__ == "__main__":
    main()
