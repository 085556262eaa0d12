# SPDX-License-Identifier: BSD-3-Clause
"""The two beams as arrays: lower z in [-1, 0], upper z in [0, 1], both x in [0, 2], y in [0, 1]; N elements a unit."""
import numpy as np

STEEL, ALUMINIUM = (211900.0, 0.277), (69000.0, 0.333)  # upper, lower: Young's modulus, Poisson's ratio
PRESSURE, TRACTION, FRICTION = 100.0, (20.0, 20.0, 0.0), 0.3  # upper top, upper end x = 2
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])


def grid(n, cells_z, z0):
    """Nodes [nx, ny, nz, 3], hexahedra [cells, 8] in Exodus order, of 2 n x n x cells_z cubes of edge 1 / n from z0."""
    shape = (2 * n + 1, n + 1, cells_z + 1)
    axes = [np.arange(s) / n for s in shape]
    axes[2] = axes[2] + z0
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), -1)
    numbers = np.arange(np.prod(shape)).reshape(shape)
    ends = [slice(0, -1), slice(1, None)]
    hexes = np.stack([numbers[tuple(ends[c] for c in corner)].reshape(-1) for corner in CORNERS], 1)
    return nodes, hexes


def weights(count, n):
    """Trapezoidal weights of `count` equally spaced nodes: consistent loads of bilinear sides."""
    w = np.full(count, 1.0 / n)
    w[[0, -1]] *= 0.5
    return w


def loads(nodes, n, z_from):
    """Consistent nodal loads on the upper body, whose nodes start at layer z_from."""
    nx, ny, nz, _ = nodes.shape
    f = np.zeros(nodes.shape)
    f[:, :, -1, 2] -= PRESSURE * np.outer(weights(nx, n), weights(ny, n))
    end = np.outer(weights(ny, n), weights(nz - z_from, n))
    for d in range(3):
        f[-1, :, z_from:, d] += TRACTION[d] * end
    return f


def element_stiffness(material, h):
    """Stiffness [24, 24] of a trilinear cube of edge h, 2 x 2 x 2 Gauss points."""
    young, nu = material
    lam, mu = young * nu / ((1 + nu) * (1 - 2 * nu)), young / (2 * (1 + nu))
    elastic = np.diag([2 * mu] * 3 + [mu] * 3)
    elastic[:3, :3] += lam
    signs = 2 * CORNERS - 1
    stiffness = np.zeros((24, 24))
    for point in signs / np.sqrt(3):
        factors = 1 + signs * point
        grad = np.empty((8, 3))
        for d in range(3):
            grad[:, d] = signs[:, d] * factors[:, (d + 1) % 3] * factors[:, (d + 2) % 3] / 8 * (2 / h)
        b = np.zeros((6, 24))
        for d in range(3):
            b[d, d::3] = grad[:, d]
        for row, (i, j) in enumerate([(0, 1), (1, 2), (0, 2)], 3):
            b[row, i::3], b[row, j::3] = grad[:, j], grad[:, i]
        stiffness += b.T @ elastic @ b * (h / 2) ** 3
    return stiffness
