"""A film whose pictures say which they are, and their numbers read back from MP4 files."""

from io import BytesIO

import av
import numpy as np

from robot_runtime.vision.film import FilmCoder
from robot_runtime.vision.picture import Picture

WIDTH, HEIGHT, CELL = 128, 96, 16
BITS = 12
RATE = 15.0


def draw_number(number: int) -> Picture:
    """Draw a picture with a number below 2^12 as bright and dark fields."""
    picture = np.full((HEIGHT, WIDTH, 3), 128, np.uint8)
    for bit in range(BITS):
        top, left = bit // 6 * 2 * CELL, bit % 6 * CELL + CELL
        picture[top : top + CELL, left : left + CELL] = 235 if number >> bit & 1 else 20
    return picture


def read_number(picture: Picture) -> int:
    """Return the number that is drawn in a picture."""
    middles = [(bit // 6 * 2 * CELL + CELL // 2, bit % 6 * CELL + CELL + CELL // 2) for bit in range(BITS)]
    return sum(int(picture[top, left].mean() > 128) << bit for bit, (top, left) in enumerate(middles))


READ_NUMBER = f"""(video) => {{
    const canvas = new OffscreenCanvas({WIDTH}, {HEIGHT});
    const context = canvas.getContext('2d');
    context.drawImage(video, 0, 0, {WIDTH}, {HEIGHT});
    let number = 0;
    for (let bit = 0; bit < {BITS}; bit += 1) {{
        const top = Math.floor(bit / 6) * 2 * {CELL} + {CELL // 2};
        const left = bit % 6 * {CELL} + {CELL} + {CELL // 2};
        if (context.getImageData(left, top, 1, 1).data[1] > 128) number += 2 ** bit;
    }}
    return number;
}}"""
"""JavaScript that returns the number that a video shows."""


def code_numbers(coder: FilmCoder, numbers: range, start: float) -> list[tuple[float, bytes]]:
    """Return the times (s) and the coded pictures of these numbers, the first one at `start`."""
    times = [start + (number - numbers[0]) / RATE for number in numbers]
    return [
        (time, coder.code(time, draw_number(number))) for time, number in zip(times, numbers, strict=True)
    ]


def read_film(mp4: bytes) -> list[tuple[float, int]]:
    """Return the times (s since the file's start) and the numbers of the pictures of an MP4 file."""
    with av.open(BytesIO(mp4), "r") as file:
        return [
            (float(frame.time or 0.0), read_number(frame.to_ndarray(format="bgr24").astype(np.uint8)))
            for frame in file.decode(video=0)
        ]
