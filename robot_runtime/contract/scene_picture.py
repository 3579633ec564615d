"""Request and answer of a picture query on the wire: see `scene/picture` in docs/reference/zenoh.md."""

import json
from dataclasses import asdict, dataclass
from struct import Struct
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from robot_runtime.contract.card_colours import Paint
from robot_runtime.contract.limits import SCENE_HEIGHT, SCENE_WIDTH, ConfigError
from robot_runtime.contract.parsing import parse

HEADER = Struct("<dII")
BYTE_MAX = 255


@dataclass(frozen=True, slots=True, kw_only=True)
class Request:
    """A request for a picture.

    `card` is the blue, green and red of the card before the camera; `marked`: it shows the marker.
    """

    width: Annotated[int, SCENE_WIDTH]
    height: Annotated[int, SCENE_HEIGHT]
    card: tuple[int, int, int] | None = None
    marked: bool = False

    def __post_init__(self) -> None:
        if self.card is not None and not all(0 <= part <= BYTE_MAX for part in self.card):
            raise ValueError(f"the card's colours are {self.card}; each must be 0 to {BYTE_MAX}")


class Picture(NamedTuple):
    """A picture, uint8 of shape (height, width, 3), blue, green, red, and its time (s, steady clock)."""

    time: float
    pixels: NDArray[np.uint8]


def write_request(width: int, height: int, card: Paint | None, marked: bool = False) -> bytes:
    """Return the request as bytes."""
    question = asdict(Request(width=width, height=height, card=card, marked=marked))
    return json.dumps({name: value for name, value in question.items() if value is not None}).encode()


def read_request(data: bytes) -> Request:
    """Return the request in these bytes. Raise ConfigError where they are none."""
    try:
        question = json.loads(data)
    except ValueError as problem:
        raise ConfigError(f"a question for a picture must be JSON: {problem}") from problem
    if not isinstance(question, dict):
        raise ConfigError("a question for a picture must be a JSON object")
    return parse(Request, question)


def write_picture(picture: Picture) -> bytes:
    """Return the answer as bytes."""
    height, width = picture.pixels.shape[:2]
    return HEADER.pack(picture.time, width, height) + picture.pixels.tobytes()


def read_picture(data: bytes) -> Picture:
    """Return the answer in these bytes. Raise ValueError where they are none."""
    if len(data) < HEADER.size:
        raise ValueError(f"a picture of {len(data)} bytes")
    time, width, height = HEADER.unpack_from(data)
    if len(data) != HEADER.size + 3 * width * height:
        raise ValueError(f"{len(data)} bytes are not a picture of {width} × {height}")
    return Picture(time, np.frombuffer(data, np.uint8, offset=HEADER.size).reshape(height, width, 3))
