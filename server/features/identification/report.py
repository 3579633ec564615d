"""The result of a fit as one HTML file: what was found, and a chart of measured over predicted (Plotly)."""

from collections.abc import Sequence
from html import escape

import plotly.graph_objects as go
from plotly.io import to_html

from server import VERSION
from server.features.comparison.report import COLOURS, FONT, PAGE
from server.features.identification.schemas import CheckedSession, IdentificationResult, describe_improvement

HIGH, GAP = 170, 44
LINES = (("measured", "#0d1a22", "solid"), ("before", COLOURS[1], "dot"), ("after", COLOURS[0], "solid"))


def write_identification_report(result: IdentificationResult) -> str:
    """The report as HTML; it needs no network."""
    names = ", ".join(one.name for one in result.sessions)
    parts = [
        f"<h1>Craft fitted to {escape(names)}</h1>",
        f"<p>µ-CAT {VERSION}. A ± is one standard deviation.</p>",
        _table(
            ("Number", "Before", "Found", "Confidence"),
            [
                (
                    f"{one.title}, {one.unit}" if one.unit else one.title,
                    f"{one.before:.4g}",
                    f"{one.value:.4g}" if one.deviation is not None else "as before",
                    one.words,
                )
                for one in result.numbers
            ],
        ),
        _missing(result.missing),
        "<h2>Prediction of a session that was left out</h2>",
        _check(result.check),
        "<h2>Craft file</h2>",
        f"<pre>{escape(result.craft)}</pre>",
    ]
    return PAGE.format(title=escape(f"µ-CAT: craft of {names}"), body="\n".join(parts))


def _missing(missing: list[str]) -> str:
    if not missing:
        return ""
    lines = "".join(f"<li>{escape(one)}</li>" for one in missing)
    return f"<h2>Not seen in these sessions</h2><p>These motions are missing:</p><ul>{lines}</ul>"


def _check(check: CheckedSession | None) -> str:
    if check is None:
        return "<p>No session was left out, so nothing checks the result.</p>"
    rows = [
        (one.name, f"{one.before_rms:.3g} {one.unit}", f"{one.after_rms:.3g} {one.unit}")
        for one in check.channels
    ]
    words = (
        f"{check.name} is predicted {describe_improvement(check.improvement)} than before: the error is "
        f"{100 * check.after_error:.1f} % of what the signals vary, before {100 * check.before_error:.0f} %."
    )
    return f"<p>{escape(words)}</p>{_table(('Signal', 'Error before', 'Error after'), rows)}{_chart(check)}"


def _chart(check: CheckedSession) -> str:
    """Measured and predicted signals; each window's first 2 s give its start."""
    figure, count = go.Figure(), len(check.channels)
    inside = count * (HIGH + GAP)
    for number, channel in enumerate(check.channels):
        axis = "" if number == 0 else str(number + 1)
        top = number * (HIGH + GAP) + GAP
        layout = {
            "domain": [1 - (top + HIGH) / inside, 1 - top / inside],
            "gridcolor": "#d9e0e5",
            "zeroline": False,
            "ticksuffix": f" {channel.unit}",
        }
        if channel.name == "depth":
            layout["autorange"] = "reversed"
        figure.update_layout({f"yaxis{axis}": layout})
        figure.add_annotation(
            text=f"<b>{escape(channel.name.capitalize())}</b>",
            xref="paper",
            yref="paper",
            x=0,
            y=1 - top / inside,
            xanchor="left",
            yanchor="bottom",
            showarrow=False,
        )
        for name, colour, dash in LINES:
            figure.add_trace(
                go.Scatter(
                    x=check.times,
                    y=getattr(channel, name),
                    yaxis=f"y{axis}",
                    name=name,
                    legendgroup=name,
                    showlegend=number == 0,
                    mode="lines",
                    line={"color": colour, "width": 1.3, "dash": dash},
                )
            )
    figure.update_layout(
        height=inside + 60,
        margin={"l": 70, "r": 12, "t": 8, "b": 50},
        paper_bgcolor="white",
        plot_bgcolor="white",
        font={"family": FONT, "size": 12, "color": "#0d1a22"},
        legend={"orientation": "h", "y": 1.01},
        xaxis={"title": "s", "gridcolor": "#d9e0e5", "anchor": f"y{count}"},
    )
    return str(to_html(figure, include_plotlyjs=True, full_html=False, config={"displaylogo": False}))


def _table(head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    lines = [
        "<table><thead><tr>",
        *(f"<th>{escape(cell)}</th>" for cell in head),
        "</tr></thead><tbody>",
        *(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in rows),
        "</tbody></table>",
    ]
    return "".join(lines)
