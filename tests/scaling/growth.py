#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""How time and memory grow with the mesh, and what a second rank gains: two beams on METIS subdomains of constant size.

    growth.py [--elements 12 24 48] [--ranks 1 2] [--repeat 2] [--rest 8] [--side-by-side] [--haptos PROGRAM]

N elements a unit length, 4 N^3 in all; unknowns are counted with their copies, memory without that of a program without
work. Every run starts after the same rest. A virtual machine gives memory that lies free back to its host, within a second or
two, and gets it again at 1 to 4 s a gigabyte: without a rest a small run, repeated, is given the warm pages of the one before,
which a large one never is, and the two are not to be compared. Of `--repeat` rounds over all sizes the fastest of each size
counts. Not part of ctest.

Cores of a shared host are no constant: two of them may give twice the work of one, or half as much more. With --side-by-side
every round also starts as many one-rank runs at once as there are ranks: what they get through, against one alone, is what
that machine, at that time, gives a program that never waits.
"""
import argparse
import contextlib
import json
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE / "peers"))
from compare import INPUT, ONE_THREAD, two_beams  # noqa: E402

GAINS = ("factor", "solve", "total")
PHASES = ("read", "decompose", "assemble", "factor", "coarse", "solve", "recover", "write", "total")


def command_of(options, n, ranks, folder):
    command = [] if ranks == 1 else ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", str(ranks)]
    command += [options.haptos, str(INPUT), "--summary", os.path.join(folder, "s.json"), "--output", os.path.join(folder, "r.exo")]
    return command + two_beams(1, n)


def run(options, n, ranks, at_once=1):
    """Summaries of runs that start together, after a rest."""
    time.sleep(options.rest)
    with contextlib.ExitStack() as stack:
        folders = [stack.enter_context(tempfile.TemporaryDirectory()) for _ in range(at_once)]
        started = [subprocess.Popen(command_of(options, n, ranks, folder), env={**os.environ, **ONE_THREAD}, stdout=subprocess.DEVNULL,
                                    stderr=subprocess.PIPE, text=True) for folder in folders]
        errors = [process.communicate()[1] for process in started]
        for process, error in zip(started, errors):
            if process.returncode != 0:
                sys.exit("growth: N = %d on %d ranks: exit status %d: %s" % (n, ranks, process.returncode, error.strip()[:300]))
        return [json.loads(pathlib.Path(folder, "s.json").read_text()) for folder in folders]


def line_of(n, ranks, runs, base):
    """Fastest seconds of every phase, and what does not change from run to run; `base`: megabytes of a program without work."""
    first = runs[0]
    seconds = {phase: min(r["time"][phase] for r in runs) for phase in PHASES}
    unknowns, memory = first["model"]["primal_unknowns"], sum(first["memory"]["peak_rss_mb"]) - base
    print("%3d %5d %9d %6d %5d |" % (n, ranks, unknowns, first["model"]["subdomains"], first["solver"]["hessian_multiplications"]),
          " ".join("%6.2f" % seconds[phase] for phase in PHASES[1:]), "| %8.1f %8.2f" %
          (1e6 * seconds["total"] / unknowns, memory * 2**20 / 1e3 / unknowns), flush=True)
    return {"seconds": seconds, "perUnknown": seconds["total"] / unknowns, "memory": memory / unknowns, "runs": runs}


def report(options, table, beside):
    least, most = min(options.elements), max(options.elements)
    for ranks in options.ranks:
        small, large = table[least, ranks], table[most, ranks]
        if least < most:
            print("N = %d to %d on %d ranks: time per unknown grows by %.2f (goal 1.4), memory per unknown by %.2f (goal 1.2)" %
                  (least, most, ranks, large["perUnknown"] / small["perUnknown"], large["memory"] / small["memory"]))
    base = min(options.ranks)
    for n in options.elements:
        for ranks in sorted(set(options.ranks) - {base}):
            one, many = table[n, base]["seconds"], table[n, ranks]["seconds"]
            print("N = %d: %d ranks are faster than %d by" % (n, ranks, base), told(one[phase] / many[phase] for phase in GAINS))
            one, many = table[n, base]["runs"], table[n, ranks]["runs"]
            gains = [[a["time"][phase] / b["time"][phase] for a, b in zip(one, many)] for phase in GAINS]
            print("    round by round (medians of %d):" % len(one), told(map(statistics.median, gains)))
            if (n, ranks) in beside:
                gains = [[ranks * a["time"][phase] / max(b["time"][phase] for b in group) for a, group in zip(one, beside[n, ranks])]
                         for phase in GAINS]
                print("    %d runs side by side get through as much more than one alone:" % ranks, told(map(statistics.median, gains)))


def told(gains):
    return ", ".join("%.2f in %s" % (gain, phase) for gain, phase in zip(gains, GAINS))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--haptos", default=str(HERE.parents[1] / "build/release/bin/haptos"))
    parser.add_argument("--elements", type=int, nargs="+", default=[12, 24, 48])
    parser.add_argument("--ranks", type=int, nargs="+", default=[1])
    parser.add_argument("--repeat", type=int, default=2)
    parser.add_argument("--rest", type=float, default=8.0, metavar="SECONDS")
    parser.add_argument("--side-by-side", action="store_true")
    options = parser.parse_args()
    if options.side_by_side and 1 not in options.ranks:
        parser.error("--side-by-side compares with one rank; give --ranks 1, too")
    if min(options.elements + options.ranks + [options.repeat]) < 1 or options.rest < 0:
        parser.error("elements, ranks and repeats must be at least 1, the rest at least 0 seconds")
    if not shutil.which(options.haptos):
        parser.error("--haptos %s: no such program; build it (./bootstrap.sh build) or name it" % options.haptos)
    if max(options.ranks) > 1 and not shutil.which("mpirun"):
        parser.error("--ranks %d needs mpirun, which is not there" % max(options.ranks))
    runs, beside = {}, {}
    for _ in range(options.repeat):
        for n in options.elements:
            for ranks in options.ranks:
                runs.setdefault((n, ranks), []).extend(run(options, n, ranks))
                if options.side_by_side and ranks > 1:
                    beside.setdefault((n, ranks), []).append(run(options, n, 1, at_once=ranks))
    base = {ranks: sum(run(options, 1, ranks)[0]["memory"]["peak_rss_mb"]) for ranks in options.ranks}
    print("  N ranks  unknowns   subd  mult | " + " ".join("%6s" % phase[:6] for phase in PHASES[1:]) + " [s] | us/unkn kB/unkn")
    report(options, {key: line_of(*key, found, base[key[1]]) for key, found in runs.items()}, beside)


if __name__ == "__main__":
    main()
