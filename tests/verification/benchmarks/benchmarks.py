#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the benchmarks and writes a page for each, with its plot, and their index.

    benchmarks.py --haptos PROGRAM [--only NAME]... [--output doc/verification] [--work FOLDER]

Needs numpy, scipy, netCDF4 and matplotlib.  Ends with status 1 where a benchmark misses its tolerance.
"""
import argparse
import functools
import json
import pathlib
import shutil
import sys
import tempfile

import calculix
import cgs4
import crack
import hertz
import partial_slip
import refinement
import rings
from pages import table
from runs import programs

PAGES = {"cgs4": cgs4.page, "rings": rings.page, "hertz_sphere": functools.partial(hertz.page, "sphere"),
         "hertz_cylinder": functools.partial(hertz.page, "cylinder"), "cattaneo": partial_slip.cattaneo, "oblique": partial_slip.oblique,
         "crack": crack.page, "calculix": calculix.page, "refinement": refinement.page}
DOCUMENTATION = pathlib.Path(__file__).resolve().parents[3] / "doc" / "verification"


def write_index(output):
    """Of all pages that were ever written here: their results are kept in results.json."""
    kept = json.loads((output / "results.json").read_text())
    rows = [{"page": f"[{kept[name]['title']}]({name}.md)", **kept[name]} for name in PAGES if name in kept]
    (output / "README.md").write_text(f"""# Verification

Scenes with known answers, one page each: scene, mesh, reference and its kind (ANALYTIC: a formula; EXTERNAL: another code or a publication;
OWN: an independent computation), values, observed orders, tolerance and plot. All are made by one command (Python with numpy, scipy, netCDF4, matplotlib):

    python3 tests/verification/benchmarks/benchmarks.py --haptos build/release/bin/haptos

The smallest variant of each is a test (`benchmarks_test.py`, labels verification and slow).

{table(rows, {"page": "benchmark", "what": "checked", "error": "largest error .1e", "tolerance": "tolerance .0e"})}
""")


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--haptos", required=True, help="the program")
    parser.add_argument("--only", action="append", choices=list(PAGES), help="this benchmark; may be repeated")
    parser.add_argument("--output", type=pathlib.Path, default=DOCUMENTATION, help="folder of the pages")
    parser.add_argument("--work", type=pathlib.Path, help="folder of meshes and results, kept (default: a temporary one)")
    return parser.parse_args()


def main():
    options = parse_arguments()
    programs.haptos = str(pathlib.Path(options.haptos).resolve())
    options.output.mkdir(parents=True, exist_ok=True)
    results = options.output / "results.json"
    kept = json.loads(results.read_text()) if results.exists() else {}
    missed = []
    with tempfile.TemporaryDirectory(prefix="haptos_") as temporary:
        for name in options.only or PAGES:
            if name == "calculix" and not shutil.which("ccx"):
                print("calculix: left out, there is no ccx")
                continue
            page = PAGES[name]((options.work or pathlib.Path(temporary)) / name, options.output)
            page.write(options.output)
            kept[name] = {"title": page.title, "what": page.what, "error": float(page.error), "tolerance": page.tolerance}
            results.write_text(json.dumps(kept, indent=1) + "\n")
            print(f"{name}: {page.error:.2e}, tolerance {page.tolerance:.0e}", "" if page.holds else "MISSED", flush=True)
            missed += [] if page.holds else [name]
    write_index(options.output)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
