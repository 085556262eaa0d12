# SPDX-License-Identifier: BSD-3-Clause
"""Finite elements for the certificate: shape functions by their monomials, stiffness with and without B-bar, integrals on faces."""
import functools
import itertools
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "drivers"))
from haptos_exodus import CORNERS, SIDES, nodes_in_middles  # noqa: E402

_CUBE = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], float)
_SIMPLEX = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], float)
_FACE_CORNERS = {3: 3, 4: 4, 6: 3, 8: 4, 9: 4}
_PRESSURE_MODES = {"HEX20": 4, "HEX27": 4}   # of B-bar, in others one: what theory.md, Elements, says
_UNPROJECTED = {"TETRA10": 0.35}             # and the Poisson's ratio up to which div u is not projected


class Shape:
    """Functions that are 1 at one node and 0 at the others: the inverse of the monomials at the nodes.

    Reference places are the unit cube, square, tetrahedron or triangle; nodes between corners lie in their middles.
    """

    def __init__(self, corners, around, dimension):
        self.is_simplex = len(corners) == dimension + 1
        self.corners = corners[:, :dimension]
        self.nodes = np.array([self.corners[list(group)].mean(0) for group in around])
        self.exponents = np.array(self._monomials(len(around), dimension))
        self.coefficients = np.linalg.inv(self._powers(self.nodes, self.exponents))

    def _monomials(self, count, dimension):
        degree = 1 if count == len(self.corners) else 2
        powers = list(itertools.product(range(degree + 1), repeat=dimension))
        if self.is_simplex:
            return [p for p in powers if sum(p) <= degree]
        return powers if len(powers) == count else [p for p in powers if p.count(2) <= 1]   # serendipity

    @staticmethod
    def _powers(x, exponents):
        return np.prod(x[..., None, :] ** exponents, -1)

    def values(self, x):
        """[... x nodes] at x [... x dimension]"""
        return self._powers(x, self.exponents) @ self.coefficients

    def gradients(self, x):
        """[... x nodes x dimension] in reference places"""
        parts = []
        for d in range(self.nodes.shape[1]):
            lower = self.exponents - np.eye(self.nodes.shape[1], dtype=int)[d]
            parts.append((self._powers(x, np.maximum(lower, 0)) * self.exponents[:, d]) @ self.coefficients)
        return np.stack(parts, -1)

    def rule(self, count):
        """Gauss points [n x dimension] and weights, `count` along an axis; simplices as collapsed cubes."""
        dimension = self.nodes.shape[1]
        t, w = np.polynomial.legendre.leggauss(count)
        x = np.array(list(itertools.product((t + 1) / 2, repeat=dimension)))
        weights = np.prod(list(itertools.product(w / 2, repeat=dimension)), 1)
        if self.is_simplex:
            for d in range(1, dimension):          # x_d shrinks all before it
                weights = weights * (1 - x[:, d]) ** d
                x[:, :d] *= 1 - x[:, d:d + 1]
        return x, weights


@functools.cache
def solid(name):
    return Shape(_SIMPLEX if CORNERS[name] == 4 else _CUBE, nodes_in_middles(name), 3)


@functools.cache
def face(size):
    """The shape of a face of `size` nodes: corners, middles of edges, centre."""
    n = _FACE_CORNERS[size]
    around = [(i,) for i in range(n)] + [(i, (i + 1) % n) for i in range(n)] + [tuple(range(n))]
    return Shape(_SIMPLEX[:3] if n == 3 else _CUBE[:4], around[:size], 2)


def _element_stiffness(x, shape, young, poisson, is_bbar):
    """[elements x 3n x 3n] = sum over points of volume * (c g_i g_j^T + mu (g_j g_i^T + g_i . g_j I)), c = lambda.

    B-bar: c = -2/3 mu, or lambda of the unprojected part; the rest of bulk goes with the projection of div u on 1, or on 1, x, y, z.
    """
    points, weights = solid(shape).rule(2 if shape in ("HEX8", "TETRA4") else 3)
    local = solid(shape).gradients(points)
    jacobians = np.einsum("enx,pnd->epxd", x, local)
    volumes = weights * np.linalg.det(jacobians)
    g = (local @ np.linalg.inv(jacobians)).reshape(*volumes.shape, -1)
    mu, lame, bulk = young / 2 / (1 + poisson), young * poisson / (1 + poisson) / (1 - 2 * poisson), young / 3 / (1 - 2 * poisson)
    n = x.shape[1]
    H = (np.swapaxes(g * volumes[..., None], 1, 2) @ g).reshape(-1, n, 3, n, 3)
    unprojected = _UNPROJECTED.get(shape, -1)
    c = min(lame, 2 * mu * unprojected / (1 - 2 * unprojected)) if is_bbar else lame
    K = c * H + mu * H.transpose(0, 1, 4, 3, 2)
    K += mu * np.einsum("eidjd,ab->eiajb", H, np.eye(3))
    K = K.reshape(-1, 3 * n, 3 * n)
    if is_bbar:
        places = np.einsum("enx,pn->epx", x - x.mean(1, keepdims=True), solid(shape).values(points)) / np.ptp(x, 1)[:, None]
        modes = np.concatenate([np.ones_like(places[..., :1]), places], 2)[..., :_PRESSURE_MODES.get(shape, 1)]
        psi, _ = np.linalg.qr(modes * np.sqrt(volumes)[..., None])
        q = np.swapaxes(g * np.sqrt(volumes)[..., None], 1, 2) @ psi
        K += (bulk - c - 2 / 3 * mu) * q @ np.swapaxes(q, 1, 2)
    return K


def forces(mesh, young, poisson, is_bbar, u):
    """K u [nodes x 3], and the root mean square of K du, du what the last digits of u hide: no field of doubles can be expected to be nearer to balance.

    By elements, coordinates and displacements from their first node: how far off a body is or goes costs no digits.
    :param young, poisson: of each block
    """
    result, squares = np.zeros(u.shape), np.zeros(u.shape)
    for block, E, nu in zip(mesh.blocks, young, poisson):
        nodes = block.connectivity
        x, local, hidden = mesh.coordinates[nodes], u[nodes] - u[nodes][:, :1], np.spacing(np.abs(u[nodes])) ** 2 / 12
        K = _element_stiffness(x - x[:, :1], block.shape, E, nu, is_bbar)
        np.add.at(result, nodes, (K @ local.reshape(len(K), -1, 1)).reshape(local.shape))
        np.add.at(squares, nodes, (K ** 2 @ hidden.reshape(len(K), -1, 1)).reshape(local.shape))
    return result, np.sqrt(squares)


def faces_of(mesh, name):
    """Nodes of the faces of a side set [faces x nodes], all of one shape."""
    side_set = next(s for s in mesh.side_sets if s.name == name)
    all_nodes = [(block.shape, row) for block in mesh.blocks for row in block.connectivity]
    return np.array([all_nodes[e][1][list(SIDES[all_nodes[e][0]][side - 1])] for e, side in zip(side_set.elements, side_set.sides)])


def areas_of(mesh, name):
    """Integrals of the shape functions [nodes] over a side set of plane triangles or parallelograms."""
    faces = faces_of(mesh, name)
    shape = face(faces.shape[1])
    x = mesh.coordinates[faces[:, :len(shape.corners)]]
    points, weights = shape.rule(3)
    sizes = np.linalg.norm(np.cross(x[:, 1] - x[:, 0], x[:, -1] - x[:, 0]), axis=1)
    area = np.zeros(len(mesh.coordinates))
    np.add.at(area, faces, sizes[:, None] * (weights @ shape.values(points)))
    return area
