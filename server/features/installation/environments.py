"""Virtual environments, one for each version, built beside the one in use."""

import re
from pathlib import Path

from server.features.installation.effects import CommandFailedError, Effects
from server.features.installation.places import COMPLETE, InstallPlaces
from server.features.installation.release import SUMS, Release
from server.platform.settings import SetupError
from server.platform.word_size import BITS

SYSTEM_PACKAGES = "usr/lib/python3/dist-packages"
FROM_APT = ("numpy", "pydantic")
"""Packages without wheels for computers with 32 bits."""
BUILD_SECONDS = 3600.0
"""A Raspberry Pi Zero unpacks some 300 MB on a slow card."""
EXTRAS = (
    ("pi", "gpiod"),
    ("film", "av"),
    ("scene", "mujoco"),
    ("mqtt", "paho-mqtt"),
    ("parquet", "pyarrow"),
    ("identify", "scipy"),
    ("lab", "distributed"),
    ("ros2", "rosbags"),
    ("gym", "gymnasium"),
)
"""Extras of mucat, each with the package that shows that a robot has it, or is to have it."""
WHEELS = "wheels"
"""Folder of an environment with the wheels that it was made of: a later release may lack those it shares."""


def build_environment(effects: Effects, places: InstallPlaces, release: Release) -> Path:
    """Build the release's environment, unless it is complete; no network is needed. Raise SetupError.

    An incomplete environment is built anew, as is one of another release with this version, unless in use.
    """
    environment = places.version(release.version)
    if places.is_complete(environment) and (
        release.version == places.version_of(places.current) or _is_made_of(environment, release)
    ):
        effects.say(f"{environment} is there")
        _share_system_packages(effects, places, environment)
        return environment
    if release.folder.resolve().is_relative_to(environment.resolve()):
        raise SetupError(f"{environment} is not complete: name the folder of a release. Nothing was changed.")
    if BITS == 32:
        _check_system_packages(places)
    effects.remove(environment)
    shared = _find_shared(places, release)
    system = ["--system-site-packages"] if _needs_system_packages(places) else []
    effects.run("/usr/bin/python3", "-m", "venv", *system, environment, seconds=BUILD_SECONDS)
    python = environment / "bin/python"
    # A kernel with 64 bits then names the machine that its programs are for.
    machine = ["linux32"] if BITS == 32 else []
    pip: list[str | Path] = [*machine, python, "-m", "pip", "--disable-pip-version-check", "--no-input"]
    sources: list[str | Path] = [
        word for source in (release.folder, *shared) for word in ("--find-links", source)
    ]
    try:
        effects.run(
            *pip,
            "install",
            "--quiet",
            "--no-index",
            *sources,
            "--no-cache-dir",
            _requirement(release, shared),
            environment={"PIP_CONFIG_FILE": "/dev/null", "PYTHONPATH": ""},
            seconds=BUILD_SECONDS,
        )
    except CommandFailedError as problem:
        effects.remove(environment)
        raise SetupError(_explain(str(problem), release)) from problem
    _store_wheels(effects, places, environment, release, shared)
    if sums := _read_sums(release.folder):
        effects.write(environment / SUMS, sums)
    # pip syncs nothing: a power cut could empty its files beside a whole mark.
    effects.sync_disk()
    effects.write(environment / COMPLETE, f"{release.version}\n")
    return environment


def _requirement(release: Release, shared: list[Path]) -> str:
    """Return mucat's requirement, with the extras of the release, and those of the version in use."""
    own = {_split(wheel)[0] for wheel in release.folder.glob("*.whl")}
    there = own | {_split(wheel)[0] for wheel in shared}
    extras = [extra for extra, package in EXTRAS if package in there]
    if "mucat-emulator" in own:
        # That of another version does not fit.
        extras.append("emulator")
    return f"mucat[{','.join(extras)}]=={release.version}" if extras else f"mucat=={release.version}"


def _needs_system_packages(places: InstallPlaces) -> bool:
    """Return True on a Raspberry Pi, whose camera library comes by apt alone, and with 32 bits."""
    return BITS == 32 or (places.root / SYSTEM_PACKAGES / "picamera2").exists()


def _share_system_packages(effects: Effects, places: InstallPlaces, environment: Path) -> None:
    """Give an environment access to the system's packages, if a needed one was installed since its build."""
    if _needs_system_packages(places):
        settings = environment / "pyvenv.cfg"
        text = settings.read_text(encoding="utf-8")
        effects.write(settings, re.sub(r"(?m)^(include-system-site-packages = )false$", r"\1true", text))


def _check_system_packages(places: InstallPlaces) -> None:
    """Check the packages that come by apt alone with 32 bits. Raise SetupError where they are missing."""
    missing = [name for name in FROM_APT if not (places.root / SYSTEM_PACKAGES / name).exists()]
    if missing:
        raise SetupError(
            f"With 32 bits {' and '.join(missing)} must come from Debian: sudo apt install "
            f"{' '.join(f'python3-{name}' for name in missing)} python3-opencv. Nothing was changed."
        )


def _is_made_of(environment: Path, release: Release) -> bool:
    """Return True where the environment was built of exactly these files, or the release has no checksums."""
    sums = _read_sums(release.folder)
    return not sums or _read_sums(environment) == sums


def _read_sums(folder: Path) -> str:
    path = folder / SUMS
    return path.read_text(encoding="ascii", errors="replace") if path.exists() else ""


def _find_shared(places: InstallPlaces, release: Release) -> list[Path]:
    """Return the wheels of the version in use that the release has in no version."""
    own = {_split(wheel)[0] for wheel in release.folder.glob("*.whl")}
    return [wheel for wheel in sorted((places.current / WHEELS).glob("*.whl")) if _split(wheel)[0] not in own]


def _store_wheels(
    effects: Effects, places: InstallPlaces, environment: Path, release: Release, shared: list[Path]
) -> None:
    """Store the release's wheels, and the shared ones from which the environment was made."""
    present = [_normalise(info.stem) for info in environment.glob("lib/python*/site-packages/*.dist-info")]
    if used := [wheel for wheel in shared if "-".join(_split(wheel)) in present]:
        effects.gather(used, environment / WHEELS)
    # Only root can change what lies in `incoming`.
    put = effects.gather if release.folder == places.incoming else effects.copy
    put(sorted(release.folder.glob("*.whl")), environment / WHEELS)


def _split(wheel: Path) -> tuple[str, str]:
    """Return name and version of a wheel, both as `_normalise` spells them."""
    name, _, rest = wheel.name.partition("-")
    return _normalise(name), _normalise(rest.partition("-")[0])


def _normalise(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


def _explain(problem: str, release: Release) -> str:
    if "No matching distribution" in problem:
        missing = problem.rpartition("No matching distribution found for ")[2].split(" ")[0]
        return (
            f"{release.folder} has no wheel of {missing} for this computer and its Python: "
            "take the release for its architecture. Nothing was changed."
        )
    if "No space left" in problem:
        return "The disk is full: an environment needs some 700 MB. Free some space. Nothing was changed."
    return f"The environment cannot be built: {problem}. Nothing was changed."
