# SPDX-License-Identifier: BSD-3-Clause
"""Checks an answer from its file alone: own stiffness, own loads, own rows, own law; nothing of the library."""
import itertools
import math
import re

import netCDF4
import numpy as np
import scipy.optimize
import scipy.sparse as sparse
import scipy.sparse.linalg

import elements
import interfaces


def read_fields(path):
    """displacement and contact_force [nodes x 3] of the file's last step."""
    with netCDF4.Dataset(path) as file:
        names = [b"".join(row.compressed()).decode() for row in file["name_nod_var"][:]]
        values = {name: np.array(file[f"vals_nod_var{i}"][-1]) for i, name in enumerate(names, start=1)}
    return tuple(np.stack([values[f"{field}_{axis}"] for axis in "xyz"], 1) for field in ("displacement", "contact_force"))


def _on_ellipses(points, semi_axes):
    """Euclidean projections [k x 2] on ellipses, by bisection of the multiplier."""
    a = semi_axes
    parts = np.divide(points, a, out=np.where(points == 0, 0.0, math.inf), where=a > 0)
    inside, flat = (parts ** 2).sum(1) <= 1, (a <= 0).any(1)
    low, high = np.zeros(len(a)), np.linalg.norm(a * points, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        for _ in range(200):
            middle = 0.5 * (low + high)
            is_low = ((a * points / (a * a + middle[:, None])) ** 2).sum(1) > 1
            low, high = np.where(is_low, middle, low), np.where(is_low, high, middle)
        outside = a * a / (a * a + high[:, None]) * points
    return np.where(inside[:, None], points, np.where(flat[:, None], np.clip(points, -a, a), outside))


def _multipliers(interface, force):
    """Forces l [rows x 3] of which the field has secondary^T l on the secondary side, and what it has there and opposite beside them."""
    S, P = interface.secondary, interface.primary
    l = scipy.sparse.linalg.splu((S @ S.T).tocsc()).solve(S @ -force)
    touched = [np.asarray(abs(W).sum(0)).ravel() > 0 for W in (S, P)]
    beside = [abs(force[nodes] + sign * (W.T @ l)[nodes]).max(initial=0) for W, sign, nodes in zip((S, P), (1, -1), touched)]
    return l, max(beside)


def _contact_errors(scene, found, u, l_ref, u_ref):
    """:param found: (interface, multipliers, what forces they leave) of each interface"""
    angle = math.radians(scene.angle)
    errors = dict.fromkeys(("penetration", "compression", "complementarity", "cone", "slip_law", "opposite"), 0.0)
    for interface, force, beside in found:
        t1 = np.array([math.cos(angle), math.sin(angle), 0])
        axes = np.stack([interface.normal, t1, np.cross(interface.normal, t1)])
        jump, l = (interface.secondary @ u - interface.primary @ u) @ axes.T, force @ axes.T
        s, lT = jump[:, 0] - interface.gap, l[:, 1:]
        bound = scene.slip_bound * interface.area if scene.law == "Tresca" else np.maximum(0.0, l[:, 0])
        semi = bound[:, None] * np.array(scene.friction)
        worst = {"penetration": s / u_ref, "compression": -l[:, 0] / l_ref, "complementarity": np.minimum(l[:, 0] / l_ref, -s / u_ref),
                 "cone": np.linalg.norm(lT - _on_ellipses(lT, semi), axis=1) / l_ref,
                 "slip_law": np.linalg.norm(lT - _on_ellipses(lT + l_ref / u_ref * jump[:, 1:], semi), axis=1) / l_ref,
                 "opposite": np.array([beside / l_ref])}
        errors.update({key: max(errors[key], value.max(initial=0)) for key, value in worst.items()})
    return errors


def clamped_nodes(scene, mesh):
    clamped = np.zeros(len(mesh.coordinates), bool)
    for body in {"all bodies": range(scene.bodies), "lowest body": [0], "contact": []}[scene.held]:
        clamped[elements.faces_of(mesh, f"clamp{body}")] = True
    return clamped


def exchanged_sides(summary):
    """Names of side sets that are secondary though the input says primary."""
    return re.findall(r"exchanged: '(\w+)'", " ".join(summary["model"]["notes"] + summary["model"]["left_out"]))


def certify(scene, mesh, summary, path):
    """The contract's measures of the written field, and the field_equilibrium that the last digits of displacements leave.

    The summary is asked for the formulation and for sides that were exchanged alone.
    """
    u, force = read_fields(path)
    load = elements.areas_of(mesh, f"top{scene.bodies - 1}")[:, None] * (np.array([0, 0, -1.0]) + np.array(scene.pull))
    elastic, rounding = elements.forces(mesh, scene.young, scene.poisson, summary["model"]["formulation"] == "B-bar", u)
    residual = load + force - elastic
    clamped = clamped_nodes(scene, mesh)
    external = max(np.linalg.norm(load), np.linalg.norm(residual[clamped]))
    found = [(item, *_multipliers(item, force)) for item in interfaces.interfaces_of(scene, mesh, clamped, exchanged_sides(summary))]
    u_ref, l_ref = np.linalg.norm(u, axis=1).max(), max(np.linalg.norm(l, axis=1).max(initial=0) for _, l, _ in found)
    l_ref = max(l_ref, 1e-3 * max(np.linalg.norm(load, axis=1).max(), np.linalg.norm(residual[clamped], axis=1).max(initial=0)))
    errors = _contact_errors(scene, found, u, l_ref, u_ref)
    errors["continuity"] = np.abs(u[clamped]).max(initial=0) / u_ref
    errors["field_equilibrium"] = np.linalg.norm(residual[~clamped]) / external
    return errors, np.linalg.norm(rounding[~clamped]) / external


def _motions(x):
    """Rigid motions [3 nodes x 6] about the middle."""
    x = (x - x.mean(0)) / np.ptp(x, 0).max()
    turns = [np.cross(axis, x).ravel() for axis in np.eye(3)]
    return np.stack([*np.tile(np.eye(3), (len(x), 1)).T, *turns], 1)


def _least_imbalance(scene, mesh, exchanged):
    """Resultants on bodies without clamps that no contact force with friction can take, in parts of those of the loads (1-norms).

    A linear programme: ellipses are replaced by polygons around them, so that what it cannot balance nothing can.
    """
    clamped, angle = clamped_nodes(scene, mesh), math.radians(scene.angle)
    load = elements.areas_of(mesh, f"top{scene.bodies - 1}")[:, None] * (np.array([0, 0, -1.0]) + np.array(scene.pull))
    bodies = [np.unique(block.connectivity) for block in mesh.blocks]
    free = [nodes for nodes in bodies if not clamped[nodes].any()]
    R = sparse.hstack([sparse.csr_matrix((_motions(mesh.coordinates[nodes]).ravel(), ((3 * nodes[:, None] + np.arange(3)).repeat(6),
                       np.tile(np.arange(6), 3 * len(nodes)))), (load.size, 6)) for nodes in free])
    columns, sides = [], []
    for item in interfaces.interfaces_of(scene, mesh, clamped, exchanged):
        t1 = np.array([math.cos(angle), math.sin(angle), 0])
        for axis in (item.normal, scene.friction[0] * t1, scene.friction[1] * np.cross(item.normal, t1)):
            columns.append(R.T @ sparse.kron(item.primary - item.secondary, axis[None]).T)
        tangents = np.arange(0, 2 * math.pi, math.pi / 16)
        sides.append(sparse.hstack([sparse.kron(np.stack([-np.ones(32), np.cos(tangents), np.sin(tangents)], 1)[:, [c]], sparse.eye(len(item.area)))
                                    for c in range(3)]))
    A, B, e = sparse.hstack(columns), sparse.block_diag(sides), -R.T @ load.ravel()
    m, n = A.shape
    bounds = [bound for item in sides for bound in [(0, None)] * (item.shape[1] // 3) + [(None, None)] * (item.shape[1] // 3 * 2)] + [(0, None)] * 2 * m
    found = scipy.optimize.linprog(np.r_[np.zeros(n), np.ones(2 * m)], sparse.hstack([B, sparse.csr_matrix((B.shape[0], 2 * m))]), np.zeros(B.shape[0]),
                                   sparse.hstack([A, sparse.eye(m), -sparse.eye(m)]), e, bounds, method="highs")
    return found.fun / np.abs(e).sum()


def has_no_solution(scene, mesh):
    """Whether contact cannot hold the loads; which sides carry multipliers nobody told, so all ways are tried."""
    if scene.held == "all bodies":
        return False
    tops = [f"top{body - 1}" for body in range(1, scene.bodies) if scene.is_mortar(body)]
    ways = itertools.chain.from_iterable(itertools.combinations(tops, k) for k in range(len(tops) + 1))
    return any(_least_imbalance(scene, mesh, way) > 1e-6 for way in ways)
