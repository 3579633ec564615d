"""The names that a shell completes. A shell waits for them: no heavy library is loaded for them."""

import os
import sqlite3
from collections.abc import Iterable
from contextlib import closing
from pathlib import Path

import click
from click.shell_completion import CompletionItem

from server.platform.data_path import DATABASE, data_path
from server.platform.terminal import plain

SESSIONS_MAX = 100
"""The newest ones; a longer list is no help in a shell."""
SESSIONS = "SELECT id, name FROM session WHERE deleted IS NULL ORDER BY id DESC"


class SessionType(click.types.IntParamType):
    """The number of a session, which the shell completes by number or by a part of the name."""

    def shell_complete(
        self,
        ctx: click.Context,
        param: click.Parameter,  # noqa: ARG002 - click's signature
        incomplete: str,
    ) -> list[CompletionItem]:
        """Return the newest matching sessions; none where the data folder cannot be read."""
        database = folder_of(ctx) / DATABASE
        try:
            with closing(sqlite3.connect(f"{database.as_uri()}?mode=ro", uri=True)) as connection:
                rows = connection.execute(SESSIONS).fetchall()
        except sqlite3.Error:
            return []
        part = incomplete.casefold()
        matching = [
            CompletionItem(str(number), help=plain(name))
            for number, name in rows
            if str(number).startswith(part) or part in name.casefold()
        ]
        return matching[:SESSIONS_MAX]


SESSION_NUMBER = SessionType()


def folder_of(ctx: click.Context) -> Path:
    """Return the path of the data folder that the incomplete command line names, or the usual one."""
    return data_path(ctx.params.get("data"), os.environ)


def complete_document(names: Iterable[str], own: Path, incomplete: str) -> list[CompletionItem]:
    """Return the names of shipped documents and of one's own in a folder that fit; files where none does."""
    own_names = [path.stem for path in sorted(own.iterdir())] if own.is_dir() else []
    known = [name for name in dict.fromkeys([*names, *own_names]) if name.startswith(incomplete)]
    # The shell completes paths where there is no name.
    return [CompletionItem(incomplete, type="file"), *map(CompletionItem, known)]
