#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Converts a gmsh mesh to the Exodus II file that haptos reads.

    haptos_from_gmsh.py INPUT.msh OUTPUT.exo [--node-set NAME]... [--split SURFACE]...
                        [--side-of SURFACE=BLOCK]... [--title TEXT]

physical volume    element block; one of hexahedra, wedges, pyramids and tetrahedra together becomes a block for each shape,
                   NAME, NAME_wedge, NAME_pyramid, NAME_tet (the first that is there keeps the name).  Of first order, or of
                   second order with 10, 13, 15, 20 or 27 nodes
physical surface   side set; the side is found on the volume element next to it
any physical group named "nodes:NAME", or named by --node-set NAME: node set NAME

A surface between two blocks makes two side sets, BLOCK1_SURFACE and BLOCK2_SURFACE;
--side-of SURFACE=BLOCK keeps one of them, under the surface's own name.  gmsh's conforming
meshes share the nodes of such a surface, so the blocks are glued there; --split SURFACE
gives the second block nodes of its own, which makes it a contact surface with matching nodes.

Needs the Python packages numpy, netCDF4 and gmsh (the last one needs libGL and libGLU).
As a module: from_gmsh() converts the current gmsh model; haptos_exodus writes it.
"""
import argparse
import pathlib
import sys
from dataclasses import dataclass

import numpy as np

from haptos_exodus import (CORNERS, CORNERS_OF_SIDES, SIDES, Block, ExodusMesh, NodeSet, SideSet, corner_jacobians, nodes_in_middles,
                           write_exodus)
from haptos_sides import SideFinder, facet_keys

NODE_SET_PREFIX = "nodes:"
GMSH_SHAPES = {4: "TETRA4", 5: "HEX8", 6: "WEDGE6", 7: "PYRAMID5", 11: "TETRA10", 12: "HEX27", 17: "HEX20", 18: "WEDGE15", 19: "PYRAMID13"}
GMSH_FACETS = {2: 3, 3: 4, 9: 3, 10: 4, 16: 4}   # corners, which come first

# In this order of corners an element is turned inside out.
MIRROR = {8: [4, 5, 6, 7, 0, 1, 2, 3], 4: [0, 2, 1, 3], 6: [3, 4, 5, 0, 1, 2], 5: [0, 3, 2, 1, 4]}
SHAPES_IN_ORDER = {8: "hex", 6: "wedge", 5: "pyramid", 4: "tet"}   # by corners


class MeshError(Exception):
    """The mesh cannot be converted as it is; the message says what would be right."""


# ---------------------------------------------------------------- geometry


def orient(coordinates, block):
    """Mirrors left-handed elements of the block in place; refuses folded and flat ones."""
    jacobians = corner_jacobians(coordinates, block)
    left_handed = np.all(jacobians < 0, axis=1)
    block.connectivity[left_handed] = block.connectivity[left_handed][:, mirrored(block.shape)]
    bad = np.flatnonzero(~left_handed & ~np.all(jacobians > 0, axis=1))
    if len(bad):
        raise MeshError(f"element {block.element_numbers[bad[0]]} of physical volume {quoted(block)} and "
                        f"{len(bad) - 1} more are flat or folded (a corner has no positive volume); improve the mesh there")


def mirrored(shape):
    """MIRROR for all nodes: each goes between the same corners as before."""
    around = nodes_in_middles(shape)
    place = {frozenset(corners): node for node, corners in enumerate(around)}
    corner_at = MIRROR[CORNERS[shape]]
    return [place[frozenset(corner_at[c] for c in corners)] for corners in around]


def exodus_order(gmsh, kind):
    """For every node of the Exodus shape its place in gmsh's element, by gmsh's own reference coordinates."""
    shape = GMSH_SHAPES[kind]
    _, dim, _, _, local, _ = gmsh.model.mesh.getElementProperties(kind)
    local = np.array(local).reshape(-1, dim)
    wanted = np.array([local[list(corners)].mean(axis=0) for corners in nodes_in_middles(shape)])
    return [int(np.argmin(np.linalg.norm(local - x, axis=1))) for x in wanted]


# ---------------------------------------------------------------- from gmsh


@dataclass
class _Group:
    dim: int
    tag: int
    name: str


def quoted(item):
    """Name of a block or physical group as a message shows it."""
    return f"'{item.name}'" if item.name else f"number {getattr(item, 'tag', getattr(item, 'id', '?'))}"


def from_gmsh(node_sets=(), split=(), side_of=None, title=""):
    """Converts the current gmsh model, which must be meshed.

    :param node_sets: names of physical groups (any dimension) that become node sets instead of side sets
    :param split: names of physical surfaces between two blocks whose nodes are duplicated
    :param side_of: {surface: block}, the side kept of a surface between two blocks
    :raises MeshError: with what is wrong and what would be right
    """
    import gmsh
    groups = [_Group(d, t, gmsh.model.getPhysicalName(d, t)) for d, t in gmsh.model.getPhysicalGroups()]
    _check_names(groups, [*node_sets, *split, *(side_of or {})])
    as_nodes = [g for g in groups if g.name in node_sets or g.name.startswith(NODE_SET_PREFIX)]
    row_of, mesh = _read_volumes(gmsh, groups)
    mesh.title = title or gmsh.model.getCurrent()
    for block in mesh.blocks:
        orient(mesh.coordinates, block)
    mesh.node_sets = _read_node_sets(gmsh, as_nodes, row_of)
    _read_surfaces(gmsh, [g for g in groups if g.dim == 2 and g not in as_nodes], row_of, mesh, split, side_of or {})
    for group in groups:
        if group.dim < 2 and group not in as_nodes:
            print(f"haptos_from_gmsh: physical {('point', 'curve')[group.dim]} {quoted(group)} is left out; "
                  f"--node-set, or a name that begins with {NODE_SET_PREFIX}, would make it a node set", file=sys.stderr)
    return mesh


def _check_names(groups, wanted):
    known = [g.name for g in groups if g.name]
    for name in wanted:
        if name not in known:
            raise MeshError(f"no physical group is named '{name}'; there are: {', '.join(known) or 'no named groups'}")
    for dim in range(4):
        names = [g.name for g in groups if g.dim == dim and g.name]
        twice = {n for n in names if names.count(n) > 1}
        if twice:
            raise MeshError(f"two physical groups of dimension {dim} are named '{twice.pop()}'; give each its own name")


def _read_volumes(gmsh, groups):
    """Element blocks of the physical volumes, and the row of each gmsh node tag (-1: not in a volume)."""
    volumes = [g for g in groups if g.dim == 3]
    if not volumes:
        raise MeshError("the mesh has no physical volume, so there is nothing to solve; "
                        "name each body, e.g. Physical Volume(\"root\") = {1};")
    owner, blocks = {}, []
    for group in volumes:
        for entity in gmsh.model.getEntitiesForPhysicalGroup(3, group.tag):
            if entity in owner:
                raise MeshError(f"volume {entity} is in two physical volumes, {quoted(owner[entity])} and {quoted(group)}; "
                                "an element belongs to one block")
            owner[entity] = group
        blocks += _read_blocks(gmsh, group, [g.tag for g in volumes] + [b.id for b in blocks])
    _check_all_covered(gmsh, owner)
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    used = np.unique(np.concatenate([b.connectivity.ravel() for b in blocks]))
    all_rows = np.full(int(tags.max()) + 1, -1, dtype=np.int64)
    all_rows[tags] = np.arange(len(tags))
    row_of = np.full(int(tags.max()) + 1, -1, dtype=np.int64)
    row_of[used] = np.arange(len(used))
    for block in blocks:
        block.connectivity = row_of[block.connectivity]
    return row_of, ExodusMesh(coordinates.reshape(-1, 3)[all_rows[used]], blocks, node_numbers=used)


def _read_blocks(gmsh, group, used_ids):
    """One block for each shape of a physical volume; the first keeps its name and number."""
    found = {}
    for entity in gmsh.model.getEntitiesForPhysicalGroup(3, group.tag):
        for kind, numbers, nodes in zip(*gmsh.model.mesh.getElements(3, entity)):
            if kind not in GMSH_SHAPES:
                raise MeshError(f"physical volume {quoted(group)} holds elements of the kind "
                                f"'{gmsh.model.mesh.getElementProperties(kind)[0]}' (first: {numbers[0]}); haptos solves with {', '.join(CORNERS)}"
                                "; Mesh.SecondOrderIncomplete = 1 makes wedges of 15 and pyramids of 13 nodes")
            found.setdefault(GMSH_SHAPES[kind], []).append((numbers, nodes.reshape(len(numbers), -1)[:, exodus_order(gmsh, kind)]))
    if not found:
        raise MeshError(f"physical volume {quoted(group)} has no elements; mesh in three dimensions before saving")
    blocks = []
    body = group.name or str(group.tag)
    for shape in sorted(found, key=lambda s: list(SHAPES_IN_ORDER).index(CORNERS[s])):
        tag, name = group.tag, group.name
        if blocks:
            tag = max([*used_ids, *(b.id for b in blocks)]) + 1
            name = f"{body}_{SHAPES_IN_ORDER[CORNERS[shape]]}"
        blocks.append(Block(tag, name, shape, np.concatenate([p[1] for p in found[shape]]).astype(np.int64),
                            np.concatenate([p[0] for p in found[shape]]).astype(np.int64), body))
    _check_one_order(group, found)
    return blocks


def _check_one_order(group, found):
    if len({len(SIDES[shape][0]) == len(CORNERS_OF_SIDES[shape][0]) for shape in found}) > 1:
        raise MeshError(f"physical volume {quoted(group)} holds {' and '.join(sorted(found))}; give all elements one order")


def _check_all_covered(gmsh, owner):
    for _, entity in gmsh.model.getEntities(3):
        numbers = gmsh.model.mesh.getElements(3, entity)[1]
        if entity not in owner and len(numbers):
            raise MeshError(f"{sum(map(len, numbers))} elements of volume {entity} (first: {numbers[0][0]}) are in no "
                            "physical volume; put the volume into one, or save without it")


def _read_node_sets(gmsh, groups, row_of):
    sets = []
    for group in groups:
        rows = row_of[np.unique(gmsh.model.mesh.getNodesForPhysicalGroup(group.dim, group.tag)[0]).astype(np.int64)]
        if not len(rows) or np.any(rows < 0):
            raise MeshError(f"physical group {quoted(group)}, a node set, has {int(np.sum(rows < 0)) if len(rows) else 'no'} "
                            "nodes " + ("that belong to no volume element" if len(rows) else "at all"))
        sets.append(NodeSet(_free_id(group.tag, sets), group.name.removeprefix(NODE_SET_PREFIX), rows))
    return sets


def _read_surfaces(gmsh, groups, row_of, mesh, split, side_of):
    finder = SideFinder(mesh.blocks)
    to_split = {}
    for group in groups:
        found = _find_sides(group, _read_facets(gmsh, group, row_of), finder)
        by_body = _sort_by_body(group, found, mesh)
        between = any(len(both) == 2 for both in found)
        _add_side_sets(group, by_body, between, side_of.get(group.name), mesh)
        if group.name in split:
            pair = tuple(by_body)
            if len(pair) != 2 or not between:
                raise MeshError(f"the nodes of '{group.name}' cannot be split: it must lie between two blocks that share nodes there")
            to_split.setdefault(pair, []).extend(by_body[pair[1]])
    for pair, sides in to_split.items():   # last: the finder knows the elements by their first nodes
        _split_nodes(pair, sides, mesh)
    for sets in (mesh.side_sets, mesh.node_sets):
        _check_unique(sets)


def _read_facets(gmsh, group, row_of):
    facets = []
    for entity in gmsh.model.getEntitiesForPhysicalGroup(2, group.tag):
        for kind, numbers, nodes in zip(*gmsh.model.mesh.getElements(2, entity)):
            if kind not in GMSH_FACETS:
                raise MeshError(f"physical surface {quoted(group)} holds elements of the kind "
                                f"'{gmsh.model.mesh.getElementProperties(kind)[0]}'; "
                                "only triangles of 3 or 6 and quadrangles of 4, 8 or 9 nodes can be sides")
            facets.append(row_of[nodes.astype(np.int64)].reshape(len(numbers), -1)[:, :GMSH_FACETS[kind]])
    if not facets:
        raise MeshError(f"physical surface {quoted(group)} has no elements; it would be an empty side set")
    return facets


def _find_sides(group, facets, finder):
    found = [s for part in facets for s in finder.find(part)]
    lost = sum(not s for s in found)
    if lost:
        raise MeshError(f"{lost} of {len(found)} elements of physical surface {quoted(group)} are no side of a volume element; "
                        "is the surface's volume in a physical volume, and meshed conformingly?")
    return found


def _bodies(mesh):
    """The blocks of each body with the first element of each, [(first element, block)], in order."""
    bodies = {}
    begin = 0
    for block in mesh.blocks:
        bodies.setdefault(block.body, []).append((begin, block))
        begin += len(block.connectivity)
    return list(bodies.values())


def _sort_by_body(group, sides, mesh):
    """{body position: [(element, side)]}, the bodies in their order."""
    bodies = _bodies(mesh)
    body_of = np.concatenate([np.full(len(block.connectivity), k) for block in mesh.blocks
                              for k, body in enumerate(bodies) if body[0][1].body == block.body])
    by_body = {}
    for both in sides:
        owners = [int(body_of[e]) for e, _ in both]
        if len(set(owners)) < len(owners):
            raise MeshError(f"physical surface {quoted(group)} runs inside block {quoted(bodies[owners[0]][0][1])}: it has no outer "
                            "side; give the volumes on its two sides different physical volumes")
        for owner, side in zip(owners, both):
            by_body.setdefault(owner, []).append(side)
    return dict(sorted(by_body.items()))


def _add_side_sets(group, by_body, between, keep, mesh):
    names = {k: body[0][1].body for k, body in enumerate(_bodies(mesh))}
    if keep is None and between:
        for k, sides in by_body.items():
            _append_side_set(mesh, group.tag, f"{names[k]}_{group.name or group.tag}", sides)
        return
    if keep is not None:
        touched = [names[k] for k in by_body]
        if keep not in touched:
            raise MeshError(f"the side of '{group.name}' cannot be that of '{keep}': the surface touches {', '.join(touched)}")
        by_body = {k: s for k, s in by_body.items() if names[k] == keep}
    _append_side_set(mesh, group.tag, group.name, [s for sides in by_body.values() for s in sides])


def _append_side_set(mesh, tag, name, sides):
    elements, numbers = np.array(sides).T
    mesh.side_sets.append(SideSet(_free_id(tag, mesh.side_sets), name, elements, numbers))


def _free_id(wanted, sets):
    used = {s.id for s in sets}
    while wanted in used:
        wanted += 1
    return wanted


def _check_unique(sets):
    names = [s.name for s in sets if s.name]
    for name in names:
        if names.count(name) > 1:
            raise MeshError(f"two sets would be named '{name}'; rename one physical group")


def _split_nodes(pair, sides, mesh):
    """Gives the second body of the pair its own nodes on these sides of it.

    Nodes where the two bodies stay glued beside the surface are kept: the tip of a partial split.
    """
    first, second = (_bodies(mesh)[k] for k in pair)
    surface, glued = [], []
    keys_of_first = np.concatenate([facet_keys(block.connectivity[:, corners]) for _, block in first
                                    for corners in CORNERS_OF_SIDES[block.shape]])
    for begin, block in second:
        for number, nodes in enumerate(SIDES[block.shape], start=1):
            facets = block.connectivity[:, nodes]
            chosen = np.isin(np.arange(begin, begin + len(facets)), [e for e, side in sides if side == number])
            keys = facet_keys(block.connectivity[:, CORNERS_OF_SIDES[block.shape][number - 1]])
            surface.append(facets[chosen].ravel())
            glued.append(facets[~chosen & np.isin(keys, keys_of_first)].ravel())
    doubled = np.setdiff1d(np.concatenate(surface), np.concatenate(glued))
    doubled = np.intersect1d(doubled, np.concatenate([block.connectivity.ravel() for _, block in first]))   # an earlier split may have freed the rest
    copies = len(mesh.coordinates) + np.arange(len(doubled))
    new_row = np.arange(len(mesh.coordinates))
    new_row[doubled] = copies
    mesh.coordinates = np.vstack([mesh.coordinates, mesh.coordinates[doubled]])
    mesh.node_numbers = np.concatenate([mesh.node_numbers, mesh.node_numbers.max() + 1 + np.arange(len(doubled))])
    for _, block in second:
        block.connectivity = new_row[block.connectivity]
    for node_set in mesh.node_sets:
        node_set.nodes = np.concatenate([node_set.nodes, copies[np.isin(doubled, node_set.nodes)]])


# ---------------------------------------------------------------- command line


def parse_arguments(arguments):
    parser = argparse.ArgumentParser(description="Converts a gmsh mesh to Exodus II: physical volumes become element blocks, "
                                     "physical surfaces side sets, groups named nodes:NAME node sets.")
    parser.add_argument("input", help="gmsh mesh (.msh)")
    parser.add_argument("output", help="Exodus file to write (.exo)")
    parser.add_argument("--node-set", action="append", default=[], metavar="NAME", help="make this physical group a node set")
    parser.add_argument("--split", action="append", default=[], metavar="SURFACE",
                        help="double the nodes of this surface between two blocks: a contact surface")
    parser.add_argument("--side-of", action="append", default=[], metavar="SURFACE=BLOCK",
                        help="keep only this block's side of a surface between two blocks")
    parser.add_argument("--title", default="", help="title in the file (default: the model's name)")
    return parser.parse_args(arguments)


def convert(options):
    import gmsh
    pairs = [text.partition("=") for text in options.side_of]
    for surface, equals, block in pairs:
        if not (surface and equals and block):
            raise MeshError(f"--side-of wants SURFACE=BLOCK, not '{surface + equals + block}'")
    if pathlib.Path(options.output).resolve() == pathlib.Path(options.input).resolve():
        raise MeshError(f"'{options.output}' is the input, too; name another file to write")
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        try:
            gmsh.open(options.input)
        except Exception as error:
            raise MeshError(f"gmsh cannot read '{options.input}': {error}") from error
        mesh = from_gmsh(options.node_set, options.split, {s: b for s, _, b in pairs}, options.title)
    finally:
        gmsh.finalize()
    write_exodus(options.output, mesh)
    return mesh


def main(arguments=None):
    options = parse_arguments(arguments)
    try:
        mesh = convert(options)
    except (MeshError, OSError) as error:
        print(f"haptos_from_gmsh: {error}", file=sys.stderr)
        return 1
    print(f"{options.output}: {len(mesh.coordinates)} nodes")
    for kind, sets in (("block", mesh.blocks), ("side set", mesh.side_sets), ("node set", mesh.node_sets)):
        for item in sets:
            size = len(getattr(item, {"block": "connectivity", "side set": "elements", "node set": "nodes"}[kind]))
            print(f"  {kind} {item.id} '{item.name}': {size}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
