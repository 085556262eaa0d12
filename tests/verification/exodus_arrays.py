# SPDX-License-Identifier: BSD-3-Clause
"""An Exodus file by netCDF4 alone, for tests: nothing of the library or its drivers."""
import netCDF4
import numpy as np

# The manual's tables, 1-based, written down here a second time on purpose.
SIDE_NODES = {"HEX8": {1: (1, 2, 6, 5), 2: (2, 3, 7, 6), 3: (3, 4, 8, 7), 4: (1, 5, 8, 4), 5: (1, 4, 3, 2), 6: (5, 6, 7, 8)},
              "TETRA4": {1: (1, 2, 4), 2: (2, 3, 4), 3: (1, 4, 3), 4: (1, 3, 2)},
              "WEDGE6": {1: (1, 2, 5, 4), 2: (2, 3, 6, 5), 3: (1, 4, 6, 3), 4: (1, 3, 2), 5: (4, 5, 6)},
              "PYRAMID5": {1: (1, 2, 5), 2: (2, 3, 5), 3: (3, 4, 5), 4: (1, 5, 4), 5: (1, 4, 3, 2)}}
LINEAR = {"HEX20": "HEX8", "HEX27": "HEX8", "TETRA10": "TETRA4", "WEDGE15": "WEDGE6", "PYRAMID13": "PYRAMID5"}
HEX_IN_TETS = [(0, 1, 3, 4), (1, 2, 3, 6), (1, 6, 4, 5), (3, 4, 6, 7), (1, 3, 4, 6)]


class Exodus:
    """An Exodus file as arrays: coordinates, blocks and sets by name."""

    def __init__(self, path):
        with netCDF4.Dataset(path) as file:
            file.set_auto_mask(False)
            self.format = file.data_model
            self.title = file.title
            self.x = np.stack([file["coord" + a][:] for a in "xyz"], axis=1)
            self.node_map = file["node_num_map"][:] if "node_num_map" in file.variables else None
            self.ids = {k: list(file[k + "_prop1"][:]) for k in ("eb", "ss", "ns") if k + "_prop1" in file.variables}
            self.blocks = {n: (file[f"connect{k}"].elem_type, file[f"connect{k}"][:] - 1) for k, n in self._names(file, "eb")}
            self.side_sets = {n: (file[f"elem_ss{k}"][:], file[f"side_ss{k}"][:]) for k, n in self._names(file, "ss")}
            self.node_sets = {n: file[f"node_ns{k}"][:] - 1 for k, n in self._names(file, "ns")}
        self._elements = [(shape, nodes) for shape, rows in self.blocks.values() for nodes in rows]

    @staticmethod
    def _names(file, kind):
        if kind + "_names" not in file.variables:
            return []
        return enumerate((b"".join(row).rstrip(b"\0").decode() for row in file[kind + "_names"][:]), start=1)

    def volumes(self, block):
        shape, rows = self.blocks[block]
        tets = HEX_IN_TETS if shape == "HEX8" else [(0, 1, 2, 3)]
        x = self.x[rows]
        return sum(np.linalg.det(x[:, t[1:]] - x[:, t[:1]]) / 6 for t in tets)

    def facets(self, side_set):
        for element, side in zip(*self.side_sets[side_set]):
            shape, nodes = self._elements[element - 1]
            yield nodes[np.array(SIDE_NODES[LINEAR.get(shape, shape)][side]) - 1]

    def area_vector(self, side_set):
        """Sum over the sides of area times outward normal, and the sum of the areas."""
        vectors = []
        for nodes in self.facets(side_set):
            p = self.x[nodes]
            vectors.append(np.cross(p[2] - p[0], p[-1] - p[1]) / 2 if len(p) == 4 else np.cross(p[1] - p[0], p[2] - p[0]) / 2)
        return np.sum(vectors, axis=0), np.linalg.norm(vectors, axis=1).sum()

    def set_nodes(self, side_set):
        return np.unique(np.concatenate(list(self.facets(side_set))))
