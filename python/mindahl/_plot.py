"""The figure of a fit, by matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any


def draw(records: Sequence[Any], units: tuple[str, str], ax: Any) -> Any:
    if not records:
        raise ValueError("the result has no records, as one that was read from JSON: fit them again")
    if any(record.fitted_force is None for record in records):
        raise ValueError("the fit failed: there is no curve to draw")
    if ax is None:
        from matplotlib import pyplot

        ax = pyplot.subplots(2, 1, sharex=True, layout="constrained",
                             gridspec_kw={"height_ratios": [3, 1]})[1]
    axes = [ax] if hasattr(ax, "plot") else list(ax)
    if len(axes) > 2 or not all(hasattr(axis, "plot") for axis in axes):
        raise ValueError("ax must be one of matplotlib's Axes, or two")
    for k, record in enumerate(records):
        name = "" if len(records) == 1 else f" {record.name}"
        points = axes[0].plot(record.displacement, record.force, ".", markersize=3,
                              label=f"measured{name}")[0]
        at = record.displacement if record.fitted_displacement is None else record.fitted_displacement
        axes[0].plot(at, record.fitted_force, "-", linewidth=1.2,
                     color="black" if len(records) == 1 else points.get_color(),
                     label=f"fitted{name}")
        if len(axes) > 1:
            axes[1].plot(record.displacement, record.residual, ".", markersize=3,
                         color=points.get_color())
    axes[0].set_ylabel(f"force [{units[1]}]")
    axes[-1].set_xlabel(f"displacement [{units[0]}]")
    axes[0].legend()
    if len(axes) > 1:
        axes[1].axhline(0.0, linewidth=0.8, color="black")
        of_displacement = any(record.fitted_displacement is not None for record in records)
        axes[1].set_ylabel(f"residual [{units[0 if of_displacement else 1]}]")
    return ax
