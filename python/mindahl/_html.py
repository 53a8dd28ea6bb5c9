"""What a notebook shows of a fit. A page that the library makes itself would replace summary()."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from typing import Any, Optional


def summary(report: Mapping[str, Any]) -> str:
    """Verdict, warnings and parameters as HTML; report: as FitResult.to_dict()."""
    parts = ["<div>", f"<p><b>mindahl fit of {escape(', '.join(report['input']['files']))}</b>, "
             f"{escape(str(report['model']))}</p>"]
    adequacy: Optional[Mapping[str, Any]] = report.get("adequacy")
    if adequacy and adequacy.get("verdict"):
        parts.append(f"<p>The model is <b>{escape(str(adequacy['verdict']))}</b>.</p>")
    if not report["solver"]["converged"]:
        parts.append(f"<p><b>Not converged</b>: {escape(str(report['solver']['termination']))}</p>")
    if report["warnings"]:
        items = "".join(f"<li>{escape(warning['message'])}</li>" for warning in report["warnings"])
        parts.append(f"<p>Warnings:</p><ul>{items}</ul>")
    if report.get("parameters"):
        parts.append(_table(report["parameters"]))
    parts.append("</div>")
    return "\n".join(parts)


def _table(parameters: Mapping[str, Mapping[str, Any]]) -> str:
    rows = ["<tr><th>parameter</th><th>unit</th><th>value</th><th>standard error</th>"
            "<th>95 % interval</th><th>verdict</th></tr>"]
    for name, parameter in parameters.items():
        low, high = parameter["ci95"]
        is_fixed = parameter["status"] == "fixed"
        interval = "" if is_fixed else f"{_number(low, '−∞')} … {_number(high, '∞')}"
        verdict = "fixed" if is_fixed else parameter["identifiability"]
        cells = [name, parameter["unit"], _number(parameter["value"], ""),
                 _number(parameter["standard_error"], "", 2), interval, verdict]
        rows.append("<tr>" + "".join(f"<td>{escape(str(cell))}</td>" for cell in cells) + "</tr>")
    return "<table>" + "".join(rows) + "</table>"


def _number(value: Optional[float], otherwise: str, digits: int = 6) -> str:
    return otherwise if value is None else f"{value:.{digits}g}"
