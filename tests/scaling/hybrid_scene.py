# SPDX-License-Identifier: BSD-3-Clause
"""Scenes of hybrid_gate.py: two beams in bricks or METIS parts, their rows of B, dense local matrices, the rows B_0 of clusters."""
import ctypes
import ctypes.util
import itertools

import numpy as np
import scipy.linalg as sl
import scipy.sparse as sp

YOUNG, POISSON = (1.0, 3.07), (0.333, 0.277)  # lower, upper beam


def hexahedron(h, young, poisson):
    lame, shear = young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / 2 / (1 + poisson)
    C = np.diag([2 * shear] * 3 + [shear] * 3)
    C[:3, :3] += lame
    corners, K = np.array(list(itertools.product((-1, 1), repeat=3)))[:, ::-1], np.zeros((24, 24))
    for point in itertools.product((-1, 1), repeat=3):
        f = 1 + corners * np.array(point) / np.sqrt(3)
        d = corners * np.stack([f[:, 1] * f[:, 2], f[:, 0] * f[:, 2], f[:, 0] * f[:, 1]], 1) / (4 * h)
        B = np.zeros((6, 24))
        for i, (x, y, z) in enumerate(d):
            B[:, 3 * i:3 * i + 3] = [[x, 0, 0], [0, y, 0], [0, 0, z], [y, x, 0], [0, z, y], [z, 0, x]]
        K += B.T @ C @ B * (h / 2) ** 3
    return K


class Beam:
    """2N x N x N elements; z from -1 (lower) or 0 (upper)."""

    def __init__(self, n, upper):
        self.n, self.h, self.upper = n, 1 / n, upper
        x, y, z = np.meshgrid(np.arange(2 * n + 1), np.arange(n + 1), np.arange(n + 1), indexing="ij")
        self.grid = np.stack([x, y, z], -1).reshape(-1, 3)
        self.points = self.grid * self.h + [0, 0, 0 if upper else -1]
        number = np.arange(len(self.grid)).reshape(2 * n + 1, n + 1, n + 1)
        self.cells = np.stack(np.meshgrid(np.arange(2 * n), np.arange(n), np.arange(n), indexing="ij"), -1).reshape(-1, 3)
        self.elements = np.stack([number[tuple((self.cells + [a, b, c]).T)] for c in (0, 1) for b in (0, 1) for a in (0, 1)], 1)
        self.K = hexahedron(self.h, YOUNG[upper], POISSON[upper])

    def face_weights(self, axis, at):
        size = np.array([2 * self.n, self.n, self.n])
        ends = ((self.grid == 0) | (self.grid == size)).astype(float)
        others = [a for a in range(3) if a != axis]
        return np.where(self.grid[:, axis] == at, np.prod(1 - 0.5 * ends[:, others], 1), 0) * self.h ** 2

    def load(self):
        ramp = np.clip(1.5 - self.points[:, 0], 0, 1)
        f = np.zeros((len(self.grid), 3))
        f[:, 2] += (-1 if self.upper else 1) * 1e-3 * ramp * self.face_weights(2, self.n if self.upper else 0)
        if self.upper:
            f += 1e-4 * self.face_weights(0, 2 * self.n)[:, None]
        return f


def metis(neighbours, parts):
    """Parts of a graph [[neighbours]]; METIS' k-way method."""
    library = ctypes.CDLL(ctypes.util.find_library("metis") or "libmetis.so.5")
    starts = np.r_[0, np.cumsum([len(n) for n in neighbours])].astype(np.int32)
    edges, part = np.concatenate(neighbours).astype(np.int32), np.zeros(len(neighbours), np.int32)
    if parts == 1:
        return part
    number = [ctypes.byref(ctypes.c_int32(v)) for v in (len(neighbours), 1, parts, 0)]
    pointer = [a.ctypes.data_as(ctypes.POINTER(ctypes.c_int32)) for a in (starts, edges, part)]
    status = library.METIS_PartGraphKway(number[0], number[1], pointer[0], pointer[1], None, None, None, number[2], None, None, None,
                                         number[3], pointer[2])
    assert status == 1, status
    return part


def graph(sets, least):
    """[[neighbours]] of items with sets of nodes: those that share at least so many."""
    count = max(max(s) for s in sets) + 1
    rows = np.repeat(np.arange(len(sets)), [len(s) for s in sets])
    A = sp.csr_matrix((np.ones(len(rows)), (rows, np.concatenate([list(s) for s in sets]))), shape=(len(sets), count))
    shared = (A @ A.T).tocsr()
    return [[j for j, v in zip(shared.indices[a:b], shared.data[a:b]) if j != i and v >= least]
            for i, (a, b) in enumerate(zip(shared.indptr, shared.indptr[1:]))]


class Subdomain:
    def __init__(self, body, nodes, elements, boundary, cache):
        self.body, self.nodes = body.upper, boundary
        local = {node: i for i, node in enumerate(nodes)}
        points = body.points[nodes]
        shape = (body.upper, tuple(map(tuple, np.round((points - points[0]) / body.h).astype(int))), tuple(local[b] for b in boundary))
        if shape not in cache:
            cache[shape] = self.matrices(body, nodes, elements, local, boundary, points)
        self.Kp, self.S, self.R, whole, self.wholeR = cache[shape]
        f = body.load()[nodes] / np.array([body.share[v] for v in nodes])[:, None]
        self.load_at_boundary, self.load_moment = whole @ f.ravel(), self.wholeR.T @ f.ravel()

    @staticmethod
    def matrices(body, nodes, elements, local, boundary, points):
        n = 3 * len(nodes)
        dofs = np.array([[3 * local[v] + d for v in e for d in range(3)] for e in elements])
        K = sp.csr_matrix((np.tile(body.K.ravel(), len(dofs)), (np.repeat(dofs, 24, 1).ravel(), np.tile(dofs, (1, 24)).ravel())),
                          shape=(n, n)).toarray()
        R = kernel(K, points)
        rho = np.trace(K) / n
        inverse = np.linalg.inv(K + rho * R @ R.T) - R @ R.T / rho
        b = np.array([3 * local[v] + d for v in boundary for d in range(3)])
        i = np.setdiff1d(np.arange(n), b)
        S = K[np.ix_(b, b)] - (K[np.ix_(b, i)] @ np.linalg.solve(K[np.ix_(i, i)], K[np.ix_(i, b)]) if len(i) else 0)
        return inverse[np.ix_(b, b)], (S + S.T) / 2, R[b], inverse[b], R


def kernel(K, points):
    """Rigid motions; more where a part hangs together at edges or corners only, or not at all."""
    values, vectors = np.linalg.eigh(K)
    count = int(np.sum(values < 1e-10 * values[-1]))
    return rigid_motions(points) if count == 6 else vectors[:, :count]


def rigid_motions(points):
    x, y, z = (points - points.mean(0)).T
    o, l = np.zeros_like(x), np.ones_like(x)
    columns = [(l, o, o), (o, l, o), (o, o, l), (o, -z, y), (z, o, -x), (-y, x, o)]
    return np.linalg.qr(np.stack([np.stack(c, 1).ravel() for c in columns], 1))[0]


class Scene:
    """Both beams in subdomains: rows of B, local matrices, loads."""

    def __init__(self, bodies, parts, tied):
        self.tied, self.subdomains, cache = tied, [], {}
        self.copies = {}  # (body, node) -> [first unknown of every copy]
        first = 0
        for body, part in zip(bodies, parts):
            sets = [np.unique(body.elements[part == s]) for s in range(part.max() + 1)]
            body.share = np.bincount(np.concatenate(sets), minlength=len(body.grid))
            plane = body.grid[:, 2] == (0 if body.upper else body.n)
            for s, nodes in enumerate(sets):
                boundary = nodes[(body.share[nodes] > 1) | (body.grid[nodes, 0] == 0) | plane[nodes]]
                self.subdomains.append(Subdomain(body, nodes, body.elements[part == s], boundary, cache))
                self.subdomains[-1].first = first
                for i, node in enumerate(boundary):
                    self.copies.setdefault((body.upper, node), []).append((len(self.subdomains) - 1, first + 3 * i))
                first += 3 * len(boundary)
        self.unknowns, self.bodies = first, bodies
        self.weight = np.concatenate([np.full(3 * len(s.nodes), 1 / YOUNG[s.body]) for s in self.subdomains])
        self.makeRows()

    def makeRows(self):
        entries, row = [], 0
        for (_, node), copies in self.copies.items():
            for j in range(1, len(copies)):
                scale = 1 / np.sqrt(j * (j + 1))
                for d in range(3):
                    entries += [(row, at + d, scale) for _, at in copies[:j]] + [(row, copies[j][1] + d, -j * scale)]
                    row += 1
        for (upper, node), copies in self.copies.items():
            if self.bodies[upper].grid[node, 0] == 0:
                for d in range(3):
                    entries += [(row, at + d, 1 / np.sqrt(len(copies))) for _, at in copies]
                    row += 1
        opposite = {tuple(g[:2]): v for v, g in enumerate(self.bodies[1].grid) if g[2] == 0}
        self.glued = row
        for (upper, node), copies in self.copies.items():
            g = self.bodies[0].grid[node]
            if upper or g[2] != self.bodies[0].n or g[0] == 0:
                continue
            for d in (2, 0, 1):
                for sign, side in ((1, copies), (-1, self.copies[1, opposite[tuple(g[:2])]])):
                    entries += [(row, at + d, sign / len(side)) for _, at in side]
                row += 1
        i, j, v = zip(*entries)
        self.B = sp.csr_matrix((v, (i, j)), shape=(row, self.unknowns))
        if self.tied:
            self.glued = row
        BW = self.B @ sp.diags(self.weight)
        self.BD = sp.diags(1 / np.asarray(BW.multiply(self.B).sum(1)).ravel()) @ BW

    def slices(self):
        return [slice(s.first, s.first + 3 * len(s.nodes)) for s in self.subdomains]


def edge_modes(points, kind):
    """On nodes that more than two subdomains share: their mean, both their ends, or both."""
    ends = sorted({int(np.argmin(points @ [1, 1.1, 1.2])), int(np.argmax(points @ [1, 1.1, 1.2]))}) if "corners" in kind else []
    modes = [np.tile(np.eye(3), (len(points), 1)) / np.sqrt(len(points))] if "edges" in kind and len(points) > len(ends) else []
    for end in ends:
        modes.append(np.zeros((3 * len(points), 3)))
        modes[-1][3 * end:3 * end + 3] = np.eye(3)
    return np.hstack(modes)


def cluster_rows(scene, members, kind):
    """B_0 of a cluster: [(unknown, value)] of every row, over what its subdomains share."""
    inside, classes = set(members), {}
    for (upper, node), copies in scene.copies.items():
        own = tuple(c for c in copies if c[0] in inside)
        if len(own) > 1:
            classes.setdefault(tuple(s for s, _ in own), []).append((scene.bodies[upper].points[node], [at for _, at in own]))
    for sharers, nodes in classes.items():
        points, places = np.array([p for p, _ in nodes]), np.array([at for _, at in nodes])
        if len(sharers) == 2 and "faces" in kind:
            modes = rigid_motions(points) if len(points) > 2 else np.eye(3 * len(points))
        elif len(sharers) == 2 and "averages" in kind:
            modes = np.tile(np.eye(3), (len(points), 1)) / np.sqrt(len(points))
        elif len(sharers) > 2 and ("edges" in kind or "corners" in kind):
            modes = edge_modes(points, kind)
        else:
            continue
        unknowns = (places.T[:, :, None] + np.arange(3)).reshape(len(sharers), -1)
        for j in range(1, len(sharers)):
            for mode in modes.T:
                kept = np.abs(mode) > 1e-14
                yield list(zip(unknowns[j - 1][kept], mode[kept])) + list(zip(unknowns[j][kept], -mode[kept]))


def make_case(text):
    """(bodies, parts, clusters of c -> cluster of every subdomain)."""
    kind, first, second = text.split(":")
    if kind == "bricks":
        k, p = int(first), int(second)
        bodies = [Beam(k * p, upper) for upper in (0, 1)]
        part = np.ravel_multi_index((bodies[0].cells // p).T, (2 * k, k, k))
        grid = np.stack(np.unravel_index(np.arange(2 * k ** 3), (2 * k, k, k)), 1)

        def clusters(c):
            edge = round(c ** (1 / 3))
            shape = [-(-size // edge) for size in (2 * k, k, k)]
            one = np.ravel_multi_index((grid // edge).T, shape)
            return np.r_[one, one + one.max() + 1]
        return bodies, [part, part], clusters
    n, s = int(first), int(second)
    bodies = [Beam(n, upper) for upper in (0, 1)]
    part = metis(graph(list(bodies[0].elements), 4), s)

    places = np.array([bodies[0].cells[part == i].mean(0) for i in range(s)])

    def clusters(c):
        one = bisected(places, max(1, round(s / c)))
        return np.r_[one, one + one.max() + 1]
    return bodies, [part, part], clusters


def bisected(places, count):
    """Points in `count` compact groups: cut across the longest side, again and again."""
    group, waiting, made = np.zeros(len(places), int), [(np.arange(len(places)), min(count, len(places)))], 0
    while waiting:
        members, wanted = waiting.pop()
        if wanted == 1:
            group[members], made = made, made + 1
            continue
        order = members[np.argsort(places[members][:, np.ptp(places[members], axis=0).argmax()], kind="stable")]
        first = wanted // 2
        cut = round(len(members) * first / wanted)
        waiting += [(order[:cut], first), (order[cut:], wanted - first)]
    return group
