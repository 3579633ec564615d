"""Paths of the build products and the sources, in a repository and in an installation from wheels.

In a repository `make` builds into the folder `build`. The wheels bring the same files in the folder
`mucat_build` beside the packages: `mucat` the firmware and the default configuration, `mucat-emulator` the
emulated board.
"""

from pathlib import Path

PACKAGES = Path(__file__).resolve().parents[1]
"""The folder of the Python packages: the repository, or site-packages."""

FIRMWARE_SOURCES = PACKAGES / "firmware"
"""The firmware's sources; they exist in a repository alone."""

IN_REPOSITORY = (FIRMWARE_SOURCES / "Makefile").exists()

BUILD = PACKAGES / ("build" if IN_REPOSITORY else "mucat_build")
"""The folder of everything built: the emulated board, its library, the firmware for each speed."""

DEFAULT_CONFIG = PACKAGES / "robot.toml" if IN_REPOSITORY else BUILD / "robot.toml"
"""The configuration with every default."""

FIRMWARE_REMEDY = (
    "`make firmware` builds it"
    if IN_REPOSITORY
    else "mucat brings firmware for 250000 and 115200 baud alone; set link.baud in robot.toml to one of them"
)
EMULATOR_REMEDY = (
    "`make firmware` builds it"
    if IN_REPOSITORY
    else "install the package mucat-emulator for this computer: pip install 'mucat[emulator]'"
)
UPLOAD_REMEDY = "`make firmware`, then `mucat upload`" if IN_REPOSITORY else "`mucat upload`"
