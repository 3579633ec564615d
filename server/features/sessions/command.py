"""`mucat sessions` and `mucat record`: sessions from a shell.

Changes go through the server that uses the data folder, since only it may write the database. Without
a server the command makes them itself.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import click

from server.platform.command_line import CommandError, name_error, with_settings
from server.platform.name_completion import SESSION_NUMBER
from server.platform.terminal import echo

if TYPE_CHECKING:
    from server.library.listing import Listing
    from server.library.schemas import SessionDetail
    from server.platform.settings import DataFolder, Settings
    from server.recording.schemas import Session, SessionSummary

SESSION = click.argument("session", type=SESSION_NUMBER)
REQUESTS = {
    "change": ("PATCH", "/sessions/{}"),
    "delete": ("DELETE", "/sessions/{}"),
    "restore": ("POST", "/sessions/{}/restore"),
}


@click.group()
def sessions() -> None:
    """Find sessions, annotate them, delete them."""


@sessions.command("list")
@click.argument("search", nargs=-1, metavar="[WORDS]...")
@click.option("--tag", multiple=True, help="Only sessions with this tag; can be repeated.")
@click.option("--deleted", is_flag=True, help="Show the sessions in the bin instead.")
@with_settings
def list_sessions(settings: "Settings", search: tuple[str, ...], tag: tuple[str, ...], deleted: bool) -> None:
    """List sessions, newest first.

    With WORDS, only those that have each of them in name, notes, tags or scenario.
    """
    from pydantic import ValidationError

    from server.library.listing import SessionSelection

    try:
        selection = SessionSelection(search=" ".join(search), tag=list(tag), deleted=deleted)
    except ValidationError as problem:
        raise CommandError("; ".join(name_error(error) for error in problem.errors())) from problem
    with _open_listing(settings) as listing:
        for page in listing.pages(selection):
            echo(_tabulate(page))


@sessions.command()
@SESSION
@with_settings
def show(settings: "Settings", session: int) -> None:
    """Show a session: contents, bookmarks, gaps."""
    with _open_listing(settings) as listing:
        echo(_describe(listing.detail(session)))


@sessions.command()
@SESSION
@click.argument("tags", nargs=-1)
@click.option("--remove", multiple=True, metavar="TAG", help="Remove this tag; can be repeated.")
@with_settings
def tag(settings: "Settings", session: int, tags: tuple[str, ...], remove: tuple[str, ...]) -> None:
    """Add tags to a session, or remove some."""
    with _open_listing(settings) as listing:
        present = listing.find(session).tags
    chosen = [name for name in dict.fromkeys([*present, *tags]) if name not in remove]
    _change(settings.data, session, tags=chosen)


@sessions.command()
@SESSION
@click.argument("text")
@with_settings
def note(settings: "Settings", session: int, text: str) -> None:
    """Replace the note of a session."""
    _change(settings.data, session, note=text)


@sessions.command()
@SESSION
@with_settings
def delete(settings: "Settings", session: int) -> None:
    """Move a session to the bin."""
    _perform(settings.data, "delete", session, "is in the bin")


@sessions.command()
@SESSION
@with_settings
def restore(settings: "Settings", session: int) -> None:
    """Take a session out of the bin."""
    _perform(settings.data, "restore", session, "is back")


@click.group()
def record() -> None:
    """Record with the running server."""


@record.command()
@click.argument("name", default="")
@click.option("--note", default="", show_default=False, help="The purpose of this dive, its settings.")
@with_settings
def start(settings: "Settings", name: str, note: str) -> None:
    """Start a recording. NAME is the date and time by default."""
    from server.platform.running_server import ask

    session = ask(settings.data, "POST", "/sessions", {"name": name, "note": note})
    echo(f"Recording of “{session['name']}” has begun; it is session {session['id']}.")


@record.command()
@with_settings
def stop(settings: "Settings") -> None:
    """End the present recording."""
    from server.library.listing import SessionSelection
    from server.platform.running_server import ask

    with _open_listing(settings) as listing:
        recording = [session.id for session in listing.page(SessionSelection(state="recording")).sessions]
    if not recording:
        raise CommandError("Nothing is being recorded.")
    session = ask(settings.data, "POST", f"/sessions/{recording[0]}/stop")
    echo(f"Recording of “{session['name']}” has ended after {session['duration']:.1f} s.")


@contextmanager
def _open_listing(settings: "Settings") -> "Iterator[Listing]":
    from server.library.listing import Listing
    from server.platform.shell_store import open_reader

    with open_reader(settings.data) as store:
        yield Listing(store)


def _change(folder: "DataFolder", session: int, **values: Any) -> None:
    from pydantic import ValidationError

    from server.library.schemas import SessionChanges

    try:
        changes = SessionChanges(**values).model_dump(exclude_unset=True)
    except ValidationError as problem:
        raise CommandError("; ".join(error["msg"] for error in problem.errors())) from problem
    _perform(folder, "change", session, "is changed", **changes)


def _perform(folder: "DataFolder", action: str, session: int, outcome: str, **changes: Any) -> None:
    import asyncio

    from server.library.catalogue import Catalogue
    from server.platform.folder_lock import claim
    from server.platform.running_server import ask, server_runs
    from server.platform.shell_store import open_writer

    if server_runs(folder):
        method, path = REQUESTS[action]
        name = ask(folder, method, path.format(session), changes or None)["name"]
    else:
        with claim(folder), open_writer(folder) as store:
            name = asyncio.run(getattr(Catalogue(store), action)(session, **changes)).name
    echo(f"“{name}” {outcome}.")


def _tabulate(rows: "list[Session]") -> str:
    if not rows:
        return "No matching session."
    return "\n".join(
        f"{row.id:5}  {row.started:%Y-%m-%d %H:%M} UTC  {row.duration:8.1f} s  {row.state:11}  "
        f"{_depth(row.summary):>7}  {row.name}"
        + (f"  ({', '.join(row.summary.controllers)})" if row.summary and row.summary.controllers else "")
        + (f"  [{', '.join(row.tags)}]" if row.tags else "")
        for row in rows
    )


def _depth(summary: "SessionSummary | None") -> str:
    return "-" if summary is None or summary.depth is None else f"{summary.depth:.2f} m"


def _describe(session: "SessionDetail") -> str:
    from server.library.crafts import describe_crafts

    lines = [
        f"{session.id}  {session.name}",
        *([session.note] if session.note else []),
        f"{session.state}, {session.origin}, {session.started:%Y-%m-%d %H:%M:%S} UTC, "
        f"{session.duration:.1f} s, {session.bytes} bytes",
        f"greatest depth: {_depth(session.summary)}, "
        f"controllers: {', '.join(session.summary.controllers if session.summary else ()) or '-'}",
        f"tags: {', '.join(session.tags) or '-'}",
        f"robot {session.robot}, version {session.version}, firmware {session.firmware or '-'}, "
        f"software {session.software or '-'}",
        f"craft: {describe_crafts(session.water, session.crafts) or '-'}",
    ]
    for mark in session.marks:
        note = ("\n" + " " * 22).join(mark.text.splitlines())
        lines.append(f"  mark  {mark.time:10.1f} s  {note}")
    if session.markers > len(session.marks):
        lines.append(f"  {session.markers - len(session.marks)} more bookmarks")
    lines += [f"  gap   {gap.time:10.1f} s  {gap.topic}: {gap.kind}, {gap.missed}" for gap in session.gaps]
    if session.gap_count > len(session.gaps):
        lines.append(f"  {session.gap_count - len(session.gaps)} more gaps")
    lines += [f"  topic {topic.name:12} {topic.count:9} samples" for topic in session.topics]
    return "\n".join(lines)
