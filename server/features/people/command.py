"""`mucat pair` and `mucat access`: who may come in, from the shell of the robot's own computer.

The server that runs is asked, which knows this shell by the token in its data folder.
"""

import argparse
import sys
from datetime import datetime
from typing import Any

from server.features.people.welcome import invitation, shows_pictures
from server.platform.running_server import ask
from server.platform.settings import DataFolder, Settings


def perform(options: argparse.Namespace, settings: Settings) -> int:
    """Do what the command line says. Raises SetupError, with a line for a person, where it cannot be done."""
    lines = _pair(options, settings.data) if options.command == "pair" else _act(options, settings.data)
    print(*lines, sep="\n")  # noqa: T201 - a command line speaks
    return 0


def _pair(options: argparse.Namespace, folder: DataFolder) -> list[str]:
    role = options.role or ("viewer" if _has_operator(folder) else "operator")
    made = ask(folder, "POST", "/access/codes", {"role": role})
    lines = invitation(made["link"], picture=shows_pictures(sys.stdout))
    return [*lines, f"It makes the browser {'an operator' if role == 'operator' else 'a viewer'}."]


def _act(options: argparse.Namespace, folder: DataFolder) -> list[str]:
    match options.action:
        case "list":
            return _tabulate(ask(folder, "GET", "/access/devices"))
        case "token":
            said = {"name": options.name, "role": options.role}
            made = ask(folder, "POST", "/access/tokens", said)
            device = made["device"]
            print(  # noqa: T201 - apart from what another program may read
                f"“{device['name']}” is device {device['id']}. The token is not shown again:", file=sys.stderr
            )
            return [made["token"]]
        case "revoke":
            ask(folder, "DELETE", f"/access/devices/{options.device}")
            return [f"Device {options.device} may not come in any longer."]
        case _:
            role = "operator" if options.action == "promote" else "viewer"
            device = ask(folder, "PATCH", f"/access/devices/{options.device}", {"role": role})
            return [f"“{device['name']}” is {'an operator' if role == 'operator' else 'a viewer'} now."]


def _has_operator(folder: DataFolder) -> bool:
    devices = ask(folder, "GET", "/access/devices")
    return any((one["kind"], one["role"]) == ("browser", "operator") for one in devices)


def _tabulate(devices: list[dict[str, Any]]) -> list[str]:
    if not devices:
        return ["Nobody is paired yet: `mucat pair` prints a link for a browser."]
    return [
        f"{one['id']:5}  {one['role']:8}  {one['kind']:7}  "
        f"last seen {datetime.fromtimestamp(one['seen']):%Y-%m-%d %H:%M}  {one['name']}"
        for one in devices
    ]
