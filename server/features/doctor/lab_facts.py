"""The facts about a lab for the doctor: its archive, its robots, its certificates, its scheduler."""

import socket
from collections.abc import Mapping
from dataclasses import dataclass, field
from urllib.parse import urlsplit

from server.feature import list_features
from server.platform.lab_config import LabConfig
from server.platform.openssl import CERTIFICATE, read_validity
from server.platform.settings import Settings, SetupError

UNIT = "mucat-lab.service"
SCHEDULER_SECONDS = 3.0


@dataclass(frozen=True, slots=True, kw_only=True)
class LabFacts:
    """The facts. `archive_bytes` is None for a file, and where PostgreSQL does not say it.

    `ends` are the ends of certificates by their files, s since 1970.
    """

    archive: str = ""
    """URL of the archive in PostgreSQL; empty for a file."""
    archive_bytes: int | None = None
    archive_problem: str = ""
    router_state: str = ""
    """State of the router by the running server's health; empty without a server."""
    router_text: str = ""
    robots_state: str = ""
    robots_text: str = ""
    ends: Mapping[str, float] = field(default_factory=dict)
    certificate_problem: str = ""
    scheduler: str = ""
    """Address of the scheduler of sweeps; empty where this computer computes them."""
    scheduler_problem: str = ""


def read_lab(settings: Settings, heard: Mapping[str, tuple[str, str]], *, thorough: bool) -> LabFacts:
    """Read the facts; nothing is changed. `heard`: state and text of parts, by the server.

    Only a thorough examination asks the scheduler.
    """
    archive = settings.section(LabConfig).database
    size, archive_problem = _measure(archive) if archive else (None, "")
    ends, certificate_problem = _read_ends(settings)
    scheduler = _find_scheduler(settings)
    router, robots = heard.get("router", ("", "")), heard.get("robots", ("", ""))
    return LabFacts(
        archive=archive,
        archive_bytes=size,
        archive_problem=archive_problem,
        router_state=router[0],
        router_text=router[1],
        robots_state=robots[0],
        robots_text=robots[1],
        ends=ends,
        certificate_problem=certificate_problem,
        scheduler=scheduler,
        scheduler_problem=_try(scheduler) if scheduler and thorough else "",
    )


def _measure(archive: str) -> tuple[int | None, str]:
    try:
        from server.platform.postgresql_schema import measure_archive

        return measure_archive(archive), ""
    except ImportError:
        return None, "PostgreSQL needs the package psycopg, which is not installed."
    except SetupError as problem:
        return None, str(problem)


def _read_ends(settings: Settings) -> tuple[dict[str, float], str]:
    """Return the ends of the page's and the router's certificates, those that there are."""
    folders = [settings.data.zenoh, *([settings.data.tls] if settings.server.tls else [])]
    files = [file for folder in folders if (file := folder / CERTIFICATE).exists()]
    try:
        return {str(file): read_validity(file).ends for file in files}, ""
    except (OSError, ValueError, SetupError) as problem:
        return {}, f"The certificates cannot be read: {problem}"


def _find_scheduler(settings: Settings) -> str:
    sweeps = list_features()["sweeps"]
    section = sweeps.section_class
    if not settings.has(sweeps) or section is None:
        return ""
    return str(getattr(settings.section(section), "scheduler", ""))


def _try(scheduler: str) -> str:
    """Return the reason why the scheduler cannot be reached; empty where it can."""
    address = urlsplit(scheduler)
    try:
        with socket.create_connection((address.hostname, address.port or 0), SCHEDULER_SECONDS):
            return ""
    except OSError as problem:
        return problem.strerror or str(problem)
