"""Commands and questions to an environment's own programs, as the user of the data."""

import json
from pathlib import Path

from server.features.installation.effects import CommandFailedError, Effects
from server.features.installation.places import USER, InstallPlaces
from server.features.installation.survey import Survey
from server.platform.pidfile import running_parts
from server.platform.settings import DataFolder, SetupError

ORDER_SECONDS = 600.0
"""A copy of a large database on a slow card, or an upload of the firmware."""

DOCTOR_SECONDS = 300.0
"""More than the doctor's own limit for the libraries, so that it can name the one that takes too long."""


def order(effects: Effects, places: InstallPlaces, environment: Path, *arguments: str | Path) -> str:
    """Run a command of a version's own `mucat`. Raise CommandFailedError."""
    program = environment / "bin/mucat"
    return effects.run(
        *("runuser", "-u", USER, "--", program, *arguments),
        environment=_environment(places),
        seconds=ORDER_SECONDS,
    )


def look_at(effects: Effects, places: InstallPlaces, environment: Path) -> Survey:
    """Return a version's survey of its data and the running server. Raise CommandFailedError."""
    # Isolated (-I): no module of the present folder is loaded.
    program = (environment / "bin/python", "-I", "-m", "server.features.installation.survey")
    answer = effects.run(
        *("runuser", "-u", USER, "--", *program), environment=_environment(places), quiet=True
    )
    try:
        return Survey(**json.loads(answer))
    except (ValueError, TypeError) as problem:
        raise CommandFailedError(f"{environment.name} gives no survey of itself: {problem}.") from problem


def refuse_in_use(effects: Effects, places: InstallPlaces) -> None:
    """Raise SetupError while the robot is armed, or may be, or a session is recorded."""
    try:
        survey = look_at(effects, places, places.current)
    except CommandFailedError as failure:
        # It cannot even look at itself: an update may be what mends it.
        survey = Survey(problem=str(failure))
    if survey.armed:
        raise SetupError(
            "The robot is armed, and this ends its runtime: the fins would stop where it swims. "
            "Disarm it first (Disarm or STOP on the page); nothing was changed."
        )
    if survey.armed is None and "runtime" in running_parts(DataFolder(places.data).run):
        raise SetupError(
            f"The robot may be armed: {survey.problem} If you see that it is not, end its runtime: "
            "sudo systemctl stop mucat-runtime. Nothing was changed."
        )
    if survey.recording:
        raise SetupError(
            "A session is being recorded. Stop it first (mucat record stop); nothing was changed."
        )


def list_wrong(effects: Effects, places: InstallPlaces, environment: Path) -> dict[str, str]:
    """Return the problems that a version's doctor finds on this computer: names and texts."""
    answer = effects.run(
        *("runuser", "-u", USER, "--", environment / "bin/mucat", "doctor", "--json"),
        environment=_environment(places),
        seconds=DOCTOR_SECONDS,
        quiet=True,
        accepted=(0, 1),
    )
    try:
        return {
            finding["name"]: finding["text"]
            for finding in json.loads(answer)
            if finding["verdict"] == "wrong"
        }
    except (ValueError, TypeError, KeyError) as problem:
        raise CommandFailedError(f"The doctor of {environment.name} cannot be asked: {problem}.") from problem


def write_services_of(effects: Effects, environment: Path) -> None:
    """Have a version write its services. Raise CommandFailedError."""
    effects.run(environment / "bin/python", "-I", "-m", "server.features.installation.services")


def _environment(places: InstallPlaces) -> dict[str, str]:
    return {"MUCAT_DATA": str(places.data), "MUCAT_CONFIG": str(places.config), "PYTHONPATH": ""}
