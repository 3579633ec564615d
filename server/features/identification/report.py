"""The result of a fit as one HTML file: its numbers, and a chart of measured over predicted (Plotly)."""

from html import escape

import plotly.graph_objects as go
from plotly.io import to_html

from server import VERSION
from server.analysis.report import COLOURS, GAP, draw_rows
from server.features.identification.schemas import CheckedSession, IdentificationResult, describe_improvement
from server.platform.report_page import report_page, report_table

HIGH = 170
LINES = (("measured", "#0d1a22", "solid"), ("before", COLOURS[1], "dot"), ("after", COLOURS[0], "solid"))


def write_identification_report(result: IdentificationResult) -> str:
    """Return the report as HTML; it needs no network."""
    names = ", ".join(session.name for session in result.sessions)
    parts = [
        f"<h1>Craft fitted to {escape(names)}</h1>",
        f"<p>µ-CAT {VERSION}. A ± is one standard deviation.</p>",
        report_table(
            ("Number", "Before", "Found", "Confidence"),
            [
                (
                    escape(f"{number.title}, {number.unit}" if number.unit else number.title),
                    f"{number.before:.4g}",
                    f"{number.value:.4g}" if number.deviation is not None else "as before",
                    escape(number.words),
                )
                for number in result.numbers
            ],
        ),
        _missing(result.missing),
        "<h2>Prediction of a session that was left out</h2>",
        _check(result.check),
        "<h2>Craft file</h2>",
        f"<pre>{escape(result.craft)}</pre>",
    ]
    return report_page(f"µ-CAT: craft of {names}", parts)


def _missing(missing: list[str]) -> str:
    if not missing:
        return ""
    lines = "".join(f"<li>{escape(entry)}</li>" for entry in missing)
    return f"<h2>Not seen in these sessions</h2><p>These motions are missing:</p><ul>{lines}</ul>"


def _check(check: CheckedSession | None) -> str:
    if check is None:
        return "<p>No session was left out, so nothing checks the result.</p>"
    rows = [
        (
            escape(channel.name),
            f"{channel.before_rms:.3g} {escape(channel.unit)}",
            f"{channel.after_rms:.3g} {escape(channel.unit)}",
        )
        for channel in check.channels
    ]
    text = (
        f"{check.name} is predicted {describe_improvement(check.improvement)} than before: the error is "
        f"{100 * check.after_error:.1f} % of what the signals vary, before {100 * check.before_error:.0f} %."
    )
    return (
        f"<p>{escape(text)}</p>{report_table(('Signal', 'Error before', 'Error after'), rows)}{_chart(check)}"
    )


def _chart(check: CheckedSession) -> str:
    """Measured and predicted signals; each window's first 2 s give its start."""
    heights = [HIGH] * len(check.channels)
    titles = [f"<b>{escape(channel.name.capitalize())}</b>" for channel in check.channels]
    figure = draw_rows(titles, heights, sum(heights) + GAP * (len(heights) - 1))
    for row, channel in enumerate(check.channels, 1):
        figure.update_yaxes(ticksuffix=f" {channel.unit}", row=row)
        if channel.name == "depth":
            figure.update_yaxes(autorange="reversed", row=row)
        for name, colour, dash in LINES:
            line = go.Scatter(
                x=check.times,
                y=getattr(channel, name),
                name=name,
                legendgroup=name,
                showlegend=row == 1,
                mode="lines",
                line={"color": colour, "width": 1.3, "dash": dash},
            )
            figure.add_trace(line, row, 1)
    figure.update_layout(
        margin_t=44, legend={"orientation": "h", "yref": "container", "y": 1, "yanchor": "top"}
    )
    figure.update_xaxes(title="s", row=len(heights))
    return str(to_html(figure, include_plotlyjs=True, full_html=False, config={"displaylogo": False}))
