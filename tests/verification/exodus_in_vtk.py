#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Does VTK, and so ParaView, see in a result file what was written?

    exodus_in_vtk.py RESULT.exo --blocks lower upper --side-sets upper_contact \
        --nodal displacement_x contact_status --element von_mises --global kkt --times 1.0 --nodes 2754 --elements 2048

VTK joins fields called a_x, a_y, a_z to a vector a by default; here they are asked for one by one.
Exit status: 0 all found and finite, 1 something is missing or wrong, 77 pyvista cannot be imported.
"""
import argparse
import sys

try:
    import pyvista  # noqa: F401  (tells whether a working VTK is at hand)
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOExodus import vtkExodusIIReader
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)

import numpy as np


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    for name in ("blocks", "side-sets", "node-sets", "nodal", "element", "global"):
        parser.add_argument(f"--{name}", nargs="*", default=[], metavar="NAME")
    parser.add_argument("--times", nargs="*", type=float)
    parser.add_argument("--nodes", type=int)
    parser.add_argument("--elements", type=int)
    return parser.parse_args()


def names_of(reader, kind):
    return [reader.GetObjectName(kind, i) for i in range(reader.GetNumberOfObjects(kind))]


def arrays_of(reader, kind):
    return [reader.GetObjectArrayName(kind, i) for i in range(reader.GetNumberOfObjectArrays(kind))]


def open_reader(path):
    reader = vtkExodusIIReader()
    reader.SetFileName(path)
    reader.SetApplyDisplacements(0)
    reader.SetSqueezePoints(0)
    reader.UpdateInformation()
    for kind in (reader.NODAL, reader.ELEM_BLOCK, reader.GLOBAL):
        reader.SetAllArrayStatus(kind, 1)
    for i in range(reader.GetNumberOfObjects(reader.ELEM_BLOCK)):
        reader.SetObjectStatus(reader.ELEM_BLOCK, i, 1)
    return reader


def leaves(dataset):
    """All grids of a tree of blocks."""
    if dataset is None:
        return
    if dataset.IsA("vtkMultiBlockDataSet"):
        for i in range(dataset.GetNumberOfBlocks()):
            yield from leaves(dataset.GetBlock(i))
    else:
        yield dataset


def component(data, name):
    """Array `name`; where VTK joined a_x, a_y, a_z to a vector a, its column."""
    array = data.GetArray(name)
    if array is not None:
        return vtk_to_numpy(array)
    stem, _, axis = name.rpartition("_")
    vector = data.GetArray(stem) or data.GetArray(stem + "_")
    if vector is None:
        return None
    # VTK takes six tensor components in the order xx yy zz xy yz zx.
    axes = {3: ["x", "y", "z"], 6: ["xx", "yy", "zz", "xy", "yz", "zx"]}.get(vector.GetNumberOfComponents(), [])
    return vtk_to_numpy(vector)[:, axes.index(axis)] if axis in axes else None


class Check:
    def __init__(self):
        self.failures = 0

    def require(self, condition, text):
        if not condition:
            self.failures += 1
            print(f"FAILED: {text}")


def check_structure(check, reader, arguments):
    kinds = ((arguments.blocks, reader.ELEM_BLOCK, "element block"),
             (arguments.side_sets, reader.SIDE_SET, "side set"),
             (arguments.node_sets, reader.NODE_SET, "node set"))
    for wanted, kind, text in kinds:
        found = names_of(reader, kind)
        for name in wanted:
            # VTK writes "name Size: 12" or "name ID: 3" for some entities.
            check.require(any(f == name or f.split(" ")[0] == name for f in found), f"{text} {name} is not among {found}")
    if arguments.times is not None:
        information = reader.GetOutputInformation(0)
        key = reader.GetExecutive().TIME_STEPS()
        times = [information.Get(key, i) for i in range(information.Length(key))] if information.Has(key) else []
        check.require(np.allclose(times, arguments.times) if len(times) == len(arguments.times) else False,
                      f"the time steps are {times}, not {arguments.times}")


def check_field(check, grids, name, where):
    """Finite values on every grid that has entities; returns the largest magnitude."""
    largest = 0.0
    for grid in grids:
        data, count = ((grid.GetPointData(), grid.GetNumberOfPoints()) if where == "nodal"
                       else (grid.GetCellData(), grid.GetNumberOfCells()))
        if count == 0:
            continue
        values = component(data, name)
        known = [data.GetArrayName(i) for i in range(data.GetNumberOfArrays())]
        check.require(values is not None, f"{where} field {name} is not among {known}")
        if values is None:
            return
        check.require(len(values) == count, f"{where} field {name} has {len(values)} values for {count}")
        check.require(bool(np.all(np.isfinite(values))), f"{where} field {name} has values that are not finite")
        largest = max(largest, float(np.max(np.abs(values))))
    print(f"{where} {name}: largest magnitude {largest:.6g}")


def check_step(check, reader, arguments, step):
    reader.SetTimeStep(step)
    reader.Update()
    grids = list(leaves(reader.GetOutput()))
    check.require(grids, "VTK reads no grid")
    for name in arguments.nodal:
        check_field(check, grids, name, "nodal")
    for name in arguments.element:
        check_field(check, grids, name, "element")
    for name in getattr(arguments, "global"):
        values = [component(g.GetFieldData(), name) for g in grids]
        check.require(any(v is not None and np.all(np.isfinite(v)) for v in values), f"no global value {name}")
    if arguments.elements is not None:
        elements = sum(g.GetNumberOfCells() for g in grids)
        check.require(elements == arguments.elements, f"{elements} elements, not {arguments.elements}")
    if arguments.nodes is not None:
        nodes = max(g.GetNumberOfPoints() for g in grids)  # unsqueezed: every grid holds all points
        check.require(nodes == arguments.nodes, f"{nodes} nodes, not {arguments.nodes}")


def main():
    arguments = parse_arguments()
    if not vtkExodusIIReader().CanReadFile(arguments.file):
        print(f"FAILED: VTK cannot read {arguments.file}")
        return 1
    check = Check()
    reader = open_reader(arguments.file)
    check_structure(check, reader, arguments)
    for step in range(len(arguments.times) if arguments.times else 1):
        check_step(check, reader, arguments, step)
    print("OK" if check.failures == 0 else f"{check.failures} failures")
    return 0 if check.failures == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
