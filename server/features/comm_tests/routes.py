"""Communication tests: documents, runs, downloads, the thesis's tables."""

from fastapi import Request
from fastapi.responses import Response

from robot_runtime.contract.limits import ConfigError
from robot_runtime.experiments.comm_test.document import CommTest
from robot_runtime.experiments.comm_test.runner import estimate_seconds
from server.driving.admission import require_control
from server.features.comm_tests import tables
from server.features.comm_tests.reference import TABLES, TITLES, read_table
from server.features.comm_tests.runner import CommTestRunner, read_limited
from server.features.comm_tests.runs import UnknownCommTestRunError
from server.features.comm_tests.schemas import (
    Check,
    CheckedTest,
    CommTestRunDetails,
    CommTestStart,
    DocumentText,
    RunSummary,
    Started,
    TableCell,
    TestDocument,
    ThesisTable,
)
from server.features.comm_tests.shipped import shipped_documents
from server.health.monitor import HealthMonitor
from server.http.dependencies import Provided
from server.http.operations import Identifier, MeantNumber, Operations
from server.http.sign_in.policy import Need
from server.platform.csv_cells import STYLES, Spreadsheet
from server.platform.runs import RunOverError

router = Operations(prefix="/api/comm-tests", tags=["communication tests"])


@router.operation("GET /documents", Need.VIEWER)
def list_test_documents() -> list[TestDocument]:
    """List the documents that ship with the program, the thesis's own example (Figure 10) first."""
    return shipped_documents()


@router.operation("POST /check", Need.VIEWER)
def check_test_document(document: DocumentText) -> Check:
    """Check a document: its problems field by field, or its tests with their estimated durations."""
    try:
        return Check(problems=[], tests=[_describe(test) for test in read_limited(document.text)])
    except ConfigError as problem:
        return Check(problems=list(problem.problems), tests=[])


@router.operation(
    "POST /runs",
    Need.OPERATOR,
    {
        409: "Refused now",
        422: "The document cannot be run",
        423: "On the robot's board: control is with somebody else",
    },
    status_code=201,
)
async def start_test_run(
    request: Request,
    monitor: Provided[HealthMonitor],
    comm_tests: Provided[CommTestRunner],
    body: CommTestStart,
) -> Started:
    """Run the tests of a document one after the other; the answer comes when the first has begun."""
    if body.place == "robot":
        require_control(request)
    monitor.require_disarmed("A communication test builds and uploads programs.")
    return Started(run=await comm_tests.start(body.text, body.place))


@router.operation("POST /cancel", Need.OPERATOR, RunOverError)
async def cancel_test_run(comm_tests: Provided[CommTestRunner], run: MeantNumber = None) -> None:
    """Cancel the running document; finished cells are stored. `run` is any of the document's."""
    comm_tests.cancel(run)


@router.operation("GET /runs", Need.VIEWER)
def list_test_runs(comm_tests: Provided[CommTestRunner]) -> list[RunSummary]:
    """List the runs, also those that ship with the program, newest first; at most 500."""
    return list(comm_tests.runs.summaries())


@router.operation("GET /runs/{run}", Need.VIEWER, UnknownCommTestRunError)
def get_test_run(comm_tests: Provided[CommTestRunner], run: Identifier) -> CommTestRunDetails:
    """Return a run with its configuration and its cells."""
    return comm_tests.runs.whole(comm_tests.runs.find(run))


@router.operation(
    "GET /runs/{run}/csv", Need.VIEWER, UnknownCommTestRunError, media_type="text/csv", linked=True
)
def download_test_run_csv(
    comm_tests: Provided[CommTestRunner], run: Identifier, spreadsheet: Spreadsheet = "none"
) -> Response:
    """Download a run as CSV, a line for each cell.

    `spreadsheet` is the decimal sign of the spreadsheet that reads it.
    """
    row = comm_tests.runs.find(run)
    text = tables.write_csv(row, comm_tests.runs.cells(run), STYLES[spreadsheet])
    return _file(text, "text/csv", f"comm_test_{run}.csv")


@router.operation(
    "GET /runs/{run}/json", Need.VIEWER, UnknownCommTestRunError, media_type="application/json", linked=True
)
def download_test_run_json(comm_tests: Provided[CommTestRunner], run: Identifier) -> Response:
    """Download a run with all its data and cells, as JSON."""
    row = comm_tests.runs.find(run)
    text = tables.write_json(row, comm_tests.runs.cells(run))
    return _file(text, "application/json", f"comm_test_{run}.json")


@router.operation("GET /tables", Need.VIEWER)
def list_test_tables() -> list[ThesisTable]:
    """Return the thesis's own results: Table 5 (plain numbers) and Table 6 (packets)."""
    return [
        ThesisTable(
            name=name,
            title=TITLES[name],
            framing="plain" if name == "table5" else "thesis",
            cells=[
                TableCell(baud=baud, arduino_delay=arduino_delay, pi_delay=pi_delay, rate=rate)
                for (baud, arduino_delay, pi_delay), rate in read_table(name).items()
            ],
        )
        for name in TABLES
    ]


def _describe(test: CommTest) -> CheckedTest:
    return CheckedTest(
        id=test.id,
        name=test.name,
        framing=test.framing,
        direction=test.direction,
        cells=len(test.cells),
        bauds=list(test.baud_rate),
        arduino_delays=list(test.arduinodelay),
        pi_delays=list(test.delay),
        seconds=sum(estimate_seconds(test, cell) for cell in test.cells),
    )


def _file(text: str, media_type: str, name: str) -> Response:
    headers = {"content-disposition": f'attachment; filename="{name}"'}
    return Response(text, media_type=media_type, headers=headers)
