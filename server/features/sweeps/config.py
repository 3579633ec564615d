"""The section [sweeps] of robot.toml."""

from dataclasses import dataclass
from importlib.util import find_spec
from ipaddress import ip_address
from typing import Annotated
from urllib.parse import urlsplit

from robot_runtime.contract.limits import ConfigError, Range
from robot_runtime.contract.parsing import TOP
from robot_runtime.contract.problems import EntryProblem

NO_DASK = (
    "A scheduler needs the package distributed, which is not installed. Install it where µ-CAT is installed, "
    "with “pip install distributed”."
)


@dataclass(frozen=True, slots=True, kw_only=True)
class SweepsConfig:
    """The computer of sweeps: this one, or the workers of a scheduler of Dask.

    `scheduler` is its address, such as "tls://lab.local:8786"; empty: this computer. `certificates` is the
    folder with `ca.pem`, `certificate.pem` and `key.pem` for it. `workers` is the number of processes on this
    computer; 0: one for each core.
    """

    scheduler: str = ""
    certificates: str = ""
    workers: Annotated[int, Range(0, 256)] = 0

    def __post_init__(self) -> None:
        if problem := find_problem(self.scheduler, self.certificates):
            raise ConfigError(problem)


def has_dask() -> bool:
    """Return True where the package distributed is installed."""
    return find_spec("distributed") is not None


def find_problem(scheduler: str, certificates: str) -> EntryProblem | None:
    """Return the reason why this scheduler cannot be used; None where it can."""
    if not scheduler:
        return None
    where = TOP.field("scheduler")
    try:
        parts = urlsplit(scheduler)
        usable = parts.scheme in ("tls", "tcp") and bool(parts.hostname) and bool(parts.port)
    except ValueError:
        usable = False
    if not usable or parts.path or parts.query or not scheduler.isprintable():
        return where.problem(f"is {scheduler!r}; write tls://NAME:PORT")
    if parts.scheme == "tls" and not certificates:
        return where.problem("is reached with certificates; say in `certificates` where they are")
    if parts.scheme == "tcp" and not _is_here(parts.hostname or ""):
        return where.problem(
            f"is {scheduler!r}: whoever reaches a scheduler without certificates runs code on it and its "
            "workers. Use tls://"
        )
    return None


def _is_here(host: str) -> bool:
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"
