"""The command lines of `mucat pair` and `mucat access`; loaded at every start, so it needs little."""

import argparse
from typing import Any

ROLES = ("viewer", "operator")


def add_pair(commands: "argparse._SubParsersAction[Any]", kept: argparse.ArgumentParser) -> None:
    """The command line of `mucat pair`."""
    pair = commands.add_parser("pair", parents=[kept], help="print a link that signs one browser in")
    pair.add_argument("--role", choices=ROLES, help="default: viewer, or operator while there is none")


def add_access(actions: "argparse._SubParsersAction[Any]", kept: argparse.ArgumentParser) -> None:
    """The command line of `mucat access`."""
    actions.add_parser("list", parents=[kept], help="list browsers and programs that may come in")
    promote = actions.add_parser("promote", parents=[kept], help="make one an operator")
    demote = actions.add_parser("demote", parents=[kept], help="make one a viewer")
    revoke = actions.add_parser("revoke", parents=[kept], help="let one in no longer, from this moment on")
    for one in (promote, demote, revoke):
        one.add_argument("device", type=int, help="its number")
    token = actions.add_parser("token", parents=[kept], help="let a program in, and print its token")
    token.add_argument("name", help="what it is to be called")
    token.add_argument("--role", choices=ROLES, default="viewer", help="default viewer")
