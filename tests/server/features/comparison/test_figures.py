"""Figures of all sessions of an archive: computed once, and studied by group and over time."""

import pytest
from sqlalchemy import insert
from sqlmodel import select

from server.analysis.definitions import STORY_FIGURES
from server.features.comparison import figure_worker
from server.features.comparison.figure_query import FigureQuery, FigureStudy, quantile, study_figure
from server.features.comparison.figure_worker import AGAIN_SECONDS, FigureWorker
from server.features.comparison.worker import ComparisonError, ComparisonWorker, Task
from server.platform.models import SessionFiguresRow, SessionRow
from server.platform.settings import Settings
from server.platform.store import Store
from tests.server.blocks import depth_block
from tests.server.features.exports.recordings import record_batches

BOTH_DATABASES = True


def row(number: int, **values: object) -> dict[str, object]:
    made = SessionRow(
        id=number,
        name=f"dive {number}",
        note="",
        state="complete",
        robot=f"turtle-{number % 2}",
        version="1",
        definitions="0",
        started=1.8e9 + 86_400 * number,
        started_steady=100.0,
        configuration="",
        robot_state="null",
        topics="{}",
    )
    return made.model_dump() | values


def figures(session: int, segment: int, **values: object) -> dict[str, object]:
    made = SessionFiguresRow(session_id=session, segment=segment, controller="PID", gains="kp 3", craft="")
    return made.model_dump() | values


@pytest.fixture
async def archive(store: Store) -> Store:
    """A hundred sessions with errors from 0.01 m to 1 m, of two controllers; one has no figures yet."""
    await store.execute(insert(SessionRow), [row(number) for number in range(1, 102)])
    rows = [
        figures(number, segment, rmse=number / 100, controller="PID" if number <= 60 else "Bang-bang")
        for number in range(1, 101)
        for segment in (0, 1, 2)
    ]
    await store.execute(insert(SessionFiguresRow), rows)
    return store


async def test_a_figure_of_all_sessions(archive: Store) -> None:
    study = study_figure(archive, FigureQuery())
    assert (study.sessions, study.waiting, study.count) == (101, 1, 100)
    (group,) = study.groups
    assert (group.least, group.greatest, group.count) == (0.01, 1.0, 100)
    assert group.median == pytest.approx(0.505)
    assert (sum(group.bins), len(study.edges)) == (100, len(group.bins) + 1)
    assert [example.value for example in study.least] == [0.01, 0.02, 0.03, 0.04, 0.05]
    assert [example.name for example in study.greatest[:2]] == ["dive 100", "dive 99"]
    assert (study.period, sum(period.count for period in study.course)) == ("week", 100)


async def test_by_group_of_segments_and_of_some_sessions(archive: Store) -> None:
    study = study_figure(archive, FigureQuery(of="segment", by="controller"))
    assert [(group.name, group.count) for group in study.groups] == [("PID", 120), ("Bang-bang", 80)]
    some = study_figure(archive, FigureQuery(robot="turtle-1", search="dive 9"))
    assert [some.sessions, some.count] == [14, 14]
    none = study_figure(archive, FigureQuery(figure="overshoot"))
    assert (none.count, none.edges, none.groups, none.course) == (0, [], [], [])


async def test_many_groups_are_the_most_common_and_all_others(store: Store) -> None:
    await store.execute(insert(SessionRow), [row(number) for number in range(1, 21)])
    rows = [figures(number, 0, rmse=0.1, gains=f"kp {max(number, 5)}") for number in range(1, 21)]
    await store.execute(insert(SessionFiguresRow), rows)
    study = study_figure(store, FigureQuery(by="gains"))
    assert (study.groups[0].name, study.groups[0].count) == ("kp 5", 5)
    assert (study.groups[-1].name, sum(group.count for group in study.groups)) == ("all others", 20)


@pytest.mark.parametrize(("share", "value"), [(0.0, 1.0), (0.5, 2.5), (0.25, 1.75), (1.0, 4.0)])
def test_a_share_of_the_values(share: float, value: float) -> None:
    assert quantile([1.0, 2.0, 3.0, 4.0], share) == value


async def test_the_comparing_process_computes_each_session_once(store: Store, settings: Settings) -> None:
    session = await record_batches(store, settings, [depth_block(0, 500)])
    comparison = ComparisonWorker(settings.data)
    try:
        worker = FigureWorker(comparison, store)
        await worker.compute_missing()
        await worker.compute_missing()
    finally:
        await comparison.close()
    with store.read() as database:
        rows = database.exec(select(SessionFiguresRow)).all()
    assert [(row.session_id, row.segment, row.controller) for row in rows] == [(session, 0, "")]
    assert isinstance(study_figure(store, FigureQuery(figure="frames_lost")), FigureStudy)


async def test_a_session_whose_figures_failed_is_tried_again_after_a_while(
    store: Store, settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    session = await record_batches(store, settings, [depth_block(0, 500)])
    comparison, now, asked = ComparisonWorker(settings.data), [1e6], list[str]()
    ask = comparison.ask

    async def fail_at_first(task: Task, query: str) -> bytes:
        asked.append(query)
        if len(asked) == 1:
            raise ComparisonError("The database does not work: PostgreSQL does not answer.")
        return await ask(task, query)

    monkeypatch.setattr(comparison, "ask", fail_at_first)
    monkeypatch.setattr(figure_worker, "monotonic", lambda: now[0])
    try:
        worker = FigureWorker(comparison, store)
        await worker.compute_missing()
        await worker.compute_missing()
        assert asked == [str(session)]
        now[0] += AGAIN_SECONDS
        await worker.compute_missing()
    finally:
        await comparison.close()
    with store.read() as database:
        assert [row.session_id for row in database.exec(select(SessionFiguresRow))] == [session]


def test_every_kept_figure_has_a_column_and_can_be_asked_for() -> None:
    names = {meaning.name for meaning in STORY_FIGURES}
    columns = SessionFiguresRow.model_fields.keys() - {
        "session_id",
        "segment",
        "controller",
        "gains",
        "craft",
    }
    assert names == columns
    asked = FigureQuery.model_json_schema()["properties"]["figure"]["enum"]
    assert names == set(asked)
