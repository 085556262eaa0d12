#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Curved bodies from gmsh, all element types, under a uniform pressure on every side but three planes of symmetry.

    gmsh_elements_test.py --haptos PROGRAM

ANALYTIC: sigma = -p I and u = -p (1 - 2 nu) / E x, which every isoparametric element has, curved or not, mixed or not: nodes, sides and
normals are right from gmsh by the converter to the program.  Exit status 77 (skipped) without gmsh or netCDF4.
"""
import argparse
import copy
import pathlib
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "drivers"))
try:
    import gmsh
    import netCDF4
    import numpy as np
except (ImportError, OSError) as error:
    print(f"skipped: {error}")
    sys.exit(77)
from haptos_from_gmsh import from_gmsh  # noqa: E402
from haptos_exodus import write_exodus  # noqa: E402

PRESSURE, YOUNG, POISSON = 3.0, 200.0, 0.3
INPUT = """<ParameterList name="Haptos">
  <ParameterList name="Mesh"><Parameter name="File" type="string" value="{mesh}"/></ParameterList>
  <ParameterList name="Decomposition"><Parameter name="Subdomains" type="int" value="{pieces}"/></ParameterList>
  <ParameterList name="Materials"><ParameterList name="stuff">
    <Parameter name="Element Blocks" type="Array(string)" value="{{{blocks}}}"/>
    <Parameter name="Young's Modulus" type="double" value="{young}"/>
    <Parameter name="Poisson's Ratio" type="double" value="{poisson}"/>
  </ParameterList></ParameterList>
  <ParameterList name="Boundary Conditions">{conditions}</ParameterList>
  <ParameterList name="Solver"><Parameter name="Relative Tolerance" type="double" value="1e-13"/></ParameterList>
</ParameterList>"""
HOLD = """<ParameterList name="hold {axis}"><Parameter name="Type" type="string" value="Displacement"/>
  <Parameter name="Sets" type="Array(string)" value="{{plane_{axis}}}"/><Parameter name="Components" type="string" value="{axis}"/>
  <Parameter name="Value" type="Array(double)" value="{{0,0,0}}"/></ParameterList>"""
PRESS = """<ParameterList name="press"><Parameter name="Type" type="string" value="Pressure"/>
  <Parameter name="Sets" type="Array(string)" value="{{skin}}"/><Parameter name="Value" type="double" value="{pressure}"/></ParameterList>"""
haptos = None


class Bodies(unittest.TestCase):
    """Every body lies in x, y, z >= 0 and touches the three planes."""

    def setUp(self):
        self._folder = tempfile.TemporaryDirectory()
        self.addCleanup(self._folder.cleanup)
        self.folder = pathlib.Path(self._folder.name)
        gmsh.initialize(interruptible=False)
        self.addCleanup(gmsh.finalize)
        gmsh.option.setNumber("General.Terminal", 0)

    def mesh(self, order, incomplete=1, size=0.5):
        gmsh.model.occ.synchronize()
        volumes = gmsh.model.getEntities(3)
        gmsh.model.addPhysicalGroup(3, [tag for _, tag in volumes], name="body")
        groups = {"plane_x": [], "plane_y": [], "plane_z": [], "skin": []}
        for dim, tag in gmsh.model.getBoundary(volumes, oriented=False):
            low, high = np.array(gmsh.model.getBoundingBox(dim, tag)).reshape(2, 3)
            flat = [axis for axis in range(3) if max(abs(low[axis]), abs(high[axis])) < 1e-5]
            groups["plane_" + "xyz"[flat[0]] if flat else "skin"].append(tag)
        for name, tags in groups.items():
            gmsh.model.addPhysicalGroup(2, tags, name=name)
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.option.setNumber("Mesh.SecondOrderIncomplete", incomplete)
        gmsh.option.setNumber("Mesh.ElementOrder", order)
        gmsh.model.mesh.generate(3)

    def run_haptos(self, mesh, pieces):
        write_exodus(str(self.folder / "mesh.exo"), mesh)
        conditions = "".join(HOLD.format(axis=a) for a in "xyz") + PRESS.format(pressure=PRESSURE)
        (self.folder / "run.xml").write_text(INPUT.format(mesh="mesh.exo", pieces=pieces, blocks=",".join(b.name for b in mesh.blocks), young=YOUNG,
                                                          poisson=POISSON, conditions=conditions))
        return subprocess.run([haptos, "run.xml", "--output", "result.exo", "--summary", "summary.json"], cwd=self.folder, capture_output=True,
                              text=True, timeout=200)

    def check(self, shapes, pieces=5):
        mesh = from_gmsh()
        self.assertEqual({b.shape for b in mesh.blocks}, shapes)
        run = self.run_haptos(mesh, pieces)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        with netCDF4.Dataset(self.folder / "result.exo") as file:
            file.set_auto_mask(False)
            names = [b"".join(row).rstrip(b"\0").decode() for row in file["name_nod_var"][:]]
            u = np.stack([file[f"vals_nod_var{names.index('displacement_' + a) + 1}"][0] for a in "xyz"], axis=1)
            fields = [b"".join(row).rstrip(b"\0").decode() for row in file["name_elem_var"][:]]
            stress = {f: np.concatenate([file[f"vals_elem_var{fields.index(f) + 1}eb{k}"][0] for k in range(1, len(mesh.blocks) + 1)])
                      for f in fields if f.startswith("stress_")}
        scale = -PRESSURE * (1 - 2 * POISSON) / YOUNG
        np.testing.assert_allclose(u, scale * mesh.coordinates, atol=1e-9 * abs(scale) * np.abs(mesh.coordinates).max())
        for name, values in stress.items():
            np.testing.assert_allclose(values, -PRESSURE if name[-1] == name[-2] else 0, atol=1e-9 * PRESSURE, err_msg=name)

    def quarter_ring(self):
        occ = gmsh.model.occ
        occ.revolve([(2, occ.addRectangle(1, 0, 0, 1, 1))], 0, 0, 0, 0, 1, 0, -np.pi / 2, [3], recombine=True)
        occ.synchronize()

    def test_hexahedra(self):
        for order, incomplete, shape in ((1, 1, "HEX8"), (2, 1, "HEX20"), (2, 0, "HEX27")):
            gmsh.clear()
            self.quarter_ring()
            for _, tag in gmsh.model.getEntities(2):
                gmsh.model.mesh.setTransfiniteSurface(tag)
                gmsh.model.mesh.setRecombine(2, tag)
            self.mesh(order, incomplete)
            self.check({shape})

    def test_wedges(self):
        for order, shape in ((1, "WEDGE6"), (2, "WEDGE15")):
            gmsh.clear()
            self.quarter_ring()
            self.mesh(order)
            self.check({shape})

    def test_tetrahedra(self):
        for order, shape in ((1, "TETRA4"), (2, "TETRA10")):
            gmsh.clear()
            gmsh.model.occ.addSphere(0, 0, 0, 1, angle1=0, angle2=np.pi / 2, angle3=np.pi / 2)
            self.mesh(order)
            self.check({shape})

    def test_bad_elements_are_refused(self):
        """Status 1 and one message that names the element or the block."""
        gmsh.model.occ.addSphere(0, 0, 0, 1, angle1=0, angle2=np.pi / 2, angle3=np.pi / 2)
        self.mesh(2)
        good = from_gmsh()
        nodes = good.blocks[0].connectivity[7]
        number = good.blocks[0].element_numbers[7]

        def moved(node, to):
            mesh = copy.deepcopy(good)
            mesh.coordinates[nodes[node]] = to
            return mesh

        def unknown():
            mesh = copy.deepcopy(good)
            mesh.blocks[0].shape = "TETRA11"
            return mesh

        x = good.coordinates[nodes]
        for mesh, words in ((moved(4, x[0]), (f"element {number} (TETRA10) of block \"body\" has its node 5", "between 1/4 and 3/4")),
                            (moved(0, x[1] + x[2] - x[0] + 3 * (x[1] - x[0])), ("(TETRA10) of block \"body\"",)),
                            (unknown(), ("element block", "('body')", "'TETRA11' with 10 nodes"))):
            run = self.run_haptos(mesh, 3)
            self.assertEqual(run.returncode, 1, run.stdout + run.stderr)
            self.assertEqual(len(run.stderr.strip().splitlines()), 1, run.stderr)
            for word in words:
                self.assertIn(word, run.stderr)

    def test_hexahedra_pyramids_tetrahedra(self):
        """A transfinite cube of hexahedra; gmsh puts pyramids between it and the tetrahedra of a quarter cylinder on it."""
        for order, shapes in ((1, {"HEX8", "PYRAMID5", "TETRA4"}), (2, {"HEX20", "PYRAMID13", "TETRA10"})):
            gmsh.clear()
            occ = gmsh.model.occ
            occ.addBox(0, 0, 0, 1, 1, 1)
            occ.addCylinder(0, 0, 1, 0, 0, 1, 1.8, angle=np.pi / 2)
            occ.fragment([(3, 1)], [(3, 2)])
            occ.synchronize()
            for _, tag in gmsh.model.getEntities(1):
                if max(abs(x) for x in gmsh.model.getBoundingBox(1, tag)) < 1.01:
                    gmsh.model.mesh.setTransfiniteCurve(tag, 4)
            for _, tag in gmsh.model.getBoundary([(3, 1)], oriented=False):
                gmsh.model.mesh.setTransfiniteSurface(tag)
                gmsh.model.mesh.setRecombine(2, tag)
            gmsh.model.mesh.setTransfiniteVolume(1)
            self.mesh(order)
            self.check(shapes, pieces=12)


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--haptos", required=True)
    options, rest = parser.parse_known_args()
    haptos = str(pathlib.Path(options.haptos).resolve())
    unittest.main(argv=[sys.argv[0], *rest], verbosity=2)
