# SPDX-License-Identifier: BSD-3-Clause
"""Meshes of mapped bricks in any of the element shapes, straight or curved: what benchmarks and examples are made of."""
import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from haptos_exodus import CORNERS_OF_SIDES, Block, ExodusMesh, NodeSet, SideSet, nodes_in_middles, write_exodus

# Corners of the elements in a cell, as offsets in {0, 1}^3; tetrahedra as Kuhn cuts a cube, so that neighbours fit.
_CUBE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
_WEDGES = [[_CUBE[k] for k in corners] for corners in ((0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7))]
_TETRAHEDRA = [[_CUBE[k] for k in corners] for corners in
               ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6))]
_CELLS = {"HEX8": [_CUBE], "HEX20": [_CUBE], "HEX27": [_CUBE], "WEDGE6": _WEDGES, "WEDGE15": _WEDGES,
          "TETRA4": _TETRAHEDRA, "TETRA10": _TETRAHEDRA}


class Body:
    """Elements of one shape: coordinates [nodes x 3], connectivity, sides {name: [(element, side)]}, label of every node.

    Nodes with different labels stay apart where bodies are joined.
    """

    def __init__(self, shape, coordinates, connectivity, sides):
        self.shape, self.coordinates, self.connectivity, self.sides = shape, coordinates, connectivity, sides
        self.label = np.zeros(len(coordinates), dtype=int)


def graded(fine, size, end, growth=1.6):
    """0 to end: `fine` equal steps up to `size`, then steps that grow, each at most by `growth`."""
    step = size / fine
    count, lengths = 0, [0.0]
    while sum(lengths) < end - size:
        count += 1
        lengths = [step * growth ** (k + 1) for k in range(count)]
    ratio = _ratio(step, count, end - size)
    tail = size + np.cumsum(step * ratio ** np.arange(1, count + 1))
    return np.concatenate([np.linspace(0, size, fine + 1), tail])


def _ratio(step, count, length):
    """q with step (q + ... + q^count) = length."""
    low, high = 0.05, 10.0
    for _ in range(80):
        q = 0.5 * (low + high)
        low, high = (q, high) if step * np.sum(q ** np.arange(1, count + 1)) < length else (low, q)
    return q


def brick(shape, axes, sides=None, to=None):
    """The product of three axes (corner positions) in elements of a shape.

    :param sides: {"x-": name, ...}, the side sets
    :param to: takes points [n x 3] to where they are; nodes between corners go to the map of their middles
    """
    fine = [np.insert(np.asarray(a, float), np.arange(1, len(a)), 0.5 * (np.asarray(a[1:]) + np.asarray(a[:-1]))) for a in axes]
    cells = np.stack(np.meshgrid(*[2 * np.arange(len(a) - 1) for a in axes], indexing="ij"), axis=-1).reshape(-1, 3)
    places = []                                    # of nodes on the grid with middles, [elements x nodes x 3]
    for corners in _CELLS[shape]:
        offsets = [np.mean([corners[c] for c in around], axis=0) for around in nodes_in_middles(shape)]
        places.append(cells[:, None, :] + np.rint(2 * np.array(offsets)).astype(int)[None])
    places = np.concatenate(places)
    used, connectivity = np.unique(np.ravel_multi_index(tuple(np.moveaxis(places, -1, 0)), [len(a) for a in fine]), return_inverse=True)
    index = np.unravel_index(used, [len(a) for a in fine])
    x = np.stack([fine[c][index[c]] for c in range(3)], axis=1)
    ends = [2 * (len(a) - 1) for a in axes]
    return Body(shape, x if to is None else to(x), connectivity.reshape(places.shape[:2]), _sides_of(shape, places, ends, sides or {}))


def _sides_of(shape, places, ends, names):
    sets = {}
    for where, name in names.items():
        axis, end = "xyz".index(where[0]), where[1] == "+"
        at = places[:, :, axis] == (ends[axis] if end else 0)
        found = [(e, number) for number, corners in enumerate(CORNERS_OF_SIDES[shape], start=1)
                 for e in np.flatnonzero(at[:, list(corners)].all(axis=1))]
        sets.setdefault(name, []).extend(found)
    return sets


def joined(bodies, tolerance=1e-9):
    """One body of several of the same shape: nodes at one place with one label become one."""
    x = np.vstack([b.coordinates for b in bodies])
    label = np.concatenate([b.label for b in bodies])
    close = cKDTree(x).query_pairs(tolerance, output_type="ndarray")
    close = close[label[close[:, 0]] == label[close[:, 1]]]
    _, node = connected_components(coo_matrix((np.ones(len(close)), (close[:, 0], close[:, 1])), shape=(len(x), len(x))))
    _, first = np.unique(node, return_index=True)
    connectivity, sides, nodes, elements = [], {}, 0, 0
    for body in bodies:
        connectivity.append(node[body.connectivity + nodes])
        for name, members in body.sides.items():
            sides.setdefault(name, []).extend((e + elements, s) for e, s in members)
        nodes, elements = nodes + len(body.coordinates), elements + len(body.connectivity)
    whole = Body(bodies[0].shape, x[first], np.vstack(connectivity), sides)
    whole.label = label[first]
    return whole


def write_mesh(path, bodies, node_sets=None):
    """Writes {name: body}, a block each.  :param node_sets: {name: test of points [n x 3]}"""
    blocks, side_sets, coordinates, elements, nodes = [], {}, [], 0, 0
    for number, (name, body) in enumerate(bodies.items(), start=1):
        blocks.append(Block(number, name, body.shape, body.connectivity + nodes))
        for side, members in body.sides.items():
            side_sets.setdefault(side, []).extend((e + elements, s) for e, s in members)
        coordinates.append(body.coordinates)
        nodes, elements = nodes + len(body.coordinates), elements + len(body.connectivity)
    x = np.vstack(coordinates)
    mesh = ExodusMesh(x, blocks, [SideSet(k, name, *np.array(members).T) for k, (name, members) in enumerate(side_sets.items(), start=1)],
                      [NodeSet(k, name, np.flatnonzero(inside(x))) for k, (name, inside) in enumerate((node_sets or {}).items(), start=1)])
    write_exodus(path, mesh)
    return mesh


def divided(length, count, start=0.0):
    return np.linspace(start, start + length, count + 1)
