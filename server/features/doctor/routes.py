"""The doctor's findings, and another examination."""

from server.features.doctor.examination import Examination
from server.features.doctor.findings import Finding
from server.health.monitor import HealthMonitor
from server.http.dependencies import Provided
from server.http.heavy_requests import Turn
from server.http.operations import Operations
from server.http.sign_in.policy import Need

router = Operations(prefix="/api/doctor", tags=["health"])


@router.operation("GET", Need.OPERATOR)
def get_findings(examination: Provided[Examination]) -> list[Finding]:
    """Return the doctor's last findings: of the server's start, or of the last examination."""
    return examination.newest()


@router.operation("POST", Need.OPERATOR, {409: "Refused while the robot is armed"})
async def examine_again(
    _: Turn, monitor: Provided[HealthMonitor], examination: Provided[Examination]
) -> list[Finding]:
    """Examine the computer again, and return the findings.

    The libraries are imported in a process of their own, which takes seconds on a Raspberry Pi.
    """
    monitor.require_disarmed("The doctor's look takes seconds of processor time.")
    return await examination.repeat()
