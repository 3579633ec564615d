"""The doctor of a lab: each of its checks has a case with every other verdict, and it looks at a real one."""

import re
import socket
from contextlib import closing
from dataclasses import replace
from typing import Any

import click
import pytest

from server.cli import mucat
from server.features.doctor.checks import LAB_CHECKS, examine
from server.features.doctor.findings import Finding
from server.features.doctor.lab_facts import UNIT, LabFacts
from server.features.doctor.machine import Machine, read_machine
from server.features.sweeps.config import SweepsConfig
from server.platform.lab_config import LabConfig
from server.platform.settings import Settings
from server.platform.wall_clock import SOFTWARE_MADE
from tests.server.features.lab.labs import serve_lab
from tests.server.postgres import new_archive, postgres

DAY = 86_400.0
NOW = SOFTWARE_MADE + DAY
LAB = LabFacts(
    archive="postgresql+psycopg:///mucat",
    archive_bytes=2_000_000,
    router_state="ok",
    router_text="Robots reach it at port 7447.",
    robots_state="ok",
    robots_text="2 of 3 are heard now.",
    ends={"tls/certificate.pem": NOW + 400 * DAY, "zenoh/certificate.pem": NOW + 9000 * DAY},
    scheduler="tls://lab.local:8786",
)
GOOD = Machine(now=NOW, data="/var/lib/mucat", units={UNIT: "[Service]\nRestart=always\n"}, lab=LAB)
CASES: dict[str, tuple[dict[str, Any], str, str]] = {
    "archive: away": (
        {"archive_problem": "PostgreSQL does not answer: refused."},
        "wrong",
        "does not answer",
    ),
    "router: not asked": ({"router_state": ""}, "look", "does not run"),
    "router: not yet": ({"router_state": "starting", "router_text": "It is starting."}, "look", "starting"),
    "router: ended": ({"router_state": "failed", "router_text": "The router ended."}, "wrong", "ended"),
    "robots: not asked": ({"robots_state": ""}, "look", "does not run"),
    "robots: silent": (
        {"robots_state": "absent", "robots_text": "Not heard for 7 days: turtle-2."},
        "look",
        "turtle-2",
    ),
    "certificates: soon": ({"ends": {"tls": NOW + DAY}}, "look", "tls ends on"),
    "certificates: over": ({"ends": {"tls": NOW - DAY}}, "wrong", "tls ended on"),
    "certificates: unreadable": ({"certificate_problem": "They cannot be read."}, "wrong", "cannot be read"),
    "scheduler: away": ({"scheduler_problem": "Connection refused"}, "look", "Connection refused"),
}


def examine_with(**facts: Any) -> dict[str, Finding]:
    """Return the findings by name, of a good lab with other facts."""
    return {finding.name: finding for finding in examine(replace(GOOD, lab=replace(LAB, **facts)))}


@pytest.mark.parametrize("case", CASES)
def test_a_check_finds_it_and_says_what_mends_it(case: str) -> None:
    facts, verdict, text = CASES[case]
    name, findings = case.partition(":")[0], examine_with(**facts)
    assert (findings[name].verdict, text in findings[name].text) == (verdict, True), findings[name]
    assert {finding.name for finding in findings.values() if finding.verdict != "ok"} == {name}
    for command in re.findall(r"\bmucat ([a-z]+)", findings[name].mend):
        assert mucat.get_command(click.Context(mucat), command) is not None, command


def test_a_good_lab_is_asked_nothing_about_a_board() -> None:
    findings = examine_with()
    assert [finding for finding in findings.values() if finding.verdict != "ok"] == []
    # Its archive is in PostgreSQL, not in a file, and its computer is no small one.
    assert len(findings) == len(LAB_CHECKS) - 2
    assert not findings.keys() & {"board", "port", "camera", "firmware", "buoyancy"}
    modest = examine_with(archive="", scheduler="", ends={})
    assert modest.keys() == findings.keys() - {"archive", "scheduler", "certificates"} | {"database"}
    unit = examine(replace(GOOD, units={UNIT: "[Service]\n"}))
    assert [finding.name for finding in unit if finding.verdict == "wrong"] == ["service"]


async def test_it_looks_at_a_lab(settings: Settings) -> None:
    async with serve_lab(settings) as lab:
        findings = {finding["name"]: finding for finding in (await lab.api.post("/doctor")).json()}
        assert findings["database"]["verdict"] == "ok"
        assert findings["certificates"]["verdict"] == "ok"
        assert findings["robots"]["text"].startswith("No robot has joined yet")


@pytest.mark.parametrize(("archive", "verdict"), [("there", "ok"), ("absent", "wrong")])
def test_it_looks_at_postgresql_and_at_a_scheduler(settings: Settings, archive: str, verdict: str) -> None:
    settings = replace(settings, lab=True)
    url = new_archive() if archive == "there" else postgres().url("absent")
    with closing(socket.socket()) as closed:
        # Nobody listens.
        closed.bind(("127.0.0.1", 0))
        scheduler = f"tcp://127.0.0.1:{closed.getsockname()[1]}"
        for section in (LabConfig(database=url), SweepsConfig(scheduler=scheduler)):
            settings = settings.with_section(section)
        findings = {finding.name: finding for finding in examine(read_machine(settings, NOW))}
    assert findings["archive"].verdict == verdict
    assert "Connection refused" in findings["scheduler"].text
    assert "database" not in findings
