"""Video4Linux devices: what the kernel says of their kind, their sizes and their use by another program."""

import errno
import os
from contextlib import suppress
from fcntl import ioctl
from pathlib import Path
from struct import Struct

from robot_runtime.vision.camera import CameraError

_CAPABILITY = Struct("16s32s32sIII12x")
"""struct v4l2_capability: driver, card, bus, version, capabilities of the whole, and of this device."""
_QUERY_CAPABILITY = 0x80685600
_REQUEST_BUFFERS = 0xC0145608
_RELEASE_BUFFERS = Struct("=IIIII").pack(0, 1, 1, 0, 0)
"""struct v4l2_requestbuffers for none: refused, where another program has buffers."""
_FRAME_SIZE = Struct("=9I8x")
"""struct v4l2_frmsizeenum: index, format, kind; width and height, or least, greatest and step of each."""
_ENUMERATE_SIZES = 0xC02C564A
_ONE_SIZE = 1
_SIZES_MAX = 64
_CAPTURES, _METADATA, _BY_DEVICE = 0x00000001, 0x00800000, 0x80000000


def check_device(path: Path) -> None:
    """Raise CameraError where a device is missing, is no camera, may not be opened, or is in use."""
    try:
        device = os.open(path, os.O_RDWR | os.O_NONBLOCK)
    except FileNotFoundError as problem:
        raise CameraError(
            f"there is no camera {path} (devices: {_others()}); plug it in, or name its device in "
            "robot.toml: [vision] file"
        ) from problem
    except PermissionError as problem:
        raise CameraError(
            f"the camera {path} may not be opened: put the user into the group video, "
            "`sudo usermod -aG video USER`, then start again"
        ) from problem
    except OSError as problem:
        why = "another program uses it" if problem.errno == errno.EBUSY else problem.strerror
        raise CameraError(f"the camera {path} cannot be opened: {why}") from problem
    try:
        _check_capabilities(path, device)
        _check_use(path, device)
    finally:
        os.close(device)


def describe_sizes(path: Path, pixel_format: int) -> str:
    """Return the sizes of a device's pictures in a format, its four characters as a number, as text.

    Empty where the driver does not list them.
    """
    sizes: list[str] = []
    # The driver ends its list by refusing the next index.
    with suppress(OSError):
        device = os.open(path, os.O_RDWR | os.O_NONBLOCK)
        try:
            for index in range(_SIZES_MAX):
                data = bytearray(_FRAME_SIZE.pack(index, pixel_format, *[0] * 7))
                ioctl(device, _ENUMERATE_SIZES, data)
                sizes.append(_describe_size(bytes(data)))
        finally:
            os.close(device)
    return ", ".join(dict.fromkeys(sizes))


def _describe_size(answer: bytes) -> str:
    _, _, kind, *numbers = _FRAME_SIZE.unpack(answer)
    if kind == _ONE_SIZE:
        return f"{numbers[0]} × {numbers[1]}"
    least_width, most_width, _, least_height, most_height, _ = numbers
    return f"{least_width} × {least_height} to {most_width} × {most_height}"


def _check_capabilities(path: Path, device: int) -> None:
    data = bytearray(_CAPABILITY.size)
    # No Video4Linux device answers so; OpenCV then says that it gives no video.
    with suppress(OSError):
        ioctl(device, _QUERY_CAPABILITY, data)
        if what := describe_other(bytes(data)):
            raise CameraError(
                f"{path} is {what}, which gives no pictures; name another device in robot.toml: [vision] "
                f"file (devices: {_others()})"
            )


def _check_use(path: Path, device: int) -> None:
    try:
        ioctl(device, _REQUEST_BUFFERS, bytearray(_RELEASE_BUFFERS))
    except OSError as problem:
        if problem.errno == errno.EBUSY:
            raise CameraError(f"another program uses the camera {path}: end that one") from problem


def describe_other(capability: bytes) -> str:
    """Return what a device is that is no camera, by its struct v4l2_capability; empty for a camera."""
    _, card, _, _, whole, own = _CAPABILITY.unpack(capability)
    bits = own if whole & _BY_DEVICE else whole
    if bits & _CAPTURES:
        return ""
    name = card.split(b"\0", 1)[0].decode("utf-8", "replace")
    kind = "the metadata" if bits & _METADATA else "another part"
    return f"{kind} of the device {name!r}"


def _others() -> str:
    return ", ".join(str(device) for device in sorted(Path("/dev").glob("video*"))) or "none"
