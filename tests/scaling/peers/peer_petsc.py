# SPDX-License-Identifier: BSD-3-Clause
"""PETSc on the tied two beams: CG, GAMG with the rigid motions as near-null space, true residual 1e-6; prints one line of JSON."""
import json
import sys
import time

import numpy as np
import petsc4py

petsc4py.init(sys.argv)
from petsc4py import PETSc  # noqa: E402

from beams import ALUMINIUM, STEEL, element_stiffness, grid, loads  # noqa: E402


def stiffness(hexes, upper, n, size):
    """AIJ rows of the bonded beams, from one element matrix a material."""
    dofs = (3 * hexes[:, :, None] + np.arange(3)).reshape(len(hexes), 24).astype(np.int32)
    matrix = PETSc.Mat().createAIJ((size, size), bsize=3, nnz=81)
    both = {False: element_stiffness(ALUMINIUM, 1 / n), True: element_stiffness(STEEL, 1 / n)}
    for rows, is_upper in zip(dofs, upper):
        matrix.setValues(rows, rows, both[bool(is_upper)], addv=True)
    matrix.assemble()
    return matrix


def solve(matrix, b):
    """Set-up and solve, CPU seconds; settings beyond the defaults from the command line."""
    x, times = b.duplicate(), [time.process_time()]
    ksp = PETSc.KSP().create()
    ksp.setOperators(matrix)
    ksp.setType("cg")
    ksp.getPC().setType("gamg")
    ksp.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)  # the true residual, as equilibrium is measured here
    ksp.setTolerances(rtol=1e-6, max_it=500)
    ksp.setFromOptions()
    ksp.setUp()
    times.append(time.process_time())
    ksp.solve(b, x)
    times.append(time.process_time())
    return x, ksp, np.diff(times)


def main():
    n = PETSc.Options().getInt("n", 16)
    nodes, hexes = grid(n, 2 * n, -1.0)
    upper = np.broadcast_to(np.arange(2 * n) >= n, (2 * n, n, 2 * n)).reshape(-1)
    whole = stiffness(hexes, upper, n, 3 * nodes.size // 3)
    free = np.arange(nodes.size // (2 * n + 1), nodes.size, dtype=np.int32)  # nodes at x = 0 come first
    rows = PETSc.IS().createGeneral(free)
    rows.setBlockSize(3)
    matrix = whole.createSubMatrix(rows, rows)
    whole.destroy()
    matrix.setBlockSize(3)
    matrix.setOption(PETSc.Mat.Option.SPD, True)
    points = PETSc.Vec().createWithArray(nodes.reshape(-1)[free].copy(), bsize=3)
    matrix.setNearNullSpace(PETSc.NullSpace().createRigidBody(points))
    b = PETSc.Vec().createWithArray(loads(nodes, n, n).reshape(-1)[free].copy(), bsize=3)
    solve(matrix, b)  # warms up
    x, ksp, seconds = solve(matrix, b)
    u = x.array.reshape(-1, 3)
    print(json.dumps({"unknowns": int(free.size), "setup": seconds[0], "solve": seconds[1], "iterations": ksp.getIterationNumber(),
                      "residual": (b - matrix * x).norm() / b.norm(), "max_displacement": float(np.sqrt((u ** 2).sum(1)).max()),
                      "work": float(b.array @ x.array)}))


if __name__ == "__main__":
    main()
