"""Computed meshes of stones and water plants; vertices in m, faces as triples of vertex numbers."""

from math import cos, pi, sin

import numpy as np
from numpy.typing import NDArray

Vertices = NDArray[np.float64]
Faces = NDArray[np.int32]

KINDS = 7
"""Number of different stones, and of different plants."""
LEAVES = 7
JOINTS = 7
"""Pairs of vertices along a leaf."""


def stone(seed: int) -> tuple[Vertices, Faces]:
    """Return a rounded stone, 7 to 30 cm high; each `seed` gives another one."""
    rng = np.random.default_rng(seed)
    size = 0.07 + 0.22 * (seed / KINDS) ** 2
    around, up = 14, 8
    faces = []
    rows = []
    for row in range(up):
        polar = pi * (row + 0.5) / up
        for column in range(around):
            turn = 2 * pi * column / around
            rows.append((sin(polar) * cos(turn), sin(polar) * sin(turn), cos(polar)))
            if row < up - 1:
                here, right = row * around + column, row * around + (column + 1) % around
                faces += [(here, here + around, right), (right, here + around, right + around)]
    top, bottom = len(rows), len(rows) + 1
    rows += [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)]
    last = (up - 1) * around
    for column in range(around):
        right = (column + 1) % around
        faces += [(top, column, right), (bottom, last + right, last + column)]
    unit = np.array(rows)
    bumps = np.zeros(len(unit))
    for _ in range(9):
        direction = rng.normal(size=3) * rng.uniform(0.8, 2.6)
        bumps += 0.085 * np.sin(unit @ direction * 1.7 + rng.uniform(0, 2 * pi))
    return size * unit * (1 + bumps)[:, np.newaxis] * np.array((1.0, 0.8, 0.7)), np.array(faces, np.int32)


def plant(seed: int) -> tuple[Vertices, Faces]:
    """Return a tuft of leaves, 20 to 60 cm high; each leaf has two sides."""
    rng = np.random.default_rng(seed)
    size = 0.22 + 0.4 * seed / KINDS
    vertices: list[tuple[float, float, float]] = []
    faces: list[tuple[int, int, int]] = []
    for leaf in range(LEAVES):
        turn = 2 * pi * (leaf + rng.uniform(-0.3, 0.3)) / LEAVES
        height, lean = rng.uniform(0.55, 1.0), rng.uniform(0.12, 0.42)
        first = len(vertices)
        for joint in range(JOINTS):
            share = joint / (JOINTS - 1)
            out = 0.03 + lean * share**2 + 0.03 * sin(5 * share + leaf)
            half = 0.045 * sin(pi * min(0.25 + 0.75 * share, 0.97))
            x, y = out * cos(turn), out * sin(turn)
            vertices += [
                (x - side * sin(turn), y + side * cos(turn), height * share) for side in (-half, half)
            ]
        for joint in range(JOINTS - 1):
            a = first + 2 * joint
            faces += [(a, a + 1, a + 2), (a + 2, a + 1, a + 3)]
    flat = size * np.array(vertices)
    front = np.array(faces, np.int32)
    # The back has vertices of its own, for its own normals.
    return np.concatenate((flat, flat)), np.concatenate((front, front[:, ::-1] + len(flat)))
