"""The database's tables. Migrations see this module alone."""

from uuid import uuid4

from sqlalchemy import BigInteger, Integer
from sqlmodel import Field, Index, SQLModel, UniqueConstraint

NEVER_AGAIN = {"sqlite_autoincrement": True}
"""A number is never given again: pages, links, caches, exports that wait and the audit log hold on to it."""
BIG = BigInteger().with_variant(Integer(), "sqlite")
"""A number of 64 bits. SQLite's are, and its primary keys are no other."""


class SessionRow(SQLModel, table=True):
    """One recording. Times are UTC (s since 1970) and steady (s, the computer's steady clock).

    `identifier` is the same wherever the session is imported; `boot` tells which start of the computer its
    steady clock counts from. Origins: "operator", "arming", "scenario" (in real time), "simulated" (a
    scenario in simulated time), "import". `scenario` is its text as TOML; `firmware` and `software` are
    hashes. `kept` protects it from the retention rule; `deleted` is when somebody deleted it, until it is
    really removed. `archived` is when a lab said that it has the session. `edits` counts the changes of its
    texts, dates and bookmarks.
    """

    __tablename__ = "session"
    __table_args__ = (Index("session_identifier", "identifier", unique=True), NEVER_AGAIN)

    id: int | None = Field(default=None, primary_key=True)
    identifier: str = Field(default_factory=lambda: uuid4().hex)
    name: str
    note: str
    state: str = Field(index=True)
    robot: str
    version: str
    definitions: str
    started: float
    started_steady: float
    ended: float | None = None
    duration: float = 0.0
    samples: int = Field(default=0, sa_type=BIG)
    bytes: int = Field(default=0, sa_type=BIG)
    configuration: str
    robot_state: str
    topics: str
    boot: str = ""
    origin: str = "operator"
    scenario: str = ""
    scenario_name: str = ""
    seed: int | None = Field(default=None, sa_type=BIG)
    firmware: str = ""
    software: str = ""
    kept: bool = False
    deleted: float | None = None
    archived: float | None = None
    edits: int = 0


class SessionTag(SQLModel, table=True):
    """A word by which sessions are found together."""

    __tablename__ = "session_tag"
    __table_args__ = (UniqueConstraint("session_id", "tag", name="session_tag_place"),)

    id: int | None = Field(default=None, primary_key=True)
    session_id: int = Field(foreign_key="session.id")
    tag: str


class SummaryRow(SQLModel, table=True):
    """The summary of a session that has ended, for the list: a `SessionSummary` as JSON.

    It follows from the samples, and is computed again where it is missing.
    """

    __tablename__ = "session_summary"

    session_id: int = Field(foreign_key="session.id", primary_key=True)
    document: str


class BookmarkRow(SQLModel, table=True):
    """A bookmark: a moment (s, steady clock), its note (Markdown), when it was made (UTC, s since 1970)."""

    __tablename__ = "marker"
    __table_args__ = (NEVER_AGAIN,)

    id: int | None = Field(default=None, primary_key=True)
    session_id: int = Field(foreign_key="session.id", index=True)
    time: float
    text: str
    made: float


class Chunk(SQLModel, table=True):
    """Samples of one topic with consecutive numbers from `first` on; how they lie in `data`, `encoding` says.

    Times are of the first and the last sample (s, steady clock). `run` names the run of the process that sent
    them; it is empty if that is not known, and for what the server itself sends.
    """

    __table_args__ = (
        UniqueConstraint("session_id", "topic", "number", name="chunk_place"),
        Index("chunk_time", "session_id", "topic", "first_time", "last_time", "count"),
    )

    id: int | None = Field(default=None, primary_key=True, sa_type=BIG)
    session_id: int = Field(foreign_key="session.id")
    topic: str
    number: int
    first_time: float
    last_time: float
    first: int = Field(sa_type=BIG)
    count: int
    encoding: str
    data: bytes
    run: str = ""


class Gap(SQLModel, table=True):
    """Samples that are not in the session: `missed` of them, noticed at `time` (s, steady clock).

    Kinds: "missed" never arrived, "restarted" the writer began to count anew, "not stored" could not be
    written, "damaged" could not be read, "removed" made room for others.
    """

    id: int | None = Field(default=None, primary_key=True)
    session_id: int = Field(foreign_key="session.id", index=True)
    topic: str
    kind: str
    time: float
    missed: int = Field(sa_type=BIG)


class CommTestRun(SQLModel, table=True):
    """One run of a communication test. Times are UTC (s since 1970); `document` is the test, `tools` the
    versions of what made and ran the sketch, both as JSON; `firmware` is the hash of sketch, core and flags.

    States: "running", "complete", "cancelled", "failed", "interrupted". `place` is "emulated" (boards of its
    own, in emulated time) or "robot" (the robot's board, in real time); `sample` names a run that came with
    the program.
    """

    __tablename__ = "comm_test_run"
    __table_args__ = (NEVER_AGAIN,)

    id: int | None = Field(default=None, primary_key=True)
    name: str
    document: str
    framing: str
    direction: str
    cells: int
    firmware: str
    tools: str
    host: str
    started: float
    ended: float | None = None
    state: str
    problem: str = ""
    place: str = "emulated"
    sample: str = ""


class CommTestCell(SQLModel, table=True):
    """One cell of a run. Delays and `seconds` (the test's time) in s; rate from 0 to 1; `answered` is false
    where the chip's own counts never came; `repeated` are frames that were sent again. Both directions'
    counts are added up.
    """

    __tablename__ = "comm_test_cell"
    __table_args__ = (UniqueConstraint("run_id", "number", name="comm_test_cell_place"),)

    id: int | None = Field(default=None, primary_key=True)
    run_id: int = Field(foreign_key="comm_test_run.id")
    number: int
    baud: int
    arduino_delay: float
    pi_delay: float
    rate: float
    answered: bool
    right: int
    out_of_sequence: int
    checksum_errors: int
    framing_errors: int
    ring_full: int
    bytes_read: int
    bytes_lost: int
    line_errors: int
    uart_overruns: int
    repeated: int = 0
    seconds: float
    causes: str
    explanation: str


class DeviceRow(SQLModel, table=True):
    """A browser, a program or a lab that may come in. Times are UTC (s since 1970).

    `seen` is kept to the hour. `secret` is the SHA-256 of what it proves itself with. Kinds: "browser" (a
    cookie), "program" and "lab" (a bearer token), "reader" (the cookie of a reading link, for the session
    `session_id` alone), "removed" (no secret; browsers do not get its name). `page_secret` is the SHA-256 of
    a browser's second secret, which its page keeps; a browser that was paired before there was one has None,
    and signs in again. `limited` is a token that may not administer, in any role; it never ends where `ends`
    is None.
    """

    __tablename__ = "device"
    __table_args__ = (Index("device_secret", "secret", unique=True), NEVER_AGAIN)

    id: int | None = Field(default=None, primary_key=True)
    name: str
    role: str
    kind: str
    secret: str
    paired: float
    seen: float
    limited: bool = False
    ends: float | None = None
    page_secret: str | None = None
    session_id: int | None = None


class ProfileRow(SQLModel, table=True):
    """Parameters stored under a name; `parameters` as JSON. Time is UTC (s since 1970).

    `author` is who stored them; empty where an older version did.
    """

    __tablename__ = "profile"
    __table_args__ = (UniqueConstraint("name", name="profile_name"), NEVER_AGAIN)

    id: int | None = Field(default=None, primary_key=True)
    name: str
    note: str = ""
    saved: float
    parameters: str
    author: str = ""


class ParameterChangeRow(SQLModel, table=True):
    """Parameters that were changed together; `changed` as JSON. Time is UTC (s since 1970).

    `run` is the runtime's, `why` the profile that was restored, `undone` who took the change back.
    """

    __tablename__ = "parameter_change"
    __table_args__ = (NEVER_AGAIN,)

    id: int | None = Field(default=None, primary_key=True)
    time: float
    run: str
    who: str
    why: str = ""
    changed: str
    undone: str = ""


class TuningRunRow(SQLModel, table=True):
    """A step response or a relay experiment, and what came of it. Time is UTC (s since 1970).

    Kinds: "step", "relay". States: "running", "complete", "stopped", "failed", "interrupted". `settings`
    (what was asked), `parameters` (the controller in force, and what a PID's gains may be) and `figures` are
    JSON; `curve` is what was measured, in zlib.
    """

    __tablename__ = "tuning_run"
    __table_args__ = (NEVER_AGAIN,)

    id: int | None = Field(default=None, primary_key=True)
    name: str
    kind: str
    loop: str
    started: float
    state: str
    problem: str = ""
    settings: str
    parameters: str
    figures: str = ""
    curve: bytes = b""


class LayoutRow(SQLModel, table=True):
    """A named arrangement of the panels of Operate; `document` as JSON. Time is UTC (s since 1970).

    `version` counts its changes from 1; `author` is who made the last one, empty where an older version did.
    """

    __tablename__ = "layout"
    __table_args__ = (UniqueConstraint("name", name="layout_name"), NEVER_AGAIN)

    id: int | None = Field(default=None, primary_key=True)
    name: str
    saved: float
    document: str
    author: str = ""
    version: int = 1


class SweepRow(SQLModel, table=True):
    """A sweep. Times are UTC (s since 1970).

    `scenario_text` and `craft` are those at its start, so that it can be resumed when the library has
    changed. States: "waiting", "running", "complete", "cancelled", "failed", "interrupted". `done` and
    `failed` count its runs; `best` is a `SweepBest` by `best_figure` as JSON, "" while there is none.
    `parameters` are their names as JSON.
    """

    __tablename__ = "sweep"
    __table_args__ = (NEVER_AGAIN,)

    id: int | None = Field(default=None, primary_key=True)
    name: str
    title: str
    scenario: str
    text: str
    scenario_text: str
    craft: str
    who: str
    state: str
    problem: str = ""
    runs: int
    done: int = 0
    failed: int = 0
    best: str = ""
    best_figure: str
    parameters: str
    made: float
    started: float | None = None
    ended: float | None = None


class SweepRunRow(SQLModel, table=True):
    """A run of a sweep that is done: its variant, its seed, the value of each parameter as JSON.

    `key` names the row of its figures, which several sweeps may share.
    """

    __tablename__ = "sweep_run"
    __table_args__ = (UniqueConstraint("sweep_id", "number", name="sweep_run_place"),)

    id: int | None = Field(default=None, primary_key=True)
    sweep_id: int = Field(foreign_key="sweep.id")
    number: int
    variant: int
    seed: int = Field(sa_type=BIG)
    parameter_values: str
    key: str = Field(foreign_key="run_figures.key", index=True)


class RunFiguresRow(SQLModel, table=True):
    """The figures of a scenario in simulated time, by everything that they follow from.

    `key` is the hash of the scenario with its seed, the range, craft, firmware and software. `simulated` and
    `seconds` are the scenario's time and the time that it took, s; `problem` says why it failed, "" if it did
    not. `figures` are values by name as JSON, null where there is none, and `words` the reasons for that.
    """

    __tablename__ = "run_figures"

    key: str = Field(primary_key=True)
    firmware: str
    software: str
    simulated: float
    seconds: float
    problem: str
    figures: str
    words: str


class PulledSessionRow(SQLModel, table=True):
    """A session that a lab has pulled: once purged there, it is not pulled again.

    `robot` is the name by which the robot had joined, `edits` the session's there, as of the last look.
    `texts` are those that came from there last (features/lab/edits.py), as JSON. Time is UTC (s since 1970).
    """

    __tablename__ = "pulled_session"

    identifier: str = Field(primary_key=True)
    robot: str
    pulled: float
    edits: int
    texts: str


class SessionFiguresRow(SQLModel, table=True):
    """Figures of a session in an archive (`segment` 0), or of one of its segments, from 1 on.

    They follow from the samples (`server.analysis.archive_figures`), and are computed again where they are
    missing. A figure that is not known is None.
    """

    __tablename__ = "session_figures"

    session_id: int = Field(foreign_key="session.id", primary_key=True)
    segment: int = Field(primary_key=True)
    controller: str
    gains: str
    craft: str
    duration: float | None = None
    deepest: float | None = None
    rmse: float | None = None
    cycle_amplitude: float | None = None
    overshoot: float | None = None
    settling_time: float | None = None
    fin_strokes: float | None = None
    frames_lost: float | None = None
    alarms: float | None = None
