"""The mixer: force and torque of its fins, computed from their places and directions."""

import ctypes
import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

COS, SIN = math.cos(math.radians(30)), math.sin(math.radians(30))
# Front right, back right, back left, front left; forward, right, down; m.
POSITIONS = ((0.11, 0.065), (-0.11, 0.065), (-0.11, -0.065), (0.11, -0.065))
# Which way a fin pushes that lies along its mount.
ALONG = ((COS, -SIN), (-COS, -SIN), (-COS, SIN), (COS, SIN))
AMPLITUDE_MAX = 1.6

Fin = tuple[float, float]
int8s = st.integers(-127, 127)
commands = st.tuples(*[int8s] * 6)
angles = st.tuples(*[st.floats(-3.125, 3.125, width=32)] * 4)


def mix(
    firmware: ctypes.CDLL, command: tuple[int, ...], directions: tuple[float, ...] = (0.0,) * 4
) -> list[Fin]:
    """Direction and amplitude of each fin, rad; before, the fins pointed to `directions`."""
    room = (ctypes.c_float * 4)(*directions)
    amplitudes = (ctypes.c_float * 4)()
    firmware.firmware_mix(bytes(count & 0xFF for count in command), room, amplitudes)
    return list(zip(room, amplitudes, strict=True))


def wrench(fins: list[Fin]) -> list[float]:
    """x, y, z, roll, pitch, yaw of the fins' forces, in units of one fin's maximum."""
    total = [0.0] * 6
    for (direction, amplitude), (x, y), (along_x, along_y) in zip(fins, POSITIONS, ALONG, strict=True):
        # Published: a fin's mean thrust goes with 1 - cos(amplitude).
        thrust = (1 - math.cos(amplitude)) / (1 - math.cos(AMPLITUDE_MAX))
        fx, fy = thrust * math.cos(direction) * along_x, thrust * math.cos(direction) * along_y
        fz = -thrust * math.sin(direction)
        moment = (y * fz, -x * fz, x * fy - y * fx)
        for i, value in enumerate((fx, fy, fz, *moment)):
            total[i] += value
    return total


@pytest.mark.parametrize("axis", range(6))
@pytest.mark.parametrize("size", [127, 64, -64, -127])
def test_each_degree_of_freedom_moves_the_right_way_and_alone(
    firmware: ctypes.CDLL, axis: int, size: int
) -> None:
    command = tuple(size if i == axis else 0 for i in range(6))
    given_ = wrench(mix(firmware, command))
    assert math.copysign(1, given_[axis]) == math.copysign(1, size)
    assert abs(given_[axis]) > 0.02
    others = [value for i, value in enumerate(given_) if i != axis]
    assert others == pytest.approx([0] * 5, abs=1e-6)


def test_forward_is_the_front_fins_and_backward_the_back_fins(firmware: ctypes.CDLL) -> None:
    for size, moving in ((127, {0, 3}), (-127, {1, 2})):
        fins = mix(firmware, (size, 0, 0, 0, 0, 0))
        assert {i for i, (_, amplitude) in enumerate(fins) if amplitude > 0} == moving
        assert all(fins[i] == (0, pytest.approx(AMPLITUDE_MAX)) for i in moving)


def test_vertical_turns_all_fins(firmware: ctypes.CDLL) -> None:
    down, up = mix(firmware, (0, 0, 127, 0, 0, 0)), mix(firmware, (0, 0, -127, 0, 0, 0))
    assert down == [(pytest.approx(-math.pi / 2), pytest.approx(AMPLITUDE_MAX))] * 4
    assert up == [(pytest.approx(math.pi / 2), pytest.approx(AMPLITUDE_MAX))] * 4


def test_published_angular_signs(firmware: ctypes.CDLL) -> None:
    """The published table counts forward, left, up; roll, pitch, yaw for each fin."""
    published = ((-1, -1, 1), (-1, 1, 1), (1, 1, -1), (1, -1, -1))
    roll = mix(firmware, (0, 0, 0, 100, 0, 0))
    pitch = mix(firmware, (0, 0, 0, 0, -100, 0))
    yaw = mix(firmware, (0, 0, 0, 0, 0, -100))
    for i, (roll_sign, pitch_sign, yaw_sign) in enumerate(published):
        assert math.sin(roll[i][0]) == pytest.approx(roll_sign)
        assert math.sin(pitch[i][0]) == pytest.approx(pitch_sign)
        assert math.cos(yaw[i][0]) * math.copysign(1, ALONG[i][0]) == pytest.approx(yaw_sign)


@given(command=commands)
def test_no_fin_exceeds_full_command(firmware: ctypes.CDLL, command: tuple[int, ...]) -> None:
    amplitudes = [amplitude for _, amplitude in mix(firmware, command)]
    assert max(amplitudes) <= AMPLITUDE_MAX * (1 + 1e-6)
    assert min(amplitudes) >= 0


@given(command=commands)
def test_excessive_commands_are_scaled_in_proportion(firmware: ctypes.CDLL, command: tuple[int, ...]) -> None:
    """Each fin adds what the axes demand; all are scaled alike where one would exceed its maximum."""
    x, y, z, roll, pitch, yaw = (count / 127 for count in command)
    expected: list[tuple[float, float]] = []
    for (px, py), (ax, ay) in zip(POSITIONS, ALONG, strict=True):
        forward, right = math.copysign(1, px), math.copysign(1, py)
        turn = math.copysign(1, px * ay - py * ax)
        along = max(x * math.copysign(1, ax), 0) + max(y * math.copysign(1, ay), 0) + yaw * turn
        expected.append((along, z + roll * right - pitch * forward))
    scale = max(1.0, *(math.hypot(*push) for push in expected))
    for (direction, amplitude), (along, down) in zip(mix(firmware, command), expected, strict=True):
        share = amplitude / AMPLITUDE_MAX
        assert share * math.cos(direction) == pytest.approx(along / scale, abs=1e-5)
        assert -share * math.sin(direction) == pytest.approx(down / scale, abs=1e-5)


@given(directions=angles)
def test_a_zero_command_turns_no_fin(firmware: ctypes.CDLL, directions: tuple[float, ...]) -> None:
    assert mix(firmware, (0,) * 6, directions) == [(direction, 0) for direction in directions]


@given(command=commands, directions=angles)
def test_direction_before_does_not_matter_where_a_fin_pushes(
    firmware: ctypes.CDLL, command: tuple[int, ...], directions: tuple[float, ...]
) -> None:
    assume(any(command))
    for now, before in zip(mix(firmware, command, directions), mix(firmware, command), strict=True):
        if now[1] > 0:
            assert now == before
