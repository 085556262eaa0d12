# SPDX-License-Identifier: BSD-3-Clause
"""Contact rows for the certificate, from theory.md section 2 alone: node to node, and dual mortar on plane surfaces."""
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse

import elements

_ALPHA = 0.2          # what the functions of corners take of the middles beside them
_ROUND_OFF = 1e-9     # of lengths and areas


@dataclass
class Interface:
    """Jump of a row: secondary @ u - primary @ u, matrices [rows x nodes]; a rigid plane has primary 0."""
    secondary: sparse.csr_matrix
    primary: sparse.csr_matrix
    area: np.ndarray
    normal: np.ndarray
    gap: float


def interfaces_of(scene, mesh, held, exchanged):
    """Those of a scene, from below.

    :param held: [nodes] clamped  :param exchanged: names of side sets that are secondary though the input says primary
    """
    result = []
    for body in range(0 if scene.plane else 1, scene.bodies):
        names = [f"bottom{body}", f"top{body - 1}" if body else None]
        if names[1] in exchanged:
            names.reverse()
        faces = [None if name is None else elements.faces_of(mesh, name) for name in names]
        if scene.is_mortar(body):
            rows = _mortar(mesh.coordinates, *faces, held)
        else:
            rows = _node_to_node(mesh, names, held)
        normal = np.array([0, 0, -1.0 if names[0].startswith("bottom") else 1.0])
        result.append(Interface(*rows, normal, scene.gap if body else 0.0))
    return result


def _node_to_node(mesh, names, held):
    """Nodes matched by place; clamped pairs, whose forces nobody knows, are left out."""
    nodes, area = [], elements.areas_of(mesh, names[0])
    for name in names:
        own = np.unique(elements.faces_of(mesh, name)) if name else nodes[0]
        nodes.append(own[np.lexsort(np.round(mesh.coordinates[own, :2], 9).T)])
    known = ~(held[nodes[0]] & (held[nodes[1]] if names[1] else True))
    nodes = [own[known] for own in nodes]
    shape = (len(nodes[0]), len(mesh.coordinates))
    matrices = [sparse.csr_matrix((np.ones(shape[0]), (np.arange(shape[0]), own)), shape) for own in nodes]
    return matrices[0], matrices[1] * (names[1] is not None), area[nodes[0]]


class _Plane:
    """Faces seen from above: corners in mathematical sense, and the affine maps to reference places."""

    def __init__(self, x, faces):
        self.faces, self.shape = faces, elements.face(faces.shape[1])
        corners = x[faces[:, :len(self.shape.corners)], :2]
        self.origin = corners[:, 0]
        self.map = np.stack([corners[:, 1] - self.origin, corners[:, -1] - self.origin], -1)
        self.size = abs(np.linalg.det(self.map))
        self.polygons = np.where(np.linalg.det(self.map)[:, None, None] > 0, corners, corners[:, ::-1])
        self.low, self.high = corners.min(1), corners.max(1)

    def values(self, face, x):
        return self.shape.values(np.linalg.solve(self.map[face], (x - self.origin[face]).T).T)


def _clipped(polygon, window):
    """What lies in a convex window: Sutherland and Hodgman."""
    for a, b in zip(window, np.roll(window, -1, 0)):
        inside = (b[0] - a[0]) * (polygon[:, 1] - a[1]) - (b[1] - a[1]) * (polygon[:, 0] - a[0])
        points = []
        for p, q, at_p, at_q in zip(polygon, np.roll(polygon, -1, 0), inside, np.roll(inside, -1)):
            if at_p >= 0:
                points.append(p)
            if (at_p > 0) != (at_q > 0) and at_p != at_q:
                points.append(p + at_p / (at_p - at_q) * (q - p))
        if len(points) < 3:
            return np.zeros((0, 2))
        polygon = np.array(points)
    return polygon


def _points_in(polygon, rule):
    """Cubature points and weights of a convex polygon, as a fan of triangles."""
    edges = polygon[1:] - polygon[0]
    double = edges[:-1, 0] * edges[1:, 1] - edges[:-1, 1] * edges[1:, 0]
    x = polygon[0] + rule[0][:, :1] * edges[:-1, None] + rule[0][:, 1:] * edges[1:, None]
    return x.reshape(-1, 2), (double[:, None] * rule[1]).ravel()


def _across(own, other, face, rule):
    """Integrals of N N_p^T over a face and those opposite: list of (face there, matrix)."""
    near = np.flatnonzero(((other.low < own.high[face]) & (other.high > own.low[face])).all(1))
    result, covered = [], 0.0
    for there in near:
        polygon = _clipped(own.polygons[face], other.polygons[there])
        if len(polygon) == 0:
            continue
        x, weights = _points_in(polygon, rule)
        covered += weights.sum()
        result.append((there, (own.values(face, x) * weights[:, None]).T @ other.values(there, x)))
    whole = own.size[face] * (0.5 if own.shape.is_simplex else 1.0)
    if abs(covered - whole) > _ROUND_OFF * whole:
        raise ValueError(f"a face is covered by {covered / whole}: the certificate knows surfaces with one outline only")
    return result


def _basis(size, kept, is_full):
    """C [kept x nodes]: multipliers' functions N' = C N; the columns add up to 1."""
    corners = len(elements.face(size).corners)
    C = np.eye(size)
    for i in range(corners if size in (6, 8) and is_full else 0):
        C[corners + i, corners + i] = 1 - 2 * _ALPHA
        C[i, corners + i] = C[(i + 1) % corners, corners + i] = _ALPHA
    if is_full:
        return C
    C = np.array([elements.face(corners).values(elements.face(size).nodes)[:, i] for i in range(corners)])   # middles are means of corners
    shares = np.full((len(kept), corners), 1 / len(kept))
    shares[:, kept] = np.eye(len(kept))
    return shares @ C


def _mortar(x, faces, opposite, held):
    """Dual rows: phi = diag(d') M'^-1 N', D = int phi N^T, M = int phi N_p^T, both divided by w = int phi."""
    own, other = _Plane(x, faces), None if opposite is None else _Plane(x, opposite)
    rule, corners, size = elements.face(3).rule(6), len(own.shape.corners), faces.shape[1]
    points, weights = own.shape.rule(5)
    N = own.shape.values(points)
    d, mass = weights @ N, (N * weights[:, None]).T @ N          # of a face of size 1
    is_full = ~held[faces].any(1) & (size > corners)
    carries = np.zeros(len(x), bool)
    carries[faces[:, :corners]] = True
    carries[faces[is_full]] = True
    carries &= ~held
    D, M, w = sparse.lil_matrix((len(x), len(x))), sparse.lil_matrix((len(x), len(x))), np.zeros(len(x))
    for f, nodes in enumerate(faces):
        kept = np.arange(size) if is_full[f] else np.flatnonzero(carries[nodes[:corners]])
        C = _basis(size, kept, is_full[f])
        phi = np.diag(C @ d) @ np.linalg.solve(C @ mass @ C.T, C)
        D[np.ix_(nodes[kept], nodes)] += own.size[f] * phi @ mass
        w[nodes[kept]] += own.size[f] * phi @ d
        for there, cross in [] if other is None else _across(own, other, f, rule):
            M[np.ix_(nodes[kept], opposite[there])] += phi @ cross
    rows = np.flatnonzero(w > 0)
    scale = sparse.diags(1 / w[rows])
    return (scale @ D.tocsr()[rows]).tocsr(), (scale @ M.tocsr()[rows]).tocsr(), w[rows]
