"""The robot's firmware for one speed of the serial line: its path and its build.

The speed is compiled in, so that each speed has its own folder; that of the default is the top one.
`python -m robot_runtime.simulation.boards.firmware` builds the firmware for `robot.toml`.
"""

import argparse
import fcntl
import os
import shutil
import subprocess
import sys
from functools import partial
from pathlib import Path

from robot_runtime.config import LinkConfig, load
from robot_runtime.contract.limits import ConfigError
from robot_runtime.places import BUILD, FIRMWARE_REMEDY, FIRMWARE_SOURCES

_LINES_SHOWN = 5


class FirmwareBuildError(Exception):
    """The firmware cannot be built; the text says why and what to do."""


def firmware_path(build: Path, baud: int, suffix: str, *, hil: bool = False) -> Path:
    """Return the path of the firmware for this many bit/s; `suffix` is ".elf" (emulated) or ".hex" (upload).

    `build` is the folder of all products, `hil` selects the firmware of a board in the loop. The file need
    not exist.
    """
    folder = build / "firmware"
    if baud != LinkConfig().baud:
        folder /= str(baud)
    return (folder / "hil" if hil else folder) / f"robot{suffix}"


def bring_up_path(build: Path, baud: int) -> Path:
    """Return the path of the bring-up's sketch for this many bit/s, to upload."""
    return firmware_path(build, baud, ".hex").with_name("bring_up.hex")


def make(folder: Path, *arguments: str, products: Path) -> subprocess.CompletedProcess[str]:
    """Run `make` in this folder, with these targets and variables. Return its status and its output.

    It waits for others that build into the folder `products`: make does not notice another make that writes
    the same files. Where nothing is to be built, a robot starts without waiting.
    """
    # Another make's flags are not for this one: to keep going would bury the compiler's words.
    alone = os.environ | {"MAKEFLAGS": ""}
    run = partial(subprocess.run, capture_output=True, text=True, check=False, env=alone)
    command = ["make", "--silent", "-C", str(folder), *arguments]
    asked = run([*command, "--question"])
    if asked.returncode == 0:
        return asked
    products.mkdir(parents=True, exist_ok=True)
    handle = os.open(products, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX)
        return run(command)
    finally:
        os.close(handle)


def build_firmware(build: Path, baud: int, *, hil: bool = False) -> None:
    """Build the firmware for this many bit/s if it is out of date. Raise FirmwareBuildError.

    Without a compiler or the sources an existing file is used as it is.
    """
    product = firmware_path(build, baud, ".elf", hil=hil)
    if not FIRMWARE_SOURCES.exists():
        if not product.exists():
            raise FirmwareBuildError(f"There is no firmware for {baud} baud: {FIRMWARE_REMEDY}.")
        return
    if shutil.which("make") is None or shutil.which("avr-gcc") is None:
        if product.exists():
            return
        raise FirmwareBuildError(
            f"There is no firmware for {baud} baud ({product}), and no compiler to build it. Install make, "
            "gcc-avr and arduino-core-avr, or set link.baud in robot.toml to what the firmware was built for."
        )
    sketches = ["robot"] if hil else ["robot", "bring_up"]
    variables = [f"BAUD={baud}", f"BUILD={product.parent}", *(["HIL=1"] if hil else [])]
    made = make(FIRMWARE_SOURCES, *sketches, *variables, products=product.parent)
    if made.returncode != 0:
        last = " ".join((made.stderr or made.stdout).split("\n")[-_LINES_SHOWN:]).strip()
        raise FirmwareBuildError(f"The firmware for {baud} baud could not be built: {last}")


def main() -> int:
    """Build the configured firmware. Return 0, or 1 if the configuration or the build has errors."""
    parser = argparse.ArgumentParser(
        prog="python -m robot_runtime.simulation.boards.firmware", description=__doc__
    )
    parser.add_argument("--config", type=Path, default=Path("robot.toml"), help="the robot's configuration")
    parser.add_argument("--build", type=Path, default=BUILD, help="folder of all products")
    options = parser.parse_args()
    try:
        config = load(options.config)
        build_firmware(options.build.absolute(), config.link.baud, hil=config.robot.mode == "hil")
    except (ConfigError, FirmwareBuildError) as problem:
        print(problem, file=sys.stderr)  # noqa: T201 - a command line speaks
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
