"""Each check of the doctor, with every outcome that it can have."""

import re
from dataclasses import replace
from typing import Any

import click
import pytest

from server.cli import mucat
from server.features.doctor.checks import CHECKS, examine
from server.features.doctor.findings import worst
from server.features.doctor.machine import SERVICE, Machine
from server.platform.wall_clock import SOFTWARE_MADE

UART = "enable_uart=1\ndtoverlay=disable-bt\n"
UNIT = "[Service]\nExitType=cgroup\nOOMPolicy=continue\nRestart=always\n"
GOOD = Machine(
    system="Debian GNU/Linux 13 (trixie)",
    architecture="aarch64",
    model="Raspberry Pi Zero 2 W Rev 1.0",
    data="/var/lib/mucat",
    firmware="/opt/robot.hex",
    port_target="ttyAMA0",
    link_state="ok",
    link_text="Connected.",
    events_named=True,
    events_state="ok",
    events_text="Connected.",
    boot_settings=UART,
    kernel_line="console=tty1 root=PARTUUID=1 rootwait",
    groups=frozenset({"dialout", "gpio", "video"}),
    reset="gpio:/dev/gpiochip0:4",
    reset_label="pinctrl-bcm2835",
    reserve=30.0,
    warm_reserve=24.0,
    cameras=("unicam",),
    now=SOFTWARE_MADE + 1,
    throttled=0,
    memory=512_000_000,
    swaps=("/dev/zram0",),
    units={SERVICE: UNIT},
)
"""A Raspberry Pi on which nothing is wrong."""
EMULATED = replace(
    GOOD, mode="emulated", model="", port_there=False, camera="scene", throttled=None, units={}
)

BY_USB: dict[str, Any] = {"port": "/dev/ttyUSB0", "port_target": ""}
CASES: dict[str, tuple[dict[str, Any], str, str]] = {
    "configuration: broken": ({"configuration_problem": "robot.toml cannot be read"}, "wrong", "robot.toml"),
    "versions: old Python": ({"python": (3, 9)}, "wrong", "needs Python 3.11"),
    "versions: 32 bits": ({"architecture": "armv6l", "bits": 32}, "look", "armv6l: a 32-bit system"),
    "libraries: wrong wheel": ({"broken_libraries": {"cv2": "no libGL"}}, "wrong", "cv2: no libGL"),
    "data: read-only": ({"disk_read_only": True}, "wrong", "read-only"),
    "data: no right": ({"data_writable": False}, "wrong", "cannot be written"),
    "data: full": ({"disk_free": 1_000_000}, "wrong", "1 MB"),
    "data: low": ({"disk_free": 100_000_000}, "look", "100 MB"),
    "database: newer": ({"database_problem": "written by a newer version"}, "wrong", "newer"),
    "firmware: missing": ({"firmware_there": False}, "wrong", "/opt/robot.hex"),
    "port: missing": ({"port_there": False}, "wrong", "no /dev/serial0. Serial ports that are there: none."),
    "port: another": (
        {"port_there": False, "other_ports": ("/dev/serial/by-id/usb-1a86", "/dev/ttyAMA0")},
        "wrong",
        "there: /dev/serial/by-id/usb-1a86, /dev/ttyAMA0.",
    ),
    "port_takers: brltty": (BY_USB | {"port_takers": ("brltty", "ModemManager")}, "look", "brltty, for"),
    "port_takers: ModemManager": (BY_USB | {"port_takers": ("ModemManager",)}, "look", "ModemManager writes"),
    "port: refused": ({"port_problem": "Permission denied"}, "wrong", "Permission"),
    "uart: the small one": ({"port_target": "ttyS0"}, "wrong", "small UART"),
    "uart: the small one, by name": (
        {"port": "/dev/ttyS0", "port_target": ""},
        "wrong",
        "/dev/ttyS0 is the small UART",
    ),
    "uart: the debug connector": ({"port_target": "ttyAMA10"}, "wrong", "not pins 8 and 10"),
    "uart: not set": ({"port_target": "", "boot_settings": "enable_uart=1"}, "wrong", "lacks dtoverlay"),
    "uart: commented out": (
        {"port_target": "", "boot_settings": UART.replace("dt", "#dt")},
        "wrong",
        "lacks dtoverlay",
    ),
    "uart: not yet in force": ({"port_target": ""}, "look", "next start"),
    "console: kernel": ({"kernel_line": "console=serial0,115200 console=tty1"}, "wrong", "console=serial0"),
    "console: kernel, by device": ({"kernel_line": "console=ttyAMA0,115200"}, "wrong", "console=ttyAMA0"),
    "console: kernel, by the line's other name": (
        {
            "port": "/dev/ttyAMA0",
            "port_target": "",
            "serial0_target": "ttyAMA0",
            "kernel_line": "console=serial0,115200",
        },
        "wrong",
        "console=serial0",
    ),
    "console: login": ({"login_on_port": True}, "wrong", "login prompt"),
    "board: other firmware": (
        {"link_state": "failed", "link_text": "Definitions differ."},
        "wrong",
        "differ",
    ),
    "events: not asked": ({"events_state": ""}, "look", "does not run"),
    "events: broken": (
        {"events_state": "failed", "events_text": "Connection refused."},
        "look",
        "Connection refused.",
    ),
    "board: not yet": ({"link_state": "starting", "link_text": "Starting."}, "look", "Starting"),
    "board: not asked": ({"link_state": "", "link_text": ""}, "look", "does not run"),
    "groups: missing": ({"groups": frozenset({"dialout"})}, "wrong", "not in gpio, video"),
    "reset: no chip": ({"reset_problem": "/dev/gpiochip0: No such file"}, "wrong", "No such file"),
    "reset: other chip": ({"reset_label": "raspberrypi-exp-gpio"}, "look", "raspberrypi-exp-gpio"),
    "buoyancy: not weighed": ({"reserve": 0.0}, "look", "reserve of buoyancy is not known"),
    "buoyancy: sinks when warm": ({"reserve": 7.0, "warm_reserve": -1.0}, "look", "there it sinks"),
    "buoyancy: little": ({"reserve": 14.0, "warm_reserve": 6.0}, "look", "less than 15 g"),
    "camera: no library": ({"camera_library": False}, "wrong", "picamera2"),
    "camera: not connected": ({"cameras": ()}, "look", "No camera"),
    "clock: 1970": ({"now": 12.0}, "look", "has not been set"),
    "clock: not synchronised": ({"clock_synchronised": False}, "look", "not synchronised"),
    "voltage: low now": ({"throttled": 0x50005}, "wrong", "too low now"),
    "voltage: was low": ({"throttled": 0x50000}, "look", "since the start"),
    "memory_limit: off": ({"memory_cgroup": False}, "look", "does not limit"),
    "swap: none": ({"swaps": ("/var/swap",)}, "look", "without compressed swap"),
    "address: taken": ({"address_problem": "Address already in use"}, "wrong", "already in use"),
    "service: lacks lines": ({"units": {SERVICE: "[Service]\nRestart=always\n"}}, "wrong", "ExitType=cgroup"),
    "runtime: older": ({"runtime_outdated": True}, "look", "another version or configuration"),
}


@pytest.mark.parametrize("case", CASES)
def test_a_check_finds_it_and_says_what_mends_it(case: str) -> None:
    changed, verdict, text = CASES[case]
    name = case.partition(":")[0]
    results = {finding.name: finding for finding in examine(replace(GOOD, **changed))}
    assert (results[name].verdict, text in results[name].text) == (verdict, True), results[name]
    assert results[name].mend
    # Nothing else is found.
    assert {finding.name for finding in results.values() if finding.verdict != "ok"} == {name}


@pytest.mark.parametrize("case", CASES)
def test_the_commands_that_mend_it_can_be_typed_so(case: str) -> None:
    for finding in examine(replace(GOOD, **CASES[case][0])):
        for text in re.findall(r"\bmucat ([a-z-]+(?: (?:[A-Z]+|--[a-z-]+))*)", finding.mend):
            name, *arguments = text.split()
            command = mucat.get_command(click.Context(mucat), name)
            assert command is not None, text
            # A group alone lists its commands.
            if not isinstance(command, click.Group):
                command.make_context(name, arguments)


def test_every_check_is_good_on_a_good_computer_and_has_a_case_with_every_other_verdict() -> None:
    good = examine(GOOD)
    assert [finding.name for finding in good if finding.verdict != "ok"] == []
    by_usb = {finding.name for finding in examine(replace(GOOD, **BY_USB)) if finding.verdict == "ok"}
    names = {finding.name for finding in good} | by_usb
    assert len(CHECKS) == len(names) == len(good) + 1
    assert {case.partition(":")[0] for case in CASES} == names
    assert not any(finding.mend for finding in good)


def test_an_emulated_robot_is_asked_nothing_about_pins() -> None:
    names = {finding.name for finding in examine(EMULATED)}
    assert names == {
        "configuration",
        "versions",
        "libraries",
        "data",
        "database",
        "firmware",
        "clock",
        "address",
        "swap",
        "events",
    }
    assert worst(examine(EMULATED)) == "ok"


@pytest.mark.parametrize(
    ("changed", "check"),
    [
        ({"model": ""}, "uart"),
        ({"port": "/dev/ttyUSB0", "port_target": ""}, "uart"),
        ({"port": "/dev/serial/by-id/usb-1a86", "port_target": "ttyUSB0"}, "uart"),
        ({"port": "/dev/serial/by-id/usb-1a86", "port_target": "", "port_there": False}, "uart"),
        ({"broken_libraries": None}, "libraries"),
        ({"port_takers": ("brltty", "ModemManager")}, "port_takers"),
        ({"reset": "dtr"}, "reset"),
        ({"camera": "file"}, "camera"),
        ({"throttled": None}, "voltage"),
        ({"units": {}}, "service"),
        ({"memory": 4_000_000_000}, "swap"),
    ],
)
def test_a_check_that_does_not_apply_says_nothing(changed: dict[str, Any], check: str) -> None:
    assert check not in {finding.name for finding in examine(replace(GOOD, **changed))}


def test_groups_are_those_that_the_configuration_needs() -> None:
    modest = replace(GOOD, reset="dtr", camera="card", groups=frozenset({"dialout"}))
    assert worst(examine(modest)) == "ok"


def test_a_port_whose_opening_resets_the_board_says_so() -> None:
    answer = {reset: examine(replace(GOOD, reset=reset)) for reset in ("dtr", "gpio:/dev/gpiochip0:4")}
    texts = {
        reset: next(finding.text for finding in result if finding.name == "port")
        for reset, result in answer.items()
    }
    assert "starts a board with DTR at its reset anew" in texts["dtr"]
    assert "anew" not in texts["gpio:/dev/gpiochip0:4"]


def test_a_server_that_runs_holds_the_address_itself() -> None:
    held = replace(GOOD, server_runs=True, address_problem="Address already in use")
    assert worst(examine(held)) == "ok"
