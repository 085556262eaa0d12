#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What the busiest rank does of all work, by counters: two beams in METIS parts on more ranks than there may be processors.

    busiest_rank.py --haptos COUNTING_PROGRAM [--mpirun "COMMAND"] --elements N [N ...] --ranks R [R ...]

Bounds are of elements, multiplications in factors and bytes of factors read, and of the coarse problem's multiplications and numbers read.
Exit status: 0, 1 if one of them is broken.
"""
import argparse
import csv
import pathlib
import subprocess
import sys
import tempfile

DRIVER = pathlib.Path(__file__).resolve().parents[2] / "drivers" / "haptos_scaling.py"
LOCAL = {2: 0.55, 8: 0.15, 64: 0.025}
COARSE = {2: 0.6, 8: 0.25, 64: 0.1}
BOUNDS = {"elements": LOCAL, "factor_flops": LOCAL, "factor_bytes_read": LOCAL, "coarse_flops": COARSE, "coarse_entries_read": COARSE}


def run(options, elements, folder):
    cells = [word for ranks in options.ranks for word in ("--cell", 0, elements, ranks)]
    subprocess.run([sys.executable, DRIVER, "--haptos", options.haptos, "--launcher", options.mpirun, "--folder", folder,
                    *map(str, cells)], check=True)
    return list(csv.DictReader((pathlib.Path(folder) / "scaling.csv").read_text().splitlines()))


def shares(row):
    """(name, share, bound) of what a build counts; without CHOLMOD neither multiplications nor a shared coarse factor."""
    counted = float(row["factor_flops_share"] or 0) > 0
    for name, bounds in BOUNDS.items():
        if counted or name in ("elements", "factor_bytes_read"):
            yield name, float(row[f"{name}_share"]), bounds[int(row["ranks"])]


def main():
    parser = argparse.ArgumentParser(allow_abbrev=False, description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--haptos", required=True)
    parser.add_argument("--mpirun", default="mpirun --oversubscribe")
    parser.add_argument("--elements", nargs="+", type=int, required=True)
    parser.add_argument("--ranks", nargs="+", type=int, default=list(LOCAL), choices=list(LOCAL))
    options = parser.parse_args()
    broken = 0
    for elements in options.elements:
        with tempfile.TemporaryDirectory(prefix="haptos_") as folder:
            rows = run(options, elements, folder)
        print(f"\nN = {elements}: the busiest rank's part of all")
        for row in rows:
            parts = list(shares(row))
            wrong = [name for name, share, bound in parts if not share <= bound]
            if row["status"] != "converged" or not all(share * int(row["ranks"]) > 0.999 for _, share, _ in parts):
                wrong.append(f"not credible: {row}")
            print(f"{row['ranks']:>4} ranks:", ", ".join(f"{name} {share:.3f} (at most {bound:g})" for name, share, bound in parts), *wrong)
            broken += len(wrong)
    print("broken bounds:", broken)
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
