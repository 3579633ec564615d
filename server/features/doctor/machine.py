"""The facts about the computer, read once, for the doctor's checks."""

import fcntl
import grp
import os
import platform
import pwd
import re
import socket
import struct
import subprocess
import sys
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path

from server.feature import list_features
from server.features.doctor.lab_facts import UNIT, LabFacts, read_lab
from server.platform.disk_space import free_bytes
from server.platform.settings import Settings
from server.platform.supply_voltage import read_throttled
from server.platform.wall_clock import is_synchronised
from server.platform.word_size import BITS

GPIO_GET_CHIPINFO = 0x8044B401
"""ioctl of a GPIO character device (linux/gpio.h): name and label, 32 bytes each, and a number."""
IMPORT_SECONDS = 120.0
"""The longest import of all libraries, on a Raspberry Pi Zero."""
LIBRARIES = ("zenoh", "numpy", "cv2", "pydantic_core", "sqlalchemy", "serial", "cobs")
"""Modules with compiled parts, and those that speak with the board: importing them shows a wrong wheel."""
SERVICE = "mucat.service"
WARM = 25.0
"""°C of the warmest fresh water that a robot is expected in."""
BRLTTY, MODEM_MANAGER = "brltty", "ModemManager"
NOTHING_HEARD: Mapping[str, tuple[str, str]] = {}


@dataclass(frozen=True, slots=True, kw_only=True)
class Machine:
    """The facts. An empty text, None or an empty list stands for a missing part of this computer.

    Sizes in bytes, times in s since 1970 (UTC).
    """

    mode: str = "robot"
    python: tuple[int, int] = (3, 11)
    system: str = ""
    architecture: str = ""
    bits: int = 64
    model: str = ""
    """Name of the Raspberry Pi; empty for another computer."""
    broken_libraries: dict[str, str] | None = field(default_factory=dict)
    """Why a library cannot be imported, by its name; None where that was not tried."""
    configuration_problem: str = ""
    data: str = ""
    data_writable: bool = True
    disk_free: int = 10**10
    disk_read_only: bool = False
    database_problem: str = ""
    firmware: str = ""
    firmware_there: bool = True
    port: str = "/dev/serial0"
    port_there: bool = True
    port_target: str = ""
    """Device that the port's link leads to."""
    serial0_target: str = ""
    """Device that /dev/serial0 leads to, by which name the kernel's console is set."""
    port_problem: str = ""
    other_ports: tuple[str, ...] = ()
    """The serial ports that are there."""
    port_takers: tuple[str, ...] = ()
    """Of brltty and ModemManager, those that open a USB adapter as soon as it is plugged in."""
    link_state: str = ""
    """State of the link by the running server's health; empty without a server."""
    link_text: str = ""
    events_named: bool = False
    """`[events]` in robot.toml names a broker."""
    events_state: str = ""
    events_text: str = ""
    boot_settings: str = ""
    """Text of config.txt."""
    kernel_line: str = ""
    """Text of cmdline.txt."""
    login_on_port: bool = False
    boot_folder: str = "/boot/firmware"
    user: str = "mucat"
    groups: frozenset[str] = frozenset()
    reset: str = "dtr"
    reset_label: str = ""
    reset_problem: str = ""
    mass: float = 3.0
    """kg, of the craft in force."""
    reserve: float = 0.0
    """g of buoyancy, as weighed; 0: not known."""
    warm_reserve: float = 0.0
    """g of it that are left in warm fresh water."""
    camera: str = "pi"
    camera_library: bool = True
    cameras: tuple[str, ...] = ()
    now: float = 0.0
    clock_synchronised: bool = True
    throttled: int | None = None
    """The bits of platform/supply_voltage.py; None where there is no such file."""
    memory_cgroup: bool = True
    memory: int = 10**9
    swaps: tuple[str, ...] = ()
    address: str = "127.0.0.1:8000"
    address_problem: str = ""
    server_runs: bool = False
    runtime_outdated: bool = False
    """The running runtime was started by another version, or with another configuration."""
    units: dict[str, str] = field(default_factory=dict)
    """Texts of the installed units, by name."""
    lab: LabFacts | None = None
    """Facts of a lab, which has no robot; None for a robot."""


def read_machine(
    settings: Settings,
    now: float,
    heard: Mapping[str, tuple[str, str]] = NOTHING_HEARD,
    *,
    thorough: bool = True,
    root: Path = Path("/"),
) -> Machine:
    """Read the facts of this computer; nothing is changed. `heard`: state and text of parts, by the server.

    Only a thorough examination imports the libraries, in another process, and opens an unused serial port.
    """
    computer = _read_computer(settings, now, root, thorough=thorough)
    if settings.lab:
        return replace(computer, lab=read_lab(settings, heard, thorough=thorough))
    return _add_robot(computer, settings, heard, root, thorough=thorough)


def _read_computer(settings: Settings, now: float, root: Path, *, thorough: bool) -> Machine:
    """Read the facts that a robot and a lab have."""
    from server.platform.folder_lock import runner_of

    units = {file.name: _read(file) for file in (root / "etc/systemd/system").glob("mucat*.*")}
    serves = runner_of(settings.data) is not None
    return Machine(
        python=sys.version_info[:2],
        system=_pretty_name(_read(root / "etc/os-release")),
        architecture=platform.machine(),
        bits=BITS,
        model=_read(root / "proc/device-tree/model").strip("\0\n "),
        broken_libraries=_try_libraries() if thorough else None,
        configuration_problem=settings.configuration_problem,
        data=str(settings.data.path),
        data_writable=os.access(_existing(settings.data.path), os.W_OK),
        disk_free=free_bytes(_existing(settings.data.path)),
        disk_read_only=_is_read_only(_existing(settings.data.path), _read(root / "proc/mounts")),
        database_problem=_try_database(settings),
        user=_service_user(units.get(UNIT if settings.lab else SERVICE, "")),
        now=now,
        clock_synchronised=is_synchronised(),
        memory=os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"),
        swaps=tuple(line.split()[0] for line in _read(root / "proc/swaps").splitlines()[1:] if line),
        address=(_announced(settings) if serves else "") or f"{settings.server.host}:{settings.server.port}",
        address_problem="" if serves else _try_address(settings.server.host, settings.server.port),
        server_runs=serves,
        units=units,
    )


def _add_robot(
    computer: Machine,
    settings: Settings,
    heard: Mapping[str, tuple[str, str]],
    root: Path,
    *,
    thorough: bool,
) -> Machine:
    """Read the facts that only a robot has."""
    from robot_runtime.link.port import list_ports
    from server.platform.pidfile import running_parts

    link, events = heard.get("link", ("", "")), heard.get("events", ("", ""))
    boot = next(
        (folder for folder in ("boot/firmware", "boot") if (root / folder / "config.txt").exists()), ""
    )
    port, serial0 = Path(settings.link.port), root / "dev/serial0"
    runtime = running_parts(settings.data.run).get("runtime")
    reset_label, reset_problem = _read_reset(settings.link.reset)
    firmware = _firmware(settings)
    mass, reserve, warm_reserve = _read_weighing(settings)
    return replace(
        computer,
        mode=settings.robot.mode if not settings.emulated_board else "emulated",
        firmware=str(firmware),
        firmware_there=firmware.exists(),
        port=str(port),
        port_there=port.exists(),
        port_target=port.resolve().name if port.is_symlink() else "",
        serial0_target=serial0.resolve().name if serial0.is_symlink() else "",
        port_problem="" if runtime or not thorough else _try_port(port, settings.link.baud),
        other_ports=tuple(list_ports(root / "dev")),
        port_takers=_find_port_takers(root),
        link_state=link[0],
        link_text=link[1],
        events_named=settings.has(list_features()["events"]),
        events_state=events[0],
        events_text=events[1],
        boot_settings=_read(root / boot / "config.txt") if boot else "",
        kernel_line=_read(root / boot / "cmdline.txt") if boot else "",
        login_on_port=_has_login(root, port),
        boot_folder=f"/{boot}",
        groups=_groups_of(computer.user),
        reset=settings.link.reset,
        reset_label=reset_label,
        reset_problem=reset_problem,
        mass=mass,
        reserve=reserve,
        warm_reserve=warm_reserve,
        camera=_camera(settings),
        camera_library=_has_picamera(),
        cameras=_list_cameras(root),
        throttled=read_throttled(root),
        memory_cgroup=_has_memory_cgroup(root),
        runtime_outdated=runtime is not None and runtime.fingerprint != _fingerprint(settings),
    )


def _read(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""


def _announced(settings: Settings) -> str:
    """Return host and port of the running server, which may differ from the configuration's."""
    return _read(settings.data.address).strip().partition("://")[2]


def _existing(path: Path) -> Path:
    """Return the path, or the nearest of its parents that exists."""
    while not path.exists():
        path = path.parent
    return path


def _is_read_only(path: Path, mounts: str) -> bool:
    """Return True for a disk that cannot be written, also where the kernel disabled it after a failed write.

    From Linux 6.15 on only the options of such a mount, its fourth word, say so.
    """
    if os.statvfs(path).f_flag & os.ST_RDONLY:
        return True
    entries = [line.split() for line in mounts.splitlines()]
    above = [entry for entry in entries if len(entry) > 3 and path.is_relative_to(entry[1])]
    # Of several at one place the last one covers the others.
    nearest = sorted(above, key=lambda entry: len(Path(entry[1]).parts))[-1:]
    return any("emergency_ro" in entry[3].split(",") for entry in nearest)


def _pretty_name(release: str) -> str:
    match = re.search(r'^PRETTY_NAME="?([^"\n]*)', release, re.MULTILINE)
    return match[1] if match else ""


def _service_user(unit: str) -> str:
    """Return the user of the installed service, or the present one without a service."""
    match = re.search(r"^User=(\S+)", unit, re.MULTILINE)
    if match:
        return match[1]
    with suppress(KeyError):
        return pwd.getpwuid(os.geteuid()).pw_name
    return str(os.geteuid())


def _groups_of(user: str) -> frozenset[str]:
    names = {group.gr_name for group in grp.getgrall() if user in group.gr_mem}
    with suppress(KeyError):
        names.add(grp.getgrgid(pwd.getpwnam(user).pw_gid).gr_name)
    return frozenset(names)


def _firmware(settings: Settings) -> Path:
    from robot_runtime.simulation.boards.firmware import firmware_path

    ending = ".elf" if settings.emulated_board else ".hex"
    return firmware_path(settings.build, settings.link.baud, ending, hil=settings.in_the_loop)


def _fingerprint(settings: Settings) -> str:
    """Return the fingerprint that a runtime would have if it were started now."""
    from server.processes.supervisor import plan

    return next(command.fingerprint() for command in plan(settings) if command.name == "runtime")


def _try_libraries() -> dict[str, str]:
    """Import each library in another process; return the errors by library."""
    program = (
        "import importlib, sys\n"
        "for name in sys.argv[1:]:\n"
        "    try:\n"
        "        importlib.import_module(name)\n"
        "    except Exception as problem:\n"
        "        print(name, ' '.join(str(problem).split()) or type(problem).__name__, flush=True)\n"
        "    else:\n"
        "        print(name, flush=True)\n"
    )
    errors = dict.fromkeys(LIBRARIES, "the process that imports it was ended")
    try:
        done = subprocess.run(
            [sys.executable, "-c", program, *LIBRARIES],
            capture_output=True,
            text=True,
            timeout=IMPORT_SECONDS,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return dict.fromkeys(LIBRARIES, f"it takes more than {IMPORT_SECONDS:g} s")
    for line in done.stdout.splitlines():
        name, _, problem = line.partition(" ")
        errors[name] = problem
    return {name: problem for name, problem in errors.items() if problem}


def _try_database(settings: Settings) -> str:
    """Return the reason why this version cannot use the database; empty if it can, or there is none yet."""
    import sqlite3

    from server.platform.schema import explain, read_revision, refuse_unknown
    from server.platform.settings import SetupError

    try:
        revision = read_revision(settings.data.database)
        if revision is not None:
            refuse_unknown(revision, settings.data.database, settings.data)
    except SetupError as problem:
        return str(problem)
    except (sqlite3.DatabaseError, OSError) as problem:
        return f"The database cannot be read: {explain(problem, settings.data.path)}"
    return ""


def _try_port(port: Path, baud: int) -> str:
    """Return the reason why the port cannot be opened at this speed; empty if it can, or does not exist."""
    from robot_runtime.link.link_driver import PortError
    from robot_runtime.link.port import Port

    if not port.exists():
        return ""
    try:
        with Port(str(port), baud):
            return ""
    except PortError as problem:
        return str(problem)


def _has_login(root: Path, port: Path) -> bool:
    """Return True where a login prompt is started on this port."""
    names = {port.name, port.resolve().name}
    wants = (root / "etc/systemd/system").glob("*.wants/serial-getty@*.service")
    return any(unit.name.removeprefix("serial-getty@").removesuffix(".service") in names for unit in wants)


def _find_port_takers(root: Path) -> tuple[str, ...]:
    """Return brltty if its udev rule is active (no empty one in /etc), and ModemManager if it runs."""
    rules = {
        file.name: file
        for folder in ("lib", "usr/lib", "etc")
        for file in (root / folder / "udev/rules.d").glob(f"*{BRLTTY}*.rules")
    }
    takers = [BRLTTY] if any(_read(rule).strip() for rule in rules.values()) else []
    if any(_read(file).strip() == MODEM_MANAGER for file in (root / "proc").glob("[0-9]*/comm")):
        takers.append(MODEM_MANAGER)
    return tuple(takers)


def _read_reset(spec: str) -> tuple[str, str]:
    """Return the label of the reset line's chip, and the reason if it cannot be read; else both empty."""
    kind, _, where = spec.partition(":")
    chip = where.rpartition(":")[0]
    if kind != "gpio" or not chip:
        return "", ""
    answer = bytearray(68)
    try:
        handle = os.open(chip, os.O_RDONLY | os.O_CLOEXEC)
        try:
            fcntl.ioctl(handle, GPIO_GET_CHIPINFO, answer)
        finally:
            os.close(handle)
    except OSError as problem:
        return "", f"{chip}: {problem.strerror}"
    _, label, _ = struct.unpack("=32s32sI", answer)
    return label.rstrip(b"\0").decode("ascii", "replace"), ""


def _camera(settings: Settings) -> str:
    from robot_runtime.config import load
    from robot_runtime.contract.limits import ConfigError

    try:
        return load(settings.config).vision.camera
    except ConfigError:
        return ""


def _read_weighing(settings: Settings) -> tuple[float, float, float]:
    """Return mass (kg), reserve (g) and that in warm fresh water; without a configuration no reserve."""
    from robot_runtime.config import craft_in_force, load
    from robot_runtime.contract.buoyancy import reserve_elsewhere, water_density
    from robot_runtime.contract.limits import ConfigError

    try:
        config = load(settings.config)
        mass = craft_in_force(config, settings.config, settings.data.path).mass
    except ConfigError:
        return 3.0, 0.0, 0.0
    trim = config.craft
    weighed = water_density(trim.temperature, trim.salinity)
    warm = reserve_elsewhere(mass, trim.reserve, weighed, water_density(WARM))
    return mass, trim.reserve, warm


def _has_picamera() -> bool:
    from importlib.util import find_spec

    return find_spec("picamera2") is not None


def _list_cameras(root: Path) -> tuple[str, ...]:
    names = (_read(file).strip() for file in (root / "sys/class/video4linux").glob("*/name"))
    return tuple(sorted({name for name in names if name.startswith(("unicam", "rp1-cfe"))}))


def _has_memory_cgroup(root: Path) -> bool:
    if "memory" in _read(root / "sys/fs/cgroup/cgroup.controllers").split():
        return True
    return any(
        line.split()[0] == "memory" and line.split()[-1] == "1"
        for line in _read(root / "proc/cgroups").splitlines()
        if line and not line.startswith("#")
    )


def _try_address(host: str, port: int) -> str:
    """Return the reason why the server cannot listen there; empty if it can."""
    with socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as problem:
            return problem.strerror or str(problem)
    return ""
