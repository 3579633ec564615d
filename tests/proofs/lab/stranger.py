"""`python -m tests.proofs.lab.stranger LAB ROBOT AUTHORITY FOLDER`: somebody tries to get into a lab.

LAB and ROBOT are their addresses on the network, AUTHORITY is the certificate of the lab's, which is no
secret, FOLDER is a new one. Prints in JSON, for each try, why it
failed; "" where it did not.
"""

import json
import shutil
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from robot_runtime.transport.network import AUTHORITY
from robot_runtime.transport.zenoh_transport import ZenohTransport
from server.http.pinned_requests import OtherServerRefusedError, send
from server.platform.authority import Authority
from server.platform.lab_network import ROBOTS, member_settings
from server.platform.settings import DataFolder, Settings, make_folders

SECONDS = 10.0
TOKEN = "mucat_" + 43 * "A"


def main() -> None:
    lab, robot, authority, folder = sys.argv[1], sys.argv[2], Path(sys.argv[3]), Path(sys.argv[4])
    joining = {"code": "7K3PXQ2M9D", "name": "turtle-9", "address": "", "fingerprint": "", "token": "t"}
    results = {
        "sessions without a sign-in": ask(lab, "GET", "/sessions"),
        "sessions with an invented token": ask(lab, "GET", "/sessions", token=TOKEN),
        "a code of the lab without a sign-in": ask(lab, "POST", "/robots/codes"),
        "joining by an invented code": ask(lab, "POST", "/robots/join", joining),
        "arming a robot without a sign-in": ask(robot, "POST", "/robot/commands/arm", {"unwatched": 0}),
        "stopping it with an invented token": ask(robot, "POST", "/robot/stop", token=TOKEN),
    }
    foreign = make_foreign_certificate(folder, "turtle-1")
    shutil.copyfile(authority, foreign / AUTHORITY)
    tls = {"root_ca_certificate": str(foreign / AUTHORITY), "verify_name_on_connect": False}
    results |= {
        "the router with another lab's certificate": dial(lab, member_settings(foreign)),
        "the router without a certificate": dial(
            lab, {"transport/link/protocols": ["tls"], "transport/link/tls": tls}
        ),
    }
    sys.stdout.write(json.dumps(results))


def ask(address: str, method: str, path: str, body: Mapping[str, Any] | None = None, token: str = "") -> str:
    """Return the reason for which a server refuses; "" where it does not."""
    try:
        send(
            f"https://{address}:8000",
            method,
            path,
            is_meant=lambda _: True,
            token=token,
            body=body,
            seconds=SECONDS,
        )
    except OtherServerRefusedError as problem:
        return f"{problem.status}: {problem}"
    return ""


def make_foreign_certificate(folder: Path, name: str) -> Path:
    """Return a folder with a robot's certificate of another lab."""
    data = DataFolder(folder)
    make_folders(data)
    settings = Settings(data=data, config=folder / "robot.toml")
    issued = folder / "issued"
    authority = Authority(settings, ROBOTS)
    authority.prepare()
    authority.issue(name, issued)
    return issued


def dial(lab: str, network: Mapping[str, Any]) -> str:
    """Return the reason why the lab's router cannot be reached so; "" where it can."""
    try:
        ZenohTransport("turtle-1", connect=[f"tls/{lab}:7447"], client=True, network=network).close()
    except OSError as problem:
        return str(problem)
    return ""


if __name__ == "__main__":
    main()
