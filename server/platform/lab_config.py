"""The section [lab] of robot.toml, for a server without a robot."""

from dataclasses import dataclass
from urllib.parse import urlsplit

POSTGRESQL = "postgresql+psycopg://"


@dataclass(frozen=True, slots=True, kw_only=True)
class LabConfig:
    """The lab: a server without a robot, which keeps the sessions of several (docs/run/lab.md)."""

    database: str = ""

    def __post_init__(self) -> None:
        if not self.database:
            return
        if not self.database.startswith(POSTGRESQL):
            raise ValueError(
                f"database is {self.database!r}; write it like {POSTGRESQL + '/mucat'!r}, or leave it empty "
                "for a file in the data folder"
            )
        if urlsplit(self.database).password is not None:
            raise ValueError(
                "database has a password; put it into the file ~/.pgpass, which PostgreSQL reads"
            )
