# SPDX-License-Identifier: BSD-3-Clause
"""Runs of haptos_scaling.py: launched here, or by a batch script of Slurm."""
import csv
import json
import math
import os
import pathlib
import shlex
import subprocess
import sys
import tempfile

KEPT = ("haptos", "machine", "model", "time", "time_over_ranks", "memory", "local", "coarse", "communication")  # of a summary, in scaling.json
COUNTED = ("reductions", "other_collectives", "messages", "bytes_sent")


class Failure(Exception):
    """One message for the user."""


def processors(summary):
    """Of all machines that had ranks, as many as on that of rank 0."""
    return summary["machine"]["processors"] * summary["machine"]["hosts"]


def read_cells(path):
    """[[k, p, ranks]] of a file with a cell on every line."""
    cells = []
    for number, line in enumerate(path.read_text().splitlines(), 1):
        words = line.split("#")[0].replace(",", " ").split()
        if not words:
            continue
        try:
            k, p, ranks = map(int, words)
        except ValueError:
            raise Failure(f"--cells {path}: line {number}: '{line.strip()}' is not k, p and ranks: three whole numbers") from None
        cells.append([k, p, ranks])
    if not cells:
        raise Failure(f"--cells {path}: no cell in it")
    return cells


def counts_of(summary):
    """What does not change from run to run."""
    solve = summary["communication"]["largest_of_phase"]["solve"]
    return [summary["solver"]["hessian_multiplications"], *(solve[name] for name in COUNTED)]


class Runner:
    """Runs cells (k, p, ranks), each as often as is asked for."""

    def __init__(self, options):
        self.options, self.known = options, {}

    def run(self, k, p, ranks):
        """Summaries of the runs of a cell."""
        if (k, p, ranks) not in self.known:
            runs = [self.launch(k, p, ranks) for _ in range(self.options.repeat)]
            for again in runs[1:]:
                if counts_of(again) != counts_of(runs[0]):
                    raise Failure(f"k = {k}, p = {p} on {ranks} ranks: counts {counts_of(runs[0])}, repeated {counts_of(again)}")
            self.known[k, p, ranks] = runs
        return self.known[k, p, ranks]

    def report(self):
        """Of every run what seconds depend on, and the seconds."""
        return [{"k": k, "p": p, **{name: run[name] for name in KEPT}} for (k, p, _), runs in self.known.items() for run in runs]

    def command(self, k, p, ranks, path):
        settings = [f"Mesh->Two Beams->Subdomains Per Edge={max(k, 1)}", f"Mesh->Two Beams->Elements Per Subdomain Edge={p}", "Output->File="]
        if k == 0:
            settings += ["Decomposition->Method=METIS", f"Decomposition->Subdomains={self.options.parts}"]
        command = [*shlex.split(self.options.launcher), "-n", str(ranks), self.options.haptos, self.options.input, "--summary", str(path)]
        for text in settings + self.options.set:
            command += ["--set", text]
        return command

    def launch(self, k, p, ranks):
        told = f"k = {k}, p = {p} on {ranks} ranks: "
        # In the folder of the results: the ranks of a cluster share that one, and no /tmp.
        with tempfile.TemporaryDirectory(prefix="haptos_", dir=self.options.folder) as folder:
            path = pathlib.Path(folder).resolve() / "summary.json"
            environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMPI_MCA_mpi_yield_when_idle": "1",
                           "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
            try:
                done = subprocess.run(self.command(k, p, ranks, path), capture_output=True, text=True, env=environment,
                                      timeout=self.options.time_limit)
            except subprocess.TimeoutExpired:
                raise Failure(f"{told}not done within {self.options.time_limit:g} s (--time-limit)") from None
            if done.returncode not in (0, 2) or not path.exists():
                lines = [line for line in done.stderr.splitlines() if line.startswith("haptos: ")] or done.stderr.split("\n")
                raise Failure(f"{told}exit status {done.returncode}: {lines[0].strip()[:300]}")
            summary = json.loads(path.read_text())
            if "communication" not in summary:
                raise Failure(f"--haptos {self.options.haptos}: does not count MPI calls; haptos_counting does")
            return summary


def without_batch_options(words):
    """The command line of the job: without what asked for the batch script, and without a launcher."""
    kept, skips = [], 0
    for word in words:
        name = word.split("=")[0]
        if skips:
            skips -= 1
        elif name in ("--slurm", "--sbatch", "--launcher", "--mpirun"):
            skips = 0 if "=" in word else 1
        else:
            kept.append(word)
    return kept


def batch_script(options, cells):
    """One job for all runs, one after the other, with room for the largest and time for all."""
    minutes = math.ceil(options.time_limit * options.repeat * len(cells) / 60)
    lines = ["#!/bin/bash", "#SBATCH --job-name=haptos_scaling", f"#SBATCH --ntasks={max(ranks for _, _, ranks in cells)}",
             f"#SBATCH --time={minutes}", "#SBATCH --cpus-per-task=1", *(f"#SBATCH {text}" for text in options.sbatch)]
    command = [sys.executable, str(pathlib.Path(__file__).resolve().parent / "haptos_scaling.py"), *without_batch_options(sys.argv[1:]),
               "--launcher", "srun"]
    return "\n".join([*lines, f"cd {shlex.quote(os.getcwd())}", shlex.join(command)]) + "\n"


def write_csv(path, columns, rows):
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
