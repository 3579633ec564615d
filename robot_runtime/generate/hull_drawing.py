"""docs/pictures/hull.svg: the reference hull to scale, with the numbers of the page's table of parts."""

from collections.abc import Iterable

from robot_runtime.contract import hull
from robot_runtime.contract.craft import Craft

SCALE = 1.3
"""Units of the drawing for each millimetre."""
WIDTH, HEIGHT = 440, 890
MIDDLE = 202.0
"""Units from the left to the hull's middle; the bow is on the right."""
SCREW, CORD = 11.5, 18.0
"""mm from the hull's side to the middle of the lid's screws and of its cord."""
INK, FAINT, LINE = "#263238", "#546e7a", "#90a4ae"
PVC, ACRYLIC, STEEL, ELECTRONICS, CELL, SEAL, RUBBER, PAPER = (
    "#cfd8dc",
    "#d5eef7",
    "#78909c",
    "#dcedc8",
    "#ffe0b2",
    "#c62828",
    "#b2dfdb",
    "#ffffff",
)
SUMMARY = (
    "The hull from the side, cut along its middle; from above without its lid; and two details, the shaft of "
    "a fin and the edge of the lid. The page's table names the numbered parts."
)


def hull_drawing() -> str:
    """Return the whole text of hull.svg."""
    shapes = (*_frame(), *_side(), *_top(), *_shaft(), *_edge())
    return "\n".join(
        (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" '
            f'height="{HEIGHT}" font-family="sans-serif" role="img" aria-label="{SUMMARY}">',
            "<!-- Written by `make generate` from robot_runtime/contract/hull.py. Do not edit. -->",
            *shapes,
            "</svg>\n",
        )
    )


def _frame() -> Iterable[str]:
    yield f'<rect width="{WIDTH}" height="{HEIGHT}" rx="12" fill="{PAPER}"/>'


def _side() -> Iterable[str]:
    """Yield the longitudinal section; heights are from the middle of the box, downwards."""
    view = _View(MIDDLE, 122)
    long, tall, wall = hull.LENGTH * 1000, hull.HEIGHT * 1000, hull.WALL * 1000
    budget = hull.weigh()
    plate = hull.ballast_thickness(budget.ballast.mass) * 1000
    clear = hull.opening()[0] * 1000
    bow, floor, top = long / 2, tall / 2, -tall / 2
    yield _text(20, 30, "from the side, cut", weight=600)
    yield view.box(-bow, top + wall, long, tall - wall, PVC)
    yield view.box(-bow + wall, top + wall, long - 2 * wall, tall - 2 * wall, PAPER)
    yield view.box(-bow, top, long, wall, ACRYLIC)
    frame = hull.FRAME * 1000
    for left in (-bow + wall, bow - wall - frame):
        yield view.box(left, top + wall, frame, frame, PVC)
    yield view.box(-clear / 2, floor - wall - plate, clear, plate, STEEL)
    yield view.box(-37, floor - wall - plate - 19, 74, 19, CELL)
    yield view.box(-70, -6, 126, 3, ELECTRONICS)
    yield view.box(-20, -14, 65, 8, ELECTRONICS)
    yield view.box(-66, -12, 36, 6, ELECTRONICS)
    ring, radius = hull.DOME_RING * 1000, hull.DOME_RADIUS * 1000
    flange = hull.DOME_FLANGE * 1000
    yield view.box(bow - wall, -20, wall, 40, PAPER)
    yield view.box(bow, -flange, ring, 2 * flange, PVC)
    yield view.half_circle(bow + ring, 0, radius, ACRYLIC)
    yield view.box(bow + ring - 8, -4.5, 8, 9, FAINT)
    yield view.box(bow + ring - 10, -12.5, 2, 25, ELECTRONICS)
    yield view.box(-6, top - 6, 12, 6, STEEL)
    yield view.box(-6, top, 12, wall + 4, STEEL)
    for plug in (-22, 22):
        yield view.box(-bow - 8, plug - 5, 8 + wall + 3, 10, STEEL)
    for ahead in (hull.SHAFT_FORWARD * 1000, -hull.SHAFT_FORWARD * 1000):
        yield view.ring(ahead, hull.SHAFT_DOWN * 1000, hull.BOSS_DIAMETER * 500)
    yield view.mark(0, 1000 * (budget.centre_down + budget.buoyancy_height), "G")
    yield view.mark(0, 1000 * budget.centre_down, "B")
    yield from view.length(-bow, bow, floor + 14, f"{long:.0f}")
    yield from view.height(top, floor, -bow - 18, f"{tall:.0f}")
    for number, x, y in (
        (1, -96, 46),
        (2, -60, -46),
        (3, -clear / 2 - 7.5, -34),
        (4, bow + 19, -15),
        (5, bow - 11, -18),
        (6, 78, 39),
        (7, 0, 25.5),
        (8, 13, -10),
        (9, 16, -58),
        (10, -88, -20),
        (11, bow - 10, 25),
    ):
        yield view.number(number, x, y)


def _top() -> Iterable[str]:
    view = _View(MIDDLE, 412)
    craft = Craft()
    long, wide, wall = hull.LENGTH * 1000, hull.WIDTH * 1000, hull.WALL * 1000
    clear, across = (measure * 1000 for measure in hull.opening())
    yield _text(20, 250, "from above, without the lid", weight=600)
    for (ahead, right), (out_ahead, out_right) in zip(craft.fin_positions, craft.fin_directions, strict=True):
        yield view.fin(ahead * 1000, right * 1000, out_ahead, out_right, 88)
    yield view.box(-long / 2, -wide / 2, long, wide, PVC)
    yield view.box(-clear / 2, -across / 2, clear, across, PAPER)
    for ahead, right in craft.fin_positions:
        yield view.boss(ahead * 1000, right * 1000, 1 if right > 0 else -1, 1 if ahead > 0 else -1)
    yield view.dashed(-long / 2 + wall, -wide / 2 + wall, long - 2 * wall, wide - 2 * wall)
    yield view.cord(CORD - long / 2, CORD - wide / 2, long - 2 * CORD, wide - 2 * CORD)
    for x in (-105, -70, -35, 0, 35, 70, 105):
        for y in (SCREW - wide / 2, wide / 2 - SCREW):
            yield view.hole(x, y)
    for end in (SCREW - long / 2, long / 2 - SCREW):
        yield view.hole(end, 0.0)
    yield view.box(-37, -32.5, 74, 65, CELL)
    yield view.box(-12, -15, 65, 30, ELECTRONICS)
    yield view.box(-80, -25, 34, 50, ELECTRONICS)
    ring = hull.DOME_RING * 1000
    yield view.box(long / 2, -hull.DOME_FLANGE * 1000, ring, hull.DOME_FLANGE * 2000, PVC)
    yield view.half_circle(long / 2 + ring, 0, hull.DOME_RADIUS * 1000, ACRYLIC)
    yield view.box(long / 2 + ring - 8, -4.5, 8, 9, FAINT)
    for plug in (-22, 22):
        yield view.box(-long / 2 - 8, plug - 5, 8, 10, STEEL)
    shaft = hull.SHAFT_FORWARD * 1000
    yield from view.length(-shaft, shaft, 122, f"{2 * shaft:.0f} between shafts")
    yield from view.height(-wide / 2, wide / 2, -long / 2 - 18, f"{wide:.0f}")
    yield from view.height(
        -hull.SHAFT_SIDE * 1000, hull.SHAFT_SIDE * 1000, 158, f"{hull.SHAFT_SIDE * 2000:.0f}"
    )
    for number, x, y in ((12, 60, 93), (13, 105, 34), (14, -100, -29.5), (15, -63, 0), (8, 40, 0)):
        yield view.number(number, x, y)


def _shaft() -> Iterable[str]:
    """Yield the section of a fin's shaft, enlarged; outside is on the right."""
    yield _text(20, 610, "a fin's shaft", weight=600)
    yield _text(20, 627, "enlarged", fill=FAINT)
    yield _rect(92, 640, 36, 220, PVC)
    yield _rect(70, 690, 110, 120, PVC)
    yield _rect(30, 738, 186, 24, STEEL)
    for x in (74, 150):
        yield _rect(x, 728, 24, 10, ELECTRONICS)
        yield _rect(x, 762, 24, 10, ELECTRONICS)
    for x in (108, 132):
        for y in (731.5, 768.5):
            yield f'<circle cx="{x}" cy="{y}" r="6" fill="{SEAL}"/>'
    yield _rect(24, 734, 8, 32, SEAL)
    yield _rect(12, 722, 6, 56, ELECTRONICS)
    yield _rect(42, 708, 20, 84, STEEL)
    yield _rect(190, 700, 20, 100, RUBBER)
    yield _rect(36, 652, 32, 50, STEEL)
    yield from _numbers(
        (
            (16, 120, 706),
            (17, 162, 786),
            (18, 28, 790),
            (19, 52, 750),
            (20, 52, 677),
            (11, 164, 700),
            (12, 200, 812),
            (1, 110, 845),
        )
    )


def _edge() -> Iterable[str]:
    """Yield the section of the lid's edge, enlarged; outside is on the left."""
    yield _text(244, 610, "the lid's edge", weight=600)
    yield _text(244, 627, "enlarged", fill=FAINT)
    scale = 4 * 1.44
    wall, frame = hull.WALL * 1000 * scale, hull.FRAME * 1000 * scale
    left, lid = 256.0, 664.0
    joint = lid + wall
    yield _rect(left, joint, wall, 146, PVC)
    yield _rect(left + wall, joint, frame, frame, PVC)
    yield _rect(left, lid, 166, wall, ACRYLIC)
    screw = left + SCREW * scale
    yield _rect(screw - 20, lid - 15, 40, 15, STEEL)
    yield _rect(screw - 11.5, lid, 23, wall + 62, STEEL)
    groove = left + CORD * scale
    yield _rect(groove - 12, joint, 24, 13.5, PAPER)
    yield f'<ellipse cx="{groove}" cy="{joint + 6.7}" rx="9.5" ry="6.7" fill="{SEAL}"/>'
    yield from _numbers(((2, 406, lid + wall / 2), (3, groove, joint + 62), (13, screw + 34, lid - 12)))
    yield from _numbers(((14, groove, joint + 29), (1, left + wall / 2, joint + 120)))


class _View:
    """A view to scale: millimetres ahead (to the right) and down (or to starboard) from its middle."""

    def __init__(self, x: float, y: float) -> None:
        self._x, self._y = x, y

    def at(self, ahead: float, down: float) -> tuple[float, float]:
        """Return the point's place in the drawing."""
        return self._x + SCALE * ahead, self._y + SCALE * down

    def box(self, ahead: float, down: float, width: float, height: float, fill: str) -> str:
        """Return a rectangle whose corner is at the upper left."""
        x, y = self.at(ahead, down)
        return _rect(x, y, SCALE * width, SCALE * height, fill)

    def dashed(self, ahead: float, down: float, width: float, height: float) -> str:
        """Return the outline of what is hidden."""
        x, y = self.at(ahead, down)
        size = f'width="{SCALE * width:.1f}" height="{SCALE * height:.1f}"'
        return f'<rect x="{x:.1f}" y="{y:.1f}" {size} fill="none" stroke="{LINE}" stroke-dasharray="4 3"/>'

    def cord(self, ahead: float, down: float, width: float, height: float) -> str:
        """Return the line of the lid's cord."""
        x, y = self.at(ahead, down)
        size = f'width="{SCALE * width:.1f}" height="{SCALE * height:.1f}"'
        return f'<rect x="{x:.1f}" y="{y:.1f}" {size} rx="7" fill="none" stroke="{SEAL}" stroke-width="2.5"/>'

    def half_circle(self, ahead: float, down: float, radius: float, fill: str) -> str:
        """Return a dome to the right of this point."""
        x, y = self.at(ahead, down)
        r = SCALE * radius
        return (
            f'<path d="M{x:.1f} {y - r:.1f} A{r:.1f} {r:.1f} 0 0 1 {x:.1f} {y + r:.1f} Z" fill="{fill}" '
            f'stroke="{LINE}"/>'
        )

    def ring(self, ahead: float, down: float, radius: float) -> str:
        """Return a circle that lies behind the section."""
        x, y = self.at(ahead, down)
        style = f'fill="none" stroke="{LINE}" stroke-dasharray="4 3"'
        return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{SCALE * radius:.1f}" {style}/>'

    def hole(self, ahead: float, down: float) -> str:
        """Return a screw of the lid."""
        x, y = self.at(ahead, down)
        return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.2" fill="{STEEL}"/>'

    def boss(self, ahead: float, right: float, side: int, end: int) -> str:
        """Return a shaft with its boss and motor, square to the fin at angle 0."""
        x, y = self.at(ahead, right)
        turn = side * (90 - end * 30)
        half = SCALE * hull.BOSS_DIAMETER * 500
        return (
            f'<g transform="translate({x:.1f} {y:.1f}) rotate({turn})">'
            f'<rect x="-36" y="{-half:.1f}" width="36" height="{2 * half:.1f}" fill="none" stroke="{LINE}" '
            'stroke-dasharray="4 3"/>'
            f'<rect x="-62" y="-3" width="66" height="6" fill="{STEEL}"/></g>'
        )

    def fin(self, ahead: float, right: float, out_ahead: float, out_right: float, length: float) -> str:
        """Return a fin at angle 0, seen along its edge from above."""
        x, y = self.at(ahead, right)
        tip_x, tip_y = self.at(ahead + length * out_ahead, right + length * out_right)
        return (
            f'<path d="M{x:.1f} {y:.1f} L{tip_x:.1f} {tip_y:.1f}" stroke="{RUBBER}" stroke-width="9" '
            'stroke-linecap="round"/>'
        )

    def mark(self, ahead: float, down: float, name: str) -> str:
        """Return a centre, with its letter."""
        x, y = self.at(ahead, down)
        return (
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4.5" fill="{PAPER}" stroke="{INK}" stroke-width="1.5"/>'
            f'<path d="M{x - 4.5:.1f} {y:.1f} H{x + 4.5:.1f} M{x:.1f} {y - 4.5:.1f} V{y + 4.5:.1f}" '
            f'stroke="{INK}"/>' + _text(x - 9, y + 5, name, anchor="end", weight=600)
        )

    def length(self, left: float, right: float, down: float, label: str) -> Iterable[str]:
        """Yield a measure along the hull."""
        (x, y), (end, _) = self.at(left, down), self.at(right, down)
        yield f'<path d="M{x:.1f} {y - 5:.1f} v10 M{x:.1f} {y:.1f} H{end:.1f} m0 -5 v10" stroke="{FAINT}"/>'
        yield _text((x + end) / 2, y + 16, label, anchor="middle", fill=FAINT)

    def height(self, top: float, bottom: float, ahead: float, label: str) -> Iterable[str]:
        """Yield a measure across it."""
        (x, y), (_, end) = self.at(ahead, top), self.at(ahead, bottom)
        yield f'<path d="M{x - 5:.1f} {y:.1f} h10 M{x:.1f} {y:.1f} V{end:.1f} m-5 0 h10" stroke="{FAINT}"/>'
        middle = (y + end) / 2
        yield _rect(x - 13, middle - 9, 26, 18, PAPER, PAPER)
        yield _text(x, middle + 5, label, anchor="middle", fill=FAINT)

    def number(self, number: int, ahead: float, down: float) -> str:
        """Return a part's number."""
        return _number(number, *self.at(ahead, down))


def _numbers(places: Iterable[tuple[int, float, float]]) -> Iterable[str]:
    return (_number(number, x, y) for number, x, y in places)


def _number(number: int, x: float, y: float) -> str:
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="10" fill="{INK}"/>' + _text(
        x, y + 4.5, str(number), anchor="middle", fill=PAPER, weight=600
    )


def _rect(x: float, y: float, width: float, height: float, fill: str, stroke: str = LINE) -> str:
    size = f'width="{width:.1f}" height="{height:.1f}"'
    return f'<rect x="{x:.1f}" y="{y:.1f}" {size} fill="{fill}" stroke="{stroke}"/>'


def _text(
    x: float,
    y: float,
    label: str,
    *,
    size: int = 14,
    anchor: str = "start",
    fill: str = INK,
    weight: int = 400,
) -> str:
    style = f'font-size="{size}" text-anchor="{anchor}" fill="{fill}" font-weight="{weight}"'
    return f'<text x="{x:.1f}" y="{y:.1f}" {style}>{label}</text>'
