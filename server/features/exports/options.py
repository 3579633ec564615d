"""What `mucat export` and `mucat import` take on their command lines. Loads nothing: it is always loaded."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    Actions = argparse._SubParsersAction[argparse.ArgumentParser]

FORMATS = ("csv", "csv-grid", "jsonl", "parquet", "mcap", "archive", "report")


def add_export(commands: "Actions", kept: argparse.ArgumentParser) -> None:
    """`mucat export`."""
    export = commands.add_parser("export", parents=[kept], help="write a session as a file")
    export.add_argument("session", type=int, help="its number")
    export.add_argument("--format", choices=FORMATS, default="csv", help="default csv")
    export.add_argument("--topics", nargs="+", metavar="TOPIC", help="default all")
    export.add_argument("--columns", nargs="+", metavar="TOPIC.COLUMN", help="of csv-grid; default all")
    export.add_argument("--start", type=float, metavar="S", help="s since the session's start")
    export.add_argument("--end", type=float, metavar="S", help="s since the session's start")
    export.add_argument("--period", type=float, metavar="S", help="of csv-grid: s between lines; default 0.1")
    export.add_argument("-o", "--output", type=Path, help="default: called after the session, here")


def add_import(commands: "Actions", kept: argparse.ArgumentParser) -> None:
    """`mucat import`."""
    taken = commands.add_parser("import", parents=[kept], help="bring in an archive of a session")
    taken.add_argument("file", type=Path, help="what --format archive wrote")
