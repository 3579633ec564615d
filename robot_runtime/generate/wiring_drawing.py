"""The drawing of the wiring, as SVG: docs/pictures/wiring.svg.

Names, pins, levels and addresses come from the tables of the contract; only places are said here.
"""

from html import escape

from robot_runtime.contract.wiring import FINS, WIRES, Conductor, Net, find_part

COLOURS = {
    Net.SUPPLY: "#c62828",
    Net.GROUND: "#546e7a",
    Net.UART: "#6a1b9a",
    Net.I2C: "#1565c0",
    Net.SPI: "#2e7d32",
    Net.SIGNAL: "#b26a00",
}
RAILS = {
    "battery": ("battery", "#8e0000"),
    "regulator": ("+5 V", "#c62828"),
    "motor_regulator": ("motor 5 V", "#ad1457"),
    "pi": ("3.3 V", "#d84315"),
}
"""Name and colour of each supply, by the part that gives it."""
RAILED = (Net.SUPPLY, Net.GROUND)
"""Nets that are drawn as names, not as lines through the whole drawing."""
INK, SOFT, LINE, PAPER, FILL = "#263238", "#546e7a", "#90a4ae", "#ffffff", "#f5f8f9"
PILL_HEIGHT, PILL_GAP, PILL_LETTER = 18, 5, 7.0

Point = tuple[float, float]


class Drawing:
    """Collects the elements of an SVG, and which wires of the table it shows."""

    def __init__(self, width: int, height: int, label: str) -> None:
        self._elements = [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" '
            f'height="{height}" font-family="sans-serif" role="img" aria-label="{escape(label)}">',
            f'<rect width="{width}" height="{height}" rx="12" fill="{PAPER}"/>',
        ]
        self._boxes: dict[str, tuple[float, float, float, float]] = {}
        self._missing = list(WIRES)

    def finish(self) -> str:
        """Returns the SVG. Raises ValueError where a wire of the table is not in it."""
        if self._missing:
            wires = ", ".join(f"{one.source} {one.source_pin} - {one.sink}" for one in self._missing)
            raise ValueError(f"the drawing does not show these wires: {wires}; add them to {__name__}")
        return "\n".join([*self._elements, "</svg>", ""])

    def take(self, *ends: str) -> Conductor:
        """Returns the wire of source, its pin, sink and its pin, and notes it as shown.

        Raises KeyError where the table has none.
        """
        for wire in self._missing:
            if (wire.source, wire.source_pin, wire.sink, wire.sink_pin) == ends:
                self._missing.remove(wire)
                return wire
        raise KeyError(f"the table has no wire of {', '.join(ends)}, or it was drawn already")

    def text(
        self, x: float, y: float, text: str, size: float = 13, anchor: str = "start", colour: str = INK,
        bold: bool = False,
    ) -> None:  # fmt: skip
        """Writes a line of text; y is its baseline."""
        weight = ' font-weight="600"' if bold else ""
        self._elements.append(
            f'<text x="{x:g}" y="{y:g}" font-size="{size:g}" text-anchor="{anchor}" fill="{colour}"{weight}>'
            f"{escape(text)}</text>"
        )

    def rectangle(
        self, x: float, y: float, width: float, height: float, fill: str, stroke: str, radius: float = 8
    ) -> None:
        """Draws a rectangle."""
        self._elements.append(
            f'<rect x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}" rx="{radius:g}" '
            f'fill="{fill}" stroke="{stroke}"/>'
        )

    def box(
        self, part: str, x: float, y: float, width: float, height: float, *lines: str, down: float = 20
    ) -> None:
        """Draws a part: its title, which is `down` below its top, and further lines under that."""
        self._boxes[part] = (x, y, width, height)
        self.rectangle(x, y, width, height, FILL, LINE)
        self.text(x + width / 2, y + down, find_part(part).title, 13.5, "middle", bold=True)
        for number, line in enumerate(lines):
            self.text(x + width / 2, y + down + 17 + 16 * number, line, 12, "middle", SOFT)

    def pills(self, part: str, x: float, y: float, width: float) -> None:
        """Draws the supplies of a part that have no line as pills, in rows from this corner."""
        at = x
        for wire in WIRES:
            if wire.sink != part or wire.net not in RAILED or wire not in self._missing:
                continue
            self._missing.remove(wire)
            rail, colour = RAILS[wire.source] if wire.net is Net.SUPPLY else ("GND", COLOURS[Net.GROUND])
            text = rail if wire.sink_pin in ("GND", "VIN") else f"{wire.sink_pin}: {rail}"
            long = PILL_LETTER * len(text) + 12
            if at > x and at + long > x + width:
                at, y = x, y + PILL_HEIGHT + PILL_GAP
            self.pill(at, y, text, colour)
            at += long + PILL_GAP

    def pill(self, x: float, y: float, text: str, colour: str) -> None:
        """Draws a supply's name in its colour."""
        long = PILL_LETTER * len(text) + 12
        self.rectangle(x, y, long, PILL_HEIGHT, colour, colour, PILL_HEIGHT / 2)
        self.text(x + long / 2, y + 13, text, 11, "middle", "#ffffff", bold=True)

    def wire(self, wire: Conductor, *points: Point, ends: tuple[str, str] | None = None) -> None:
        """Draws a wire through these points, and the names of its pins where it meets a part's edge."""
        self.line(wire.net, *points)
        names = ends or (wire.source_pin, wire.sink_pin)
        for part, name, point in ((wire.source, names[0], points[0]), (wire.sink, names[1], points[-1])):
            self._label(part, name, point)

    def line(self, net: Net, *points: Point) -> None:
        """Draws a line in a net's colour."""
        path = "M" + " ".join(f"{x:g} {y:g}" for x, y in points)
        self._elements.append(f'<path d="{path}" fill="none" stroke="{COLOURS[net]}" stroke-width="2"/>')

    def dot(self, net: Net, x: float, y: float) -> None:
        """Draws a joint."""
        self._elements.append(f'<circle cx="{x:g}" cy="{y:g}" r="3.5" fill="{COLOURS[net]}"/>')

    def resistor(self, x: float, y: float, upright: bool) -> None:
        """Draws a resistor with its middle here."""
        width, height = (8, 18) if upright else (24, 8)
        self.rectangle(x - width / 2, y - height / 2, width, height, PAPER, INK, 1)

    def ground(self, x: float, y: float) -> None:
        """Draws the sign of ground, below this point."""
        self._elements.append(
            f'<path d="M{x - 8:g} {y:g}h16M{x - 5:g} {y + 4:g}h10M{x - 2:g} {y + 8:g}h4" '
            f'stroke="{COLOURS[Net.GROUND]}" stroke-width="2"/>'
        )

    def _label(self, part: str, name: str, point: Point) -> None:
        x, y, width, height = self._boxes.get(part, (-1, -1, 0, 0))
        if point[0] == x:
            self.text(x + 6, point[1] + 4.5, name, 13)
        elif point[0] == x + width:
            self.text(x + width - 6, point[1] + 4.5, name, 13, "end")
        elif point[1] == y:
            self.text(point[0], y + 16, name, 13, "middle")
        elif point[1] == y + height:
            self.text(point[0], y + height - 6, name, 13, "middle")


def strap_rows() -> list[tuple[str, ...]]:
    """The rows of the table of fins: number, place, select, address, A1, A0."""
    return [
        (str(number), fin.place, fin.select, f"0x{fin.address:02x}", fin.a1.value, fin.a0.value)
        for number, fin in enumerate(FINS)
    ]
