# SPDX-License-Identifier: BSD-3-Clause
"""Checks an answer from its file alone: own stiffness, own loads, own rows, own law; nothing of the library."""
import math
import re

import netCDF4
import numpy as np
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


def certify(scene, mesh, summary, path):
    """The contract's measures of the written field.  The summary is asked for the formulation and for sides that were exchanged alone."""
    u, force = read_fields(path)
    load = elements.areas_of(mesh, f"top{scene.bodies - 1}")[:, None] * (np.array([0, 0, -1.0]) + np.array(scene.pull))
    K = elements.stiffness(mesh, scene.young, scene.poisson, summary["model"]["formulation"] == "B-bar")
    residual = load + force - (K @ u.ravel()).reshape(-1, 3)
    clamped = clamped_nodes(scene, mesh)
    external = max(np.linalg.norm(load), np.linalg.norm(residual[clamped]))
    exchanged = re.findall(r"exchanged: '(\w+)'", " ".join(summary["model"]["notes"] + summary["model"]["left_out"]))
    found = [(item, *_multipliers(item, force)) for item in interfaces.interfaces_of(scene, mesh, clamped, exchanged)]
    u_ref, l_ref = np.linalg.norm(u, axis=1).max(), max(np.linalg.norm(l, axis=1).max(initial=0) for _, l, _ in found)
    l_ref = max(l_ref, 1e-3 * max(np.linalg.norm(load, axis=1).max(), np.linalg.norm(residual[clamped], axis=1).max(initial=0)))
    errors = _contact_errors(scene, found, u, l_ref, u_ref)
    errors["continuity"] = np.abs(u[clamped]).max(initial=0) / u_ref
    errors["field_equilibrium"] = np.linalg.norm(residual[~clamped]) / external
    return errors
