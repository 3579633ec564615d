"""The doctor's checks: each is a function from the facts to a finding, None where it does not apply."""

from collections.abc import Callable

from robot_runtime.contract.buoyancy import RESERVE
from server.features.doctor.findings import Finding, Reporter
from server.features.doctor.lab_checks import (
    check_archive,
    check_certificates,
    check_lab_service,
    check_robots,
    check_router,
    check_scheduler,
)
from server.features.doctor.lab_facts import UNIT
from server.features.doctor.machine import BRLTTY, MODEM_MANAGER, SERVICE, WARM, Machine
from server.platform.disk_space import DIVE_BYTES
from server.platform.supply_voltage import UNDERVOLTAGE_NOW, UNDERVOLTAGE_SINCE
from server.platform.wall_clock import is_set

PYTHON_LEAST = (3, 11)
DISK_LOW = 500_000_000
"""Bytes; below them the server's alarm `disk_low` begins."""
SMALL_MEMORY = 1_000_000_000
"""Bytes; with less a Raspberry Pi needs compressed swap."""
GROUPS = ("dialout", "gpio", "video")
REINSTALL = "sudo mucat uninstall (the data stay), then sudo sh RELEASE/install.sh; or make setup"
PI_LINES = ("serial0", "serial1", "ttyS0", "ttyAMA")
"""Names of a Raspberry Pi's own serial lines."""
DEBUG_CONNECTOR = "ttyAMA10"
RESET_LABELS = ("pinctrl-bcm", "pinctrl-rp1")
"""Beginnings of the labels of a Raspberry Pi's own GPIO chips."""

Check = Callable[[Machine], Finding | None]


def check_configuration(machine: Machine) -> Finding | None:
    """Check that the configuration can be used."""
    report = Reporter("configuration", "Configuration")
    if machine.configuration_problem:
        services = {SERVICE: "mucat-runtime mucat", UNIT: "mucat-lab"}
        then = [
            f", then: sudo systemctl restart {names}"
            for unit, names in services.items()
            if unit in machine.units
        ]
        return report.wrong(
            machine.configuration_problem, f"Correct it (docs/run/configure.md){''.join(then)}"
        )
    return report.ok(f"Mode “{machine.mode}”." if machine.lab is None else "A lab.")


def check_versions(machine: Machine) -> Finding | None:
    """Check that Python and the operating system are of versions tested with µ-CAT."""
    report = Reporter("versions", "Versions")
    versions = f"Python {machine.python[0]}.{machine.python[1]}, {machine.system or 'unknown system'}"
    if machine.python < PYTHON_LEAST:
        return report.wrong(f"{versions}: µ-CAT needs Python 3.11.", "Install Raspberry Pi OS 12 or newer.")
    if machine.bits == 32:
        text = f"{versions}, {machine.architecture}: a 32-bit system, without rendered water and MCAP files."
        return report.look(text, "On a 64-bit Raspberry Pi, install the 64-bit Raspberry Pi OS.")
    return report.ok(f"{versions}, {machine.architecture}.")


def check_libraries(machine: Machine) -> Finding | None:
    """Check that the libraries with compiled parts can be imported."""
    report = Reporter("libraries", "Libraries")
    if machine.broken_libraries is None:
        return None
    if machine.broken_libraries:
        reasons = "; ".join(f"{name}: {why}" for name, why in sorted(machine.broken_libraries.items()))
        return report.wrong(f"Cannot be imported: {reasons}.", REINSTALL)
    return report.ok("All can be imported.")


def check_data(machine: Machine) -> Finding | None:
    """Check that the data folder can be written, and that its disk has room."""
    report = Reporter("data", "Data folder")
    if machine.disk_read_only:
        text = f"The disk of {machine.data} is read-only: the card may be worn out or damaged."
        return report.wrong(text, "sudo mount -o remount,rw / ; if it fails: back up, and take another card")
    if not machine.data_writable:
        return report.wrong(
            f"{machine.data} cannot be written.", f"sudo chown -R {machine.user} {machine.data}"
        )
    free = f"{machine.disk_free / 1e6:.0f} MB are free for {machine.data}"
    if machine.disk_free < DIVE_BYTES:
        lacks = "an hour cannot be recorded" if machine.lab is None else "no session can be fetched"
        return report.wrong(f"{free}: {lacks}.", "Delete sessions on the page, or: mucat sessions")
    if machine.disk_free < DISK_LOW:
        return report.look(f"{free}.", "Delete sessions on the page, or: mucat sessions")
    return report.ok(f"{free}.")


def check_database(machine: Machine) -> Finding | None:
    """Check that the database can be read, and that this version knows it."""
    report = Reporter("database", "Database")
    if machine.lab is not None and machine.lab.archive:
        return None
    if machine.database_problem:
        return report.wrong(machine.database_problem, "mucat restore FILE; docs/run/backup.md")
    return report.ok("Can be read.")


def check_firmware(machine: Machine) -> Finding | None:
    """Check that the firmware for this speed is on the computer."""
    report = Reporter("firmware", "Firmware file")
    if not machine.firmware_there:
        text = f"There is no {machine.firmware}, so that the board cannot get its firmware."
        return report.wrong(text, "make firmware, or another link.baud in robot.toml")
    return report.ok(machine.firmware)


def check_port(machine: Machine) -> Finding | None:
    """Check that the serial port exists, and opens at the line's speed."""
    report = Reporter("port", "Serial port")
    if machine.mode == "emulated":
        return None
    if not machine.port_there:
        others = ", ".join(machine.other_ports) or "none"
        text = f"There is no {machine.port}. Serial ports that are there: {others}."
        remedy = "Set link.port in robot.toml, of a USB adapter to its name in /dev/serial/by-id, which stays"
        return report.wrong(text, f"{remedy}; for the Pi's UART: sudo mucat install")
    if machine.port_problem:
        return report.wrong(machine.port_problem, f"sudo usermod -aG dialout {machine.user}; fuser the port")
    target = f" leads to {machine.port_target}" if machine.port_target else " is there"
    opened = " Each opening starts a board with DTR at its reset anew." if machine.reset == "dtr" else ""
    return report.ok(f"{machine.port}{target}.{opened}")


def check_port_takers(machine: Machine) -> Finding | None:
    """Check that no other program opens a USB adapter as soon as it is plugged in."""
    report = Reporter("port_takers", "Other programs at the port")
    name = machine.port_target or machine.port.removeprefix("/dev/")
    if machine.mode == "emulated" or not name.startswith(("ttyUSB", "ttyACM", "serial/by-")):
        return None
    if BRLTTY in machine.port_takers:
        return report.look(
            "brltty, for braille displays, takes adapters with a CH340 away: their port vanishes.",
            "sudo apt purge brltty, where nobody reads braille here; then plug the board in again",
        )
    if MODEM_MANAGER in machine.port_takers:
        return report.look(
            "ModemManager writes to each USB adapter that is plugged in, to find modems.",
            "sudo systemctl disable --now ModemManager, where there is no mobile modem",
        )
    return report.ok("Neither brltty nor ModemManager is there.")


def check_uart(machine: Machine) -> Finding | None:
    """Check that the Pi's serial port is the full UART: the small one follows the processor's clock."""
    report = Reporter("uart", "UART")
    name = machine.port_target or machine.port.removeprefix("/dev/")
    if not machine.model or machine.mode == "emulated" or not name.startswith(PI_LINES):
        return None
    lines = {line.split("#")[0].replace(" ", "") for line in machine.boot_settings.splitlines()}
    missing = [setting for setting in ("enable_uart=1", "dtoverlay=disable-bt") if setting not in lines]
    if name == "ttyS0":
        text = f"{machine.port} is the small UART (ttyS0), whose speed follows the processor's clock."
        named = "" if machine.port_target else 'Set link.port in robot.toml to "/dev/serial0"; '
        return report.wrong(text, f"{named}sudo mucat install, then restart the Raspberry Pi")
    if name == DEBUG_CONNECTOR:
        text = f"{machine.port} is the Raspberry Pi 5's debug connector ({name}), not pins 8 and 10."
        return report.wrong(text, 'Set link.port in robot.toml to "/dev/ttyAMA0"')
    if name.startswith("ttyAMA"):
        return report.ok(f"{machine.port} is the full UART ({name}).")
    if missing:
        text = f"{machine.boot_folder}/config.txt lacks {' and '.join(missing)}."
        return report.wrong(text, "sudo mucat install, then restart the Raspberry Pi")
    return report.look("The settings are there, and come into force at the next start.", "sudo reboot")


def check_console(machine: Machine) -> Finding | None:
    """Check that neither kernel nor login prompt writes to the board's line."""
    report = Reporter("console", "Console")
    if machine.mode == "emulated" or not machine.port_there:
        return None
    names = {machine.port.removeprefix("/dev/"), machine.port_target} - {""}
    if machine.serial0_target in names:
        names.add("serial0")
    consoles = [
        word
        for word in machine.kernel_line.split()
        if word.startswith("console=") and word[8:].split(",")[0] in names
    ]
    if consoles:
        text = f"The kernel writes its messages to the board's line ({consoles[0]})."
        return report.wrong(text, "sudo mucat install, then restart the Raspberry Pi")
    if machine.login_on_port:
        name = machine.port_target or machine.port.removeprefix("/dev/")
        return report.wrong(
            "A login prompt runs on the board's line.",
            f"sudo systemctl disable --now serial-getty@{name}",
        )
    return report.ok("Neither kernel nor login uses the board's line.")


def check_board(machine: Machine) -> Finding | None:
    """Check that the board answers, with the definitions of this version."""
    report = Reporter("board", "Board")
    if machine.mode == "emulated":
        return None
    if not machine.link_state:
        return report.look("Not asked: the server does not run.", "mucat run, or sudo systemctl start mucat")
    if machine.link_state == "ok":
        return report.ok(machine.link_text)
    if machine.link_state == "starting":
        return report.look(machine.link_text, "Look again in a minute; journalctl -u 'mucat*'")
    return report.wrong(
        machine.link_text or "It does not answer.",
        "Check power and cable; another version's firmware: mucat upload",
    )


def check_groups(machine: Machine) -> Finding | None:
    """Check that the service's user may use line, pins and camera."""
    report = Reporter("groups", "Groups")
    if machine.mode == "emulated" or machine.user == "root":
        return None
    needed = [
        group
        for group in GROUPS
        if group == "dialout"
        or (group == "gpio" and machine.reset.startswith("gpio:"))
        or (group == "video" and machine.camera == "pi")
    ]
    missing = [group for group in needed if group not in machine.groups]
    if missing:
        text = f"{machine.user} is not in {', '.join(missing)}."
        return report.wrong(text, f"sudo usermod -aG {','.join(missing)} {machine.user}, then start again")
    return report.ok(f"{machine.user} is in {', '.join(needed)}.")


def check_reset(machine: Machine) -> Finding | None:
    """Check that the reset line is one of the Pi's own pins."""
    report = Reporter("reset", "Reset line")
    if machine.mode == "emulated" or not machine.reset.startswith("gpio:"):
        return None
    if machine.reset_problem:
        return report.wrong(
            f"The board cannot be reset for an upload: {machine.reset_problem}.",
            f"Set link.reset in robot.toml (gpiodetect lists chips); sudo usermod -aG gpio {machine.user}",
        )
    if not machine.reset_label.startswith(RESET_LABELS):
        text = f"{machine.reset} is a chip named “{machine.reset_label}”, not the Raspberry Pi's pins."
        return report.look(text, "gpiodetect lists the chips; set link.reset in robot.toml")
    return report.ok(f"{machine.reset} ({machine.reset_label}).")


def check_camera(machine: Machine) -> Finding | None:
    """Check that the Raspberry Pi's camera is connected, and its library installed."""
    report = Reporter("camera", "Camera")
    if machine.camera != "pi":
        return None
    if not machine.camera_library:
        return report.wrong(
            "The library picamera2 is missing.",
            "sudo apt install python3-picamera2, then sudo mucat install and sudo reboot",
        )
    if not machine.cameras:
        text = "No camera is found: vision sees nothing, everything else works."
        return report.look(text, "Check its ribbon cable; rpicam-hello --list-cameras")
    return report.ok(", ".join(machine.cameras))


def check_buoyancy(machine: Machine) -> Finding | None:
    """Check that a real robot was weighed, and that it comes up in fresh water that is warm."""
    report = Reporter("buoyancy", "Buoyancy")
    if machine.mode != "robot":
        return None
    if not machine.reserve:
        return report.look(
            "The reserve of buoyancy is not known: STOP relies on it to bring the robot up.",
            "Weigh and trim it (docs/run/hardware/trim.md), then set craft.reserve in robot.toml",
        )
    text = f"{machine.reserve:.0f} g as weighed, {machine.warm_reserve:.0f} g in fresh water of {WARM:g} °C"
    if machine.warm_reserve <= 0:
        return report.look(f"{text}: there it sinks.", "Trim it again in fresh water before it dives there")
    least = 1000 * RESERVE * machine.mass / 2
    if machine.reserve < least:
        return report.look(f"{text}: less than {least:.0f} g.", "Trim it: docs/run/hardware/trim.md")
    return report.ok(f"{text}.")


def check_clock(machine: Machine) -> Finding | None:
    """Check that the clock is right; a Raspberry Pi has no clock while it is off."""
    report = Reporter("clock", "Clock")
    if not is_set(machine.now):
        return report.look(
            "The clock has not been set: recordings get a wrong date. Control does not depend on it.",
            "sudo date -u -s '2026-11-24 12:00', or a network with a time server",
        )
    if not machine.clock_synchronised:
        return report.look(
            "The clock is not synchronised: recordings may get a wrong date.",
            "timedatectl; a network with a time server",
        )
    return report.ok("Synchronised.")


def check_voltage(machine: Machine) -> Finding | None:
    """Check that the supply of the Raspberry Pi holds its voltage."""
    report = Reporter("voltage", "Supply")
    if machine.throttled is None:
        return None
    if machine.throttled & UNDERVOLTAGE_NOW:
        return report.wrong(
            "The voltage is too low now: the processor is slowed, and the card may be damaged.",
            "Take a better supply or cable, or charge the battery",
        )
    if machine.throttled & UNDERVOLTAGE_SINCE:
        return report.look(
            "The voltage has been too low since the start.",
            "Take a better supply or cable, or charge the battery",
        )
    return report.ok("The voltage has been high enough since the start.")


def check_memory_limit(machine: Machine) -> Finding | None:
    """Check that the kernel can limit the server's memory."""
    report = Reporter("memory_limit", "Memory limit")
    if SERVICE not in machine.units:
        return None
    if not machine.memory_cgroup:
        return report.look(
            "The kernel does not limit memory: a server that grows could slow the robot down.",
            f"sudo mucat install, which adds it to {machine.boot_folder}/cmdline.txt, then sudo reboot",
        )
    return report.ok("The kernel limits the server's memory.")


def check_swap(machine: Machine) -> Finding | None:
    """Check that a small computer has compressed swap, which spares the SD card."""
    report = Reporter("swap", "Compressed swap")
    if machine.memory >= SMALL_MEMORY:
        return None
    if any("zram" in swap for swap in machine.swaps):
        return report.ok(f"{machine.memory / 1e6:.0f} MB of memory, and zram.")
    return report.look(
        f"{machine.memory / 1e6:.0f} MB of memory, without compressed swap.",
        "sudo apt install zram-tools",
    )


def check_address(machine: Machine) -> Finding | None:
    """Check that the page's address is free for the server."""
    report = Reporter("address", "Address of the page")
    if machine.server_runs:
        return report.ok(f"The server answers at {machine.address}.")
    if machine.address_problem:
        return report.wrong(
            f"The server cannot listen at {machine.address}: {machine.address_problem}.",
            "ss -ltnp shows who does; or another server.port in robot.toml",
        )
    return report.ok(f"{machine.address} is free.")


def check_service(machine: Machine) -> Finding | None:
    """Check that the installed service goes on when a part of it is killed."""
    report = Reporter("service", "Service")
    unit = machine.units.get(SERVICE)
    if unit is None:
        return None
    lines = {line.strip() for line in unit.splitlines()}
    missing = [
        setting
        for setting in ("ExitType=cgroup", "OOMPolicy=continue", "Restart=always")
        if setting not in lines
    ]
    if missing:
        text = f"{SERVICE} lacks {', '.join(missing)}: a part that is killed would end all of it."
        return report.wrong(text, "sudo mucat install")
    return report.ok("Server and runtime are services of their own.")


def check_runtime(machine: Machine) -> Finding | None:
    """Check that a runtime service has this version and configuration."""
    report = Reporter("runtime", "Runtime")
    if SERVICE not in machine.units:
        return None
    if machine.runtime_outdated:
        return report.look(
            "It was started with another version or configuration than the present one.",
            "Disarm the robot, then: sudo systemctl restart mucat-runtime",
        )
    return report.ok("It has the present version and configuration.")


def check_events(machine: Machine) -> Finding | None:
    """Check that the broker for events can be reached."""
    report = Reporter("events", "Events to other programs")
    if not machine.events_named:
        return None
    if not machine.events_state:
        return report.look("Not asked: the server does not run.", "mucat run, or sudo systemctl start mucat")
    if machine.events_state == "ok":
        return report.ok(machine.events_text)
    return report.look(machine.events_text, "Correct [events] in robot.toml: docs/use/events.md")


CHECKS: tuple[Check, ...] = (
    check_configuration,
    check_versions,
    check_libraries,
    check_data,
    check_database,
    check_firmware,
    check_port,
    check_port_takers,
    check_uart,
    check_console,
    check_board,
    check_groups,
    check_reset,
    check_buoyancy,
    check_camera,
    check_clock,
    check_voltage,
    check_memory_limit,
    check_swap,
    check_address,
    check_service,
    check_runtime,
    check_events,
)
"""In the order of the report: what everything else needs comes first."""


LAB_CHECKS: tuple[Check, ...] = (
    check_configuration,
    check_versions,
    check_libraries,
    check_data,
    check_database,
    check_archive,
    check_clock,
    check_swap,
    check_address,
    check_lab_service,
    check_certificates,
    check_router,
    check_robots,
    check_scheduler,
)


def examine(machine: Machine) -> list[Finding]:
    """Return the findings of all checks that apply."""
    checks = CHECKS if machine.lab is None else LAB_CHECKS
    return [finding for check in checks if (finding := check(machine)) is not None]
