"""The picture of a counterexample."""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import Any

from mpmfw.plots.style import journal_style, new_figure
from mpmfw_testing.check import Violation, shown

#: Characters of a line of text under the picture.
LINE = 74


@journal_style()
def draw(path: Path, title: str, violation: Violation) -> Path:
    """Draw a violation's picture with its legend above and the numbers of its case below, and write it.

    Parameters
    ----------
    path
        File; its folder is made.
    title
        Plug-in and check.
    """
    figure = new_figure(1, 1, height=78.0)
    axes = figure.add_subplot()
    if violation.picture is not None:
        violation.picture(axes)
    axes.set_title(title, loc="left")
    _legend_above(figure, axes)
    case = [f"{name} = {shown(value)}" for name, value in violation.counterexample.items()]
    if violation.measured is not None and violation.bound is not None:
        case.insert(0, f"measured {shown(violation.measured)}, bound {shown(violation.bound)}")
    figure.supxlabel("\n".join(textwrap.wrap("; ".join(case), LINE)), x=0.02, horizontalalignment="left")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path)
    return path


def _legend_above(figure: Any, axes: Any) -> None:
    """Move the legend out of the axes, where it would cover what is drawn."""
    handles, labels = axes.get_legend_handles_labels()
    if axes.get_legend() is not None:
        axes.get_legend().remove()
    if handles:
        figure.legend(
            handles,
            labels,
            loc="outside upper left",
            ncols=2,
            columnspacing=1.2,
        )
