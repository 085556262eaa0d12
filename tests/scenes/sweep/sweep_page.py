# SPDX-License-Identifier: BSD-3-Clause
"""Makes doc/sweep.md and its chart from the table that sweep.py --csv writes.

    sweep_page.py TABLE.csv [--page doc/sweep.md] [--chart doc/charts/sweep.svg]
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
    return rows


def is_solved(row):
    return bool(row["F"]) and all(status == "0" for status in row["status"])


def summary(name, rows):
    solved = [row for row in rows if is_solved(row)]
    counts = np.array([max(row["F"]) for row in solved])
    spread = max(max(row["F"]) - min(row["F"]) for row in solved)
    fields = max(float(row["field_equilibrium"]) for row in solved)
    return (f"| {name} | {len(rows)} | {len(solved)} | {sum(set(row['status']) == {'3'} for row in rows)} | "
            f"{sum(bool(row['remarks']) for row in rows)} | {np.median(counts):.0f} | {np.percentile(counts, 90):.0f} | {counts.max()} | "
            f"{spread} | {fields:.1e} |")


def lines(rows):
    seeds = list(dict.fromkeys(row["seed"] for row in rows))
    yield "| seed | scenes | solved | no solution | do not hold | median F | 90th percentile | largest | spread over ranks | largest field equilibrium |"
    yield "|" + "---|" * 10
    for seed in seeds:
        yield summary(seed, [row for row in rows if row["seed"] == seed])
    yield summary("all", rows)
    yield ""
    yield "Those that do not hold, and the ten with the most multiplications:"
    yield ""
    yield "| seed | scene | what | pairs | F by ranks | remarks |"
    yield "|" + "---|" * 6
    hardest = sorted(rows, key=lambda row: (bool(row["remarks"]), max(row["F"], default=0)), reverse=True)
    for row in hardest[:10 + sum(bool(row["remarks"]) for row in rows)]:
        yield f"| {row['seed']} | {row['index']} | {row['scene']} | {row['pairs']} | {', '.join(map(str, row['F']))} | {row['remarks']} |"


def draw(rows, path):
    """Left: how many scenes take at most so many multiplications. Right: these against the certified error."""
    figures.style()
    figure, (left, right) = figures.plt.subplots(1, 2, figsize=(8.4, 3.3))
    solved = [row for row in rows if is_solved(row)]
    for seed, colour in zip(dict.fromkeys(row["seed"] for row in rows), ("#0072B2", "#D55E00", "#009E73", "#000000")):
        own = [row for row in solved if row["seed"] == seed]
        counts = np.sort([max(row["F"]) for row in own])
        left.step(counts, 100 * np.arange(1, len(counts) + 1) / len(counts), where="post", color=colour, label=f"seed {seed}")
        right.plot([max(row["F"]) for row in own], [float(row["largest_error"]) for row in own], "o", markersize=3, color=colour)
    for axes in (left, right):
        axes.set(xscale="log", xlabel="multiplications by F")
        figures.plain_ticks(axes.xaxis)
    left.set(title="Share of the scenes [%]", ylim=(0, 101))
    left.legend(frameon=False, fontsize=8, loc="lower right")
    right.set(yscale="log", title="Largest certified error")
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})
    figures.close(figure)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("table", type=pathlib.Path)
    parser.add_argument("--page", type=pathlib.Path, default=pathlib.Path("doc/sweep.md"))
    parser.add_argument("--chart", type=pathlib.Path, default=pathlib.Path("doc/charts/sweep.svg"))
    arguments = parser.parse_args()
    rows = read(arguments.table)
    text = arguments.page.read_text()
    before, after = text.index(BEGIN) + len(BEGIN), text.index(END)
    arguments.page.write_text(text[:before] + "\n\n" + "\n".join(lines(rows)) + "\n\n" + text[after:])
    draw(rows, arguments.chart)


if __name__ == "__main__":
    main()
