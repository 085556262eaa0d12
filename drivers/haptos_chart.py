#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures speed against accuracy and draws it: CSV and SVG files, all from one command.

    haptos_chart.py --haptos PROGRAM --scenes-test PROGRAM [--only accuracy|profile|counts|tied]... [--quick]
                    [--folder doc/charts] [--repeats 3] [--time-limit 120] [--redraw] [--png]

accuracy   multiplications by the Hessian F and seconds of the solve, over the measured kkt and over the true error
           of the contact forces (against a solution at 1e-12): accuracy.csv, accuracy_kkt.svg, accuracy_forces.svg
profile    a performance profile over the scenes of scenes_test: profile.csv, profile.svg
counts     the 20 cells of the published scaling table: counts.csv, counts.svg
tied       contact against the same bodies tied together, a linear problem: tied.csv, tied.svg

--quick    fewer tolerances, scenes and cells; asks for a --folder, so that it replaces no complete chart
--redraw   draws from the CSV files that are there and runs nothing
--png      also writes each chart as PNG

All runs are on one rank.  Runs that end without a solution are rows of the CSV and marks in the charts.
Needs the Python packages matplotlib, netCDF4 and numpy.
"""
import argparse
import csv
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import netCDF4
import numpy as np

import haptos_chart_figures as figures

ROOT = pathlib.Path(__file__).resolve().parents[1]
TOLERANCES = tuple(10.0**-e for e in range(2, 11))


def two_beams(k, p):
    return {"Mesh->Two Beams->Subdomains Per Edge": k, "Mesh->Two Beams->Elements Per Subdomain Edge": p}


SCENES = {  # name: input, parameters that differ from it
    "table31 k=2 p=4": ("table31.xml", two_beams(2, 4)),
    "table31 k=3 p=3": ("table31.xml", two_beams(3, 3)),
    "two_beams": ("two_beams.xml", {}),
}

# n_PFP, the multiplications by the Hessian, of Table 3.1 in Dostal, Haslinger, Kozubek, Kucera, "An algorithm for 3D
# contact problems with orthotropic friction": rows k = 1..5 (4 k^3 subdomains), columns p = H/h = 2..5.
PUBLISHED = {1: (180, 269, 356, 470), 2: (483, 657, 665, 847), 3: (636, 878, 906, 1071),
             4: (737, 939, 1173, 1400), 5: (812, 1039, 1533, 1776)}

ACCURACY_COLUMNS = ("scene", "method", "method_used", "tolerance", "status", "reason", "multiplications",
                    "preconditioner_applications", "solve_seconds", "kkt", "force_error")
PROFILE_COLUMNS = ("scene", "method", "method_used", "status", "multiplications", "kkt", "force_error", "remark")
COUNTS_COLUMNS = ("k", "p", "subdomains", "unknowns", "published", "tolerance", "method_used", "status", "multiplications",
                  "kkt", "solve_seconds")

TIED_COLUMNS = ("k", "p", "subdomains", "tolerance", "contact_status", "contact_multiplications", "contact_solve_seconds",
                "tied_method", "tied_status", "tied_multiplications", "tied_solve_seconds", "ratio_multiplications", "ratio_seconds")
SHORT = 0.1  # seconds of solving
TIED_AT = 1e-6


def launch(command, time_limit):
    """Exit status (None where the time limit was hit) and the text on stdout."""
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1",
                   "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    try:
        done = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=time_limit)
    except subprocess.TimeoutExpired:
        return None, ""
    if done.returncode not in (0, 1, 2, 3):
        raise RuntimeError(f"exit status {done.returncode} of {command[0]}: {done.stderr.strip()[:500]}")
    return done.returncode, done.stdout


def solve(options, scene, method, tolerance, result=""):
    """One run of the program: its summary as a dictionary, None where the time limit was hit."""
    name, parameters = scene
    with tempfile.TemporaryDirectory(prefix="haptos_") as folder:
        summary = pathlib.Path(folder) / "summary.json"
        command = [options.haptos, str(ROOT / "inputs" / name), "--summary", str(summary)]
        settings = {**parameters, "Solver->Method": method, "Solver->Relative Tolerance": f"{tolerance:g}",
                    "Solver->Maximum Hessian Multiplications": 20000, "Output->File": result}
        for path, value in settings.items():
            command += ["--set", f"{path}={value}"]
        status, _ = launch(command, options.time_limit)
        if status is None:
            return None
        if not summary.exists():
            raise RuntimeError(f"{name}, {method}, {tolerance:g}: exit status {status} and no summary")
        return json.loads(summary.read_text())


def contact_forces(path):
    """Forces on the nodes [nodes x 3] of the last step of a result file."""
    with netCDF4.Dataset(path) as file:
        names = ["".join(c.decode() for c in row if c).strip("\0 ") for row in np.ma.filled(file["name_nod_var"][:], b"")]
        columns = [names.index("contact_force_" + axis) + 1 for axis in "xyz"]
        return np.stack([np.asarray(file[f"vals_nod_var{column}"][-1]) for column in columns], axis=1)


def force_error(forces, reference):
    """Largest error of a nodal contact force over the largest such force."""
    return np.linalg.norm(forces - reference, axis=1).max() / np.linalg.norm(reference, axis=1).max()


def run_with_forces(options, scene, method, tolerance):
    """The summary of a run and the contact forces; None, None where the time limit was hit."""
    with tempfile.TemporaryDirectory(prefix="haptos_") as folder:
        result = str(pathlib.Path(folder) / "result.exo")
        summary = solve(options, scene, method, tolerance, result)
        return (summary, contact_forces(result)) if summary else (None, None)


def accuracy_row(name, method, tolerance, summary, error):
    row = dict(scene=name, method=method, tolerance=f"{tolerance:g}")
    if summary is None:
        return {**row, "status": "time limit"}
    solver = summary["solver"]
    return {**row, "method_used": solver["method"], "status": solver["status"], "reason": solver["reason"],
            "multiplications": solver["hessian_multiplications"],
            "preconditioner_applications": solver["preconditioner_applications"],
            "solve_seconds": f"{summary['time']['solve']:.4f}",
            "kkt": f"{summary['accuracy']['kkt']:.3e}", "force_error": f"{error:.3e}"}


def measure_scene(options, name, scene, tolerances):
    summary, reference = run_with_forces(options, scene, "Automatic", figures.REFERENCE_TOLERANCE)
    if summary is None:
        raise RuntimeError(f"{name}: no reference within the time limit")
    rows = {"reference": {**accuracy_row(name, "Automatic", figures.REFERENCE_TOLERANCE, summary, 0.0), "method": "reference"}}
    # The other method at the reference's tolerance tells how far the reference itself can be trusted.
    runs = [(method, t) for method in figures.METHODS for t in tolerances] + [("SMALSE", figures.REFERENCE_TOLERANCE)]
    for run in runs * options.repeats:  # in rounds, so that a busy moment of the machine meets all methods alike
        summary, forces = run_with_forces(options, scene, *run)
        row = accuracy_row(name, *run, summary, np.nan if forces is None else force_error(forces, reference))
        if run not in rows or float(row.get("solve_seconds", "inf")) < float(rows[run].get("solve_seconds", "inf")):
            rows[run] = row
            say(row)
    return list(rows.values())


def measure_accuracy(options):
    tolerances = TOLERANCES[::2] if options.quick else TOLERANCES
    scenes = list(SCENES.items())[:2 if options.quick else None]
    return [row for name, scene in scenes for row in measure_scene(options, name, scene, tolerances)]


SCENE_LINE = re.compile(r"^(\S+)\s+exit (\d+)  (.+) (\d+)  kkt (\S+) \(\w+\)  forces (\S+)  u \S+  dense ")


def parse_scene(name, method, status, text):
    """A row of the profile from what scenes_test printed about one scene."""
    row = dict(scene=name, method=method)
    if status is None:
        return {**row, "status": "time limit"}
    lines = text.splitlines()
    failures = [line.split("FAILED", 1)[1].strip() for line in lines if line.startswith("    FAILED")]
    row["remark"] = "; ".join(failures)
    matches = [m for m in map(SCENE_LINE.match, lines) if m and m[1] == name]
    if matches:
        _, exit_status, used, count, kkt, error = matches[0].groups()
        # A count above a promised one is slow, not wrong: the ratio shows it.
        holds = exit_status == "0" and all("promises" in failure for failure in failures)
        return {**row, "method_used": used, "status": "holds" if holds else "does not hold",
                "multiplications": count, "kkt": kkt, "force_error": error}
    ended = [m for m in (re.match(r"^(\S+)\s+exit (\d+)  ", line) for line in lines) if m and m[1] == name]
    if not ended:
        raise RuntimeError(f"scenes_test printed no line of scene {name}")
    return {**row, "status": "does not hold" if failures else f"refused, as meant (exit {ended[0][2]})"}


def measure_profile(options):
    status, text = launch([options.scenes_test, "--list"], options.time_limit)
    names = [line for line in text.splitlines() if re.fullmatch(r"[A-Za-z]\S*", line)]
    if status != 0 or not names:
        raise RuntimeError("scenes_test --list printed no scenes")
    rows = []
    for name, method in [(n, m) for n in (names[:12] if options.quick else names) for m in figures.METHODS]:
        # One scene a run, so that the time limit takes no other scene with it.
        command = [options.scenes_test, "--scene", name, "--method", method]
        rows.append(parse_scene(name, method, *launch(command, options.time_limit)))
        say(rows[-1])
    return rows


def measure_counts(options):
    rows = []
    for k, p, tolerance in [(k, p, t) for k in options.k for p in figures.P_VALUES for t in figures.COUNTED_AT]:
        summary = solve(options, ("table31.xml", two_beams(k, p)), "Automatic", tolerance)
        row = accuracy_row(None, None, tolerance, summary, np.nan)
        row |= dict(k=k, p=p, subdomains=4 * k**3, published=PUBLISHED[k][figures.P_VALUES.index(p)])
        row |= dict(unknowns=summary["model"]["primal_unknowns"]) if summary else {}
        rows.append(row)
        say(rows[-1])
    return rows


def best_of_runs(options, scenes, tolerance):
    """Of every scene the summary of the run with the shortest solve, None where the time limit was hit.

    In rounds, so that a busy moment of the machine meets all scenes alike; three times as many where all of them
    take no time worth mentioning, since those are disturbed most.
    """
    rounds = []
    while len(rounds) < options.repeats or (len(rounds) < 3 * options.repeats and took(rounds[-1]) < SHORT):
        rounds.append([solve(options, scene, "Automatic", tolerance) for scene in scenes])
    return [None if None in runs else min(runs, key=lambda summary: summary["time"]["solve"]) for runs in zip(*rounds)]


def took(summaries):
    return sum(SHORT if summary is None else summary["time"]["solve"] for summary in summaries)


def tied_columns(name, summary):
    if summary is None:
        return {f"{name}_status": "time limit"}
    return {f"{name}_status": summary["solver"]["status"], f"{name}_multiplications": summary["solver"]["hessian_multiplications"],
            f"{name}_solve_seconds": f"{summary['time']['solve']:.4f}"}


def measure_tied(options):
    """Contact with friction against the bonded interface, by PCPG, at the same tolerance of kkt."""
    rows = []
    for k, p in [(k, p) for k in options.k for p in figures.P_VALUES]:
        beams = two_beams(k, p)
        contact, tied = best_of_runs(options, [("table31.xml", beams), ("table31.xml", {**beams, "Contact->interface->Friction->Law": "Tied"})],
                                     TIED_AT)
        row = dict(k=k, p=p, subdomains=4 * k**3, tolerance=f"{TIED_AT:g}", tied_method=tied["solver"]["method"] if tied else "")
        row |= tied_columns("contact", contact) | tied_columns("tied", tied)
        if contact and tied:
            row["ratio_multiplications"] = f"{row['contact_multiplications'] / row['tied_multiplications']:.3f}"
            row["ratio_seconds"] = f"{contact['time']['solve'] / tied['time']['solve']:.3f}"
        rows.append(row)
        say(row)
    return rows


def say(row):
    print(", ".join(str(value) for value in row.values() if value not in ("", None, "nan")), flush=True)


def save(figure, options, name):
    figure.savefig(options.folder / f"{name}.svg", metadata={"Date": None})
    if options.png:
        figure.savefig(options.folder / f"{name}.png", dpi=110)
    figures.close(figure)


def make(options, part):
    measure, columns = {"accuracy": (measure_accuracy, ACCURACY_COLUMNS), "profile": (measure_profile, PROFILE_COLUMNS),
                        "counts": (measure_counts, COUNTS_COLUMNS), "tied": (measure_tied, TIED_COLUMNS)}[part]
    path = options.folder / f"{part}.csv"
    if not options.redraw:
        rows = measure(options)
        with open(path, "w", newline="") as file:
            writer = csv.DictWriter(file, columns, restval="", extrasaction="ignore", lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
    rows = list(csv.DictReader(path.read_text().splitlines()))
    if part == "accuracy":
        save(figures.draw_accuracy(rows, "kkt", "kkt reached"), options, "accuracy_kkt")
        save(figures.draw_accuracy(rows, "force_error", "true error of the contact forces"), options, "accuracy_forces")
    else:
        save({"profile": figures.draw_profile, "counts": figures.draw_counts, "tied": figures.draw_tied}[part](rows), options, part)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--haptos", default=str(ROOT / "build/release/bin/haptos"))
    parser.add_argument("--scenes-test", default=str(ROOT / "build/release/bin/scenes_test"))
    parser.add_argument("--only", action="append", choices=("accuracy", "profile", "counts", "tied"))
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--k", type=int, nargs="+", choices=PUBLISHED, help="cells of counts and tied; all of them, or 1 2 if --quick")
    parser.add_argument("--folder", type=pathlib.Path)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--time-limit", type=float, default=120.0, metavar="SECONDS", help="of one run")
    parser.add_argument("--redraw", action="store_true")
    parser.add_argument("--png", action="store_true")
    options = parser.parse_args()
    if options.quick and options.folder is None and not options.redraw:
        parser.error("--quick needs a --folder, so that it does not replace the complete charts")
    options.k = options.k or ([1, 2] if options.quick else list(PUBLISHED))
    options.repeats = 1 if options.quick else max(1, options.repeats)
    options.folder = options.folder or ROOT / "doc" / "charts"
    options.folder.mkdir(parents=True, exist_ok=True)
    figures.style()
    try:
        for part in options.only or ("accuracy", "profile", "counts", "tied"):
            make(options, part)
    except (RuntimeError, OSError) as error:
        print(f"haptos_chart: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
