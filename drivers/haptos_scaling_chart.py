# SPDX-License-Identifier: BSD-3-Clause
"""Draws what haptos_scaling.py measured (used by its --draw and --redraw), and what haptos_scaling_time.py tells."""
import csv

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import NullFormatter

import haptos_scaling_model as model

BLUE, ORANGE, BLACK, GREY = "#0072B2", "#D55E00", "#000000", "#808080"


def rows_of(rows, study):
    return [row for row in rows if row["study"] == study]


def values(rows, key):
    return [float(row[key]) for row in rows]


def label(axes, x, y, text, colour, offset=(-22, 8)):
    axes.annotate(text, (x, y), xytext=offset, textcoords="offset points", color=colour, fontsize=8, ha="center",
                  annotation_clip=False)


def ticks(axes, x):
    axes.set_xscale("log")
    places = sorted(set(x))
    axes.set_xticks(places, [f"{place:g}" for place in places], fontsize=8)
    axes.xaxis.set_minor_formatter(NullFormatter())


def draw_seconds(axes, rows):
    """Seconds of the solve over subdomains on one rank, and the part of them that goes into the coarse problem."""
    for study, colour, text in (("subdomains-strong", ORANGE, "one mesh"), ("subdomains-weak", BLUE, "4 elements per edge")):
        own = [row for row in rows_of(rows, study) if row["oversubscribed"] == "0"]
        if not own:
            continue
        x, y = values(own, "subdomains"), values(own, "solve_seconds")
        coarse = [a + b for a, b in zip(values(own, "coarse_set_up_seconds"), values(own, "coarse_solve_seconds"))]
        axes.plot(x, y, "o-", color=colour, markersize=4)
        axes.plot(x, coarse, "o--", color=colour, markersize=3, linewidth=0.9)
        label(axes, x[-1], y[-1], text, colour, (-40, 6) if study == "subdomains-weak" else (-120, 0))
    axes.set(yscale="log", xlabel="subdomains (one rank)", ylabel="solve [s]", title="Seconds (dashed: coarse problem)")
    ticks(axes, values(rows_of(rows, "subdomains-weak"), "subdomains"))


def draw_multiplications(axes, rows):
    for study, colour, text in (("subdomains-strong", ORANGE, "one mesh"), ("subdomains-weak", BLUE, "4 elements per edge")):
        own = rows_of(rows, study)
        if own:
            x, y = values(own, "subdomains"), values(own, "multiplications")
            axes.plot(x, y, "o-", color=colour, markersize=4)
            label(axes, x[-1], y[-1], text, colour, (-30, 8) if study == "subdomains-weak" else (-22, -14))
    axes.set(ylim=(0, None), xlabel="subdomains (one rank)", ylabel="multiplications by F", title="Iterations")
    ticks(axes, values(rows_of(rows, "subdomains-weak"), "subdomains"))


def draw_bytes(axes, rows):
    """Kilobytes of the rank that sends most, per multiplication by F: all, and those of B with the formula beside."""
    for study, colour, text in (("ranks-strong", ORANGE, "one mesh"), ("ranks-weak", BLUE, "32 subdomains a rank")):
        own = [row for row in rows_of(rows, study) if int(row["ranks"]) > 1]
        if not own:
            continue
        x = values(own, "ranks")
        axes.plot(x, values(own, "kbytes_sent_per_multiplication"), "o-", color=colour, markersize=4)
        axes.plot(x, values(own, "kbytes_of_jumps_per_multiplication"), "s--", color=colour, markersize=4, linewidth=0.9)
        expected = []
        for row in own:
            forward, transposed = model.jump_traffic(int(row["k"]), int(row["p"]), int(row["ranks"]))
            per_pair = max(a[1] + b[1] for a, b in zip(forward, transposed))
            expected.append(per_pair * (float(row["multiplications"]) + float(row["preconditioner_applications"])) /
                            float(row["multiplications"]) / 1e3)
        axes.plot(x, expected, "x", color=BLACK, markersize=8)
        label(axes, x[-1], values(own, "kbytes_sent_per_multiplication")[-1], text, colour)
    axes.set(ylim=(0, None), xlabel="ranks", ylabel="kB sent, largest rank", title="Bytes per multiplication\n(dashed: by B; cross: formula)")
    ticks(axes, [x for x in values(rows_of(rows, "ranks-strong"), "ranks") if x > 1])


def draw_reductions(axes, rows):
    for study, colour, text in (("ranks-strong", ORANGE, "one mesh"), ("ranks-weak", BLUE, "32 subdomains a rank")):
        own = [row for row in rows_of(rows, study) if int(row["ranks"]) > 1]
        if own:
            axes.plot(values(own, "ranks"), values(own, "reductions_per_multiplication"), "o-", color=colour, markersize=4)
            axes.plot(values(own, "ranks"), values(own, "largest_reductions_of_a_step"), "o--", color=colour, markersize=3, linewidth=0.9)
            offset = (-22, -13) if study == "ranks-weak" else (-22, 8)
            label(axes, float(own[-1]["ranks"]), float(own[-1]["reductions_per_multiplication"]), text, colour, offset)
    axes.set(ylim=(0, None), xlabel="ranks", ylabel="reductions", title="Reductions per multiplication\n(dashed: most of a step)")
    ticks(axes, [x for x in values(rows_of(rows, "ranks-strong"), "ranks") if x > 1])


def draw_memory(axes, rows):
    for study, colour, text in (("ranks-strong", ORANGE, "one mesh, over ranks"), ("ranks-weak", BLUE, "32 subdomains a rank")):
        own = rows_of(rows, study)
        if own:
            axes.plot(values(own, "ranks"), values(own, "bytes_per_unknown"), "o-", color=colour, markersize=4)
            offset = (-70, -4) if study == "ranks-weak" else (-22, -14)
            label(axes, float(own[-1]["ranks"]), float(own[-1]["bytes_per_unknown"]), text, colour, offset)
    axes.set(ylim=(0, None), xlabel="ranks", ylabel="bytes per unknown", title="Memory of all ranks together,\nbeyond the empty program")
    ticks(axes, values(rows_of(rows, "ranks-strong"), "ranks"))


def draw_coarse(axes, rows):
    for study, colour, text in (("subdomains-strong", ORANGE, "one mesh"), ("subdomains-weak", BLUE, "4 elements per edge")):
        own = rows_of(rows, study)
        if own:
            x = values(own, "subdomains")
            share = [100 * (float(r["coarse_set_up_seconds"]) + float(r["coarse_solve_seconds"])) / float(r["solve_seconds"]) for r in own]
            axes.plot(x, share, "o-", color=colour, markersize=4)
            label(axes, x[-1], share[-1], text, colour, (-6, 8))
    axes.set(ylim=(0, 105), xlabel="subdomains (one rank)", ylabel="share of the solve [%]", title="Seconds of the coarse problem")
    ticks(axes, values(rows_of(rows, "subdomains-weak"), "subdomains"))


def set_style():
    plt.rcParams.update({"font.size": 9, "axes.titlesize": 9, "axes.titlelocation": "left", "axes.spines.top": False,
                         "axes.spines.right": False, "axes.grid": True, "grid.color": "#e4e4e4", "grid.linewidth": 0.6,
                         "axes.axisbelow": True, "xtick.minor.bottom": False, "svg.hashsalt": "haptos"})


def draw(path, target, png):
    """Reads scaling.csv at `path`, writes `target`.svg (and .png)."""
    rows = list(csv.DictReader(path.read_text().splitlines()))
    set_style()
    figure, grid = plt.subplots(2, 3, figsize=(12, 6.4))
    for axes, panel in zip(grid.flat, (draw_multiplications, draw_reductions, draw_bytes, draw_seconds, draw_coarse, draw_memory)):
        panel(axes, rows)
    over = sorted({int(row["ranks"]) for row in rows if row["oversubscribed"] == "1"})
    if over:
        figure.text(0.01, 0.005, "no seconds of runs with more ranks than processors (" + ", ".join(map(str, over)) + " ranks here) are drawn",
                    color=GREY, fontsize=8)
    figure.tight_layout(rect=(0, 0.02, 1, 1))
    figure.savefig(f"{target}.svg", metadata={"Date": None})
    if png:
        figure.savefig(f"{target}.png", dpi=100)
    plt.close(figure)


def draw_model(rows, parts, path):
    """A panel a case, a line a part of the seconds."""
    set_style()
    figure, grid = plt.subplots(2, 2, figsize=(11, 7.4), sharex=True, sharey=True)
    for axes, case in zip(grid.flat, dict.fromkeys(row["case"] for row in rows)):
        own = [row for row in rows if row["case"] == case]
        ranks = values(own, "ranks")
        for part, colour in zip(parts, ("#999999", "#E69F00", "#0072B2", "#009E73", "#CC79A7", "#D55E00", "#8B0000")):
            axes.plot(ranks, values(own, part), "-", color=colour, linewidth=1.4, label=part.replace("_", " "))
        axes.plot(ranks, values(own, "total"), "o-", color=BLACK, markersize=3, label="all")
        axes.set(xscale="log", yscale="log", ylim=(1e-3, None), title=case)
    for axes in grid[1]:
        axes.set_xlabel("ranks")
    for axes in grid[:, 0]:
        axes.set_ylabel("seconds of a run, by the model")
    grid[0, 0].legend(fontsize=7, ncol=2)
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)
