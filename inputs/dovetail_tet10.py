#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The bodies of dovetail.py, each meshed for itself with tetrahedra of 10 nodes: writes dovetail_tet10.exo beside this script.

    venv/bin/python inputs/dovetail_tet10.py        (needs what dovetail.py needs)

Nothing is shared: nodes, edges and sizes of the elements differ on the flanks.
"""
import pathlib

import gmsh
import numpy as np

from dovetail import FINE, LENGTH, Section, disc_steps, flank_ends, plane_surface, root_steps, skew, surface_name
from haptos_exodus import ExodusMesh, write_exodus
from haptos_from_gmsh import from_gmsh

HERE = pathlib.Path(__file__).resolve().parent
AT_FLANKS = {"root": 2.0, "disc": 2.3}     # factors on the sizes of dovetail.py
ELSEWHERE = {"root": 3.6, "disc": 3.0}
STEPS = {"root": root_steps, "disc": disc_steps}


def draw(body):
    """The section of a body; the curves of both halves make one loop."""
    section = Section()
    a, b, _ = flank_ends()

    def resized(x, y, size, *centre):
        return (x, y, size * (AT_FLANKS if size == FINE else ELSEWHERE)[body], *centre)
    loop = []
    for mirror in (False, True):
        for steps in (*STEPS[body](), [(*a, FINE), (*b, FINE)]):
            loop += section.chain([resized(*step) for step in steps], mirror)
    return plane_surface(loop)


def is_flank(box, sign):
    a, b, _ = flank_ends()
    x = sorted((sign * a[0], sign * b[0]))
    return np.allclose(box, (x[0], b[1], -LENGTH / 2, x[1], a[1], LENGTH / 2), atol=1e-3)


def name_surfaces(body, volume):
    named = {}
    for _, tag in gmsh.model.getBoundary([(3, volume)], oriented=False):
        box = gmsh.model.getBoundingBox(2, tag)
        flank = [side for side, sign in (("right", 1), ("left", -1)) if is_flank(box, sign)]
        name = f"{body}_flank_{flank[0]}" if flank else surface_name(body, box)
        if name:
            named.setdefault(name, []).append(tag)
    for name, tags in sorted(named.items()):
        gmsh.model.addPhysicalGroup(2, tags, name=name)


def build(body):
    gmsh.model.add(body)
    swept = gmsh.model.geo.extrude([(2, draw(body))], 0, 0, LENGTH)
    gmsh.model.geo.synchronize()
    volume = next(tag for dim, tag in swept if dim == 3)
    gmsh.model.addPhysicalGroup(3, [volume], name=body)
    name_surfaces(body, volume)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.optimize("Netgen")
    gmsh.model.mesh.setOrder(2)
    return from_gmsh()


def together(meshes):
    """One mesh of several bodies that share nothing."""
    whole = ExodusMesh(np.zeros((0, 3)), [], title="dovetail root in its disc slot, tetrahedra of 10 nodes")
    for number, mesh in enumerate(meshes, start=1):
        elements = sum(len(block.connectivity) for block in whole.blocks)
        for block in mesh.blocks:
            block.id, block.element_numbers, block.connectivity = number, None, block.connectivity + len(whole.coordinates)
            whole.blocks.append(block)
        for side_set in mesh.side_sets:
            side_set.id, side_set.elements = len(whole.side_sets) + 1, np.asarray(side_set.elements) + elements
            whole.side_sets.append(side_set)
        whole.coordinates = np.vstack([whole.coordinates, mesh.coordinates])
    return whole


def main():
    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.Algorithm", 6)
    mesh = together([build(body) for body in ("root", "disc")])
    gmsh.finalize()
    skew(mesh)
    write_exodus(HERE / "dovetail_tet10.exo", mesh)
    print(f"dovetail_tet10.exo: {len(mesh.coordinates)} nodes, {[len(b.connectivity) for b in mesh.blocks]} elements")


if __name__ == "__main__":
    main()
