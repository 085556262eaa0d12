# SPDX-License-Identifier: BSD-3-Clause
"""Draws what haptos_chart.py measured: rows of its CSV files in, matplotlib figures out."""
import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import LogLocator, NullFormatter
import numpy as np

METHODS = ("SMALSE", "Subspace Newton", "Automatic")
REFERENCE_TOLERANCE = 1e-12
COUNTED_AT = (1e-4, 1e-6)
P_VALUES = (2, 3, 4, 5)
GOAL_MULTIPLICATIONS, GOAL_SECONDS = 2.5, 3.0  # of contact over tied

# Okabe and Ito's palette: told apart with any colour vision; the marks differ in shape as well.
COLOUR = {"SMALSE": "#D55E00", "Subspace Newton": "#0072B2", "Automatic": "#000000"}
LINE = {"SMALSE": dict(marker="s", markersize=4, linewidth=1.4),
        "Subspace Newton": dict(marker="o", markersize=4, linewidth=1.4),
        "Automatic": dict(marker="o", markersize=8.5, markerfacecolor="none", markeredgewidth=1.0, linewidth=0)}


def style():
    plt.rcParams.update({
        "font.size": 9, "axes.titlesize": 9.5, "axes.titlelocation": "left", "axes.spines.top": False,
        "axes.spines.right": False, "axes.grid": True, "grid.color": "#e4e4e4", "grid.linewidth": 0.6, "axes.axisbelow": True,
        "xtick.minor.bottom": False, "ytick.minor.left": False, "svg.hashsalt": "haptos", "figure.facecolor": "white"})


def close(figure):
    plt.close(figure)


def label(axes, x, y, text, colour, offset=(4, 0), ha="left"):
    axes.annotate(text, (x, y), xytext=offset, textcoords="offset points", color=colour, fontsize=8.5, ha=ha, va="center",
                  annotation_clip=False)


def plain_ticks(axis):
    axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter(NullFormatter())


def number(row, key):
    return float(row[key]) if row.get(key) else np.nan


def draw_method(axes, rows, method, x_key, y_key):
    """One method's line; runs that did not converge are crosses on no line, those without an answer are written out."""
    solved = [r for r in rows if r["status"] == "converged"]
    failed = [r for r in rows if r["status"] not in ("converged", "time limit")]
    axes.plot([number(r, x_key) for r in solved], [number(r, y_key) for r in solved], color=COLOUR[method], **LINE[method])
    axes.plot([number(r, x_key) for r in failed], [number(r, y_key) for r in failed], "x", color=COLOUR[method], markersize=8)
    return [f"{method} at {r['tolerance']}: time limit" for r in rows if r["status"] == "time limit"]


def draw_accuracy(rows, x_key, x_title):
    scenes = list(dict.fromkeys(r["scene"] for r in rows))
    figure, grid = plt.subplots(2, len(scenes), figsize=(3.5 * len(scenes), 5.6), sharex=True, sharey="row", squeeze=False)
    for column, name in enumerate(scenes):
        for line, y_key in enumerate(("multiplications", "solve_seconds")):
            axes, missing = grid[line][column], []
            axes.set(xscale="log", yscale="log")
            for method in METHODS:
                own = [r for r in rows if r["scene"] == name and r["method"] == method
                       and float(r["tolerance"]) > REFERENCE_TOLERANCE]
                missing += draw_method(axes, own, method, x_key, y_key)
                if column == line == 0:
                    name_line(axes, own, method, x_key, y_key)
            axes.text(0.02, 0.02, "\n".join(missing), transform=axes.transAxes, fontsize=8)
            plain_ticks(axes.yaxis)
        grid[0][column].set_title(name)
        grid[1][column].set_xlabel(x_title)
    grid[0][0].invert_xaxis()
    grid[0][0].set_ylabel("multiplications by F")
    grid[1][0].set_ylabel("solve [s], 1 rank")
    figure.text(0.01, 0.005, "more accurate to the right; cross: the run ended before its tolerance", color="#606060")
    figure.tight_layout(rect=(0, 0.02, 1, 1))
    return figure


def name_line(axes, rows, method, x_key, y_key):
    offset = (0, -15) if method == "Subspace Newton" else (0, 15)
    for middle in rows[len(rows) // 2:][:1]:
        label(axes, number(middle, x_key), number(middle, y_key), method, COLOUR[method], offset=offset, ha="center")


def profile_ratios(rows):
    """{method: its multiplications over the best method's, infinite where a scene does not hold}, and the scenes left out."""
    counts = {}
    for row in rows:
        counts.setdefault(row["scene"], {})[row["method"]] = row
    ratios, left_out = {method: [] for method in METHODS}, 0
    for scene in counts.values():
        if all(r["status"].startswith("refused") for r in scene.values()):
            left_out += 1
            continue
        held = {m: number(r, "multiplications") for m, r in scene.items() if r["status"] == "holds"}
        best = min(held.values(), default=np.inf)
        for method in METHODS:
            ratios[method].append(held[method] / best if method in held else np.inf)
    return ratios, left_out


def draw_profile(rows):
    ratios, left_out = profile_ratios(rows)
    total = len(ratios[METHODS[0]])
    end = 1.3 * max(r for own in ratios.values() for r in own if np.isfinite(r))
    figure, axes = plt.subplots(figsize=(6.6, 4.2))
    finals = {}
    for method in METHODS:
        finite = np.sort([r for r in ratios[method] if np.isfinite(r)])
        x = np.concatenate([[1.0], finite, [end]])
        y = 100.0 * np.concatenate([[0], np.arange(1, len(finite) + 1), [len(finite)]]) / total
        axes.step(x, y, where="post", color=COLOUR[method], linewidth=1.6, linestyle="--" if method == "Automatic" else "-")
        finals[method] = (y[-1], len(finite))
    height = np.inf
    for method in sorted(METHODS, key=lambda m: -finals[m][0]):  # labels keep apart where lines end alike
        height = min(finals[method][0], height - 5.5)
        label(axes, end, height, f"{method}: {finals[method][1]} of {total}", COLOUR[method])
    axes.set(xscale="log", xlim=(1, end), ylim=(0, 103), ylabel="scenes that hold [%]",
             xlabel="multiplications by F, at most this many times those of the best method")
    ticks = [t for t in (1, 2, 5, 10, 20, 50, 100, 200, 500) if t <= end]
    axes.set_xticks(ticks, [str(t) for t in ticks])
    axes.set_title(f"{total} scenes of scenes_test at 1e-6, without {left_out} that are refused, as they should be")
    figure.tight_layout()
    return figure


def draw_counts_at(axes, p, rows):
    lines = [("published", "#000000", [{**r, "status": "converged"} for r in rows], "published", (0, 8))]
    for tolerance, colour, offset in zip(COUNTED_AT, ("#56B4E9", "#0072B2"), ((0, -13), (0, 15))):
        at = [r for r in rows if float(r["tolerance"]) == tolerance]
        lines.append((f"Haptos, kkt <= {tolerance:.0e}", colour, at, "multiplications", offset))
    for name, colour, points, key, offset in lines:
        for mark, drawn in (("o-", [r for r in points if r["status"] == "converged"]),
                            ("x", [r for r in points if r["status"] not in ("converged", "time limit")])):
            x, y = [int(r["subdomains"]) for r in drawn], [number(r, key) for r in drawn]
            axes.plot(x, y, mark, color=colour, markersize=4 if mark == "o-" else 8, linewidth=1.4)
            if p == P_VALUES[0] and mark == "o-" and drawn:
                label(axes, x[len(x) // 2], y[len(y) // 2], name, colour, offset, "center")
    lost = [f"{r['subdomains']} at {r['tolerance']}: time limit" for r in rows if r["status"] == "time limit"]
    axes.text(0.02, 0.02, "\n".join(lost), transform=axes.transAxes, fontsize=8)


def draw_counts(rows):
    figure, grid = plt.subplots(1, len(P_VALUES), figsize=(10.5, 3.4), sharex=True, sharey=True)
    subdomains = sorted({int(r["subdomains"]) for r in rows})
    for axes, p in zip(grid, P_VALUES):
        axes.set(xscale="log", yscale="log", title=f"H/h = {p}", xlabel="subdomains", ylim=(5, 3000))
        draw_counts_at(axes, p, [r for r in rows if int(r["p"]) == p])
        axes.set_xticks(subdomains, [str(s) for s in subdomains], fontsize=8)
    grid[0].set_ylabel("multiplications by F")
    plain_ticks(grid[0].yaxis)
    figure.tight_layout()
    return figure


def draw_tied(rows):
    figure, grid = plt.subplots(1, 2, figsize=(8.4, 3.6), sharex=True)
    shades = ("#56B4E9", "#0072B2", "#E69F00", "#D55E00")
    subdomains = sorted({int(r["subdomains"]) for r in rows})
    for axes, key, goal, title in zip(grid, ("ratio_multiplications", "ratio_seconds"), (GOAL_MULTIPLICATIONS, GOAL_SECONDS),
                                      ("multiplications by F", "time of the solve")):
        axes.axhline(goal, color="#606060", linewidth=1, linestyle="--")
        label(axes, subdomains[0], goal, f"goal {goal:g}", "#606060", (0, 6))
        for p, colour in zip(P_VALUES, shades):
            own = [r for r in rows if int(r["p"]) == p and r["contact_status"] == r["tied_status"] == "converged"]
            axes.plot([int(r["subdomains"]) for r in own], [number(r, key) for r in own], "o-", color=colour, markersize=4, linewidth=1.4)
            for last in own[-1:]:
                label(axes, int(last["subdomains"]), number(last, key), f"H/h = {p}", colour)
        axes.set(xscale="log", xlabel="subdomains", title=f"contact / tied: {title}")
        axes.set_ylim(bottom=0)
        axes.set_xticks(subdomains, [str(s) for s in subdomains])
        axes.xaxis.set_minor_formatter(NullFormatter())
    figure.tight_layout()
    return figure
