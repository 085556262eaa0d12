#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Strong and weak scaling over ranks and subdomains: runs haptos by mpirun on the two-beams benchmark.

    haptos_scaling.py [--study NAME]... [--haptos PROGRAM] [--launcher COMMAND] [--repeat N] [--folder FOLDER] [--draw] [--quick]
    haptos_scaling.py --cell K P RANKS ...      one run (or several: repeat --cell), with the formulas beside the counters
    haptos_scaling.py --cells FILE ...          the same of a file: k, p and ranks on every line; # begins a comment
    haptos_scaling.py ... --slurm FILE          writes a batch script that does it by srun, and runs nothing
    haptos_scaling.py --redraw [--folder FOLDER]

Studies (all without --study):
  ranks-strong       one mesh on more and more ranks
  ranks-weak         about 32 subdomains a rank
  subdomains-strong  one mesh in more and more subdomains, one rank
  subdomains-weak    more and more subdomains of the same size, one rank
  ranks-metis        one mesh in METIS parts: work of the busiest rank, as a part of all
  formulas           1 to 64 ranks: messages, bytes and the coarse problem against the formulas of doc/scaling.md

Prints a table and writes scaling.csv (and scaling_formulas.csv) to the folder; --draw adds scaling.svg (needs matplotlib).
A cell with k = 0 is a mesh of p elements an edge in METIS parts (--parts N: so many), compared with bounds.
scaling.json has every run, repeated ones too: seconds of every phase by rank (min, mean, max), machine, MPI, BLAS, commit.
Of repeated runs the fastest is in the table; efficiencies are seconds times ranks an unknown, against the first row of a study.
Ranks beyond the processors are marked with *: their seconds mean nothing; their counts, bytes and memory do.
Exit status: 0, 1 for wrong input or a run that failed, 2 if a formula and its counter disagree.
"""
import argparse
import json
import pathlib
import shlex
import shutil
import statistics
import sys

import haptos_scaling_model as model
from haptos_scaling_run import Failure, Runner, batch_script, processors, read_cells, write_csv

ROOT = pathlib.Path(__file__).resolve().parents[1]
PHASES = ("read", "decompose", "assemble", "factor", "coarse", "solve", "recover", "write", "total")
SHARES = {"elements": ("local", "elements"), "factor_flops": ("local", "flops"), "factor_bytes_read": ("local", "bytes_read"),
          "coarse_flops": ("coarse", "flops"), "coarse_entries_read": ("coarse", "entries_read")}
COLUMNS = ("study", "k", "p", "ranks", "oversubscribed", "subdomains", "unknowns", "dual_unknowns", "method", "status",
           "multiplications", "preconditioner_applications", "reductions", "reductions_per_multiplication",
           "largest_reductions_of_a_step", "other_collectives", "messages", "mbytes_sent", "kbytes_sent_per_multiplication",
           "kbytes_of_jumps_per_multiplication", "coarse_unknowns", "coarse_factors", "coarse_set_ups", "coarse_set_up_seconds",
           "coarse_solve_seconds", "coarse_mbytes", "memory_mb", "bytes_per_unknown", *(f"{name}_seconds" for name in PHASES),
           *(f"{name}_share" for name in SHARES), "runs", "median_total_seconds", "solve_efficiency", "total_efficiency")
FORMULA_COLUMNS = ("k", "p", "ranks", "quantity", "formula", "measured", "agrees")

STUDIES = {  # (k, p, ranks)
    "ranks-strong": [(4, 3, r) for r in (1, 2, 4, 8, 16)],
    "ranks-weak": [(2, 3, 1), (3, 3, 3), (4, 3, 8), (5, 3, 16)],
    "subdomains-strong": [(k, 12 // k, 1) for k in (1, 2, 3, 4, 6)],
    "subdomains-weak": [(k, 4, 1) for k in (1, 2, 3, 4, 5, 6)],
    "ranks-metis": [(0, 24, r) for r in (1, 2, 8, 16, 64)],
    "formulas": [(2, 2, r) for r in (1, 2, 3, 4)] + [(4, 2, r) for r in (1, 2, 4, 8, 16, 32, 64)],
}
QUICK = {"ranks-strong": [(1, 2, r) for r in (1, 2)], "ranks-weak": [(1, 2, 1), (2, 2, 3)],
         "subdomains-strong": [(1, 4, 1), (2, 2, 1)], "subdomains-weak": [(1, 2, 1), (2, 2, 1)],
         "ranks-metis": [(0, 6, 1), (0, 6, 3)], "formulas": [(1, 2, 2), (2, 2, 3)]}


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise Failure(f"{message}; see --help")


def largest_step(history):
    """Most reductions between two entries of the history: those of one step of the method."""
    counts = [entry["reductions"] for entry in history]
    return max((b - a for a, b in zip(counts, counts[1:])), default=0)


def most_of_jumps(sent):
    """Bytes that B and B^T let the busiest rank send; of more ranks than are listed, those of both maxima."""
    jump, transposed = sent["jump"], sent["jump_transposed"]
    if "message_bytes" in jump:
        return max(a + b for a, b in zip(jump["message_bytes"], transposed["message_bytes"]))
    return sum(block["over_ranks"]["message_bytes"]["max"] for block in (jump, transposed))


def efficiency(phase, summary, first):
    """Seconds times ranks an unknown, of the first run of a study over this one's."""
    def cost(s):
        return s["time"][phase] * s["haptos"]["ranks"] / s["model"]["primal_unknowns"]
    return cost(first) / max(cost(summary), 1e-300)


def row_of(study, cell, runs, first, base_memory):
    """A line of the table: of the fastest of `runs`; `first`: the fastest of the study's first cell."""
    summary = fastest(runs)
    k, p, ranks = cell
    solver, coarse, time = summary["solver"], summary["coarse"], summary["time"]
    sent = summary["communication"]
    solve, memory = sent["largest_of_phase"]["solve"], memory_of(summary)
    multiplications = max(1, solver["hessian_multiplications"])
    oversubscribed = int(ranks > processors(summary))
    row = dict(study=study, k=k, p=p, ranks=ranks, oversubscribed=oversubscribed,
               subdomains=summary["model"]["subdomains"], unknowns=summary["model"]["primal_unknowns"],
               dual_unknowns=summary["model"]["dual_unknowns"], method=solver["method"], status=solver["status"],
               multiplications=solver["hessian_multiplications"],
               preconditioner_applications=solver["preconditioner_applications"], reductions=solve["reductions"],
               reductions_per_multiplication=f"{solve['reductions'] / multiplications:.1f}",
               largest_reductions_of_a_step=largest_step(solver["history"]), other_collectives=solve["other_collectives"],
               messages=solve["messages"], mbytes_sent=f"{solve['bytes_sent'] / 1e6:.4f}",
               kbytes_sent_per_multiplication=f"{solve['bytes_sent'] / 1e3 / multiplications:.2f}",
               kbytes_of_jumps_per_multiplication=f"{most_of_jumps(sent) / 1e3 / multiplications:.2f}",
               coarse_unknowns=coarse["unknowns"], coarse_factors=coarse["factors"], coarse_set_ups=coarse["set_ups"],
               coarse_set_up_seconds=f"{coarse['set_up_seconds']:.4f}", coarse_solve_seconds=f"{coarse['solve_seconds']:.4f}",
               coarse_mbytes=f"{(coarse['set_up_bytes'] + coarse['solve_bytes']) / 1e6:.4f}", memory_mb=f"{memory:.1f}",
               bytes_per_unknown=f"{max(0.0, memory - base_memory) * 2**20 / summary['model']['primal_unknowns']:.0f}")
    row.update({f"{name}_seconds": f"{time[name]:.4f}" for name in PHASES})
    for name, (block, key) in SHARES.items():  # of the busiest rank, of all
        everything = summary[block][f"{key}_all"]
        row[f"{name}_share"] = f"{summary[block][key] / everything:.4f}" if everything else ""
    row.update(runs=len(runs), median_total_seconds=f"{statistics.median(run['time']['total'] for run in runs):.4f}")
    for phase in ("solve", "total"):  # seconds of ranks that wait for a processor tell nothing
        row[f"{phase}_efficiency"] = "" if oversubscribed else f"{efficiency(phase, summary, first):.3f}"
    return row


def fastest(runs):
    return min(runs, key=lambda summary: summary["time"]["total"])


def memory_of(summary):
    """Megabytes of all ranks."""
    return summary["memory"]["over_ranks"]["peak_rss_mb"]["mean"] * summary["haptos"]["ranks"]


HEADER = ("ranks  subd   p  unknowns   mult | decomp assemb factor coarse  solve  total [s] | reductions  /mult /step"
          " messages  MB sent | MB memory  B/unknown | efficiency: solve, total")


def line_of(row):
    seconds = [float(row[f"{name}_seconds"]) for name in ("decompose", "assemble", "factor", "coarse", "solve", "total")]
    mark = "*" if row["oversubscribed"] else " "
    times = " ".join(f"{s:6.2f}" for s in seconds)
    failed = "" if row["status"] == "converged" else f"  {row['status']}"
    return (f"{row['ranks']:4d}{mark} {row['subdomains']:5d} {row['p']:3d} {row['unknowns']:9d}  {row['multiplications']:5d} | {times}"
            f"     | {row['reductions']:10d} {float(row['reductions_per_multiplication']):6.1f} {row['largest_reductions_of_a_step']:5d}"
            f" {row['messages']:8d} {float(row['mbytes_sent']):8.3f} | {float(row['memory_mb']):9.0f} {row['bytes_per_unknown']:>10s}"
            f" | {row['solve_efficiency'] or '-':>17s}  {row['total_efficiency'] or '-':>5s}{failed}")


def measure(runner, studies):
    rows = []
    for study, cells in studies.items():
        print(f"\n{study}\n{HEADER}", flush=True)
        for cell in cells:
            base = memory_of(runner.run(1, 1, cell[2])[0])  # with next to nothing in it: program, libraries, MPI
            rows.append(row_of(study, cell, runner.run(*cell), fastest(runner.run(*cells[0])), base))
            print(line_of(rows[-1]), flush=True)
    if any(row["oversubscribed"] for row in rows):
        print("\n* more ranks than processors: seconds mean nothing, counts, bytes and memory do")
    return rows


def compare_formulas(runner, cells):
    print("\nformulas of doc/scaling.md against the counters\n   k   p ranks  quantity                               formula     measured")
    rows = []
    for k, p, ranks in cells:
        for pair in model.compare(fastest(runner.run(k, p, ranks)), k, p):
            rows.append(dict(k=k, p=p, ranks=ranks, quantity=pair[0], formula=pair[1], measured=pair[2],
                             agrees="yes" if model.agrees(pair) else "NO"))
            print(f"{k:4d} {p:3d} {ranks:5d}  {pair[0]:34s} {pair[1]:11d}  {pair[2]:11d}  {rows[-1]['agrees']}", flush=True)
    return rows


def parse():
    parser = Parser(prog="haptos_scaling", allow_abbrev=False, description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--study", action="append", choices=tuple(STUDIES))
    parser.add_argument("--cell", action="append", default=[], nargs=3, type=int, metavar=("K", "P", "RANKS"))
    parser.add_argument("--cells", type=pathlib.Path, metavar="FILE")
    parser.add_argument("--haptos", default=str(ROOT / "build/release/bin/haptos_counting"))
    parser.add_argument("--input", default=str(ROOT / "inputs/table31.xml"), help="an input with Mesh->Two Beams")
    parser.add_argument("--launcher", "--mpirun", default="mpirun --oversubscribe --bind-to none", metavar="COMMAND",
                        help="starts ranks, whose number it takes by -n: mpirun, srun")
    parser.add_argument("--slurm", type=pathlib.Path, metavar="FILE", help="write a batch script that does the same, and run nothing")
    parser.add_argument("--sbatch", action="append", default=[], metavar="OPTION", help="a further line #SBATCH OPTION in it: --sbatch=--exclusive")
    parser.add_argument("--parts", type=int, default=0, metavar="N", help="METIS parts of cells with k = 0, all together; 0: by their size")
    parser.add_argument("--repeat", type=int, default=1, metavar="N", help="runs of every cell")
    parser.add_argument("--set", action="append", default=[], metavar="PATH=VALUE", help="passed on to haptos")
    parser.add_argument("--folder", type=pathlib.Path)
    parser.add_argument("--time-limit", type=float, default=900.0, metavar="SECONDS", help="of one run")
    parser.add_argument("--quick", action="store_true", help="tiny meshes; asks for a --folder")
    parser.add_argument("--draw", action="store_true")
    parser.add_argument("--redraw", action="store_true", help="draws from the CSV that is there and runs nothing")
    parser.add_argument("--png", action="store_true", help="also draws a PNG")
    options = parser.parse_args()
    check(options)
    return options


def check(options):
    if options.cells:
        options.cell = options.cell + read_cells(options.cells)
    if (options.quick or options.cell) and options.folder is None:
        raise Failure("--quick, --cell and --cells need a --folder, so that they do not replace the complete tables")
    for k, p, ranks in options.cell:
        if k < 0 or min(p, ranks) < 1:
            raise Failure(f"--cell {k} {p} {ranks}: subdomains per edge (0: METIS parts), elements per subdomain edge and ranks must be positive")
    if options.parts < 0:
        raise Failure(f"--parts {options.parts}: must not be negative")
    if options.time_limit <= 0:
        raise Failure(f"--time-limit {options.time_limit:g}: must be positive")
    if options.repeat < 1:
        raise Failure(f"--repeat {options.repeat}: must be at least 1")
    if options.sbatch and not options.slurm:
        raise Failure("--sbatch tells what --slurm writes; give that, too")
    if not options.redraw:
        if not shutil.which(options.haptos):
            raise Failure(f"--haptos {options.haptos}: no such program; build it (./bootstrap.sh build) or name it")
        if not options.slurm and (not options.launcher.split() or not shutil.which(shlex.split(options.launcher)[0])):
            raise Failure(f"--launcher {options.launcher}: no such program")
    options.folder = options.folder or ROOT / "doc" / "charts"
    options.folder.mkdir(parents=True, exist_ok=True)


def draw(options):
    try:
        import haptos_scaling_chart
    except ImportError as error:
        raise Failure(f"drawing needs the Python package {error.name}")
    path = options.folder / "scaling.csv"
    if not path.exists():
        raise Failure(f"{path}: not there; run the studies first")
    haptos_scaling_chart.draw(path, options.folder / "scaling", options.png)


def chosen_studies(options):
    if options.cell:
        return {"cells": [tuple(cell) for cell in options.cell]}
    chosen = QUICK if options.quick else STUDIES
    return {name: chosen[name] for name in options.study or STUDIES}


def run(options, studies):
    compared = [cell for name in ("formulas", "ranks-metis", "cells") for cell in studies.get(name, [])]
    tables = {name: cells for name, cells in studies.items() if name != "formulas"}
    runner = Runner(options)
    try:
        if tables:
            write_csv(options.folder / "scaling.csv", COLUMNS, measure(runner, tables))
        rows = compare_formulas(runner, compared) if compared else []
    finally:
        (options.folder / "scaling.json").write_text(json.dumps(runner.report(), indent=1) + "\n")
    if rows:
        write_csv(options.folder / "scaling_formulas.csv", FORMULA_COLUMNS, rows)
    if options.draw:
        draw(options)
    return 2 if any(row["agrees"] == "NO" for row in rows) else 0


def main():
    try:
        options = parse()
        if options.redraw:
            draw(options)
            return 0
        studies = chosen_studies(options)
        if options.slurm:
            options.slurm.write_text(batch_script(options, [cell for cells in studies.values() for cell in cells]))
            print(f"{options.slurm}: written; sbatch {options.slurm} runs it")
            return 0
        return run(options, studies)
    except (Failure, OSError) as error:
        print(f"haptos_scaling: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
