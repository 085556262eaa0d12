#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes doc/sweep.md and its chart from the tables that sweep.py --csv writes.

    sweep_page.py TABLE.csv... [--page doc/sweep.md] [--chart doc/charts/sweep.svg]
"""
import argparse
import csv
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "drivers"))

import numpy as np

import haptos_chart_figures as figures

BEGIN, END = "<!-- table: begin -->", "<!-- table: end -->"


def read(path):
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        row["F"] = [int(f) for f in row["F"].split()]
        row["status"] = row["status"].split()
        row.setdefault("family", "basic")
    return rows


def is_solved(row):
    return bool(row["F"]) and all(status == "0" for status in row["status"])


def over_tied(rows, key):
    """What contact takes in parts of what ties take, in every scene where both are known."""
    return np.array([float(row[key]) / float(row[f"tied_{key}"]) for row in rows if row.get(f"tied_{key}")])


def summary(name, rows):
    solved = [row for row in rows if is_solved(row)]
    counts = np.array([max(row["F"]) for row in solved])
    fields = max(float(row["field_equilibrium"]) for row in solved)
    spread = [max(row["F"]) - min(row["F"]) for row in solved if len(row["F"]) > 1]
    solves, seconds = over_tied(solved, "solves"), over_tied(solved, "seconds")
    cells = [name, len(rows), len(solved), sum(set(row["status"]) == {"3"} for row in rows),
             sum("2" in row["status"] and not row["remarks"] for row in rows), sum(bool(row["remarks"]) for row in rows),
             f"{np.median(counts):.0f}", f"{np.percentile(counts, 90):.0f}", counts.max(), max(spread, default=""),
             f"{np.median(solves):.1f}, {solves.max():.1f}" if len(solves) else "", f"{np.median(seconds):.1f}, {seconds.max():.0f}" if len(seconds) else "",
             f"{fields:.1e}"]
    return "| " + " | ".join(map(str, cells)) + " |"


def groups(rows):
    """Those of a seed and of a family, by name."""
    basic, wide = ([row for row in rows if (row["family"] == "basic") == is_basic] for is_basic in (True, False))
    for seed in dict.fromkeys(row["seed"] for row in basic):
        yield f"basic, seed {seed}", [row for row in basic if row["seed"] == seed]
    if basic:
        yield "basic", basic
    for family in dict.fromkeys(row["family"] for row in wide):
        yield family, [row for row in wide if row["family"] == family]
    for seed in dict.fromkeys(row["seed"] for row in wide):
        yield f"wide, seed {seed}", [row for row in wide if row["seed"] == seed]
    if wide:
        yield "wide", wide


def lines(rows):
    yield ("| scenes | number | solved | no solution | beyond digits | do not hold | median F | 90th percentile | largest | spread over ranks | "
           "solves over tied: median, largest | seconds over tied | largest field equilibrium |")
    yield "|" + "---|" * 13
    yield from (summary(*group) for group in groups(rows))
    for families, own in (("basic", [row for row in rows if row["family"] == "basic"]), ("wide", [row for row in rows if row["family"] != "basic"])):
        yield from ("", f"Those of `--families {families}` that do not hold, and the ten with the most multiplications:", "")
        yield "| seed | scene | family | what | pairs | F by ranks | tied | remarks |"
        yield "|" + "---|" * 8
        hardest = sorted(own, key=lambda row: (bool(row["remarks"]), max(row["F"], default=0)), reverse=True)
        for row in hardest[:10 + sum(bool(row["remarks"]) for row in own)]:
            yield (f"| {row['seed']} | {row['index']} | {row['family']} | {row['scene']} | {row['pairs']} | {', '.join(map(str, row['F']))} | "
                   f"{row.get('tied_F', '')} | {row['remarks']} |")


def draw(rows, path):
    """How many scenes take at most so many multiplications; these against the certified error; seconds over those of ties."""
    figures.style()
    figure, (left, middle, right) = figures.plt.subplots(1, 3, figsize=(11.5, 3.4))
    families = dict.fromkeys(row["family"] for row in rows)
    for family, colour in zip(families, ("#000000", "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00")):
        own = [row for row in rows if is_solved(row) and row["family"] == family]
        counts = np.sort([max(row["F"]) for row in own])
        left.step(counts, 100 * np.arange(1, len(counts) + 1) / len(counts), where="post", color=colour, label=family)
        middle.plot([max(row["F"]) for row in own], [float(row["largest_error"]) for row in own], "o", markersize=2.5, color=colour)
        tied = np.sort(over_tied(own, "seconds"))
        right.step(tied, 100 * np.arange(1, len(tied) + 1) / max(1, len(tied)), where="post", color=colour)
    for axes in (left, middle):
        axes.set(xscale="log", xlabel="multiplications by F")
        figures.plain_ticks(axes.xaxis)
    left.set(title="Share of the scenes [%]", ylim=(0, 101))
    left.legend(frameon=False, fontsize=8, loc="lower right")
    middle.set(yscale="log", title="Largest certified error")
    right.set(xscale="log", title="Share of the scenes [%]", ylim=(0, 101), xlabel="seconds of the solution over those of ties")
    figures.plain_ticks(right.xaxis)
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})
    figures.close(figure)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("tables", type=pathlib.Path, nargs="+")
    parser.add_argument("--page", type=pathlib.Path, default=pathlib.Path("doc/sweep.md"))
    parser.add_argument("--chart", type=pathlib.Path, default=pathlib.Path("doc/charts/sweep.svg"))
    arguments = parser.parse_args()
    rows = [row for table in arguments.tables for row in read(table)]
    text = arguments.page.read_text()
    before, after = text.index(BEGIN) + len(BEGIN), text.index(END)
    arguments.page.write_text(text[:before] + "\n\n" + "\n".join(lines(rows)) + "\n\n" + text[after:])
    draw(rows, arguments.chart)


if __name__ == "__main__":
    main()
