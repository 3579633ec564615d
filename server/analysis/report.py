"""A comparison as one self-contained HTML file: charts (Plotly), figures, differences, bookmarks.

Dark on white, for printing. The file includes Plotly, about 5 MB.
"""

from collections.abc import Sequence
from datetime import UTC, datetime
from html import escape

import plotly.graph_objects as go
from plotly.io import to_html
from plotly.subplots import make_subplots

from robot_runtime.contract.topics import MOTOR
from server import VERSION
from server.analysis.schemas import Compared, Comparison, SignalLine, TimeRange
from server.analysis.signals import Signal
from server.metrics.figure import FigureMeaning
from server.platform.report_page import report_page, report_table

COLOURS = ("#0072b2", "#c25200", "#a3427d", "#00795a", "#7d6a00", "#5b3fa0", "#4a5a66")
"""After Okabe and Ito, darkened for white paper."""
DEPTHS = frozenset(
    (
        "depth.depth",
        "control.set_point",
        "control.depth",
        "state.set_point",
        "state.set_point_default",
        "state.set_point_detected",
        "truth.position_2",
    )
)
SHOWN_KINDS = frozenset({"armed", "disarmed", "fin_check", "controller"})
"""Kinds of events that are shown above the charts, besides cautions and alarms."""
HIGH_FIRST, HIGH, GAP, EDGE, ROW = 300, 180, 46, 60, 22
GRID = "#d9e0e5"
FONT = "Inter, Helvetica, Arial, sans-serif"
ALIGNED = {"start": "the start of the recording", "armed": "arming"}
SET_POINTS = ("set_point", "wanted")


def write_report(comparison: Comparison, view: TimeRange | None = None) -> str:
    """Return the report as HTML; `view` is the time range (s) that its charts show first."""
    names = ", ".join(session.name for session in comparison.sessions)
    parts = [
        f"<h1>{escape(names)}</h1>",
        f"<p>Time 0 is {escape(_moment(comparison))}. µ-CAT {VERSION}, {_utc(datetime.now(UTC))}.</p>",
        _session_table(comparison),
        _charts(comparison, view),
        "<h2>Figures</h2>",
        f"<p>{escape(comparison.likeness.why)}</p>",
        _figure_table(comparison),
        "<h2>Differences</h2>" if len(comparison.sessions) > 1 else "<h2>Settings</h2>",
        _difference_table(comparison),
        _bookmark_table(comparison),
    ]
    return report_page(f"µ-CAT: {names}", parts)


def _moment(comparison: Comparison) -> str:
    align = comparison.align
    if align.by == "set_point":
        return f"step {align.number} of the set point"
    if align.by == "mission":
        return f"the start of the mission’s step {align.step}" if align.step else "the start of the mission"
    if align.by == "segment":
        return "the beginning of the segment"
    return ALIGNED.get(align.by) or f"the bookmark “{align.marker}”"


def _charts(comparison: Comparison, view: TimeRange | None) -> str:
    charts = _group(comparison.signals)
    laid = [
        (number, session) for number, session in enumerate(comparison.sessions) if session.offset is not None
    ]
    if not charts or not laid:
        return "<p>There is nothing to draw: no signal, or no session with this moment.</p>"
    heights = [ROW * len(laid), HIGH_FIRST, *[HIGH] * (len(charts) - 1)]
    inside = sum(heights) + GAP * len(charts)
    titles = ["", *(f"<b>{escape(title)}</b>{_kinds(signals)}" for title, signals in charts)]
    figure = draw_rows(titles, heights, inside)
    figure.update_yaxes(range=[len(laid) - 0.5, -0.5], visible=False, row=1)
    for row, (_, signals) in enumerate(charts, 2):
        figure.update_yaxes(ticksuffix=f" {signals[0].unit}" if signals[0].unit else "", row=row)
        if signals[0].name in DEPTHS:
            figure.update_yaxes(autorange="reversed", row=row)
        for order, session in laid:
            for signal in signals:
                if signal.name in session.series:
                    figure.add_trace(_trace(session, signal, _colour(order), len(signals)), row, 1)
    for height, (order, session) in enumerate(laid):
        figure.add_trace(_signs(session, height, _colour(order)), 1, 1)
    for order, session in laid:
        for bookmark in session.markers:
            figure.add_vline(
                bookmark.time - (session.offset or 0), line_dash="dot", line_color=_colour(order)
            )
    figure.update_layout(hovermode="x unified", showlegend=False)
    figure.update_xaxes(range=[view.start, view.end] if view else None)
    figure.update_xaxes(title=f"s since {_moment(comparison)}", row=len(heights))
    return str(
        to_html(
            figure,
            include_plotlyjs=True,
            full_html=False,
            div_id="charts",
            config={"displaylogo": False, "responsive": True},
        )
    )


def draw_rows(titles: Sequence[str], heights: Sequence[int], inside: int) -> go.Figure:
    """Return empty charts, one below the other, over one time axis, `inside` px high with their gaps."""
    figure = make_subplots(
        len(heights),
        1,
        shared_xaxes=True,
        row_heights=list(heights),
        vertical_spacing=GAP / inside,
        subplot_titles=titles,
    )
    figure.update_annotations(x=0, xanchor="left", font_size=12)
    figure.update_yaxes(gridcolor=GRID, zeroline=False)
    figure.update_xaxes(gridcolor=GRID, zeroline=False)
    figure.update_layout(
        height=inside + EDGE + 20,
        margin={"l": 70, "r": 12, "t": 20, "b": EDGE},
        paper_bgcolor="white",
        plot_bgcolor="white",
        font={"family": FONT, "size": 12, "color": "#0d1a22"},
    )
    return figure


def _group(signals: Sequence[Signal]) -> list[tuple[str, list[Signal]]]:
    """Return the charts by title: depths together, a fin's set angle with its measured one."""
    charts: dict[str, list[Signal]] = {}
    for signal in signals:
        if signal.name in DEPTHS:
            title = "Depth"
        elif signal.topic == MOTOR.name and signal.column.startswith(("wanted_", "angle_")):
            title = f"motor, angle {signal.column[-1]}"
        else:
            title = f"{signal.topic}, {signal.column.replace('_', ' ')}"
        charts.setdefault(title, []).append(signal)
    return list(charts.items())


def _kinds(signals: Sequence[Signal]) -> str:
    """Return a legend of the line styles, for a chart with several signals."""
    if len(signals) < 2:
        return ""
    kinds = (
        f"{'dashed' if signal.column.startswith(SET_POINTS) else 'solid'}: {signal.column.replace('_', ' ')}"
        for signal in signals
    )
    return f"   {', '.join(dict.fromkeys(kinds))}"


def _trace(session: Compared, signal: Signal, colour: str, together: int) -> go.Scatter:
    dashed = signal.column.startswith(SET_POINTS)
    times, values = _points(session.series[signal.name], session.offset or 0.0)
    name = f"{session.name}, {signal.column.replace('_', ' ')}" if together > 1 else session.name
    return go.Scatter(
        x=times,
        y=values,
        name=name,
        mode="lines",
        line={"color": colour, "width": 1.5, "dash": "dash" if dashed else "solid"},
        line_shape="hv" if dashed else "linear",
        hovertemplate=f"%{{y:.4~g}} {signal.unit}",
    )


def _signs(session: Compared, row: int, colour: str) -> go.Scatter:
    """Return events on the time axis: a stroke for information, a triangle for a caution or an alarm."""
    shown = [event for event in session.events if event.kind in SHOWN_KINDS or event.severity != "info"]
    happened = [(event, "line-ns" if event.severity == "info" else "triangle-down") for event in shown]
    happened += [(marker, "diamond") for marker in session.markers]
    return go.Scatter(
        x=[event.time - (session.offset or 0.0) for event, _ in happened],
        y=[row] * len(happened),
        name=session.name,
        mode="markers",
        text=[escape(event.text) for event, _ in happened],
        hovertemplate="%{text}",
        marker={
            "symbol": [symbol for _, symbol in happened],
            "size": 9,
            "color": colour,
            "line": {"width": 2, "color": colour},
        },
    )


def _points(line: SignalLine, offset: float) -> tuple[list[float], list[float | None]]:
    """Return the minimum and maximum of each column in turn."""
    pairs = [
        (round(time - offset, 4), value)
        for time, low, high in zip(line.time, line.low, line.high, strict=True)
        for value in ((low,) if low == high else (low, high))
    ]
    return [time for time, _ in pairs], [value for _, value in pairs]


def _colour(number: int) -> str:
    return COLOURS[number % len(COLOURS)]


def _session_table(comparison: Comparison) -> str:
    rows = (
        (
            f'<span class="stroke" style="background:{_colour(number)}"></span>{escape(session.name)}',
            _utc(datetime.fromtimestamp(session.started, UTC)),
            f"{session.duration:.1f} s",
            escape(session.state),
            escape(session.problem),
        )
        for number, session in enumerate(comparison.sessions)
    )
    return report_table(("Session", "Started", "Duration", "State", ""), rows)


def _figure_table(comparison: Comparison) -> str:
    head = (
        "Figure",
        *(escape(session.name) + _covered(session) for session in comparison.sessions),
        "Meaning",
    )
    rows = (
        (
            escape(f"{meaning.title}, {meaning.unit}" if meaning.unit else meaning.title),
            *(_value(session, meaning) for session in comparison.sessions),
            escape(meaning.meaning),
        )
        for meaning in comparison.figures
    )
    return report_table(head, rows)


def _covered(session: Compared) -> str:
    """Return what the figures cover, s since the session's start."""
    if not session.range:
        return ""
    return f"<small>{session.range[0][0]:.1f} to {session.range[-1][1]:.1f} s of the recording</small>"


def _value(session: Compared, meaning: FigureMeaning) -> str:
    figure = session.figures[meaning.name]
    text = "none" if figure.value is None else f"{figure.value:.{meaning.decimals}f}".replace("-", "−")
    return f"{text}<small>{escape(figure.words)}</small>" if figure.words else text


def _difference_table(comparison: Comparison) -> str:
    if not comparison.differences:
        return "<p>Configuration, gains, versions, scenario and seed are the same in all sessions.</p>"
    rows = (
        (
            escape(f"{difference.group}: {difference.name}"),
            *(escape(value) or "–" for value in difference.values),
        )
        for difference in comparison.differences
    )
    return report_table(("", *(escape(session.name) for session in comparison.sessions)), rows)


def _bookmark_table(comparison: Comparison) -> str:
    rows = [
        (f"{bookmark.time - (session.offset or 0):.2f} s", escape(session.name), escape(bookmark.text))
        for session in comparison.sessions
        for bookmark in session.markers
    ]
    return "<h2>Bookmarks</h2>" + report_table(("Time", "Session", "Bookmark"), rows) if rows else ""


def _utc(moment: datetime) -> str:
    return f"{moment:%Y-%m-%d %H:%M:%S} UTC"
