# SPDX-License-Identifier: BSD-3-Clause
"""Exodus II files from Python: the mesh as plain arrays, and its writer on netCDF4."""
from dataclasses import dataclass, field

import netCDF4
import numpy as np

# Families by their number of corners, Exodus' order: edges, corners of the sides (outward by the right-hand rule), and for
# corners the three neighbours that make a right-handed frame there (a pyramid's apex has four edges and none).
_HEX = ([(0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 5), (2, 6), (3, 7), (4, 5), (5, 6), (6, 7), (7, 4)],
        [(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (0, 4, 7, 3), (0, 3, 2, 1), (4, 5, 6, 7)],
        [(0, 1, 3, 4), (1, 2, 0, 5), (2, 3, 1, 6), (3, 0, 2, 7), (4, 7, 5, 0), (5, 4, 6, 1), (6, 5, 7, 2), (7, 6, 4, 3)])
_TET = ([(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)],
        [(0, 1, 3), (1, 2, 3), (0, 3, 2), (0, 2, 1)],
        [(0, 1, 2, 3)])
_WEDGE = ([(0, 1), (1, 2), (2, 0), (0, 3), (1, 4), (2, 5), (3, 4), (4, 5), (5, 3)],
          [(0, 1, 4, 3), (1, 2, 5, 4), (0, 3, 5, 2), (0, 2, 1), (3, 4, 5)],
          [(0, 1, 2, 3), (1, 2, 0, 4), (2, 0, 1, 5), (3, 5, 4, 0), (4, 3, 5, 1), (5, 4, 3, 2)])
_PYRAMID = ([(0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4)],
            [(0, 1, 4), (1, 2, 4), (2, 3, 4), (0, 4, 3), (0, 3, 2, 1)],
            [(0, 1, 3, 4), (1, 2, 0, 4), (2, 3, 1, 4), (3, 0, 2, 4)])
_FAMILIES = {"HEX8": (8, _HEX), "HEX20": (8, _HEX), "HEX27": (8, _HEX), "TETRA4": (4, _TET), "TETRA10": (4, _TET),
             "WEDGE6": (6, _WEDGE), "WEDGE15": (6, _WEDGE), "PYRAMID5": (5, _PYRAMID), "PYRAMID13": (5, _PYRAMID)}
_HEX27_CENTRES = [25, 24, 26, 23, 21, 22]   # of its sides; 20 is its own

CORNERS = {shape: corners for shape, (corners, _) in _FAMILIES.items()}          # how many
FRAMES = {shape: family[2] for shape, (_, family) in _FAMILIES.items()}
CORNERS_OF_SIDES = {shape: family[1] for shape, (_, family) in _FAMILIES.items()}


def nodes_in_middles(shape):
    """The corners around every node of a shape, [nodes]: one for a corner, two for the middle of an edge."""
    corners, (edges, sides, _) = _FAMILIES[shape]
    around = [(i,) for i in range(corners)]
    if shape not in ("HEX8", "TETRA4", "WEDGE6", "PYRAMID5"):
        around += edges
    if shape == "HEX27":
        around += [tuple(range(8)), *(sides[_HEX27_CENTRES.index(node)] for node in range(21, 27))]
    return around


def _all_nodes(shape):
    """Nodes of each side: corners, the middles of its edges, its centre."""
    place = {frozenset(around): node for node, around in enumerate(nodes_in_middles(shape))}
    sides = []
    for side in CORNERS_OF_SIDES[shape]:
        edges = [frozenset(edge) for edge in zip(side, side[1:] + side[:1])]
        sides.append(side + tuple(place[key] for key in [*edges, frozenset(side)] if key in place))
    return sides


SIDES = {shape: _all_nodes(shape) for shape in _FAMILIES}


@dataclass
class Block:
    """Elements of one shape; connectivity [elements x nodes] are 0-based rows of the coordinates.

    body: name of what several blocks of different shapes make together, the block's own name where there is one shape.
    """
    id: int
    name: str
    shape: str
    connectivity: np.ndarray
    element_numbers: np.ndarray = None
    body: str = ""


@dataclass
class SideSet:
    """elements: 0-based, counted over all blocks in their order; sides: 1-based, Exodus' order."""
    id: int
    name: str
    elements: np.ndarray
    sides: np.ndarray


@dataclass
class NodeSet:
    """nodes: 0-based rows of the coordinates."""
    id: int
    name: str
    nodes: np.ndarray


@dataclass
class ExodusMesh:
    """What an Exodus file holds; coordinates [nodes x 3] in the user's unit."""
    coordinates: np.ndarray
    blocks: list
    side_sets: list = field(default_factory=list)
    node_sets: list = field(default_factory=list)
    node_numbers: np.ndarray = None
    title: str = ""


def corner_jacobians(coordinates, block):
    """Triple products at the corners, [elements x corners but apexes]; a sound element has them all > 0."""
    x = coordinates[block.connectivity]
    frames = np.array(FRAMES[block.shape])
    edges = x[:, frames[:, 1:]] - x[:, frames[:, :1]]
    return np.linalg.det(edges)


def write_exodus(path, mesh):
    """Writes the mesh as an Exodus II file (netCDF classic, 64-bit offsets); names may have any length."""
    with netCDF4.Dataset(path, "w", format="NETCDF3_64BIT_OFFSET") as file:
        names = [s.name for s in [*mesh.blocks, *mesh.side_sets, *mesh.node_sets]]
        longest = max([32, *(len(n.encode()) for n in names)])
        _write_header(file, mesh, longest)
        for axis, name in enumerate("xyz"):
            file.createVariable("coord" + name, "f8", ("num_nodes",))[:] = mesh.coordinates[:, axis]
        _write_strings(file, "coor_names", "num_dim", "xyz")
        _write_map(file, "node_num_map", "num_nodes", mesh.node_numbers)
        _write_blocks(file, mesh.blocks)
        for item in enumerate(mesh.side_sets, start=1):
            _write_side_set(file, *item)
        for item in enumerate(mesh.node_sets, start=1):
            _write_node_set(file, *item)
        _write_properties(file, "ss", "num_side_sets", mesh.side_sets)
        _write_properties(file, "ns", "num_node_sets", mesh.node_sets)


def _write_header(file, mesh, longest):
    file.setncatts({"api_version": np.float32(5.14), "version": np.float32(5.14), "floating_point_word_size": np.int32(8),
                    "file_size": np.int32(1), "maximum_name_length": np.int32(longest), "int64_status": np.int32(0),
                    "title": mesh.title[:80]})
    sizes = {"len_string": 33, "len_line": 81, "len_name": longest + 1, "four": 4, "time_step": None, "num_dim": 3,
             "num_nodes": len(mesh.coordinates), "num_elem": sum(len(b.connectivity) for b in mesh.blocks),
             "num_el_blk": len(mesh.blocks), "num_side_sets": len(mesh.side_sets), "num_node_sets": len(mesh.node_sets)}
    for name, size in sizes.items():
        if size != 0:
            file.createDimension(name, size)
    file.createVariable("time_whole", "f8", ("time_step",))


def _write_blocks(file, blocks):
    _write_properties(file, "eb", "num_el_blk", blocks)
    for k, block in enumerate(blocks, start=1):
        file.createDimension(f"num_el_in_blk{k}", len(block.connectivity))
        file.createDimension(f"num_nod_per_el{k}", block.connectivity.shape[1])
        connect = file.createVariable(f"connect{k}", "i4", (f"num_el_in_blk{k}", f"num_nod_per_el{k}"))
        connect.elem_type = block.shape
        connect[:] = block.connectivity + 1
    if all(b.element_numbers is not None for b in blocks):
        _write_map(file, "elem_num_map", "num_elem", np.concatenate([b.element_numbers for b in blocks]))


def _write_properties(file, kind, dimension, items):
    if not items:
        return
    file.createVariable(kind + "_status", "i4", (dimension,))[:] = 1
    ids = file.createVariable(kind + "_prop1", "i4", (dimension,))
    ids.setncattr("name", "ID")
    ids[:] = [item.id for item in items]
    _write_strings(file, kind + "_names", dimension, [item.name for item in items])


def _write_side_set(file, k, side_set):
    file.createDimension(f"num_side_ss{k}", len(side_set.elements))
    file.createVariable(f"elem_ss{k}", "i4", (f"num_side_ss{k}",))[:] = np.asarray(side_set.elements) + 1
    file.createVariable(f"side_ss{k}", "i4", (f"num_side_ss{k}",))[:] = side_set.sides


def _write_node_set(file, k, node_set):
    file.createDimension(f"num_nod_ns{k}", len(node_set.nodes))
    file.createVariable(f"node_ns{k}", "i4", (f"num_nod_ns{k}",))[:] = np.asarray(node_set.nodes) + 1


def _write_map(file, name, dimension, numbers):
    """A number map is left out where it says 1..n, as Exodus' default does."""
    if numbers is not None and not np.array_equal(numbers, np.arange(1, len(numbers) + 1)):
        file.createVariable(name, "i4", (dimension,))[:] = numbers


def _write_strings(file, name, dimension, strings):
    width = len(file.dimensions["len_name"])
    table = file.createVariable(name, "S1", (dimension, "len_name"))
    table[:] = np.array([s.encode().ljust(width, b"\0") for s in strings]).view("S1").reshape(len(strings), width)
