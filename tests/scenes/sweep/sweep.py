#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draws random scenes, runs them, checks each answer independently of the library, and prints a distribution and the worst.

    sweep.py --haptos PROGRAM [--mpirun "mpirun --oversubscribe"] [--seed 1] [--count 100] [--only INDEX...] [--ranks 1 2 3]
             [--families basic|wide] [--no-tied] [--method Automatic] [--most F] [--limit 600] [--cheap 60] [--csv FILE] [--keep FOLDER]

A scene holds if it ends with status 0 and all measures of the written field are at most ten tolerances, with F on all
ranks within 2 % + 2 of each other, or with status 3 on all of them where no contact forces balance the loads, or with 2
where what the last digits of the displacements hide is more than the tolerance: forces are balanced to three times that then, or
to ten tolerances, and the other measures are as ever.  --only reproduces scenes by their number.  Each scene is also
solved with its surfaces tied, for what contact costs beside that.
--limit: processor time of a run.  --cheap: more ranks only where the solution on the first number of them took no longer.
--csv adds a line a scene to a table, from which sweep_page.py makes doc/sweep.md.
"""
import argparse
import csv
import dataclasses
import json
import os
import pathlib
import resource
import shlex
import signal
import subprocess
import sys
import tempfile

try:
    import numpy as np

    import certificate
    import random_scenes
except ImportError as missing:
    print(f"not run: {missing}")
    sys.exit(77)

ALLOWED = 10  # tolerances
ALLOWED_OF_DIGITS = 3  # times what digits hide, a root mean square


def drawing(families):
    if families == "basic":
        return random_scenes.draw
    try:
        import wide_scenes
    except ImportError as missing:  # gmsh, which the others do not need
        print(f"not run: {missing}")
        sys.exit(77)
    return wide_scenes.draw


def run(arguments, path, ranks):
    """Exit status and summary, or the message where there is none."""
    summary = path.with_suffix(f".{ranks}.json")
    summary.unlink(missing_ok=True)
    command = [arguments.haptos, path, "--output", path.with_suffix(".result.exo"), "--summary", summary, "--set",
               f"Solver->Method={arguments.method}"]
    if ranks > 1:
        command = [*shlex.split(arguments.mpirun), "-n", str(ranks), *command]
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
                   "OMPI_MCA_mpi_yield_when_idle": "1"}
    before = os.times().children_user
    limit = (arguments.limit, arguments.limit)
    done = subprocess.run(command, capture_output=True, text=True, env=environment, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, limit))
    if done.returncode == -signal.SIGKILL:
        return None, {"message": f"more than {arguments.limit} s of processor time"}
    if not summary.exists():
        return done.returncode, {"message": (done.stderr.strip().splitlines() or [""])[-1]}
    result = json.loads(summary.read_text())
    # of processor time, which tells more than the clock where others work too
    result["solve_seconds"] = (os.times().children_user - before) * result["time"]["solve"] / result["time"]["total"]
    return done.returncode, result


def examine(arguments, index, folder):
    """One scene on all ranks: a row of results."""
    scene = drawing(arguments.families)(arguments.seed, index)
    path = scene.write(folder, f"scene{index}")
    row = {"index": index, "family": scene.family, "scene": scene.describe(), "F": [], "status": [], "why": [], "errors": {}, "pairs": 0,
           "seconds": 0.0, **dict.fromkeys(("rounding", "solves", "tied_F", "tied_seconds", "tied_solves"), "")}
    for ranks in arguments.ranks:
        if row["status"] and (None in row["status"] or row["seconds"] > arguments.cheap):
            break
        status, summary = run(arguments, path, ranks)
        row["status"].append(status)
        if "solver" not in summary:
            row["why"].append(f"{ranks} ranks: status {status}, {summary['message']}" if status != 3 else "")
            continue
        row["F"].append(summary["solver"]["hessian_multiplications"])
        row["pairs"] = summary["model"]["contact_pairs"]
        if ranks == arguments.ranks[0]:
            row["seconds"], row["solves"] = summary["solve_seconds"], summary["solver"]["local_solves"]
        if status not in (0, 2):
            row["why"].append(f"{ranks} ranks: status {status}")
            continue
        errors, row["rounding"] = certificate.certify(scene, random_scenes.mesh_of(scene), summary, path.with_suffix(".result.exo"))
        row["errors"] = {key: max(value, row["errors"].get(key, 0)) for key, value in errors.items()}
        if status != 0 and row["rounding"] <= scene.tolerance:
            row["why"].append(f"{ranks} ranks: status {status}, {summary['solver']['reason'].split('; raise')[0]}")
    if not arguments.no_tied and row["status"][0] == 0:
        row.update(tied(arguments, scene, folder, f"scene{index}.tied"))
    judge(scene, row, arguments)
    return row


def tied(arguments, scene, folder, name):
    """What the same scene costs with its surfaces bonded; nothing where that is no problem of its own."""
    status, summary = run(arguments, dataclasses.replace(scene, law="Tied").write(folder, name), arguments.ranks[0])
    if status != 0:
        return {}
    return {"tied_F": summary["solver"]["hessian_multiplications"], "tied_seconds": summary["solve_seconds"],
            "tied_solves": summary["solver"]["local_solves"]}


def allowed(measure, scene, row):
    digits = row["rounding"] if measure == "field_equilibrium" and 2 in row["status"] else 0.0
    return max(ALLOWED * scene.tolerance, ALLOWED_OF_DIGITS * digits)


def judge(scene, row, arguments):
    for key, value in row["errors"].items():
        if not value <= allowed(key, scene, row):
            row["why"].append(f"{key} {value:.1e}")
    if set(row["status"]) == {3} and not certificate.has_no_solution(scene, random_scenes.mesh_of(scene)):
        row["why"].append("status 3, but there are contact forces in balance")
    if row["F"] and max(row["F"]) > 1.02 * min(row["F"]) + 2:
        row["why"].append("F depends on the ranks")
    if len(set(row["status"])) > 1:
        row["why"].append("the status depends on the ranks")
    if arguments.most and row["F"] and max(row["F"]) > arguments.most:
        row["why"].append(f"more than {arguments.most} multiplications")
    row["why"] = [why for why in row["why"] if why]


def distribution(rows):
    """Lines of text about the rows that were solved."""
    counts = np.array([max(row["F"]) for row in rows if row["F"] and not any(row["status"])])
    if len(counts) == 0:
        return ["none solved"]
    fields = np.array([row["errors"]["field_equilibrium"] for row in rows if row["errors"]])
    return [f"{len(rows)} scenes: {len(counts)} solved, {sum(row['status'][0] == 3 for row in rows)} without a solution, "
            f"{sum(bool(row['why']) for row in rows)} do not hold",
            f"multiplications: median {np.median(counts):.0f}, 90th percentile {np.percentile(counts, 90):.0f}, largest {counts.max()}",
            f"equilibrium of the written field: median {np.median(fields):.1e}, 90th percentile {np.percentile(fields, 90):.1e}, "
            f"largest {fields.max():.1e}"]


def table(rows):
    lines = ["| scene | what | pairs | F | field equilibrium | remarks |", "|---|---|---|---|---|---|"]
    for row in rows:
        field = f"{row['errors']['field_equilibrium']:.0e}" if row["errors"] else ""
        lines.append(f"| {row['index']} | {row['scene']} | {row['pairs']} | {', '.join(map(str, row['F']))} | {field} | {'; '.join(row['why'])} |")
    return lines


def add_to(path, seed, row):
    """One line of the table `sweep_page.py` reads; the first brings the names of the columns."""
    cells = {"seed": seed, "index": row["index"], "scene": row["scene"], "pairs": row["pairs"], "F": " ".join(map(str, row["F"])),
             "status": " ".join(map(str, row["status"])), "field_equilibrium": row["errors"].get("field_equilibrium", ""),
             "largest_error": max(row["errors"].values(), default=""), "remarks": "; ".join(row["why"]),
             **{key: row[key] for key in ("family", "rounding", "seconds", "solves", "tied_F", "tied_seconds", "tied_solves")}}
    is_new = not path.exists()
    with path.open("a", newline="") as file:
        writer = csv.DictWriter(file, cells)
        if is_new:
            writer.writeheader()
        writer.writerow(cells)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--haptos", required=True)
    parser.add_argument("--mpirun", default="mpirun --oversubscribe")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--only", type=int, nargs="*")
    parser.add_argument("--ranks", type=int, nargs="*", default=[1])
    parser.add_argument("--families", default="basic", choices=("basic", "wide"))
    parser.add_argument("--no-tied", action="store_true")
    parser.add_argument("--method", default="Automatic")
    parser.add_argument("--most", type=int, default=0)
    parser.add_argument("--limit", type=int, default=600)
    parser.add_argument("--cheap", type=float, default=60)
    parser.add_argument("--csv", type=pathlib.Path)
    parser.add_argument("--keep", type=pathlib.Path)
    arguments = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.keep or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for index in arguments.only or range(arguments.count):
            rows.append(examine(arguments, index, folder))
            print(*table(rows[-1:])[2:], flush=True)
            if arguments.csv:
                add_to(arguments.csv, arguments.seed, rows[-1])
    print(*distribution(rows), sep="\n")
    return 1 if any(row["why"] for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
