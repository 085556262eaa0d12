#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Converts small gmsh meshes and reads the Exodus files back with plain netCDF4.

Exit status 77 (skipped) where netCDF4 is missing, and where only gmsh is missing and all else passed.
"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
CONVERTER = SOURCE / "drivers" / "haptos_from_gmsh.py"
SKIPPED = 77
sys.path.insert(0, str(SOURCE / "drivers"))

try:
    import numpy as np
    from exodus_arrays import SIDE_NODES, Exodus
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(SKIPPED)
from haptos_exodus import SIDES, nodes_in_middles  # noqa: E402

try:
    import gmsh
except (ImportError, OSError) as error:   # OSError: the package is there, its system libraries are not
    gmsh = None
    print(f"conversion not tested: {error}")


# ---------------------------------------------------------------- conversion


def convert(mesh, output, *options):
    return subprocess.run([sys.executable, str(CONVERTER), str(mesh), str(output), *options], capture_output=True, text=True, timeout=120)


def msh2(path, names, nodes, elements):
    """A mesh in gmsh's format 2.2: names [(dim, tag, name)], nodes {tag: xyz}, elements [(kind, physical, entity, nodes)]."""
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(names))]
    lines += [f'{dim} {tag} "{name}"' for dim, tag, name in names] + ["$EndPhysicalNames", "$Nodes", str(len(nodes))]
    lines += [f"{tag} {x} {y} {z}" for tag, (x, y, z) in nodes.items()] + ["$EndNodes", "$Elements", str(len(elements))]
    for number, (kind, physical, entity, corners) in enumerate(elements, start=1):
        lines.append(" ".join(map(str, (number, kind, 2, physical, entity, *corners))))
    path.write_text("\n".join([*lines, "$EndElements", ""]))


CUBE = {11: (0, 0, 0), 12: (1, 0, 0), 13: (1, 1, 0), 14: (0, 1, 0), 25: (0, 0, 1), 26: (1, 0, 1), 27: (1, 1, 1), 28: (0, 1, 1)}
TOP = (3, 1, 1, (25, 26, 27, 28))


@unittest.skipIf(gmsh is None, "gmsh is not importable")
class Conversion(unittest.TestCase):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory()
        self.addCleanup(self._folder.cleanup)
        self.msh = pathlib.Path(self._folder.name) / "mesh.msh"
        self.exo = pathlib.Path(self._folder.name) / "mesh.exo"
        gmsh.initialize(interruptible=False)
        self.addCleanup(gmsh.finalize)
        gmsh.option.setNumber("General.Terminal", 0)

    def converted(self, *options):
        run = convert(self.msh, self.exo, *options)
        self.assertEqual(run.returncode, 0, run.stderr)
        return Exodus(self.exo)

    def refused(self, *options):
        run = convert(self.msh, self.exo, *options)
        self.assertEqual(run.returncode, 1, run.stdout + run.stderr)
        self.assertFalse(self.exo.exists(), "a refused mesh leaves no file")
        self.assertEqual(run.stderr.count("\n"), 1, "one message: " + run.stderr)
        return run.stderr

    def save_stack(self, hexahedra, depth=1.0, physical=("lower", "upper")):
        """Two unit cubes, one on the other, conforming; `middle` is their common square [0, depth] x [0, 1]."""
        geo = gmsh.model.geo
        parts = [(0.0, depth)] + ([(depth, 1.0)] if depth < 1 else [])
        volumes = {0: [], 1: []}
        for begin, end in parts:
            curve = geo.extrude([(0, geo.addPoint(begin, 0, 0))], end - begin, 0, 0, [4], recombine=hexahedra)[1]
            face = next(e for e in geo.extrude([curve], 0, 1, 0, [4], recombine=hexahedra) if e[0] == 2)
            for level in volumes:
                swept = geo.extrude([face], 0, 0, 1, [4], recombine=hexahedra)
                face = swept[0]
                volumes[level].append(swept[1][1])
        geo.removeAllDuplicates()
        geo.synchronize()
        for name, tags in zip(physical, volumes.values()):
            gmsh.model.addPhysicalGroup(3, tags, name=name)
        self.name_faces(depth)
        gmsh.model.mesh.generate(3)
        gmsh.write(str(self.msh))

    def name_faces(self, depth):
        boxes = {"middle": (0, 0, 1, depth, 1, 1), "top": (0, 0, 2, 1, 1, 2), "left": (0, 0, 0, 0, 1, 2)}
        for name, box in boxes.items():
            low, high = np.array(box[:3]) - 1e-4, np.array(box[3:]) + 1e-4
            tags = [t for _, t in gmsh.model.getEntitiesInBoundingBox(*low, *high, dim=2)]
            gmsh.model.addPhysicalGroup(2, tags, name=name)
        corner = gmsh.model.getEntitiesInBoundingBox(-1e-4, -1e-4, -1e-4, 1e-4, 1e-4, 1e-4, dim=0)
        gmsh.model.addPhysicalGroup(0, [corner[0][1]], name="nodes:corner")
        edge = gmsh.model.getEntitiesInBoundingBox(-1e-4, -1e-4, 1 - 1e-4, 1e-4, 1 + 1e-4, 1 + 1e-4, dim=1)
        gmsh.model.addPhysicalGroup(1, [edge[0][1]], name="edge")

    def check_stack(self, shape):
        mesh = self.converted("--node-set", "edge")
        self.assertEqual({n: s for n, (s, _) in mesh.blocks.items()}, {"lower": shape, "upper": shape})
        self.assertEqual(mesh.format, "NETCDF3_64BIT_OFFSET")
        for name in mesh.blocks:
            self.assertGreater(mesh.volumes(name).min(), 0)
            self.assertAlmostEqual(mesh.volumes(name).sum(), 1)
        expected = {"top": (0, 0, 1), "left": (-2, 0, 0), "lower_middle": (0, 0, 1), "upper_middle": (0, 0, -1)}
        self.assertEqual(set(mesh.side_sets), set(expected))
        for name, vector in expected.items():
            np.testing.assert_allclose(mesh.area_vector(name)[0], vector, atol=1e-12, err_msg=name)
            self.assertAlmostEqual(mesh.area_vector(name)[1], np.linalg.norm(vector))
        self.assertEqual(set(mesh.node_sets), {"corner", "edge"})
        np.testing.assert_allclose(mesh.x[mesh.node_sets["corner"]], [[0, 0, 0]], atol=1e-12)
        on_edge = mesh.x[mesh.node_sets["edge"]]
        self.assertEqual(len(on_edge), 5)
        np.testing.assert_allclose(on_edge[:, [0, 2]], np.tile([0, 1], (5, 1)), atol=1e-12)
        for kind, ids in mesh.ids.items():
            self.assertEqual(len(set(ids)), len(ids), kind)

    def test_hexahedra(self):
        self.save_stack(hexahedra=True)
        self.check_stack("HEX8")

    def test_tetrahedra(self):
        self.save_stack(hexahedra=False)
        self.check_stack("TETRA4")

    def test_unused_groups_are_mentioned(self):
        self.save_stack(hexahedra=True)
        self.assertIn("'edge'", convert(self.msh, self.exo).stderr)
        self.assertEqual(convert(self.msh, self.exo, "--node-set", "edge").stderr, "")

    def test_split_makes_matching_contact_surfaces(self):
        self.save_stack(hexahedra=True)
        glued = self.converted("--node-set", "edge")
        mesh = self.converted("--split", "middle", "--node-set", "edge")
        self.assertEqual(len(mesh.x), len(glued.x) + 25)
        lower, upper = (mesh.set_nodes(n) for n in ("lower_middle", "upper_middle"))
        self.assertEqual(len(np.intersect1d(lower, upper)), 0)
        key = lambda nodes: sorted(map(tuple, mesh.x[nodes].round(12)))
        self.assertEqual(key(lower), key(upper))
        self.assertEqual(len(lower), 25)
        self.assertEqual(len(mesh.node_sets["edge"]), 10, "a node set holds both copies")
        self.assertIsNone(mesh.node_map, "gmsh numbered 1..n, the copies go on from there")
        np.testing.assert_allclose(mesh.area_vector("left")[0], (-2, 0, 0), atol=1e-12)

    def test_partial_split_keeps_its_tip_glued(self):
        self.save_stack(hexahedra=True, depth=0.5)
        mesh = self.converted("--split", "middle")
        lower, upper = (mesh.set_nodes(n) for n in ("lower_middle", "upper_middle"))
        shared = np.intersect1d(lower, upper)
        self.assertEqual((len(lower), len(upper), len(shared)), (25, 25, 5))
        np.testing.assert_allclose(mesh.x[shared, 0], 0.5, atol=1e-12)

    def test_side_of_keeps_one_side(self):
        self.save_stack(hexahedra=True)
        mesh = self.converted("--side-of", "middle=upper")
        np.testing.assert_allclose(mesh.area_vector("middle")[0], (0, 0, -1), atol=1e-12)
        self.assertNotIn("upper_middle", mesh.side_sets)
        self.exo.unlink()
        self.assertIn("touches lower, upper", self.refused("--side-of", "middle=nothing"))

    def test_surfaces_on_double_nodes_go_to_their_own_bodies(self):
        upper = {t + 100: (x, y, z + 1) for t, (x, y, z) in CUBE.items()}
        msh2(self.msh, [(3, 1, "lower"), (3, 2, "upper"), (2, 1, "down"), (2, 2, "up")], {**CUBE, **upper},
             [(5, 1, 1, tuple(CUBE)), (5, 2, 2, tuple(upper)), TOP, (3, 2, 2, (111, 112, 113, 114))])
        mesh = self.converted()
        np.testing.assert_allclose(mesh.area_vector("down")[0], (0, 0, 1))
        np.testing.assert_allclose(mesh.area_vector("up")[0], (0, 0, -1))
        self.assertEqual(list(mesh.node_map), sorted([*CUBE, *upper]))

    def test_left_handed_elements_are_mirrored(self):
        mirrored = (25, 26, 27, 28, 11, 12, 13, 14)
        msh2(self.msh, [(3, 1, "cube"), (2, 1, "top")], CUBE, [(5, 1, 1, mirrored), TOP])
        mesh = self.converted()
        np.testing.assert_allclose(mesh.volumes("cube"), [1])
        np.testing.assert_allclose(mesh.area_vector("top")[0], (0, 0, 1))
        msh2(self.msh, [(3, 1, "tet")], CUBE, [(4, 1, 1, (11, 14, 12, 25))])
        np.testing.assert_allclose(self.converted().volumes("tet"), [1 / 6])

    def test_every_side_of_all_shapes(self):
        """Each facet of one element as a side set of its own: all rows of the side tables."""
        cubes = {"HEX8": (5, tuple(CUBE)), "TETRA4": (4, (11, 12, 14, 25)), "WEDGE6": (6, (11, 12, 14, 25, 26, 28)),
                 "PYRAMID5": (7, (11, 12, 13, 14, 25))}
        for shape, (kind, corners) in cubes.items():
            sides = SIDE_NODES[shape]
            facets = {f"side{n}": tuple(corners[i - 1] for i in reversed(nodes)) for n, nodes in sides.items()}
            msh2(self.msh, [(3, 1, "body"), *((2, k, n) for k, n in enumerate(facets, 1))], CUBE,
                 [(kind, 1, 1, corners), *((len(f) - 1, k, k, f) for k, f in enumerate(facets.values(), 1))])
            mesh = self.converted()
            centre = mesh.x[mesh.blocks["body"][1][0]].mean(axis=0)
            for number in sides:
                nodes = mesh.set_nodes(f"side{number}")
                self.assertEqual(list(mesh.side_sets[f"side{number}"][1]), [number], shape)
                self.assertGreater(mesh.area_vector(f"side{number}")[0] @ (mesh.x[nodes].mean(axis=0) - centre), 0.01)

    def check_sides_in_vtk(self, mesh):
        """VTK reads the file and knows the faces of its cells: each has the points of one side, corners and all."""
        from vtkmodules.vtkIOExodus import vtkExodusIIReader
        reader = vtkExodusIIReader()
        reader.SetFileName(str(self.exo))
        reader.Update()
        blocks = reader.GetOutput().GetBlock(0)
        for k, (shape, rows) in enumerate(mesh.blocks.values()):
            grid = blocks.GetBlock(k)
            self.assertEqual(grid.GetNumberOfCells(), len(rows), shape)
            for e in (0, len(rows) - 1):
                cell, x, seen = grid.GetCell(e), mesh.x[rows[e]], set()
                for i in range(cell.GetNumberOfFaces()):   # VTK gives the same object again for the next one
                    points = cell.GetFace(i).GetPoints()
                    seen.add(frozenset(int(np.argmin(np.linalg.norm(x - points.GetPoint(j), axis=1))) for j in range(points.GetNumberOfPoints())))
                self.assertEqual(seen, set(map(frozenset, SIDES[shape])), shape)

    def test_second_order_of_all_shapes(self):
        """Quarter of a ring, swept: wedges or hexahedra; an octant of a ball; a cube of hexahedra, pyramids and tetrahedra."""
        for incomplete, shapes in ((1, {"HEX20", "TETRA10", "WEDGE15"}), (0, {"HEX27", "TETRA10"})):
            gmsh.clear()
            occ = gmsh.model.occ
            ring = occ.revolve([(2, occ.addRectangle(1, 0, 0, 1, 1))], 0, 0, 0, 0, 1, 0, np.pi / 2, [4], recombine=True)
            wedges = occ.revolve([(2, occ.addDisk(8, 0, 0, 0.5, 0.5))], 6, 0, 0, 0, 1, 0, np.pi / 2, [3], recombine=True)
            octant = occ.addSphere(12, 0, 0, 1, angle1=0, angle2=np.pi / 2, angle3=np.pi / 2)
            occ.synchronize()
            gmsh.model.mesh.setTransfiniteSurface(1)
            gmsh.model.mesh.setRecombine(2, 1)
            volumes = {"ring": ring[1][1], "octant": octant} | ({"wedges": wedges[1][1]} if incomplete else {})
            for name, tag in volumes.items():
                gmsh.model.addPhysicalGroup(3, [tag], name=name)
                gmsh.model.addPhysicalGroup(2, [t for _, t in gmsh.model.getBoundary([(3, tag)], oriented=False)], name=name + "_skin")
            gmsh.option.setNumber("Mesh.MeshSizeMax", 0.6)
            gmsh.option.setNumber("Mesh.SecondOrderIncomplete", incomplete)
            gmsh.option.setNumber("Mesh.ElementOrder", 2)
            gmsh.model.mesh.generate(3)
            gmsh.write(str(self.msh))
            mesh = self.converted()
            self.assertEqual({shape for shape, _ in mesh.blocks.values()}, shapes)
            self.check_sides_in_vtk(mesh)
            for name in volumes:
                np.testing.assert_allclose(mesh.area_vector(name + "_skin")[0], 0, atol=1e-12)
                corners = mesh.set_nodes(name + "_skin")
                self.assertGreater(len(corners), 10)

    def test_one_volume_of_several_shapes(self):
        """A hexahedron with a pyramid on it: two blocks of one body; and pyramids of second order."""
        nodes = {**CUBE, 31: (0.5, 0.5, 2)}
        msh2(self.msh, [(3, 1, "house"), (2, 1, "skin")], nodes,
             [(5, 1, 1, tuple(CUBE)), (7, 1, 2, (25, 26, 27, 28, 31)), (3, 1, 1, (11, 12, 13, 14)), (2, 1, 2, (25, 26, 31))])
        mesh = self.converted()
        self.assertEqual({n: s for n, (s, _) in mesh.blocks.items()}, {"house": "HEX8", "house_pyramid": "PYRAMID5"})
        np.testing.assert_array_equal(mesh.side_sets["skin"], [(1, 2), (5, 1)])
        gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)
        gmsh.open(str(self.msh))
        gmsh.model.mesh.setOrder(2)
        gmsh.write(str(self.msh))
        mesh = self.converted()
        self.assertEqual({n: s for n, (s, _) in mesh.blocks.items()}, {"house": "HEX20", "house_pyramid": "PYRAMID13"})
        np.testing.assert_array_equal(mesh.side_sets["skin"], [(1, 2), (5, 1)])
        self.check_sides_in_vtk(mesh)

    def test_every_node_of_second_order(self):
        """One element of every shape, deformed quadratically: each node lies where the corners around it say, left-handed ones too."""
        shapes = {5: tuple(CUBE), 4: (11, 12, 14, 25), 6: (11, 12, 14, 25, 26, 28), 7: (11, 12, 13, 14, 25)}
        for kind, corners in shapes.items():
            for flip, incomplete in ((1, 1), (-1, 1), (1, 0)):
                if incomplete == 0 and kind > 5:
                    continue
                gmsh.clear()
                gmsh.option.setNumber("Mesh.SecondOrderIncomplete", incomplete)
                msh2(self.msh, [(3, 1, "body")], {t: (flip * x, y, z) for t, (x, y, z) in CUBE.items()}, [(kind, 1, 1, corners)])
                gmsh.open(str(self.msh))
                gmsh.model.mesh.setOrder(2)
                gmsh.write(str(self.msh))
                mesh = self.converted()
                (shape, rows), = mesh.blocks.values()
                self.assertEqual(rows.shape[1], int(shape.lstrip("ABCDEFGHIJKLMNOPQRSTUVWXYZ")))
                x = mesh.x[rows[0]]
                for node, around in enumerate(nodes_in_middles(shape)):
                    np.testing.assert_allclose(x[node], x[list(around)].mean(axis=0), atol=1e-12, err_msg=f"{shape} {node}")
                frame = x[[1, 3, 4]] - x[0] if kind in (5, 7) else x[[1, 2, 3]] - x[0]
                self.assertGreater(np.linalg.det(frame), 0.1)

    def test_long_names_are_kept(self):
        name = "root_flank_of_the_third_stage_rotor_blade_pressure_side"
        msh2(self.msh, [(3, 1, "cube"), (2, 1, name)], CUBE, [(5, 1, 1, tuple(CUBE)), TOP])
        self.assertEqual(list(self.converted("--title", "a title").side_sets), [name])
        self.assertEqual(Exodus(self.exo).title, "a title")

    def test_folded_element_is_refused(self):
        msh2(self.msh, [(3, 1, "cube")], CUBE, [(5, 1, 1, (11, 13, 12, 14, 25, 26, 27, 28))])
        self.assertIn("flat or folded", self.refused())

    def test_other_shapes_are_refused_by_name(self):
        gmsh.model.occ.extrude([(2, gmsh.model.occ.addRectangle(0, 0, 0, 1, 1))], 0, 0, 1, [1], recombine=True)
        gmsh.model.occ.synchronize()
        gmsh.model.addPhysicalGroup(3, [1], name="wedges")
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(2)
        gmsh.write(str(self.msh))
        self.assertIn("'Prism 18'", self.refused())
        self.assertIn("SecondOrderIncomplete", self.refused())

    def test_missing_and_uncovered_volumes(self):
        msh2(self.msh, [(2, 1, "top")], CUBE, [TOP])
        self.assertIn("no physical volume", self.refused())
        self.save_stack(hexahedra=True, physical=("lower",))
        gmsh.option.setNumber("Mesh.SaveAll", 1)
        gmsh.write(str(self.msh))
        self.assertIn("in no physical volume", self.refused())

    def test_surface_inside_a_block(self):
        upper = {t + 100: (x, y, 2) for t, (x, y, z) in CUBE.items() if z == 1}
        msh2(self.msh, [(3, 1, "both"), (2, 1, "inside")], {**CUBE, **upper},
             [(5, 1, 1, tuple(CUBE)), (5, 1, 1, (25, 26, 27, 28, *upper)), TOP])
        self.assertIn("runs inside block 'both'", self.refused())

    def test_surface_apart_from_the_volumes(self):
        apart = {t + 100: (x, y, 5) for t, (x, y, z) in CUBE.items() if z == 1}
        msh2(self.msh, [(3, 1, "cube"), (2, 1, "lost")], {**CUBE, **apart}, [(5, 1, 1, tuple(CUBE)), (3, 1, 1, tuple(apart))])
        self.assertIn("'lost' are no side of a volume element", self.refused())

    def test_wrong_options(self):
        msh2(self.msh, [(3, 1, "cube"), (2, 1, "top")], CUBE, [(5, 1, 1, tuple(CUBE)), TOP])
        self.assertRegex(self.refused("--node-set", "tip"), "there are: (cube, top|top, cube)")
        self.assertIn("must lie between two blocks", self.refused("--split", "top"))
        self.assertIn("SURFACE=BLOCK", self.refused("--side-of", "top"))
        self.msh.unlink()
        self.assertIn("cannot read", self.refused())


if __name__ == "__main__":
    result = unittest.main(exit=False, verbosity=2).result
    sys.exit(1 if not result.wasSuccessful() else SKIPPED if gmsh is None else 0)
