# SPDX-License-Identifier: BSD-3-Clause
"""GetFEM on the frictional two beams: augmented Lagrangian contact with friction 0.3; prints one line of JSON."""
import json
import sys
import time

import getfem as gf
import numpy as np

from beams import ALUMINIUM, FRICTION, PRESSURE, STEEL, TRACTION

CLAMP, CONTACT, TOP, END = 1, 2, 3, 4


def body(n, z0):
    """Regular mesh of one beam with its displacement space."""
    mesh = gf.Mesh("cartesian Q1", np.linspace(0, 2, 2 * n + 1), np.linspace(0, 1, n + 1), np.linspace(z0, z0 + 1, n + 1))
    faces = mesh.outer_faces()
    normals = mesh.normal_of_faces(faces)
    mesh.set_region(CLAMP, faces[:, normals[0] < -0.5])
    mesh.set_region(END, faces[:, normals[0] > 0.5])
    mesh.set_region(TOP, faces[:, normals[2] > 0.5])
    mesh.set_region(CONTACT, faces[:, normals[2] < -0.5] if z0 >= 0 else faces[:, normals[2] > 0.5])
    space = gf.MeshFem(mesh, 3)
    space.set_fem(gf.Fem("FEM_QK(3,1)"))
    return mesh, space, gf.MeshIm(mesh, gf.Integ("IM_GAUSS_PARALLELEPIPED(3,3)"))


def add_body(model, name, space, im, material):
    young, nu = material
    model.add_fem_variable(name, space)
    model.add_initialized_data("lambda_" + name, [young * nu / ((1 + nu) * (1 - 2 * nu))])
    model.add_initialized_data("mu_" + name, [young / (2 * (1 + nu))])
    model.add_isotropic_linearized_elasticity_brick(im, name, "lambda_" + name, "mu_" + name)
    model.add_Dirichlet_condition_with_simplification(name, CLAMP)


def main():
    n = int(sys.argv[1])
    start = time.process_time()
    mesh1, space1, im1 = body(n, 0.0)
    _, space2, im2 = body(n, -1.0)
    model = gf.Model("real")
    add_body(model, "u1", space1, im1, STEEL)
    add_body(model, "u2", space2, im2, ALUMINIUM)
    model.add_initialized_data("pressure", [0, 0, -PRESSURE])
    model.add_source_term_brick(im1, "u1", "pressure", TOP)
    model.add_initialized_data("traction", list(TRACTION))
    model.add_source_term_brick(im1, "u1", "traction", END)
    multipliers = gf.MeshFem(mesh1, 3)
    multipliers.set_fem(gf.Fem("FEM_QK(3,1)"))
    model.add_filtered_fem_variable("force", multipliers, CONTACT)
    model.add_initialized_data("r", [STEEL[0]])
    model.add_initialized_data("friction", [FRICTION])
    model.add_integral_contact_between_nonmatching_meshes_brick(im1, "u1", "u2", "force", "r", "friction", CONTACT, CONTACT, 1)
    model.solve("max_res", 1e-7, "max_iter", 100, "lsearch", "simplest", "alpha min", 0.8, "lsolver", "mumps")
    u = np.hstack([model.variable("u1").reshape(-1, 3).T, model.variable("u2").reshape(-1, 3).T])
    total = [float(gf.asm("generic", im1, 0, "force(%d)" % d, CONTACT, model)) for d in (1, 2, 3)]
    print(json.dumps({"total": time.process_time() - start, "max_displacement": float(np.sqrt((u ** 2).sum(0)).max()),
                      "normal_force": abs(total[2]), "tangential_force": float(np.hypot(*total[:2]))}))


if __name__ == "__main__":
    main()
