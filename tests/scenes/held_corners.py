#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The blocks of corners.py with their backs held along y: nodes in several contacts with one or two directions left; multiplications by F and seconds, as a table.

    tests/scenes/held_corners.py --haptos build/release/bin/haptos [--seed 1] [--scenes 12] [--only N ...] [--most 40]

On planes that lean, with axes of friction in any direction, rows along y are empty up to round-off (doc/decisions/057).  Exit status 1 where one is not solved,
or takes more multiplications than --most.
"""
import sys

import corners  # ends with 77 where modules are missing
from corners import Corner, hold


class HeldCorner(Corner):
    def describe(self):
        return f"{super().describe()}, held"

    def conditions(self):
        return [*super().conditions(), hold("hold", [f"back{box}" for box in range(sum(map(len, self.bodies)))], "y")]


if __name__ == "__main__":
    sys.exit(corners.main(HeldCorner, __doc__))
