"""A PostgreSQL server of its own for the tests, in memory, which loses everything with its end."""

import atexit
import os
import shutil
import subprocess
import tempfile
from functools import cache
from itertools import count
from pathlib import Path

from sqlalchemy import create_engine, pool

from server.platform.postgresql_schema import prepare_archive

USER = "postgres" if os.geteuid() == 0 else None
"""PostgreSQL refuses to run as root."""
TEMPLATE = "empty"
_numbers = count(1)


class PostgresServer:
    """A running server in a new folder of `parent`, that listens on a socket there alone."""

    def __init__(self, parent: Path | None) -> None:
        programs = sorted(Path("/usr/lib/postgresql").glob("*/bin"))[-1]
        self.folder = Path(tempfile.mkdtemp(prefix="mucat-pg-", dir=parent))
        self._control = [str(programs / "pg_ctl"), "--pgdata", str(self.folder / "data"), "--silent"]
        if USER:
            shutil.chown(self.folder, USER)
        initdb = [
            str(programs / "initdb"),
            "--pgdata",
            str(self.folder / "data"),
            "--no-sync",
            "--auth=trust",
        ]
        self._run(*initdb, "--username=mucat", "--encoding=UTF8", "--locale=C.UTF-8")
        self.start()

    @property
    def runs(self) -> bool:
        """True until it ends, by itself or not."""
        asked = subprocess.run(
            [*self._control, "status"], user=USER, cwd="/", check=False, stdout=subprocess.DEVNULL
        )
        return asked.returncode == 0

    def start(self) -> None:
        """Start it, and wait until it answers."""
        options = f"-k {self.folder} -c listen_addresses= -c fsync=off -c full_page_writes=off"
        log = str(self.folder / "log")
        self._run(*self._control, "--wait", "--log", log, "--options", options, "start")

    def stop(self) -> None:
        """End it at once, as a crash does."""
        self._run(*self._control, "--mode=immediate", "stop")

    def remove(self) -> None:
        """End it, and remove its files."""
        self.stop()
        shutil.rmtree(self.folder, ignore_errors=True)

    def url(self, database: str) -> str:
        """Return the address of a database."""
        return f"postgresql+psycopg://mucat@/{database}?host={self.folder}"

    def create(self, database: str, template: str = "template1") -> str:
        """Create a database; return its address."""
        engine = create_engine(self.url("postgres"), poolclass=pool.NullPool, isolation_level="AUTOCOMMIT")
        with engine.connect() as connection:
            connection.exec_driver_sql(f"CREATE DATABASE {database} TEMPLATE {template} STRATEGY file_copy")
        return self.url(database)

    def _run(self, *command: str) -> None:
        subprocess.run(command, user=USER, cwd="/", check=True, stdout=subprocess.DEVNULL)


@cache
def postgres() -> PostgresServer:
    """Return the server, started at its first use, with an archive that is copied for each test."""
    memory = Path("/dev/shm")
    server = PostgresServer(memory if memory.is_dir() else None)
    atexit.register(server.remove)
    prepare_archive(server.create(TEMPLATE))
    return server


def new_archive() -> str:
    """Return the address of a new archive with its tables."""
    return postgres().create(f"archive_{os.getpid()}_{next(_numbers)}", TEMPLATE)
