"""The requirements of rendering, checked without loading MuJoCo."""

import sys
from ctypes.util import find_library
from importlib.util import find_spec


def missing() -> str | None:
    """Return the missing packages and how to install them; None if nothing is missing."""
    if find_spec("mujoco") is None:
        return (
            "MuJoCo is not installed; where there is a wheel for this computer, "
            f"“{sys.executable} -m pip install mujoco” adds it"
        )
    if find_library("EGL") is None:
        return "there is no EGL library; “sudo apt install libegl1 libegl-mesa0 libgl1-mesa-dri” adds it"
    return None
