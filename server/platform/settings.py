"""The server's settings from `robot.toml`, the environment and the command line."""

import fcntl
import os
import re
import socket
import stat
import struct
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, fields, replace
from ipaddress import ip_address
from pathlib import Path
from typing import Any, TypeVar

from robot_runtime.config import (
    ADOPTED_CRAFT,
    Config,
    craft_in_force,
    craft_path,
    parse_table,
    read_file,
    read_table,
)
from robot_runtime.contract.craft import Craft
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.parsing import read_value
from robot_runtime.contract.problems import DocumentEntry
from robot_runtime.control.controllers import check_control
from robot_runtime.durable_files import make_folder, write_whole
from robot_runtime.places import BUILD, DEFAULT_CONFIG, IN_REPOSITORY
from robot_runtime.profile import profile_here
from server.feature import Feature, list_features
from server.platform.data_path import DATABASE, MISSIONS, SCENARIOS, data_path
from server.platform.pidfile import RUNTIME_PAUSED, hold_still, running_parts
from server.platform.server_config import ServerConfig

SOCKET_PATH_BYTES_MAX = 107
"""Linux's limit for the path of a Unix socket (sockaddr_un), without its closing zero."""

OTHERS = stat.S_IRWXG | stat.S_IRWXO
"""The mode bits of other users than the owner."""

NOWHERE = "192.0.2.1"
"""An address of documentation's own network (RFC 5737)."""

SIOCGIFADDR = 0x8915
"""Linux's request for the IPv4 address of a network interface (netdevice(7))."""

ROBOT_NAME = re.compile(r"[a-z0-9][a-z0-9_-]{0,31}")

T = TypeVar("T")


class SetupError(Exception):
    """The server cannot start; the text is one line that says why and what to do."""


RESERVE = "reserve"
"""File of the data folder; see server.platform.disk_reserve."""


class DataFolder:
    """The paths of everything that the server stores, and of the sockets that its processes share."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.database = path / DATABASE
        """Sessions and their samples, and everything else that is stored."""
        self.backups = path / "backups"
        """Copies of the database."""
        self.logs = path / "logs"
        """Output of the supervised processes."""
        self.exports = path / "exports"
        """Exported files."""
        self.imports = path / "imports"
        """Archives while they are imported."""
        self.pulls = path / "pulls"
        """A lab's: archives while they are pulled from robots."""
        self.run = path / "run"
        """Folder of sockets and PID files; emptied at a start if none of the processes still runs."""
        self.lab = path / "lab"
        """Exists where the folder is a lab's, with the URL of its archive where that is in PostgreSQL."""
        self.lock = path / "server.lock"
        """Held by the one server that uses this folder."""
        self.runner = path / "server.pid"
        """PID file of the process that runs the server."""
        self.address = path / "server.address"
        """The address of the server that uses this folder, or used it last."""
        self.token = path / "server.token"
        """The token of this computer's shell for the running server; readable by its user alone."""
        self.audit = path / "audit"
        """The audit log: who did what when (platform/audit_file.py)."""
        self.tls = path / "tls"
        """The robot's certificate and its key."""
        self.zenoh = path / "zenoh"
        """The authority for Zenoh on the network, the robot's certificate, and those that are in force."""
        self.membership = path / "membership"
        """The lab that this robot has joined, and its certificate there (features/membership)."""
        self.paired_robots = path / "robots.json"
        """The robots that have joined this lab (platform/paired_robots.py)."""
        self.router_socket = self.run / "router.sock"
        """The Zenoh endpoint of a lab's router for the lab's own server."""
        self.runtime_socket = self.run / "runtime.sock"
        """The runtime's Zenoh endpoint."""
        self.server_socket = self.run / "server.sock"
        """The server's Zenoh endpoint."""
        self.runtime_paused = self.run / RUNTIME_PAUSED
        """Exists while something else uses the board of a runtime that systemd starts."""
        self.scene_socket = self.run / "scene.sock"
        """The scene's Zenoh endpoint: peers reach only those that they are connected to."""
        self.board_socket = self.run / "board.sock"
        """The emulated board's socket for the simulator."""
        self.board_tty = self.run / "board.tty"
        """The emulated board's end of the serial line."""
        self.board_eeprom = path / "board.eeprom"
        """The emulated board's EEPROM."""
        self.firmware_away = path / "firmware-away"
        """Exists while the robot's board may hold another program than its firmware."""
        self.firmware_previous = path / "firmware-previous.hex"
        """The firmware that was on the board before the last upload of another one."""
        self.upload_progress = self.run / "upload-progress"
        """What avrdude says of the present or last upload."""
        self.bring_up = path / "bring-up.html"
        """The report of the newest bring-up."""
        self.scenario_before = path / "scenario-before.json"
        """Exists while a scenario runs on the robot: the settings before it."""
        self.scenarios = path / SCENARIOS
        """Your own scenarios."""
        self.missions = path / MISSIONS
        """Your own missions: a folder each, with their versions."""
        self.wall_clock = path / "wall-clock.json"
        """The last known time (platform/wall_clock.py)."""
        self.film = path / "film.json"
        """The choice of the film that people have made, and its sizes (features/film/choice.py)."""
        self.reserve = path / RESERVE
        """Room on the disk that is given up for deletions (platform/disk_reserve.py)."""
        self.config = path / "robot.toml"
        """The robot's configuration, unless the present folder has one."""
        self.last_config = path / "robot.toml.last"
        """The last configuration that could be used, for services where the present one cannot be."""
        self.craft = path / ADOPTED_CRAFT
        """The adopted craft (docs/use/identify.md)."""
        self.craft_before = path / "craft-before.toml"
        """The craft before the last adoption; empty if there was none."""
        self.panels = path / "panels"
        """Your own panels for the page (docs/use/panels.md)."""

    @property
    def database_location(self) -> Path | str:
        """The database: its file, or the URL of a lab's archive in PostgreSQL."""
        try:
            return self.lab.read_text(encoding="utf-8").strip() or self.database
        except FileNotFoundError:
            return self.database


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings(Config):
    """All of robot.toml as it is in force, and what only the command line, the environment and the place say.

    `build` is the folder that holds the emulated board and the firmware.
    """

    data: DataFolder
    config: Path
    config_text: str = ""
    """The text of `config` as it was read; the file may have changed since."""
    features: Mapping[str, bool] = field(default_factory=dict)
    """The optional features that robot.toml switches on or off, by name."""
    sections: Mapping[type, object] = field(default_factory=dict)
    """The server's section and those of features, by their classes, where they differ from the defaults."""
    mistakes: tuple[str, ...] = ()
    """Of the emulated board; see robot_runtime/simulation/boards/mistakes.py."""
    uncalibrated: bool = False
    """The emulated board begins without a calibration."""
    external_runtime: bool = False
    """The runtime is a service of its own, which this server does not start and does not end."""
    configuration_problem: str = ""
    """Reason why these are the settings of the last configuration instead; empty if they are not."""
    lab: bool = False
    """The server is a lab's: it has no robot, and keeps the sessions of several."""
    every_feature: bool = False
    """All features are on, whatever their sections say: for the description of the interface."""
    build: Path = BUILD
    page: Path = Path(__file__).parents[1] / "page"
    help_pages: Path = Path(__file__).parents[1] / "help"

    def section(self, kind: type[T]) -> T:
        """Return the section of robot.toml that the server or a feature declares with this class."""
        section = self.sections.get(kind)
        return section if isinstance(section, kind) else kind()

    def with_section(self, section: object) -> "Settings":
        """Return these settings with another section of the server or of a feature."""
        return replace(self, sections={**self.sections, type(section): section})

    @property
    def server(self) -> ServerConfig:
        """The server's own section."""
        return self.section(ServerConfig)

    def has(self, feature: Feature) -> bool:
        """Return True where this feature is on."""
        if self.every_feature:
            return True
        if feature.place not in ("both", "lab" if self.lab else "robot"):
            return False
        if feature.optional and not self.features.get(feature.name, True):
            return False
        section = feature.section_class
        return section is None or feature.is_on(self.section(section))

    @property
    def scheme(self) -> str:
        """The scheme of its addresses."""
        return "https" if self.server.tls else "http"

    @property
    def only_here(self) -> bool:
        """True where no other computer can reach the server."""
        return is_loopback(self.server.host) and not self.server.public_url

    def base_url(self, called: str = "") -> str:
        """Return the server's address for a browser; `called` is the host name of the browser's request.

        Where others can reach the server, the address works for them too.
        """
        if self.server.public_url:
            return self.server.origin
        usable = called in self._names or (_is_address(called) and not is_loopback(called))
        return self._url(called) if usable else self.base_urls()[0]

    def base_urls(self) -> list[str]:
        """Return every address for browsers elsewhere; the local one if no other computer can connect."""
        if self.server.public_url:
            return [self.server.origin]
        return [self._url(name) for name in self._names or [self.server.host]]

    @property
    def _names(self) -> list[str]:
        return [name for name in self.server.allowed_hosts if self.only_here or not is_loopback(name)]

    def _url(self, name: str) -> str:
        return f"{self.scheme}://{name}:{self.server.port}"

    @property
    def craft_file(self) -> Path:
        """The craft file in force, which need not exist."""
        return craft_path(self, self.config, self.data.path)

    def read_craft(self) -> Craft:
        """Return the craft in force. Raise ConfigError where its file cannot be used."""
        return craft_in_force(self, self.config, self.data.path)

    @property
    def emulated_board(self) -> bool:
        """True where the robot's board is an emulated one."""
        return self.robot.mode == "emulated" or (self.in_the_loop and self.hil.board == "emulated")

    @property
    def in_the_loop(self) -> bool:
        """True where a simulator feeds the board's sensors."""
        return self.robot.mode == "hil"


def read_settings(
    config: Path | None,
    data: Path | None,
    host: str | None,
    port: int | None,
    environment: Mapping[str, str],
) -> Settings:
    """Read the settings: command line before environment before `robot.toml`. Raise SetupError if invalid.

    Without a `config` it is robot.toml in the present folder, else the data folder's, else the default one.
    """
    folder = data_folder(data, environment)
    config = config or find_config(folder)
    try:
        text = read_file(config)
        table = read_table(text, config)
        loaded = parse_table(table, config)
        features, sections = _read_sections(table, DocumentEntry(config.name))
        check_control(loaded.control)
    except ConfigError as problem:
        raise SetupError(f"{problem}. Correct the file, or name another with --config.") from problem
    _check_socket_paths(folder)
    try:
        craft_in_force(loaded, config, folder.path)
    except ConfigError as problem:
        raise SetupError(f"{problem}. Correct or remove the craft file.") from problem
    if not ROBOT_NAME.fullmatch(loaded.robot.name):
        raise SetupError(f"{config}: robot.name is {loaded.robot.name!r}; use up to 32 of a-z, 0-9, - and _.")
    server = sections[ServerConfig]
    host = host or server.host
    server = replace(
        server,
        host=host,
        port=server.port if port is None else port,
        allowed_hosts=_allowed_hosts(server.allowed_hosts, host),
    )
    if not 0 < server.port < 65536:
        raise SetupError(f"The port is {server.port}; it must be a whole number from 1 to 65535.")
    sections_of_robot = {field.name: getattr(loaded, field.name) for field in fields(Config)}
    return Settings(
        **sections_of_robot | {"robot": replace(loaded.robot, profile=profile_here(loaded))},
        data=folder,
        config=config.absolute(),
        config_text=text,
        features=features,
        sections={**sections, ServerConfig: server},
        lab=folder.lab.exists(),
    )


def _read_sections(
    table: Mapping[str, Any], where: DocumentEntry
) -> tuple[Mapping[str, bool], Mapping[type, Any]]:
    """Return the switches of optional features, and the sections beside the robot's. Raise ConfigError."""
    features = list_features().values()
    named = {feature.name: feature for feature in features if feature.section}
    optional = [feature.name for feature in features if feature.optional]
    known = [*(field.name for field in fields(Config)), "server", "features", *named]
    problems = [
        where.field(name, repr(name)).problem(f"is not known here; known are {', '.join(known)}")
        for name in table
        if name not in known
    ]
    switched = read_value(dict[str, bool], table.get("features", {}), where.field("features"))
    problems += [
        where.field("features")
        .field(name)
        .problem(f"is no optional feature; there are {', '.join(optional)}")
        for name in switched
        if name not in optional
    ]
    if problems:
        raise ConfigError(*problems)
    sections: dict[type, Any] = {}
    sections[ServerConfig] = read_value(ServerConfig, table.get("server", {}), where.field("server"))
    for name, feature in named.items():
        section = feature.section_class
        if name in table and section is not None:
            entries = _without_removed(table[name], feature.removed, where.field(name))
            sections[section] = read_value(section, entries, where.field(name))
    return switched, sections


def _without_removed(section: Any, removed: Sequence[str], where: DocumentEntry) -> Any:
    """Return a section without empty entries of earlier versions.

    Raise ConfigError where one is not empty.
    """
    if not isinstance(section, dict):
        return section
    used = [name for name in removed if section.get(name)]
    if used:
        reason = "is no longer there; remove the entry. The changelog says what to use"
        raise ConfigError(*(where.field(name).problem(reason) for name in used))
    return {name: value for name, value in section.items() if name not in removed}


def data_folder(data: Path | None, environment: Mapping[str, str]) -> DataFolder:
    """Return the data folder named by the command line, else by the environment."""
    return DataFolder(data_path(data, environment))


def find_config(folder: DataFolder) -> Path:
    """Return the path of the configuration if the command line names none."""
    paths = (path for path in (Path("robot.toml"), folder.config) if path.exists())
    return next(paths, DEFAULT_CONFIG)


def keep_config(settings: Settings) -> Settings:
    """Put the default configuration into the data folder for editing, where there is no configuration.

    Raise SetupError where it cannot.
    """
    if settings.config != DEFAULT_CONFIG or IN_REPOSITORY:
        return settings
    try:
        write_whole(settings.data.config, DEFAULT_CONFIG.read_bytes())
    except OSError as problem:
        raise SetupError(f"{settings.data.config} cannot be written: {problem.strerror}.") from problem
    return replace(settings, config=settings.data.config)


def make_folders(folder: DataFolder) -> None:
    """Create the data folder, for this user alone, and empty its `run` where nothing runs.

    Raise SetupError where it cannot.
    """
    try:
        for path in (folder.path, folder.logs, folder.run):
            make_folder(path)
        _make_private(folder)
        with hold_still(folder.run):
            # The files belong to processes of a killed server as long as one of them runs.
            if not running_parts(folder.run):
                for file in folder.run.iterdir():
                    file.unlink()
    except OSError as problem:
        raise SetupError(
            f"The data folder {folder.path} cannot be used: {problem.strerror}. Choose another with --data."
        ) from problem


def _make_private(folder: DataFolder) -> None:
    """Remove others' rights on the folder: older versions let them read it. Raise OSError."""
    known = [path for path in vars(folder).values() if path != folder.path and path.is_dir()]
    files = [file for file in folder.path.iterdir() if not file.is_dir()]
    for path in (folder.path, *files, *known, *(inner for parent in known for inner in parent.rglob("*"))):
        with suppress(FileNotFoundError):  # a process of a killed server may just have removed it
            status = path.lstat()
            if status.st_uid == os.geteuid() and status.st_mode & OTHERS and not path.is_symlink():
                path.chmod(stat.S_IMODE(status.st_mode) & ~OTHERS)


def _allowed_hosts(names: list[str], host: str) -> list[str]:
    everywhere = host in ("0.0.0.0", "::")
    own = _own_names() if everywhere else [f"[{host}]" if ":" in host else host]
    return [*dict.fromkeys(name.lower() for name in [*names, *own])]


def _own_names() -> list[str]:
    """Return this computer's addresses, first that of its outgoing packets, and its names.

    No foreign page can make a browser take such an address for the page's own.
    """
    name = socket.gethostname().lower()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        addresses = [_interface_address(probe, interface) for _, interface in socket.if_nameindex()]
        try:
            probe.connect((NOWHERE, 9))  # which sends nothing
            addresses.insert(0, probe.getsockname()[0])
        except OSError:
            pass  # no network beyond its own
    return [
        *(address for address in addresses if address and not is_loopback(address)),
        f"{name}.local",
        name,
    ]


def _interface_address(probe: socket.socket, interface: str) -> str:
    """Return the IPv4 address of a network interface; empty where it has none."""
    try:
        request = fcntl.ioctl(probe, SIOCGIFADDR, struct.pack("256s", interface.encode()[:15]))
    except OSError:
        return ""
    return socket.inet_ntoa(request[20:24])


def _is_address(name: str) -> bool:
    try:
        ip_address(name.strip("[]"))
    except ValueError:
        return False
    return True


def is_loopback(name: str) -> bool:
    """Return True where this address or name always means the computer itself."""
    try:
        return ip_address(name.strip("[]")).is_loopback
    except ValueError:
        return name == "localhost"


def _check_socket_paths(folder: DataFolder) -> None:
    longest = max(
        (folder.runtime_socket, folder.server_socket, folder.scene_socket, folder.board_socket),
        key=lambda path: len(os.fsencode(path)),
    )
    size = len(os.fsencode(longest))
    if size > SOCKET_PATH_BYTES_MAX:
        raise SetupError(
            f"The data folder's path is too long: {longest} has {size} bytes, and a Unix socket's path may "
            f"have {SOCKET_PATH_BYTES_MAX}. Choose a shorter one with --data."
        )
