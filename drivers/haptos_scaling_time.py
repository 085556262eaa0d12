#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A model of a run's seconds on many ranks: formulas for work and messages (doc/scaling.md), rates measured here.

    haptos_scaling_time.py [--haptos PROGRAM] [--launcher COMMAND] [--repeat N] [--latency SECONDS] [--link BYTES_PER_SECOND]
                           [--folder FOLDER] [--quick | --redraw]

Measures bandwidth, dense products, messages (haptos_scaling_rates.py, on one rank and on all processors), runs two beams of METIS parts,
and takes from one run on one rank what work an element is and which part of the machine's rates its phases reach. Then the formulas stand
beside counters of 1 to 64 ranks, and beside seconds where every rank has a processor (scaling_model_check.csv), and tell runs on 64 to 1e5
ranks (scaling_model.csv, .svg). Between machines latency and link are the options'. About eight minutes and 8 GB; NumPy, mpi4py, matplotlib.

Exit status: 0, or 1 for wrong input or a run that failed.
"""
import argparse
import csv
import dataclasses
import json
import math
import os
import pathlib
import shlex
import subprocess
import sys

from haptos_scaling_model import counts_factors, faces_of_boxes
from haptos_scaling_run import Failure, Runner, processors, write_csv

ROOT = pathlib.Path(__file__).resolve().parents[1]
SOLVES, SET_UPS = 6, 14       # coarse solves a multiplication, coarse matrices a run
VECTORS = 2.2                 # through B a multiplication, and through B^T
RAGGED = 3                    # times the faces of cubes
REDUCTIONS = 21               # a multiplication, beside those of coarse solves
REPLICATED = 1500             # coarse unknowns: `Replicated Up To`
COARSE_FLOPS = 65             # times l^2: multiplications in factors of a run
COARSE_ENTRIES = 20           # times l^(4/3): read in a solve
SHARED = 3                    # times as many of both, of all ranks, where they share a factor
FRONTS = 6.5                  # times l^(2/3): unknowns of a rank's fronts, between ranks and in contact; squared, 4 bytes a set-up
COARSE_RATE = 1 / 8           # of dense products, in multiplications
NEIGHBOURS = 26               # of a compact set of subdomains
PARTS = ("mesh", "factor", "local", "neighbours", "reductions", "coarse_work", "coarse_payload")
COLUMNS = ("case", "ranks", "unknowns", "coarse_unknowns", *PARTS, "total")
CHECKED = ("elements", "ranks", "quantity", "model", "measured", "ratio")
CELLS = [(24, 1), (12, 1), (12, 2), (24, 2), (24, 4), (24, 8), (24, 16), (24, 64), (48, 1), (48, 2), (48, 8), (48, 64)]   # elements an edge, ranks
LARGE_PARTS = 31              # instead of 307 at 24 elements an edge
SMALL = 24                    # elements an edge of meshes that run again with --repeat


@dataclasses.dataclass
class Work:
    """What one run on one rank tells: work an element, and what its phases make of the machine."""
    part: float               # elements of a subdomain
    multiplications: int
    unknowns: float           # an element, as the next two
    flops: float
    bytes: float              # of factors, a multiplication
    mesh: float               # seconds an element: reading, cutting, assembling, recovering
    factor: float             # share of dense products
    solve: float              # share of the bandwidth, with all that goes by vectors


def coarse_seconds(run):
    return run["coarse"]["set_up_seconds"] + run["coarse"]["solve_seconds"]


def told_seconds(run):
    """By phase, as the model has them."""
    time = run["time"]
    return {"mesh": sum(time[phase] for phase in ("read", "decompose", "assemble", "recover")), "factor": time["factor"],
            "solve": time["coarse"] + time["solve"] - coarse_seconds(run), "coarse": coarse_seconds(run)}


def work_of(run, rates):
    if not counts_factors(run):
        raise Failure("this haptos is built without CHOLMOD, and multiplications of KLU2's factors are not counted; build it with CHOLMOD")
    local, count, seconds = run["local"], run["solver"]["hessian_multiplications"], told_seconds(run)
    elements = local["elements_all"]
    return Work(part=elements / run["model"]["subdomains"], multiplications=count, unknowns=run["model"]["primal_unknowns"] / elements,
                flops=local["flops_all"] / elements, bytes=local["bytes_read_all"] / elements / count, mesh=seconds["mesh"] / elements,
                factor=local["flops_all"] / seconds["factor"] / rates["flops"],
                solve=local["bytes_read_all"] / seconds["solve"] / rates["bandwidth"])


def quantities(work, elements, ranks):
    """What the busiest rank does, holds and sends in a run."""
    busiest = (1 + 0.05 * math.log2(ranks)) / ranks
    l, count = 6 * elements / work.part, work.multiplications
    shared = ranks > 1 and l > REPLICATED
    coarse = SHARED * busiest if shared else 1
    faces = RAGGED * faces_of_boxes(elements, work.part, ranks)
    return {"elements": elements * busiest, "factor flops": work.flops * elements * busiest,
            "factor bytes read": count * work.bytes * elements * busiest, "bytes of B and B^T": 2 * VECTORS * count * faces, "coarse unknowns": l,
            "coarse multiplications": COARSE_FLOPS * l ** 2 * coarse, "coarse entries read": SOLVES * count * COARSE_ENTRIES * l ** (4 / 3) * coarse,
            "coarse fronts": FRONTS * l ** (2 / 3) if shared else 0,
            "bytes of coarse fronts": 4 * SET_UPS * FRONTS ** 2 * l ** (4 / 3) / ranks if shared else 0,
            "bytes of coarse solves": (ranks > 1) * SOLVES * count * 8 * l * (2 if shared else 1),
            "reductions": (ranks > 1) * count * (REDUCTIONS + SOLVES * (3 + math.log2(ranks) if shared else 1))}


def seconds(work, rates, elements, ranks):
    """Of a run, by PARTS; `rates`: of a rank among so many."""
    q, depth, latency, link = quantities(work, elements, ranks), math.log2(ranks), rates["latency"], rates["link"]
    calls = 2 * VECTORS * work.multiplications * min(NEIGHBOURS, ranks - 1)
    trees = 2 * depth * latency                          # up and down; a shared factor's groups are smaller from one to the next
    groups = SOLVES * work.multiplications * depth * (depth + 1) * latency if q["coarse fronts"] else 0
    simple = work.multiplications * (REDUCTIONS + SOLVES * (3 if q["coarse fronts"] else 1)) * trees
    fronts = ranks * q["bytes of coarse fronts"]         # by broadcasts: what one rank sends the others get
    return {"mesh": work.mesh * q["elements"], "factor": q["factor flops"] / (rates["flops"] * work.factor),
            "local": q["factor bytes read"] / (rates["bandwidth"] * work.solve),
            "neighbours": q["bytes of B and B^T"] / link + calls * latency, "reductions": groups + simple,
            "coarse_work": q["coarse multiplications"] / (rates["flops"] * COARSE_RATE) + 8 * q["coarse entries read"] / rates["bandwidth"],
            "coarse_payload": (2 * q["bytes of coarse solves"] + fronts) / link}


def cases(small, large):
    """(name, work, elements on so many ranks)."""
    rank, mesh = 40 * small.part, 4 * 256 ** 3
    return [(f"{text}, parts of {work.part:.0f} elements", work, elements) for text, elements in
            ((f"{rank:.0f} elements a rank", lambda ranks: rank * ranks), (f"one mesh of {mesh / 1e6:.0f} million elements", lambda ranks: mesh))
            for work in (small, large)]


def predict(small, large, rates):
    rows = []
    for name, work, elements in cases(small, large):
        for ranks in (64, 250, 1000, 2500, 10000, 30000, 100000):
            parts = seconds(work, rates, elements(ranks), ranks)
            rows.append(dict(case=name, ranks=ranks, unknowns=round(work.unknowns * elements(ranks)),
                             coarse_unknowns=round(quantities(work, elements(ranks), ranks)["coarse unknowns"]),
                             **{key: f"{value:.4f}" for key, value in parts.items()}, total=f"{sum(parts.values()):.4f}"))
    return rows


def counters(run):
    """What the program counted of `quantities`; the fullest rank's."""
    local, coarse, sent = run["local"], run["coarse"], run["communication"]
    shared = coarse["factors"] == 1 < run["haptos"]["ranks"]
    jumps = sum(sent[name]["over_ranks"]["message_bytes"]["max"] for name in ("jump", "jump_transposed"))
    return {"elements": local["elements"], "factor flops": local["flops"], "factor bytes read": local["bytes_read"], "bytes of B and B^T": jumps,
            "coarse unknowns": coarse["unknowns"], "coarse multiplications": coarse["flops"], "coarse entries read": coarse["entries_read"],
            "coarse fronts": (coarse["between"] + coarse["last"]) * shared,
            "bytes of coarse fronts": coarse["set_up_bytes"] * shared,
            "bytes of coarse solves": coarse["solve_bytes"], "reductions": sent["largest_of_phase"]["solve"]["reductions"]}


def check(work, rates_of, runs):
    """Rows of CHECKED, at as many multiplications as the run took; seconds where every rank had a processor."""
    rows, work_of_parts = [], work
    for (n, ranks, _), run in runs.items():
        elements = run["local"]["elements_all"]
        work = dataclasses.replace(work_of_parts, multiplications=run["solver"]["hessian_multiplications"])
        pairs = [(name, value, counters(run)[name]) for name, value in quantities(work, elements, ranks).items()]
        if ranks <= processors(run):
            parts, told = seconds(work, rates_of(ranks), elements, ranks), told_seconds(run)
            model = {"mesh": parts["mesh"], "factor": parts["factor"], "solve": sum(parts[key] for key in ("local", "neighbours", "reductions")),
                     "coarse": parts["coarse_work"] + parts["coarse_payload"]}
            pairs += [(f"seconds: {name}", model[name], told[name]) for name in model]
            pairs.append(("seconds: all", sum(parts.values()), sum(told.values())))
        rows += [dict(elements=n, ranks=ranks, quantity=name, model=f"{a:.5g}", measured=f"{b:.5g}", ratio=f"{a / b:.2f}")
                 for name, a, b in pairs if a > 0 or b > 0]
    return rows


def measure_rates(options, ranks):
    command = [*shlex.split(options.launcher), "-n", str(ranks), sys.executable, str(pathlib.Path(__file__).with_name("haptos_scaling_rates.py"))]
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=options.time_limit)
    if done.returncode:
        raise Failure(f"rates on {ranks} ranks: {(done.stderr.strip().splitlines() or ['no message'])[-1]}")
    return json.loads(done.stdout.splitlines()[-1])


def better(first, second):
    """Of what was measured at two times: another program may have had the processors at one of them."""
    return {name: (min if name in ("latency", "reduction") else max)(value, second.get(name, value)) for name, value in first.items()}


class Measurements:
    """Of every cell (elements an edge, ranks, parts) the fastest run; of a number of ranks the best rates, measured after every run that has processors."""

    def __init__(self, options):
        self.options, self.runs, self.rates, self.processors = argparse.Namespace(**{**vars(options), "repeat": 1}, set=[]), {}, {}, 1

    def run(self, cell):
        n, ranks, parts = cell
        self.options.parts = parts
        run = Runner(self.options).run(0, n, ranks)[0]
        self.runs[cell] = min(self.runs.get(cell, run), run, key=lambda r: sum(told_seconds(r).values()))
        self.processors = processors(run)
        if ranks <= self.processors:
            self.rates[ranks] = better(measure_rates(self.options, ranks), self.rates.get(ranks, {}))

    def run_all(self, cells, rounds):
        """Round by round, as other programs come and go; large meshes once, and ranks beyond the processors, of which only counts are looked at."""
        for first in [True] + [False] * (rounds - 1):
            for cell in cells:
                if first or (cell[1] <= self.processors and cell[0] <= SMALL):
                    self.run(cell)


def draw(rows, path):
    import haptos_scaling_chart
    haptos_scaling_chart.draw_model(rows, PARTS, path)


def study(options):
    cells = [(n, ranks, 0) for n, ranks in ([(6, 1), (6, 2)] if options.quick else CELLS)]
    coarser = (*cells[0][:2], 2 if options.quick else LARGE_PARTS)
    measured = Measurements(options)
    measured.run_all([*cells, coarser], options.repeat)
    most = max(measured.rates)
    for rates in measured.rates.values():
        print(json.dumps(rates))
    large = work_of(measured.runs.pop(coarser), measured.rates[1])
    small = work_of(measured.runs[cells[0]], measured.rates[1])
    for work in (small, large):
        print(work)
    checked = check(small, lambda ranks: measured.rates[min(most, ranks)], measured.runs)
    rows = predict(small, large, {**measured.rates[most], "latency": options.latency, "link": options.link})
    for columns, table, name in ((CHECKED, checked, "scaling_model_check.csv"), (COLUMNS, rows, "scaling_model.csv")):
        write_csv(options.folder / name, columns, table)
        print("\n" + "  ".join(columns))
        for row in table:
            print("  ".join(str(row[column]) for column in columns))
    draw(rows, options.folder / "scaling_model.svg")


def parse():
    parser = argparse.ArgumentParser(prog="haptos_scaling_time", allow_abbrev=False, description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--haptos", default=str(ROOT / "build/release/bin/haptos_counting"))
    parser.add_argument("--input", default=str(ROOT / "inputs/table31.xml"), help="an input with Mesh->Two Beams")
    parser.add_argument("--launcher", default="mpirun --oversubscribe --bind-to none", metavar="COMMAND")
    parser.add_argument("--repeat", type=int, default=1, metavar="N", help="rounds of the small meshes whose ranks have processors; the fastest counts")
    parser.add_argument("--time-limit", type=float, default=1800.0, metavar="SECONDS", help="of one run")
    parser.add_argument("--latency", type=float, default=2e-6, help="seconds a message between machines")
    parser.add_argument("--link", type=float, default=2e9, help="bytes a second that a rank sends between machines")
    parser.add_argument("--folder", type=pathlib.Path, default=ROOT / "doc" / "charts")
    parser.add_argument("--quick", action="store_true", help="two tiny meshes")
    parser.add_argument("--redraw", action="store_true", help="draws from scaling_model.csv and runs nothing")
    options = parser.parse_args()
    if options.latency <= 0 or options.link <= 0 or options.repeat < 1:
        raise Failure("--latency, --link and --repeat must be positive")
    options.folder.mkdir(parents=True, exist_ok=True)
    return options


def main():
    try:
        options = parse()
        if options.redraw:
            with open(options.folder / "scaling_model.csv", newline="") as file:
                draw(list(csv.DictReader(file)), options.folder / "scaling_model.svg")
        else:
            study(options)
    except (Failure, OSError, ImportError) as error:
        print(f"haptos_scaling_time: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
