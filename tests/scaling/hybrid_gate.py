#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Hybrid Total FETI on small scenes: multiplications by F with clusters of c subdomains against c = 1 (doc/decisions/038-hybrid-gate.md).

    hybrid_gate.py [--case bricks:K:P | metis:N:S]... [--clusters 1 8 27] [--rows faces faces+edges corners ...] [--tied] [--friction 0.3]

Two beams as in the benchmark, clamped at x = 0, in K bricks of P^3 elements an edge, or N elements an edge in S METIS parts a beam.
A cluster is glued inside by rows B_0, exactly, in every K^+; its kernel is what B_0 leaves of the rigid motions of its subdomains:

    K~^+ = K^+ - W M^+ W^T,   W = [K^+ B_0^T, -R],   M = [F_0, -G_0^T; -G_0, 0],   F_0 = B_0 K^+ B_0^T,   G_0 = R^T B_0^T

Rows of B stay all as they are (F gets a kernel: the span of B_0).  Tied beams are solved by PCPG, contact by the subspace Newton method
of doc/theory.md, with isotropic friction.  Local matrices are dense: s up to some hundreds.  Needs NumPy, SciPy and, for METIS cuts, libmetis.
"""
import argparse
import time

import numpy as np
import scipy.linalg as sl
import scipy.sparse as sp
import scipy.sparse.linalg as spl

from hybrid_scene import Scene, cluster_rows, make_case

class Clusters:
    """F, G and loads of the scene in clusters; `multiplications` by F are counted."""

    def __init__(self, scene, cluster, kind):
        self.scene, self.multiplications, self.rows, self.parts, self.slices = scene, 0, 0, [], scene.slices()
        t = np.concatenate([s.load_at_boundary for s in scene.subdomains])
        u0, R, moments = t.copy(), [], []
        for c in range(cluster.max() + 1):
            members = np.flatnonzero(cluster == c)
            unknowns = np.concatenate([np.arange(self.slices[s].start, self.slices[s].stop) for s in members])
            ownR = sl.block_diag(*[scene.subdomains[s].R for s in members])
            moment = np.concatenate([scene.subdomains[s].load_moment for s in members])
            entries = list(cluster_rows(scene, members, kind)) if len(members) > 1 else []
            null = self.glue(members, unknowns, ownR, entries) if entries else np.eye(len(moment))
            if entries:
                _, W, inverse = self.parts[-1]
                u0[unknowns] -= W @ (inverse @ np.r_[self.B0 @ t[unknowns], -moment])
            columns = np.tile(np.arange(null.shape[1]), len(unknowns))
            R.append(sp.csr_matrix(((ownR @ null).ravel(), (np.repeat(unknowns, null.shape[1]), columns)), shape=(scene.unknowns, null.shape[1])))
            moments.append(null.T @ moment)
        self.G = (sp.hstack(R).T @ scene.B.T).tocsr()
        self.e, self.s0 = np.concatenate(moments), scene.B @ u0
        self.kappa = scene.BD.multiply(scene.BD) @ np.concatenate([np.diag(s.S) for s in scene.subdomains])  # diagonal of M

    def glue(self, members, unknowns, R, entries):
        """Keeps W and M^+ of a cluster; what B_0 leaves of the motions R of its members."""
        local = {u: i for i, u in enumerate(unknowns)}
        self.B0 = np.zeros((len(entries), len(unknowns)))
        for i, row in enumerate(entries):
            for u, v in row:
                self.B0[i, local[u]] += v
        T = sl.block_diag(*[self.scene.subdomains[s].Kp for s in members]) @ self.B0.T
        G0 = R.T @ self.B0.T
        M = np.block([[self.B0 @ T, -G0.T], [-G0, np.zeros((len(G0),) * 2)]])
        self.parts.append((unknowns, np.hstack([T, -R]), np.linalg.pinv((M + M.T) / 2, rcond=1e-10, hermitian=True)))
        self.rows = max(self.rows, len(entries))
        return sl.null_space(G0.T, rcond=1e-8)

    def blocks(self, name, x):
        return np.concatenate([getattr(s, name) @ x[at] for s, at in zip(self.scene.subdomains, self.slices)])

    def F(self, x):
        self.multiplications += 1
        f = self.scene.B.T @ x
        u = self.blocks("Kp", f)
        for unknowns, W, inverse in self.parts:
            u[unknowns] -= W @ (inverse @ (W.T @ f[unknowns]))
        return self.scene.B @ u

    def M(self, x):
        return self.scene.BD @ self.blocks("S", self.scene.BD.T @ x)


def factor(A):
    """A sparse matrix that may be singular where rows say the same thing twice."""
    shift = 1e-13 * A.diagonal().mean()
    return spl.splu((A + shift * sp.eye(A.shape[0])).tocsc()).solve


class Projector:
    """Onto G x = 0 by weights Q; `dual` adds G^T a, so that G Q s = 0."""

    def __init__(self, G, weights):
        self.G, self.QGT = G, sp.diags(weights) @ G.T
        self.solve = factor(G @ self.QGT)

    def primal(self, x):
        return x - self.QGT @ self.solve(self.G @ x)

    def dual(self, s):
        return s - self.G.T @ self.solve(self.QGT.T @ s)


def pcpg(system, tolerance):
    """Multiplications until the projected residual has fallen; all directions are kept."""
    P = Projector(system.G, system.kappa / np.median(system.kappa))
    lam = P.QGT @ P.solve(system.e)
    r, kept = P.dual(system.s0 - system.F(lam)), []
    start = np.sqrt(r @ system.M(r))
    while len(kept) < 400:
        z = P.primal(system.M(r))
        if np.sqrt(abs(r @ z)) <= tolerance * start:
            break
        for v, Fv, d in kept:
            z = z - v * (Fv @ z / d)
        Fz = P.dual(system.F(z))
        d = z @ Fz
        kept.append((z, Fz, d))
        step = z @ r / d
        lam, r = lam + step * z, r - step * Fz
    return lam


class Law:
    """Coulomb's, isotropic: phi = (lambda - P(lambda + r s)) / r with its derivatives A, Bm; P' and P' for the radius."""

    def __init__(self, coefficient, r):
        self.mu, self.r = coefficient, r

    def __call__(self, lam, s):
        x, m = lam + self.r * s, len(lam)
        closed, g = x[:, 0] > 0, self.mu * np.maximum(x[:, 0], 0)
        size = np.maximum(np.hypot(x[:, 1], x[:, 2]), 1e-300)
        slips = closed & (size > g)
        D, P = np.zeros((m, 3, 3)), np.zeros((m, 3))
        D[closed] = np.eye(3)
        P[closed] = x[closed]
        e = x[slips, 1:] / size[slips, None]
        P[slips, 1:] = g[slips, None] * e
        across = np.eye(2) - e[:, :, None] * e[:, None, :]
        D[slips, 1:, 1:] = (g / size)[slips, None, None] * across
        D[slips, 1:, 0] = self.mu * e
        self.state = closed.astype(int) + slips
        return (np.eye(3) - D) / self.r, -D, (lam - P) / self.r, D


class SubspaceNewton:
    """doc/theory.md, for supported bodies: one pair a step, the law solved in the span of all pairs."""

    def __init__(self, system, coefficient, tolerance):
        scene = system.scene
        self.system, self.nE = system, scene.glued
        self.contact = np.arange(scene.glued, scene.B.shape[0]).reshape(-1, 3)
        self.V, self.S = np.zeros((len(system.s0), 0)), np.zeros((len(system.s0), 0))
        self.GE = system.G[:, :self.nE]
        self.solveE = factor(self.GE @ self.GE.T)
        self.r = 0.3 * np.median(system.kappa[self.contact[:, 0]])
        free = system.G.T @ factor(system.G @ system.G.T)(system.e)
        self.scale = np.linalg.norm(Projector(system.G, np.ones(len(free))).dual(system.s0 - system.F(free)))
        system.multiplications = 0
        self.lam = np.zeros(len(free))
        self.lam[:self.nE] = self.GE.T @ self.solveE(system.e)
        self.s = self.balanced(system.s0 - system.F(self.lam))
        for level, aim in ((1.5 * coefficient, 0.1), (coefficient, tolerance)):
            self.law = Law(level, self.r)
            self.run(aim)

    def balanced(self, s):
        return s - self.system.G.T @ self.solveE(self.GE @ s[:self.nE])

    def residual(self, lam, s):
        terms = self.law(lam[self.contact], s[self.contact])
        return terms, np.sqrt(np.sum(s[:self.nE] ** 2) + np.sum(terms[2] ** 2))

    def run(self, aim):
        terms, now = self.residual(self.lam, self.s)
        while now > aim * self.scale and self.system.multiplications < 300:
            self.addPair(terms)
            terms, now = self.minimise(terms, now)
        self.converged = now <= aim * self.scale

    def addPair(self, terms):
        _, _, phi, D = terms
        c, kappa, state = self.contact, self.system.kappa[self.contact[:, 1:]].mean(1), self.law.state
        sigma = np.where(state == 1, 1.0, np.trace(D[:, 1:, 1:], axis1=1, axis2=2))
        x = self.lam[c] + self.r * self.s[c]
        size = np.maximum(np.hypot(x[:, 1], x[:, 2]), 1e-300)
        across = np.stack([-x[:, 2], x[:, 1]], 1) / size[:, None]
        theta = np.where(state > 0, 1 / kappa / ((1 - sigma) / (self.r * np.maximum(sigma, 1e-14)) + 1 / kappa), 0)
        Y = np.zeros((len(c), 3, 3))  # closed rows; of those that slip the part across the force
        Y[state > 0, 0, 0] = 1
        Y[state == 1, 1:, 1:] = np.eye(2)
        slip = state == 2
        Y[slip, 1:, 1:] = np.sqrt(theta[slip])[:, None, None] * across[slip, :, None] * across[slip, None, :]
        res = self.s.copy()
        res[c] = np.einsum("iab,ib->ia", Y, np.column_stack([self.s[c][:, 0], -phi[:, 1:] / np.maximum(sigma, 1e-14)[:, None]]))
        P = Projector(self.system.G @ self.expanded(Y), self.system.kappa / np.median(self.system.kappa))
        z = P.primal(self.system.M(P.dual(res)))
        zc = np.einsum("iab,ib->ia", Y, z[c])
        lc, sc = self.lam[c], self.s[c]
        dN = zc[:, 0] - self.r * sc[:, 0]
        along = D[:, 1:, 0] * dN[:, None] - self.r * phi[:, 1:]
        e = x[:, 1:] / size[:, None]
        zc[slip, 1:] += (e * np.sum(e * along, 1)[:, None])[slip]
        zc[state == 0] = -lc[state == 0]
        z[c] = zc
        z[:self.nE] -= self.GE.T @ self.solveE(self.system.G @ z)
        z /= np.linalg.norm(z)
        s = self.balanced(-self.system.F(z))
        size = np.linalg.norm(s)
        self.V, self.S = np.column_stack([self.V, z / size]), np.column_stack([self.S, s / size])

    def expanded(self, Y):
        c, n = self.contact, len(self.lam)
        i, j = np.repeat(c[:, :, None], 3, 2).ravel(), np.repeat(c[:, None, :], 3, 1).ravel()
        glued = np.arange(self.nE)
        return sp.csr_matrix((np.r_[np.ones(self.nE), Y.ravel()], (np.r_[glued, i], np.r_[glued, j])), shape=(n, n))

    def minimise(self, terms, now):
        """Gauss-Newton over all pairs, by line search; a full step where the first has no descent."""
        for step in range(8):
            A, Bm, phi, _ = terms
            V, S = self.V[self.contact], self.S[self.contact]
            J = (np.einsum("iab,ibm->iam", A, V) + np.einsum("iab,ibm->iam", Bm, S)).reshape(phi.size, -1)
            system = np.vstack([self.S[:self.nE], J])
            size = np.linalg.norm(system, axis=0)
            y = np.linalg.lstsq(system / size, -np.r_[self.s[:self.nE], phi.ravel()], rcond=1e-12)[0] / size
            dl, ds, t = self.V @ y, self.S @ y, 1.0
            full = self.residual(self.lam + dl, self.s + ds)
            found = full
            while t > 1 / 40 and not found[1] < (1 - 1e-4 * t) * now:
                t /= 2
                found = self.residual(self.lam + t * dl, self.s + t * ds)
            if t <= 1 / 40:
                if step > 0 or full[1] > 3 * now:
                    break
                t, found = 1.0, full
            self.lam, self.s = self.lam + t * dl, self.s + t * ds
            before, (terms, now) = now, found
            if now > 0.98 * before:
                break
        return self.residual(self.lam, self.s)


def run(case, options, tied):
    bodies, parts, clusters = make_case(case)
    scene, reference, base = Scene(bodies, parts, tied), None, None
    for c in options.clusters:
        for kind in options.rows if c > 1 else ["-"]:
            start = time.time()
            cluster = clusters(c)
            system = Clusters(scene, cluster, kind)
            if tied:
                lam, note = pcpg(system, options.tolerance), ""
            else:
                newton = SubspaceNewton(system, options.friction, options.tolerance)
                lam, note = newton.lam, "open %d stick %d slip %d" % tuple(np.bincount(newton.law.state, minlength=3))
                note += "" if newton.converged else "  NOT CONVERGED"
            contact = lam[scene.B.shape[0] - 3 * newton_pairs(scene):]
            reference, base = (contact, system.multiplications) if reference is None else (reference, base)
            error = np.linalg.norm(contact - reference) / np.linalg.norm(reference)
            print("%-14s %-8s c %3d %-14s clusters %3d  kernel %5d (%.1f a cluster)  rows of B_0 %4d | F %4d  x %.2f | %.0e from c = 1 | %s  %.0f s" %
                  (case, "tied" if tied else "friction", c, kind, cluster.max() + 1, len(system.e), len(system.e) / (cluster.max() + 1),
                   system.rows, system.multiplications, system.multiplications / base, error, note, time.time() - start), flush=True)


def newton_pairs(scene):
    return sum(1 for (upper, node) in scene.copies if not upper and scene.bodies[0].grid[node, 2] == scene.bodies[0].n and scene.bodies[0].grid[node, 0] > 0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--case", action="append")
    parser.add_argument("--clusters", type=int, nargs="+", default=[1, 8, 27])
    parser.add_argument("--rows", nargs="+", default=["faces", "faces+edges", "faces+corners"])
    parser.add_argument("--tied", action="store_true", help="tied beams only")
    parser.add_argument("--friction", type=float, default=0.3)
    parser.add_argument("--tolerance", type=float, default=1e-6)
    options = parser.parse_args()
    for case in options.case or ["bricks:2:3"]:
        for tied in ([True] if options.tied else [True, False]):
            run(case, options, tied)


if __name__ == "__main__":
    main()
