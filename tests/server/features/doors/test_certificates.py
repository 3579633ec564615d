"""`mucat certificate` and `mucat simulator`, as somebody types them."""

import os
import subprocess
from pathlib import Path

import pytest

from robot_runtime.transport.network import connect_settings
from server.cli import main
from server.platform.authority import Authority
from server.platform.pidfile import PidFile
from server.platform.settings import Settings


def test_certificates_are_issued_listed_and_revoked(
    settings: Settings, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def shell(*arguments: str, status: int = 0) -> str:
        common = ("--data", str(settings.data.path), "--config", str(settings.config))
        assert main(["certificate", *arguments, *common]) == status
        output = capsys.readouterr()
        return output.err if status else output.out

    assert shell("list") == "There is none: mucat certificate issue NAME makes one.\n"
    folder = tmp_path / "lab"
    issued = shell("issue", "lab", "--to", str(folder))
    assert "mucat simulator --connect tls/ADDRESS:PORT --certificate lab --robot tested" in issued
    connect_settings(folder)
    assert shell("list").endswith("  lab\n")
    assert "Revoke it first" in shell("issue", "lab", "--to", str(tmp_path / "again"), status=1)
    # A robot that runs has read the certificates already.
    PidFile(settings.data.runner).write(os.getpid(), "")
    assert shell("revoke", "lab") == (
        "The certificate lab is revoked.\n"
        "The running robot takes note when mucat run is ended and started again.\n"
    )
    assert "There is none" in shell("list")
    refused = shell("revoke", "lab", status=1)
    assert "There is no certificate lab" in refused
    assert "ROS 2 program is revoked under People, or with mucat access revoke" in refused


def test_a_simulator_without_its_files_is_refused_in_words(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    there = ["--connect", "tls/192.0.2.7:7447", "--certificate", str(tmp_path)]
    assert main(["simulator", *there]) == 1
    assert "lacks authority.pem, certificate.pem, key.pem" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (None, "the craft file {file} cannot be read: [Errno 2] No such file or directory"),
        ("title = 'Two'\n[craft]\nmas = 2.5\n", "two.toml: craft: 'mas' is not known here; known are mass"),
        (
            "title = 'Two'\n[craft]\nmass = 99\n",
            "two.toml: craft: mass is 99; it must lie between 0.75 and 12",
        ),
        ("[craft\n", "two.toml: the craft file is not TOML"),
    ],
)
def test_a_simulator_refuses_a_craft_file_in_words(
    settings: Settings, tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str | None, why: str
) -> None:
    Authority(settings).issue("lab", tmp_path / "lab")
    file = tmp_path / "two.toml"
    if text is not None:
        file.write_text(text)
    there = ["--connect", "tls/192.0.2.7:7447", "--certificate", str(tmp_path / "lab")]
    assert main(["simulator", *there, "--craft", str(file)]) == 1
    assert why.format(file=file) in capsys.readouterr().err


def test_the_simulator_swims_the_craft_of_the_file(
    settings: Settings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    Authority(settings).issue("lab", tmp_path / "lab")
    file = tmp_path / "two.toml"
    file.write_text("title = 'Two'\n[craft]\nmass = 2.5\n")
    started: list[list[str]] = []
    monkeypatch.setattr(subprocess, "Popen", started.append)
    monkeypatch.setattr(os, "execv", lambda _, message: started.append(message))
    there = ["--connect", "tls/192.0.2.7:7447", "--certificate", str(tmp_path / "lab")]
    main(["simulator", *there, "--craft", str(file)])
    main(["simulator", *there])
    _, water, _, default = started
    assert water[water.index("--craft") + 1] == str(file)
    assert "--craft" not in default
