"""The doctor's checks of a lab, each as those in `checks`; they apply only where the server is a lab's."""

from datetime import UTC, datetime

from server.features.doctor.findings import Finding, Reporter
from server.features.doctor.lab_facts import UNIT, LabFacts
from server.features.doctor.machine import Machine

DAY = 86_400
SOON_DAYS = 30
START = f"mucat lab run, or sudo systemctl start {UNIT}"


def check_archive(machine: Machine) -> Finding | None:
    """Check that PostgreSQL answers, with an archive that this version knows."""
    report, lab = Reporter("archive", "Archive"), _lab(machine)
    if not lab.archive:
        return None
    if lab.archive_problem:
        return report.wrong(
            lab.archive_problem, "sudo systemctl status postgresql; database under [lab]: docs/run/lab.md"
        )
    return report.ok(f"PostgreSQL answers, {(lab.archive_bytes or 0) / 1e6:.0f} MB.")


def check_router(machine: Machine) -> Finding | None:
    """Check that the router runs, by which the robots reach the lab."""
    report, lab = Reporter("router", "Router of the robots"), _lab(machine)
    if not lab.router_state:
        return report.look("Not asked: the lab does not run.", START)
    if lab.router_state == "ok":
        return report.ok(lab.router_text)
    if lab.router_state == "starting":
        return report.look(lab.router_text, f"Look again in a minute; journalctl -u {UNIT}")
    return report.wrong(lab.router_text, f"journalctl -u {UNIT}; ss -ltnp shows who has its port")


def check_robots(machine: Machine) -> Finding | None:
    """Check that no robot has been silent for long."""
    report, lab = Reporter("robots", "Robots"), _lab(machine)
    if not lab.robots_state:
        return report.look("Not asked: the lab does not run.", START)
    if lab.robots_state == "ok":
        return report.ok(lab.robots_text)
    return report.look(
        lab.robots_text, "Switch it on where it reaches the lab; or remove it: mucat lab remove"
    )


def check_certificates(machine: Machine) -> Finding | None:
    """Check that the lab's own certificates are valid for a while."""
    report, lab = Reporter("certificates", "Certificates"), _lab(machine)
    if lab.certificate_problem:
        return report.wrong(lab.certificate_problem, f"Check the permissions of {machine.data}")
    if not lab.ends:
        return None
    file, end = min(lab.ends.items(), key=lambda item: item[1])
    text = f"{file} ends on {datetime.fromtimestamp(end, UTC):%Y-%m-%d}."
    remedy = f"sudo systemctl restart {UNIT}: the page's is renewed at each start"
    if end < machine.now:
        return report.wrong(text.replace(" ends ", " ended "), remedy)
    if end < machine.now + SOON_DAYS * DAY:
        return report.look(text, remedy)
    return report.ok(f"The first that ends: {text}")


def check_scheduler(machine: Machine) -> Finding | None:
    """Check that the scheduler of sweeps can be reached."""
    report, lab = Reporter("scheduler", "Scheduler of sweeps"), _lab(machine)
    if not lab.scheduler:
        return None
    if lab.scheduler_problem:
        return report.look(
            f"{lab.scheduler} does not answer: {lab.scheduler_problem}.",
            "Start it, or correct scheduler under [sweeps] in robot.toml: docs/use/sweeps.md",
        )
    return report.ok(f"{lab.scheduler} answers.")


def check_lab_service(machine: Machine) -> Finding | None:
    """Check that the installed service goes on when a part of it is killed."""
    report, unit = Reporter("service", "Service"), machine.units.get(UNIT)
    if unit is None:
        return None
    if "Restart=always" not in {line.strip() for line in unit.splitlines()}:
        return report.wrong(f"{UNIT} lacks Restart=always.", "sudo mucat install --lab")
    return report.ok("The lab is started again whatever ends it.")


def _lab(machine: Machine) -> LabFacts:
    assert machine.lab is not None
    return machine.lab
