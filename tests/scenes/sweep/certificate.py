# SPDX-License-Identifier: BSD-3-Clause
"""Checks an answer from its file alone: own stiffness, own loads, own law; nothing of the library."""
import math

import netCDF4
import numpy as np
import scipy.sparse as sparse

_CORNERS = np.array([(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)])


def read_fields(path):
    """displacement and contact_force [nodes x 3] of the file's last step."""
    with netCDF4.Dataset(path) as file:
        names = [b"".join(row.compressed()).decode() for row in file["name_nod_var"][:]]
        values = {name: np.array(file[f"vals_nod_var{i}"][-1]) for i, name in enumerate(names, start=1)}
    return tuple(np.stack([values[f"{field}_{axis}"] for axis in "xyz"], 1) for field in ("displacement", "contact_force"))


def _gradients(x, shape):
    """Gradients of the shape functions [points x elements x nodes x 3] and the points' volumes [points x elements]."""
    if shape == "TETRA4":
        local = [np.array([(-1, -1, -1), (1, 0, 0), (0, 1, 0), (0, 0, 1)], float)]
        weights = [1 / 6]
    else:
        points = _CORNERS / math.sqrt(3)
        local = [np.stack([_CORNERS[:, d] / 8 * np.prod([1 + _CORNERS[:, e] * p[e] for e in range(3) if e != d], axis=0) for d in range(3)], 1)
                 for p in points]
        weights = [1.0] * 8
    jacobians = [np.einsum("enx,nd->exd", x, g) for g in local]
    return (np.stack([g @ np.linalg.inv(J) for g, J in zip(local, jacobians)]),
            np.stack([w * np.linalg.det(J) for w, J in zip(weights, jacobians)]))


def stiffness(mesh, young, poisson):
    """Sum over points of volume * (lambda g_i g_j^T + mu (g_j g_i^T + g_i . g_j I)), sparse [3 nodes]^2."""
    rows, columns, values = [], [], []
    for block, E, nu in zip(mesh.blocks, young, poisson):
        nodes = block.connectivity
        g, volume = _gradients(mesh.coordinates[nodes], block.shape)
        lame, mu = E * nu / (1 + nu) / (1 - 2 * nu), E / 2 / (1 + nu)
        K = np.einsum("peia,pejb->eiajb", volume[..., None, None] * lame * g, g, optimize=True) + np.einsum("peib,peja->eiajb", volume[..., None, None] * mu * g, g, optimize=True)
        K += np.einsum("eij,ab->eiajb", np.einsum("peid,pejd->eij", volume[..., None, None] * mu * g, g, optimize=True), np.eye(3))
        dofs = (3 * nodes[:, :, None] + np.arange(3)).reshape(len(nodes), -1)
        rows.append(np.repeat(dofs, dofs.shape[1], 1).ravel())
        columns.append(np.tile(dofs, dofs.shape[1]).ravel())
        values.append(K.ravel())
    n = mesh.coordinates.size
    return sparse.csr_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), (n, n))


def areas_of(mesh, sides, name):
    """Nodal areas [nodes] of a side set of plane triangles or rectangles."""
    side_set = next(s for s in mesh.side_sets if s.name == name)
    all_nodes = [(block.shape, row) for block in mesh.blocks for row in block.connectivity]
    area = np.zeros(len(mesh.coordinates))
    for element, side in zip(side_set.elements, side_set.sides):
        shape, row = all_nodes[element]
        nodes = row[list(sides[shape][side - 1])]
        x = mesh.coordinates[nodes]
        size = np.linalg.norm(np.cross(x[1] - x[0], x[-1] - x[0])) * (0.5 if len(nodes) == 3 else 1.0)
        area[nodes] += size / len(nodes)
    return area


def _ellipse(point, semi_axes):
    """Euclidean projection of one point, by bisection of the multiplier."""
    a = np.array(semi_axes, float)
    if ((point == 0) | (a > 0)).all() and np.sum(np.divide(point, a, out=np.zeros(2), where=a > 0) ** 2) <= 1:
        return point
    if (a <= 0).any():
        return np.clip(point, -a, a)
    low, high = 0.0, np.linalg.norm(a * point)
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if np.sum((a * point / (a * a + middle)) ** 2) > 1 else (low, middle)
    return a * a / (a * a + high) * point


def _pairs(mesh, scene, sides):
    """(secondary nodes, primary nodes or None, nodal areas) of every interface, matched by place."""
    result = []
    for body in range(0 if scene.plane else 1, scene.bodies):
        area = areas_of(mesh, sides, f"bottom{body}")
        secondary = np.flatnonzero(area)
        if body == 0:
            result.append((secondary, None, area[secondary]))
            continue
        primary = np.flatnonzero(areas_of(mesh, sides, f"top{body - 1}"))
        order = [nodes[np.lexsort(np.round(mesh.coordinates[nodes, :2], 9).T)] for nodes in (secondary, primary)]
        result.append((order[0], order[1], area[order[0]]))
    return result


def _contact_errors(scene, pairs, u, force, u_ref, l_ref):
    angle = math.radians(scene.angle)
    n, t1 = np.array([0, 0, -1.0]), np.array([math.cos(angle), math.sin(angle), 0])
    axes = np.stack([n, t1, np.cross(n, t1)])
    errors = dict.fromkeys(("penetration", "compression", "complementarity", "cone", "slip_law", "opposite"), 0.0)
    for secondary, primary, area in pairs:
        jump = u[secondary] - (0 if primary is None else u[primary])
        f = -force[secondary]
        if primary is not None:
            errors["opposite"] = max(errors["opposite"], abs(force[secondary] + force[primary]).max() / l_ref)
        for (s, *sT), (l, *lT), a in zip(jump @ axes.T, f @ axes.T, area):
            s, lT, sT = s - (scene.gap if primary is not None else 0), np.array(lT), np.array(sT)
            semi = np.array(scene.friction) * (scene.slip_bound * a if scene.law == "Tresca" else max(0.0, l))
            found = {"penetration": s / u_ref, "compression": -l / l_ref, "complementarity": min(l / l_ref, -s / u_ref),
                     "cone": np.linalg.norm(lT - _ellipse(lT, semi)) / l_ref,
                     "slip_law": np.linalg.norm(lT - _ellipse(lT + l_ref / u_ref * sT, semi)) / l_ref}
            errors.update({key: max(errors[key], value) for key, value in found.items()})
    return errors


def certify(scene, mesh, sides, path):
    """The contract's measures of the written field; clamped pairs, whose forces nobody knows, are left out."""
    u, force = read_fields(path)
    top = areas_of(mesh, sides, f"top{scene.bodies - 1}")
    load = top[:, None] * (np.array([0, 0, -1.0]) + np.array(scene.pull))
    residual = load + force - (stiffness(mesh, scene.young, scene.poisson) @ u.ravel()).reshape(-1, 3)
    clamped = np.zeros(len(u), bool)
    for body in {"all bodies": range(scene.bodies), "lowest body": [0], "contact": []}[scene.held]:
        clamped |= areas_of(mesh, sides, f"clamp{body}") > 0
    external = max(np.linalg.norm(load), np.linalg.norm(residual[clamped]))
    u_ref, l_ref = np.linalg.norm(u, axis=1).max(), np.linalg.norm(force, axis=1).max()
    l_ref = max(l_ref, 1e-3 * max(np.linalg.norm(load, axis=1).max(), np.linalg.norm(residual[clamped], axis=1).max(initial=0)))
    pairs = []
    for secondary, primary, area in _pairs(mesh, scene, sides):
        known = ~(clamped[secondary] & (True if primary is None else clamped[primary]))
        pairs.append((secondary[known], None if primary is None else primary[known], area[known]))
    errors = _contact_errors(scene, pairs, u, force, u_ref, l_ref)
    errors["continuity"] = np.abs(u[clamped]).max(initial=0) / u_ref
    errors["field_equilibrium"] = np.linalg.norm(residual[~clamped]) / external
    return errors
