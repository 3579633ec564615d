"""Lines over time as an SVG for documents: stacked panels with one time axis."""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

WIDTH, LEFT, RIGHT, HEAD, FOOT = 900, 62, 16, 26, 44
INK, GRID = "#0d1a22", "#dde4e9"
FONT = "Inter, system-ui, sans-serif"


@dataclass(frozen=True)
class Axis:
    """From `first`, at the bottom or left, to `last`, with a mark every `step`."""

    title: str
    first: float
    last: float
    step: float

    def share(self, value: "Floats | float") -> "Floats | float":
        """Position of a value along the axis, 0 to 1."""
        return (value - self.first) / (self.last - self.first)

    @property
    def marks(self) -> list[float]:
        """The multiples of the step on it."""
        low, high = sorted((self.first, self.last))
        count = round((high - low) / self.step)
        return [low + index * self.step for index in range(count + 1)]


@dataclass(frozen=True)
class Line:
    """Values over time; with `steps` each holds until the next."""

    name: str
    colour: str
    times: "Floats"
    values: "Floats"
    steps: bool = False
    dashed: bool = False


@dataclass(frozen=True)
class Panel:
    """Lines over one axis, `height` px high."""

    axis: Axis
    lines: Sequence[Line]
    height: int


def draw(panels: Sequence[Panel], time: Axis) -> str:
    """The SVG's text."""
    height = sum(panel.height + HEAD for panel in panels) + FOOT
    parts = []
    top = 0
    for panel in panels:
        top += HEAD
        parts += _panel(panel, time, top)
        top += panel.height
    parts += [_text(_across(time, mark), top + 18, f"{mark:g}", "middle") for mark in time.marks]
    parts.append(_text((LEFT + WIDTH - RIGHT) / 2, top + 36, time.title, "middle"))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" width="{WIDTH}" '
        f'font-family="{FONT}" font-size="13" fill="{INK}">\n'
        '<rect width="100%" height="100%" fill="#ffffff"/>\n' + "\n".join(parts) + "\n</svg>\n"
    )


def _panel(panel: Panel, time: Axis, top: int) -> list[str]:
    parts = []
    for mark in panel.axis.marks:
        y = _down(panel, top, mark)
        parts.append(_rule(LEFT, y, WIDTH - RIGHT, y))
        parts.append(_text(LEFT - 8, y + 4, f"{mark:.10g}" if abs(mark) > 1e-9 else "0", "end"))
    parts += [_rule(x, top, x, top + panel.height) for x in (_across(time, mark) for mark in time.marks)]
    parts.append(
        f'<text transform="translate(16 {top + panel.height / 2:.1f}) rotate(-90)" text-anchor="middle">'
        f"{escape(panel.axis.title)}</text>"
    )
    x = LEFT + 4.0
    for line in panel.lines:
        dash = ' stroke-dasharray="6 4"' if line.dashed else ""
        parts.append(f'<path d="{_path(line, panel, time, top)}" fill="none" stroke="{line.colour}" '
                     f'stroke-width="1.6" stroke-linejoin="round"{dash}/>')  # fmt: skip
        parts.append(f'<path d="M{x:g} {top - 10}h22" stroke="{line.colour}" stroke-width="2"{dash}/>')
        parts.append(_text(x + 28, top - 6, line.name, "start"))
        x += 60 + 7.5 * len(line.name)
    return parts


def _path(line: Line, panel: Panel, time: Axis, top: int) -> str:
    points = []
    last = None
    for at, value in zip(line.times.tolist(), line.values.tolist(), strict=True):
        x, y = _across(time, at), _down(panel, top, value)
        if line.steps and last is not None and y != last:
            points.append(f"{x:.1f} {last:.1f}")
        if not line.steps or y != last:
            points.append(f"{x:.1f} {y:.1f}")
        last = y
    if line.steps and last is not None:
        points.append(f"{_across(time, float(line.times[-1])):.1f} {last:.1f}")
    return "M" + "L".join(points)


def _across(time: Axis, at: float) -> float:
    return float(LEFT + (WIDTH - RIGHT - LEFT) * time.share(at))


def _down(panel: Panel, top: int, value: float) -> float:
    return float(top + panel.height * (1 - panel.axis.share(value)))


def _rule(x: float, y: float, to_x: float, to_y: float) -> str:
    return f'<path d="M{x:.1f} {y:.1f}L{to_x:.1f} {to_y:.1f}" stroke="{GRID}"/>'


def _text(x: float, y: float, words: str, anchor: str) -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{escape(words)}</text>'
