"""The audit log: what the server and its shell write into it, and what nobody can do to it."""

import json
import resource
from dataclasses import replace
from pathlib import Path

import click
import pytest
from fastapi.routing import iter_route_contexts

from robot_runtime.clock import SimulatedClock
from server import cli
from server.app import create_app
from server.http import audit
from server.http.audit import (
    DELETING,
    DOWNLOADS,
    LIMIT,
    LIMIT_OPERATOR,
    NOTICED,
    QUERY_MAX,
    SIGNING,
    UNCHANGING,
    WINDOW,
    AuditLog,
)
from server.http.security import SAFE_METHODS
from server.http.sign_in.identity import SHELL, Identity
from server.http.sign_in.policy import Need, list_needs, need_of
from server.platform import audit_file
from server.platform.audit_file import AuditEntry, append_entries, read_entries
from server.platform.command_line import with_settings
from server.platform.folder_lock import record_command
from server.platform.settings import Settings
from tests.server.test_matrix import FAR, House, Somebody, open_house, signed_in

ANNA = Identity(7, "Anna", "operator", "browser")


def entry(number: int) -> AuditEntry:
    return AuditEntry(float(number), "Anna", 7, "operator", "192.0.2.1", "Arm", f"number {number}", "done")


def make_log(folder: Path, clock: SimulatedClock) -> AuditLog:
    return AuditLog(folder, clock, lambda _operation, _text: None)


def test_tables_name_operations_that_exist(settings: Settings) -> None:
    known = list_needs(create_app(replace(settings, every_feature=True)).routes).keys()
    assert known >= UNCHANGING | DOWNLOADS | NOTICED.keys() | SIGNING | DELETING


def test_what_only_looks_is_in_no_log(settings: Settings) -> None:
    asked = {
        context.operation_id
        for context in iter_route_contexts([*create_app(replace(settings, every_feature=True)).routes])
        if need_of(context) is Need.VIEWER and not (context.methods or set()) <= SAFE_METHODS
    }
    assert asked - UNCHANGING == {"signOut", "startExport", "stopRobot", "stopAllRobots"}


async def test_sign_in_refusals_roles_arm_and_stop_are_written_with_who_and_where(settings: Settings) -> None:
    async with open_house(settings) as house:
        await act(house)
    acts = [(entry.who, entry.role, entry.address, entry.outcome) for entry in reversed(written(settings))]
    what = [entry.about for entry in reversed(written(settings))]
    assert acts == [
        ("the shell of this computer", "operator", FAR, "done"),
        ("Eve", "viewer", FAR, "done"),
        ("Eve", "viewer", FAR, "refused"),
        ("operator", "operator", FAR, "done"),
        ("operator", "operator", FAR, "refused"),
        ("control", "operator", FAR, "done"),
        ("control", "operator", FAR, "done"),
        ("", "", FAR, "refused"),
        ("control", "operator", "", "done"),
    ]
    assert what[1] == 'POST /api/access/pair {"name": "Eve"}'
    assert '{"role": "operator"}' in what[3]
    assert what[-2] == "GET /api/robot"
    assert "page was closed" in what[-1]
    files = {path.stem.rstrip("0123456789") for path in (settings.data.audit / "own").iterdir()}
    assert files == {"", "access", "arming"}


async def act(house: House) -> None:
    """One act of each kind, from an address elsewhere; those before it are forgotten."""
    right, operator, control = (
        house.places("right", "right"),
        house.people["operator"],
        house.people["control"],
    )
    await house.ask(control, "POST", "/api/control/take", right, query="over=true")
    log = house.container.services.get(AuditLog)
    log._thread.submit(lambda: None).result()
    log.folder = house.container.settings.data.audit / "own"
    log._windows.clear()

    async def ask(who: Somebody, method: str, path: str, body: object = None) -> tuple[int, bytes]:
        status, headers, report = await house.ask(who, method, path, right, body, address=FAR)
        if path.endswith("/pair"):
            who.headers |= signed_in(headers, report)
        return status, report

    _, report = await ask(house.shell, "POST", "/api/access/codes", {"role": "viewer"})
    eve = Somebody()
    await ask(eve, "POST", "/api/access/pair", {"code": json.loads(report)["code"], "name": "Eve"})
    await ask(eve, "POST", "/api/sessions", {"name": "mine"})
    await ask(eve, "GET", "/api/robot")
    await ask(operator, "PATCH", "/api/access/devices/1", {"role": "operator"})
    await ask(operator, "POST", "/api/robot/commands/arm")
    await ask(control, "POST", "/api/robot/commands/arm")
    await ask(control, "POST", "/api/robot/stop")
    await ask(Somebody(), "GET", "/api/robot")
    await ask(operator, "POST", "/api/scenarios/check", {"text": "?"})


def written(settings: Settings) -> list[AuditEntry]:
    return list(read_entries(settings.data.audit / "own"))


def test_arm_and_stop_are_notices_that_name_who(tmp_path: Path) -> None:
    answer: list[tuple[str, str]] = []
    log = AuditLog(tmp_path, SimulatedClock(), lambda operation, text: answer.append((operation, text)))
    acts = ("commandArm", "refused"), ("commandArm", "done"), ("startMission", "done"), ("stopRobot", "done")
    for operation, outcome in acts:
        log.record(ANNA, "", "Arm", "", "refused" if outcome == "refused" else "done", operation)
    log.close()
    assert answer == [
        ("commandArm", "“Anna” armed the robot."),
        ("startMission", "“Anna” started a mission."),
        ("stopRobot", "“Anna” pressed STOP."),
    ]


def test_a_flood_of_a_stranger_is_counted_and_leaves_others_acts_in_the_log(tmp_path: Path) -> None:
    clock = SimulatedClock()
    log = make_log(tmp_path, clock)
    log.record(SHELL, "", "Make a token", "", "done")
    for _ in range(LIMIT + 1000):
        log.record(None, FAR, "Request", "GET /api/robot", "refused")
    clock.forward(WINDOW)
    log.record(ANNA, "", "Arm", "", "done")
    log.close()
    newest, flood, *rest = read_entries(tmp_path)
    assert (newest.who, flood.who, flood.count) == ("Anna", "", 1000)
    assert len(rest) == LIMIT + 1
    assert rest[-1].action == "Make a token"


PROGRAM = Identity(8, "Program", "operator", "program", limited=True)


def test_no_program_of_an_operator_pushes_out_what_others_did(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(audit_file, "FILE_BYTES", 10_000)
    clock = SimulatedClock()
    log = make_log(tmp_path, clock)
    log.record(ANNA, "", "Make a token", "", "done", "makeToken", "access")
    log.record(ANNA, "", "Arm", "", "done", "commandArm")
    log.record(ANNA, "", "Delete a session", "", "done", "deleteSession", "deletion")
    for _ in range(5):
        for number in range(20 * LIMIT_OPERATOR):
            log.record(PROGRAM, "", f"Action {number % 20}", "x" * 400, "done", "stopRobot")
        clock.forward(WINDOW)
    log.close()
    entries = list(read_entries(tmp_path))
    assert [file.action for file in entries if file.who == "Anna"] == [
        "Delete a session",
        "Arm",
        "Make a token",
    ]
    assert sum(path.stat().st_size for path in tmp_path.iterdir()) < 10 * 10_000


def test_a_program_has_as_many_entries_an_hour_whatever_it_does(tmp_path: Path) -> None:
    log = make_log(tmp_path, SimulatedClock())
    for number in range(2 * LIMIT_OPERATOR):
        log.record(PROGRAM, "", f"Action {number % 20}", "", "done")
    log.record(PROGRAM, "", "Delete a session", "", "done", "deleteSession", "deletion")
    log.close()
    entries = list(read_entries(tmp_path))
    assert sum(entry.count for entry in entries) == 2 * LIMIT_OPERATOR + 1
    assert len(entries) == LIMIT_OPERATOR + 2
    assert "Delete a session" in {entry.action for entry in entries}


async def test_a_long_query_does_not_pad_an_entry(settings: Settings) -> None:
    async with open_house(settings) as house:
        right, operator = house.places("right", "right"), house.people["operator"]
        await house.ask(operator, "POST", "/api/robot/stop", right, query="x" * 5000)
    (entry, *_) = (entry for entry in read_entries(settings.data.audit) if "/api/robot/stop" in entry.about)
    assert entry.about == "POST /api/robot/stop?" + "x" * QUERY_MAX


def test_entries_wait_while_the_disk_takes_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise OSError("full")

    log = make_log(tmp_path, SimulatedClock())
    with monkeypatch.context() as full:
        full.setattr(audit, "append_entries", refuse)
        log.record(ANNA, "", "Arm", "", "done")
        log._thread.submit(lambda: None).result()
    log.record(ANNA, "", "Disarm", "", "done")
    log.close()
    assert [entry.action for entry in read_entries(tmp_path)] == ["Disarm", "Arm"]


def test_a_line_that_was_cut_off_costs_no_other(tmp_path: Path) -> None:
    append_entries(tmp_path, [entry(1)])
    (file,) = tmp_path.iterdir()
    file.write_bytes(file.read_bytes() + b'{"time": 2')
    append_entries(tmp_path, [entry(3)])
    assert list(read_entries(tmp_path)) == [entry(3), entry(1)]


def test_the_oldest_file_goes_when_there_are_too_many(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(audit_file, "FILE_BYTES", 1)
    for number in range(audit_file.FILES_MOST[""] + 2):
        append_entries(tmp_path, [entry(number)])
    assert len(list(tmp_path.iterdir())) == audit_file.FILES_MOST[""]
    assert [entry.time for entry in read_entries(tmp_path)] == [9.0, 8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0]


def test_texts_of_others_turn_and_move_nothing(tmp_path: Path) -> None:
    log = make_log(tmp_path, SimulatedClock())
    log.record(ANNA, "", "Request", "\x1b]52;c;\u202e" + "x" * 1000, "done")
    log.close()
    (entries,) = read_entries(tmp_path)
    assert entries.about.isprintable()
    assert len(entries.about) <= audit_file.TEXT_MAX + 1


def test_a_command_in_the_shell_is_written_with_its_end(settings: Settings) -> None:
    options = ["--data", str(settings.data.path), "--config", str(settings.config)]
    assert cli.main(["sessions", "delete", "5", *options]) == 1
    assert cli.main(["sessions", "list", *options]) == 0
    assert cli.main(["backup", str(settings.data.path / "copy.db"), *options]) == 0
    copied, copying, failed, begun = read_entries(settings.data.audit)
    assert {entry.who for entry in (copied, copying, failed, begun)} == {SHELL.name}
    assert (begun.action, begun.outcome) == (failed.action, "begun") == ("mucat sessions delete", "begun")
    assert json.loads(begun.about)["session"] == "5"
    assert (failed.outcome, "There is no session 5" in failed.about) == ("failed", True)
    assert [(entry.action, entry.outcome) for entry in (copying, copied)] == [
        ("mucat backup", "begun"),
        ("mucat backup", "done"),
    ]


def test_a_command_in_the_shell_that_ends_with_a_status_has_failed(settings: Settings) -> None:
    @click.command("check")
    @with_settings
    def check(settings: Settings) -> int:
        record_command(settings.data)
        return 3

    options = ["--data", str(settings.data.path), "--config", str(settings.config)]
    assert check.main(options, "mucat", standalone_mode=False) == 3
    assert [entry.outcome for entry in read_entries(settings.data.audit)] == ["failed", "begun"]


def test_entries_that_the_disk_takes_in_part_are_written_once(settings: Settings) -> None:
    folder, entries = settings.data.audit, [entry(1), entry(2), entry(3)]
    append_entries(folder, entries[:1])
    (file,) = folder.iterdir()
    size = file.stat().st_size
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (int(2.5 * size), hard))
    try:
        with pytest.raises(OSError, match="full"):
            append_entries(folder, entries[1:])
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    append_entries(folder, entries[1:])
    assert list(read_entries(folder)) == entries[::-1]


async def test_the_list_is_filtered_and_exported_without_formulas(settings: Settings) -> None:
    async with open_house(settings) as house:
        right, operator = house.places("right", "right"), house.people["operator"]
        results = [entry(1), AuditEntry(2.0, "=1+1", 8, "viewer", "192.0.2.2", "STOP", "", "done")]
        append_entries(settings.data.audit, results)

        async def ask(path: str, query: str) -> bytes:
            status, _, report = await house.ask(operator, "GET", path, right, query=query)
            assert status == 200
            return report

        for query, times in (
            ("who=anna&until=9", [1.0]),
            ("what=stop&until=9", [2.0]),
            ("since=1.5&until=9", [2.0]),
            ("until=9", [2.0, 1.0]),
        ):
            listed = json.loads(await ask("/api/audit", query))
            assert ([entry["time"] for entry in listed["entries"]], listed["more"]) == (times, False)
        lines = (await ask("/api/audit/csv", "until=9")).decode().splitlines()
        assert lines[1].startswith("1970-01-01T00:00:02.000+00:00,'=1+1,8,viewer,192.0.2.2,STOP,")
