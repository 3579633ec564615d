"""An environment as the system's Python and its pip really build it."""

import subprocess
import zipfile
from pathlib import Path

import pytest

from server.features.installation.effects import Effects
from server.features.installation.environments import WHEELS, build_environment
from server.features.installation.places import InstallPlaces
from server.features.installation.release import read_release

NAMES = ("mqtt", "ros2", "parquet")
EXTRAS = ('paho-mqtt; extra == "mqtt"', 'rosbags; extra == "ros2"', 'pyarrow; extra == "parquet"')
"""Requirements of a wheel of mucat with these extras."""


def can_build() -> bool:
    """Return True where Debian's package python3-venv is there."""
    try:
        done = subprocess.run(
            ["/usr/bin/python3", "-c", "import ensurepip"], capture_output=True, check=False
        )
    except OSError:
        return False
    return done.returncode == 0


def place_wheel(folder: Path, name: str, version: str, *needs: str, extras: tuple[str, ...] = ()) -> str:
    """Write a wheel without modules; return the name of its file."""
    folder.mkdir(parents=True, exist_ok=True)
    info = f"{name}-{version}.dist-info"
    needed = "".join(f"Requires-Dist: {need}\n" for need in needs)
    needed += "".join(f"Provides-Extra: {extra}\n" for extra in extras)
    file = f"{name}-{version}-py3-none-any.whl"
    with zipfile.ZipFile(folder / file, "w") as wheel:
        wheel.writestr(
            f"{info}/METADATA", f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n{needed}"
        )
        wheel.writestr(f"{info}/WHEEL", "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n")
        wheel.writestr(f"{info}/RECORD", "")
    return file


@pytest.mark.skipif(not can_build(), reason="there is no /usr/bin/python3 with venv")
def test_an_environment_has_the_release_s_versions_and_stores_nothing_else(tmp_path: Path) -> None:
    places = InstallPlaces(tmp_path)
    used = places.version("2.0.0") / WHEELS
    place_wheel(used, "mucat", "2.0.0")
    place_wheel(used, "mucat_emulator", "2.0.0")
    place_wheel(used, "a_library", "2.0")
    shared = {place_wheel(used, "Another.Library", "1.0"), place_wheel(used, "rosbags", "1.0")}
    places.current.symlink_to(places.version("2.0.0"))
    release = tmp_path / "release"
    own = {
        place_wheel(release, "mucat", "1.0.0", "a-library>=1", "another-library", *EXTRAS, extras=NAMES),
        place_wheel(release, "a_library", "1.0"),
        place_wheel(release, "paho_mqtt", "1.0"),
    }
    environment = build_environment(Effects(lambda _: None), places, read_release(release))
    results = {file.name for file in environment.glob("lib/python*/site-packages/*.dist-info")}
    assert {"mucat-1.0.0.dist-info", "a_library-1.0.dist-info", "Another.Library-1.0.dist-info"} <= results
    # The release brings one extra, the version in use has another, and nobody has the third.
    assert {"paho_mqtt-1.0.dist-info", "rosbags-1.0.dist-info"} <= results
    assert {file.name for file in (environment / WHEELS).iterdir()} == own | shared
