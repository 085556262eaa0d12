# SPDX-License-Identifier: BSD-3-Clause
"""Pages of doc/verification: text, tables and plots."""
import dataclasses

import numpy as np


@dataclasses.dataclass
class Page:
    """name: of the file; what: the checked value in words; error: the largest found; tolerance: its bound."""
    name: str
    title: str
    what: str
    error: float
    tolerance: float
    text: str

    @property
    def holds(self):
        return bool(self.error <= self.tolerance)

    def write(self, folder):
        (folder / f"{self.name}.md").write_text(f"# {self.title}\n\n{self.text.strip()}\n")


def table(rows, columns):
    """Markdown of dictionaries.  :param columns: {key: "title [format]"}, the format in Python's notation"""
    heads, formats = zip(*(_head(text) for text in columns.values()))
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    for row in rows:
        lines.append("| " + " | ".join(format(row[key], spec) if row[key] != "" else "" for key, spec in zip(columns, formats)) + " |")
    return "\n".join(lines)


def _head(text):
    title, _, spec = text.rpartition(" ")
    return (title, spec) if spec.startswith(".") else (text, "")


def order(sizes, errors):
    """Slope of log(error) over log(size) by least squares."""
    return float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])


def figure(size=(5.2, 3.6)):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    plt.rcParams.update({"font.size": 9, "axes.titlelocation": "left", "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True,
                         "grid.color": "#e4e4e4", "grid.linewidth": 0.6, "axes.axisbelow": True, "svg.hashsalt": "haptos"})
    return plt.subplots(figsize=size)


def save(drawn, path):
    drawn.tight_layout()
    drawn.savefig(path, metadata={"Date": None})
    import matplotlib.pyplot as plt
    plt.close(drawn)
