# SPDX-License-Identifier: BSD-3-Clause
"""Which side of which element has given nodes."""
import numpy as np

from haptos_exodus import CORNERS_OF_SIDES


class SideFinder:
    """Finds element sides by their nodes, in any order: the adjacency that gmsh does not store."""

    def __init__(self, blocks):
        keys, elements, sides, first = [], [], [], 0
        for block in blocks:
            count = len(block.connectivity)
            for number, nodes in enumerate(CORNERS_OF_SIDES[block.shape], start=1):
                keys.append(facet_keys(block.connectivity[:, nodes]))
                elements.append(np.arange(first, first + count))
                sides.append(np.full(count, number))
            first += count
        keys = np.concatenate(keys)
        order = np.argsort(keys, kind="stable")
        self._keys = keys[order]
        self._elements = np.concatenate(elements)[order]
        self._sides = np.concatenate(sides)[order]

    def find(self, facets):
        """For each facet the list of its (element, side): none, one, or two for an inner facet."""
        keys = facet_keys(facets)
        begin = np.searchsorted(self._keys, keys, "left")
        end = np.searchsorted(self._keys, keys, "right")
        return [[(int(self._elements[i]), int(self._sides[i])) for i in range(b, e)] for b, e in zip(begin, end)]


def facet_keys(facets):
    """One comparable value per facet [facets x 3 or 4], independent of the order of its nodes."""
    padded = np.full((len(facets), 4), -1, dtype=">i8")
    padded[:, :facets.shape[1]] = np.asarray(facets, dtype=np.int64)
    padded.sort(axis=1)
    return padded.view("S32").ravel()
