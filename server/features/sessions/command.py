"""`mucat sessions` and `mucat record`: what people do with sessions, from a shell.

What changes something is asked of the server that runs on the data folder, since nothing else may write its
database; where none runs, it is done here.
"""

import argparse
import asyncio
from contextlib import closing
from typing import Any

from pydantic import ValidationError

from server.features.sessions.catalogue import Catalogue, Listing
from server.features.sessions.presence import NotNow, UnknownSession
from server.features.sessions.session import Session, SessionChanges, SessionDetail
from server.platform.running_server import Claim, ask, open_reader, server_runs
from server.platform.schema import prepare
from server.platform.settings import DataFolder, Settings, SetupError
from server.platform.store import Store, StoreError


def perform(options: argparse.Namespace, settings: Settings, claim: Claim) -> int:
    """Do what the command line says. Raises SetupError, with a line for a person, where it cannot be done."""
    try:
        print(_act(options, settings, claim))  # noqa: T201 - a command line speaks
    except (UnknownSession, NotNow) as problem:
        raise SetupError(str(problem)) from problem
    except StoreError as problem:
        raise SetupError(f"The database {settings.data.database} fails: {problem}") from problem
    return 0


def _act(options: argparse.Namespace, settings: Settings, claim: Claim) -> str:
    folder, action = settings.data, options.action
    if options.command == "record":
        return _start(options, folder) if action == "start" else _stop(folder, claim)
    if action in ("list", "show"):
        with open_reader(folder, claim) as store:
            if action == "show":
                return _describe(Listing(store).detail(options.session))
            found = Listing(store).list(" ".join(options.words), options.tag, deleted=options.deleted)
            return _tabulate(found)
    if action == "tag":
        with open_reader(folder, claim) as store:
            tags = [*Listing(store).find(options.session).tags, *options.tags]
        said = _check(tags=[tag for tag in dict.fromkeys(tags) if tag not in options.remove])
    elif action == "note":
        said = _check(note=options.text)
    else:
        said = {}
    session = _change(folder, claim, options.session, action, said)
    words = {"delete": "is in the bin", "restore": "is back"}.get(action, "is changed")
    return f"“{session['name']}” {words}."


def _change(
    folder: DataFolder, claim: Claim, session: int, action: str, said: dict[str, Any]
) -> dict[str, Any]:
    if server_runs(folder, claim):
        path = f"/sessions/{session}"
        method, path = {
            "delete": ("DELETE", path),
            "restore": ("POST", f"{path}/restore"),
        }.get(action, ("PATCH", path))
        changed: dict[str, Any] = ask(folder, method, path, said or None)
        return changed
    with claim(folder):
        prepare(folder)
        with closing(Store(folder.database)) as store:
            catalogue = Catalogue(store)
            if said:
                change = catalogue.change(session, **said)
            else:
                change = catalogue.delete(session) if action == "delete" else catalogue.restore(session)
            return asyncio.run(change).model_dump()


def _check(**said: Any) -> dict[str, Any]:
    try:
        return SessionChanges(**said).model_dump(exclude_unset=True)
    except ValidationError as problem:
        raise SetupError("; ".join(error["msg"] for error in problem.errors())) from problem


def _start(options: argparse.Namespace, folder: DataFolder) -> str:
    session = ask(folder, "POST", "/sessions", {"name": options.name, "note": options.note})
    return f"Recording of “{session['name']}” has begun; it is session {session['id']}."


def _stop(folder: DataFolder, claim: Claim) -> str:
    with open_reader(folder, claim) as store:
        recording = [one.id for one in Listing(store).list() if one.state == "recording"]
    if not recording:
        raise SetupError("Nothing is being recorded.")
    session = ask(folder, "POST", f"/sessions/{recording[0]}/stop")
    return f"Recording of “{session['name']}” has ended after {session['duration']:.1f} s."


def _tabulate(sessions: list[Session]) -> str:
    if not sessions:
        return "No session is like that."
    return "\n".join(
        f"{one.id:5}  {one.started:%Y-%m-%d %H:%M}  {one.duration:8.1f} s  {one.state:11}  {one.name}"
        + (f"  [{', '.join(one.tags)}]" if one.tags else "")
        for one in sessions
    )


def _describe(session: SessionDetail) -> str:
    lines = [
        f"{session.id}  {session.name}",
        *([session.note] if session.note else []),
        f"{session.state}, {session.origin}, {session.started:%Y-%m-%d %H:%M:%S} UTC, "
        f"{session.duration:.1f} s, {session.bytes} bytes",
        f"tags: {', '.join(session.tags) or '-'}",
        f"robot {session.robot}, version {session.version}, firmware {session.firmware or '-'}, "
        f"software {session.software or '-'}",
    ]
    lines += [f"  mark  {mark.time:10.1f} s  {mark.text}" for mark in session.marks]
    lines += [f"  gap   {gap.time:10.1f} s  {gap.topic}: {gap.kind}, {gap.missed}" for gap in session.gaps]
    lines += [f"  topic {topic.name:12} {topic.count:9} samples" for topic in session.topics]
    return "\n".join(lines)
