"""Virtual environments, one for each version, built beside the one in use."""

import re
from pathlib import Path

from server.features.installation.effects import CommandFailedError, Effects
from server.features.installation.places import COMPLETE, InstallPlaces
from server.features.installation.release import WHEEL, Release
from server.platform.settings import SetupError
from server.platform.word_size import BITS

SYSTEM_PACKAGES = "usr/lib/python3/dist-packages"
FROM_APT = ("numpy", "pydantic")
"""Packages without wheels for computers with 32 bits."""
BUILD_SECONDS = 3600.0
"""A Raspberry Pi Zero unpacks some 300 MB on a slow card."""
WHEELS = "wheels"
"""Folder of an environment with the wheels that it was made of: a later release may lack those it shares."""


def build_environment(effects: Effects, places: InstallPlaces, release: Release) -> Path:
    """Build the release's environment, unless it is complete; no network is needed. Raises SetupError.

    One that was cut off is built anew.
    """
    environment = places.version(release.version)
    if places.is_complete(environment):
        effects.say(f"{environment} is there")
        _share_system_packages(effects, places, environment)
        return environment
    if BITS == 32:
        _check_system_packages(places)
    effects.remove(environment)
    shared = [places.current / WHEELS] if (places.current / WHEELS).is_dir() else []
    system = ["--system-site-packages"] if _needs_system_packages(places) else []
    effects.run("/usr/bin/python3", "-m", "venv", *system, environment, seconds=BUILD_SECONDS)
    python = environment / "bin/python"
    # A kernel with 64 bits then names the machine that its programs are for.
    machine = ["linux32"] if BITS == 32 else []
    pip: list[str | Path] = [*machine, python, "-m", "pip", "--disable-pip-version-check", "--no-input"]
    sources: list[str | Path] = [
        word for folder in (release.folder, *shared) for word in ("--find-links", folder)
    ]
    try:
        effects.run(
            *pip,
            "install",
            "--quiet",
            "--no-index",
            *sources,
            "--no-cache-dir",
            *_packages(release),
            environment={"PIP_CONFIG_FILE": "/dev/null", "PYTHONPATH": ""},
            seconds=BUILD_SECONDS,
        )
    except CommandFailedError as problem:
        effects.remove(environment)
        raise SetupError(_explain(str(problem), release)) from problem
    _keep_wheels(effects, environment, release, shared)
    effects.write(environment / COMPLETE, f"{release.version}\n")
    return environment


def _packages(release: Release) -> list[str]:
    """The requirements: mucat itself, and what else the release brings for this robot."""
    extra = [
        name
        for name, wheel in (("pi", "gpiod-*"), ("emulator", "mucat_emulator-*"), ("scene", "mujoco-*"))
        if any(release.folder.glob(f"{wheel}.whl"))
    ]
    return [f"mucat[{','.join(extra)}]=={release.version}" if extra else f"mucat=={release.version}"]


def _needs_system_packages(places: InstallPlaces) -> bool:
    """True on a Raspberry Pi, whose camera library comes by apt alone, and with 32 bits."""
    return BITS == 32 or (places.root / SYSTEM_PACKAGES / "picamera2").exists()


def _share_system_packages(effects: Effects, places: InstallPlaces, environment: Path) -> None:
    """Makes an environment see the system's packages, where one that it needs has come since it was built."""
    if _needs_system_packages(places):
        settings = environment / "pyvenv.cfg"
        text = settings.read_text(encoding="utf-8")
        effects.write(settings, re.sub(r"(?m)^(include-system-site-packages = )false$", r"\1true", text))


def _check_system_packages(places: InstallPlaces) -> None:
    """With 32 bits some packages come by apt alone. Raises SetupError where they are missing."""
    missing = [name for name in FROM_APT if not (places.root / SYSTEM_PACKAGES / name).exists()]
    if missing:
        raise SetupError(
            f"With 32 bits {' and '.join(missing)} must come from Debian: sudo apt install "
            f"{' '.join(f'python3-{name}' for name in missing)} python3-opencv. Nothing was changed."
        )


def _keep_wheels(effects: Effects, environment: Path, release: Release, shared: list[Path]) -> None:
    files = {
        file.name: file for one in shared for file in one.glob("*.whl") if not WHEEL.fullmatch(file.name)
    }
    files |= {file.name: file for file in release.folder.glob("*.whl")}
    effects.gather(list(files.values()), environment / WHEELS)


def _explain(problem: str, release: Release) -> str:
    if "not a supported wheel" in problem or "No matching distribution" in problem:
        missing = problem.rpartition("No matching distribution found for ")[2].split(" ")[0]
        return (
            f"{release.folder} has no wheel of {missing or 'a package'} for this computer and its Python: "
            "take the release for its architecture. Nothing was changed."
        )
    if "No space left" in problem:
        return "The disk is full: an environment needs some 400 MB. Free some space. Nothing was changed."
    return f"The environment cannot be built: {problem}. Nothing was changed."
