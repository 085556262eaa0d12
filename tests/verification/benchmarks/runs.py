# SPDX-License-Identifier: BSD-3-Clause
"""Runs of the program on a benchmark's scene, and its results as arrays."""
import dataclasses
import json
import pathlib
import sys

import netCDF4
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "tests" / "regression"), str(ROOT / "drivers")]
from haptos_grids import write_mesh  # noqa: E402
from haptos_runs import displacement, programs, run_haptos, xml_of  # noqa: E402,F401


class BenchmarkError(Exception):
    """A run did not end as it should."""


@dataclasses.dataclass
class Result:
    """Arrays of the result file [nodes (x 3)] and its summary; body: number of the block of every node, from 0.

    blocks: their shape and connectivity [elements x nodes]
    """
    summary: dict
    x: np.ndarray
    body: np.ndarray
    fields: dict
    blocks: list

    def vector(self, name):
        return np.stack([self.fields[f"{name}_{axis}"] for axis in "xyz"], axis=1)

    @property
    def multiplications(self):
        return self.summary["solver"]["hessian_multiplications"]

    @property
    def unknowns(self):
        return self.summary["model"]["primal_unknowns"]

    def pressures(self, body=None):
        """Nodes with a multiplier [indices]; they have a normal force or a status and a pressure of their own."""
        on = self.fields["contact_status"] > 0.5
        return np.flatnonzero(on if body is None else on & (self.body == body))

    def contact_force(self, body):
        """Sum of the contact forces on a body [3]."""
        return self.vector("contact_force")[self.body == body].sum(axis=0)


def material(blocks, young, poisson):
    return {"Element Blocks": list(blocks), "Young's Modulus": float(young), "Poisson's Ratio": float(poisson)}


def contact(secondary, primary, friction=None, direction=(1.0, 0.0, 0.0), **more):
    entry = {"Secondary Side Set": secondary, "Primary Side Set": primary, **more}
    if friction is not None:
        entry["Friction"] = {"Law": "Coulomb", "Coefficients": [float(f) for f in friction], "Principal Direction": [float(d) for d in direction]}
    return entry


def solve(folder, bodies, materials, conditions, contacts, tolerance=1e-8, node_sets=None, subdomains=0, statuses=(0,)):
    """Writes mesh and input to the folder, runs the program there, and reads its answer."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    write_mesh(folder / "mesh.exo", bodies, node_sets)
    scene = {"Mesh": {"File": "mesh.exo"}, "Decomposition": {"Subdomains": subdomains}, "Materials": materials,
             "Boundary Conditions": conditions, "Contact": contacts, "Solver": {"Relative Tolerance": float(tolerance)},
             "Output": {"File": "result.exo", "Summary": "summary.json"}}
    (folder / "scene.xml").write_text(xml_of(scene))
    return run(folder, statuses=statuses)


def run(folder, *arguments, scene="scene.xml", statuses=(0,)):
    outcome = run_haptos([scene, *arguments], folder=folder, timeout=1800)
    if outcome.status not in statuses:
        raise BenchmarkError(f"status {outcome.status} in {folder}\n{outcome.out[-2000:]}\n{outcome.err[-2000:]}")
    return read(folder)


def read(folder, result="result.exo", summary="summary.json"):
    folder = pathlib.Path(folder)
    with netCDF4.Dataset(folder / result) as file:
        x = np.stack([np.ma.filled(file[f"coord{a}"][:]) for a in "xyz"], axis=1)
        body, blocks = np.zeros(len(x), dtype=int), []
        for k in range(len(file.dimensions["num_el_blk"])):
            connect = file[f"connect{k + 1}"]
            blocks.append((connect.elem_type, np.ma.filled(connect[:]) - 1))
            body[np.unique(blocks[-1][1])] = k
        names = ["".join(c.decode() for c in row if c and c != b"\0").strip() for row in np.ma.filled(file["name_nod_var"][:], b"\0")]
        fields = {name: np.ma.filled(file[f"vals_nod_var{k + 1}"][-1]) for k, name in enumerate(names)}
    return Result(json.loads((folder / summary).read_text()), x, body, fields, blocks)
