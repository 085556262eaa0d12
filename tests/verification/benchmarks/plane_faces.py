# SPDX-License-Identifier: BSD-3-Clause
"""Integrals over the faces of a mesh in the plane z = 0."""
import numpy as np

from runs import ROOT  # noqa: F401  (makes the drivers known)
from haptos_exodus import SIDES

_PLACES, _WEIGHTS = np.polynomial.legendre.leggauss(6)
_CORNERS = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], float)


def _square(nodes, x, y):
    """N, and its derivatives by x and y, of a square of 4 or 8 nodes."""
    N = np.zeros((3, nodes))
    for k, (i, j) in enumerate(_CORNERS):
        a, b = 1 + i * x, 1 + j * y
        N[:, k] = np.array([a * b, i * b, a * j]) / 4
        if nodes == 8:
            edge, other = 4 + k, 4 + (k + 3) % 4      # on both sides of the corner
            N[:, k] = np.array([a * b * (i * x + j * y - 1), i * b * (2 * i * x + j * y), j * a * (i * x + 2 * j * y)]) / 4
            for at in (edge, other):
                i2, j2 = (_CORNERS[at - 4] + _CORNERS[(at - 3) % 4]) / 2
                N[:, at] = np.array([(1 - x * x) * (1 + j2 * y), -2 * x * (1 + j2 * y), (1 - x * x) * j2]) / 2 if i2 == 0 else \
                    np.array([(1 - y * y) * (1 + i2 * x), (1 - y * y) * i2, -2 * y * (1 + i2 * x)]) / 2
    return N


def _triangle(x, y):
    """The same of a triangle of 6 nodes."""
    L, dL = np.array([1 - x - y, x, y]), np.array([(-1, -1), (1, 0), (0, 1)], float)
    N = np.zeros((3, 6))
    for k in range(3):
        m = (k + 1) % 3
        N[:, k] = [L[k] * (2 * L[k] - 1), *((4 * L[k] - 1) * dL[k])]
        N[:, 3 + k] = [4 * L[k] * L[m], *(4 * (L[m] * dL[k] + L[k] * dL[m]))]
    return N


def _rule(nodes):
    """Shape functions [points x 3 x nodes] and weights at 6 x 6 points, those of a triangle by Duffy's map."""
    if nodes in (4, 8):
        return np.array([_square(nodes, x, y) for x in _PLACES for y in _PLACES]), np.outer(_WEIGHTS, _WEIGHTS).ravel()
    halves = (1 + _PLACES) / 2
    return (np.array([_triangle(s, t * (1 - s)) for s in halves for t in halves]),
            np.array([v * w * (1 - s) / 4 for s, v in zip(halves, _WEIGHTS) for w in _WEIGHTS]))


def displacement_error(result, exact):
    """L2 norm over z = 0 of the error of (u_x, u_y), over that of the exact field.  :param exact: (places [n x 2], body) -> [n x 2]"""
    error = size = 0.0
    for body, (shape, connectivity) in enumerate(result.blocks):
        for side in SIDES[shape]:
            faces = connectivity[:, list(side)]
            faces = faces[np.all(np.abs(result.x[faces, 2]) < 1e-9, axis=1)]
            if len(faces) == 0:
                continue
            shapes, weights = _rule(len(side))
            x, dx, dy = (np.einsum("qn,fnc->fqc", shapes[:, k], result.x[faces][:, :, :2]) for k in range(3))
            area = np.abs(dx[..., 0] * dy[..., 1] - dx[..., 1] * dy[..., 0]) * weights
            found = np.einsum("qn,fnc->fqc", shapes[:, 0], result.vector("displacement")[faces][:, :, :2])
            wanted = exact(x.reshape(-1, 2), body).reshape(x.shape)
            error += np.sum(np.sum((found - wanted) ** 2, axis=2) * area)
            size += np.sum(np.sum(wanted ** 2, axis=2) * area)
    return float(np.sqrt(error / size))
