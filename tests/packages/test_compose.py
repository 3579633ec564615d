"""Robot and lab as containers: every name in their compose files is one that exists."""

import tomllib
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import click
import yaml  # type: ignore[import-untyped]
from distributed.cli.dask_scheduler import main as dask_scheduler

from packages.image import CONFIG, DATA, ENVIRONMENT
from robot_runtime.places import PACKAGES
from server import VERSION
from server.cli import mucat
from server.features.roster.router_process import PORT
from server.features.sweeps.config import SweepsConfig
from server.platform.lab_config import LabConfig
from server.platform.settings import Settings, read_settings

FOLDER = PACKAGES / "packages/lab"
COMPOSE: dict[str, Any] = yaml.safe_load((FOLDER / "compose.yaml").read_text())
SERVICES: dict[str, dict[str, Any]] = COMPOSE["services"]
OURS = ("lab", "scheduler", "worker")
ROBOT: dict[str, Any] = yaml.safe_load((PACKAGES / "packages/robot/compose.yaml").read_text())
KEYS = {
    "profiles",
    "image",
    "restart",
    "command",
    "environment",
    "ports",
    "volumes",
    "depends_on",
    "healthcheck",
}
"""Of a service, as the Compose specification names them."""
PASSWORD = "${ARCHIVE_PASSWORD:?write it into the file .env}"


def settings_of(folder: Path, text: str) -> Settings:
    config = folder / "robot.toml"
    config.write_text(text)
    return read_settings(config, folder, None, None, {})


def test_it_has_the_keys_of_a_compose_file_and_its_images_are_those_that_are_built() -> None:
    assert COMPOSE.keys() == {"name", "services", "volumes"}
    assert SERVICES.keys() == {"archive", *OURS}
    for name, service in SERVICES.items():
        assert service.keys() <= KEYS, name
        assert service["image"] == ("postgres:17" if name == "archive" else f"mucat:{VERSION}")
        assert set(service.get("depends_on", ())) <= SERVICES.keys()
    assert SERVICES["lab"]["depends_on"] == {"archive": {"condition": "service_healthy"}}


def test_the_robot_of_the_image_is_for_this_computer_alone(tmp_path: Path) -> None:
    assert ROBOT.keys() == {"name", "services", "volumes"}
    (robot,) = ROBOT["services"].values()
    assert robot.keys() <= KEYS
    assert robot["image"] == f"mucat:{VERSION}"
    port = settings_of(tmp_path, "").server.port
    assert robot["ports"] == [f"127.0.0.1:{port}:{port}"]
    (volume,) = robot["volumes"]
    assert volume.split(":") == [*ROBOT["volumes"], DATA]


def test_its_volumes_are_declared_and_its_files_are_there() -> None:
    mounts = [mount.split(":") for service in SERVICES.values() for mount in service["volumes"]]
    named = {source for source, *_ in mounts if not source.startswith(".")}
    assert named == COMPOSE["volumes"].keys()
    assert {source for source, *_ in mounts} - named == {"./robot.toml", "./tls"}
    assert (FOLDER / "robot.toml").is_file()
    assert ["lab", DATA] in mounts
    assert f"MUCAT_DATA={DATA}" in CONFIG


def test_its_commands_can_be_typed_so() -> None:
    for name in ("lab", "worker"):
        program, *arguments = SERVICES[name]["command"]
        assert program == "mucat"
        command: click.Command = mucat
        while isinstance(command, click.Group):
            inner = command.get_command(click.Context(command), arguments.pop(0))
            assert inner is not None
            command = inner
        command.make_context(name, arguments)
    dask, scheduler, *arguments = SERVICES["scheduler"]["command"]
    assert (dask, scheduler) == (f"{ENVIRONMENT}/bin/dask", "scheduler")
    parameters = {
        option for parameter in dask_scheduler.params for option in parameter.opts + parameter.secondary_opts
    }
    assert {word for word in arguments if word.startswith("--")} <= parameters


def test_the_configuration_names_the_services_and_their_ports(tmp_path: Path) -> None:
    text = (FOLDER / "robot.toml").read_text()
    lab = settings_of(tmp_path, text)
    archive, inner = urlsplit(lab.section(LabConfig).database), SERVICES["archive"]["environment"]
    assert (archive.hostname, archive.username, archive.path) == (
        "archive",
        inner["POSTGRES_USER"],
        f"/{inner['POSTGRES_DB']}",
    )
    outer = SERVICES["lab"]["environment"]
    assert (inner["POSTGRES_PASSWORD"], outer["PGPASSWORD"]) == (PASSWORD, PASSWORD)
    assert f"./robot.toml:{outer['MUCAT_CONFIG']}:ro" in SERVICES["lab"]["volumes"]
    assert SERVICES["lab"]["ports"] == [f"{port}:{port}" for port in (lab.server.port, PORT)]
    assert (lab.server.host, lab.server.tls) == ("0.0.0.0", True)
    # With the lines that a cluster needs.
    cluster = settings_of(
        tmp_path,
        text.replace("# [sweeps]", "[sweeps]").replace("# scheduler", "scheduler").replace("# cert", "cert"),
    )
    sweeps = cluster.section(SweepsConfig)
    scheduler = urlsplit(sweeps.scheduler)
    assert scheduler.hostname in SERVICES
    assert SERVICES["scheduler"]["ports"] == [f"{scheduler.port}:{scheduler.port}"]
    assert SERVICES["worker"]["command"][2:] == [
        "--scheduler",
        sweeps.scheduler,
        "--certificates",
        sweeps.certificates,
    ]
    for name in OURS:
        assert f"./tls:{sweeps.certificates}:ro" in SERVICES[name]["volumes"]
    assert tomllib.loads(text)["robot"]["name"] == lab.robot.name
