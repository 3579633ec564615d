"""The command lines of `mucat sessions` and `mucat record`; loaded at every start, so it needs little."""

import argparse
from typing import Any


def add_sessions(actions: "argparse._SubParsersAction[Any]", kept: argparse.ArgumentParser) -> None:
    """The command line of `mucat sessions`."""
    found = actions.add_parser("list", parents=[kept], help="list sessions, newest first")
    found.add_argument("words", nargs="*", help="that name, note, tags or scenario have, all of them")
    found.add_argument(
        "--tag", action="append", default=[], help="only with this tag; may come several times"
    )
    found.add_argument("--deleted", action="store_true", help="those in the bin instead")
    show = actions.add_parser("show", parents=[kept], help="show a session: what is in it, marks, gaps")
    tag = actions.add_parser("tag", parents=[kept], help="give a session tags, or take them away")
    note = actions.add_parser("note", parents=[kept], help="write the note of a session")
    delete = actions.add_parser("delete", parents=[kept], help="put a session into the bin")
    restore = actions.add_parser("restore", parents=[kept], help="take a session out of the bin")
    for one in (show, tag, note, delete, restore):
        one.add_argument("session", type=int, help="its number")
    tag.add_argument("tags", nargs="*", help="to be added")
    tag.add_argument("--remove", action="append", default=[], metavar="TAG", help="to be taken away")
    note.add_argument("text", help="the whole note")


def add_record(actions: "argparse._SubParsersAction[Any]", kept: argparse.ArgumentParser) -> None:
    """The command line of `mucat record`."""
    start = actions.add_parser("start", parents=[kept], help="have the running server record")
    start.add_argument("name", nargs="?", default="", help="default: the moment")
    start.add_argument("--note", default="", help="what is tried, with what settings")
    actions.add_parser("stop", parents=[kept], help="end what it records")
