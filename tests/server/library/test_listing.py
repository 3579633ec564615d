"""Lists of sessions a page at a time, and answers about one session that do not grow with it."""

import asyncio
import json
from collections.abc import Callable
from datetime import UTC, datetime, timedelta, timezone
from typing import Any

import pytest
from sqlalchemy import Executable, insert, update
from sqlmodel import SQLModel, col

from robot_runtime.clock import SimulatedClock
from server.library.bookmarks import Bookmarks
from server.library.content import Recording
from server.library.listing import (
    COLUMNS_SHOWN,
    TAGS_SHOWN,
    Grouping,
    Listing,
    SessionPage,
    SessionSelection,
)
from server.library.replay import read_blocks_between
from server.library.schemas import SHOWN_MAX
from server.library.timeline import read_timeline
from server.platform.models import BookmarkRow, Chunk, Gap, SessionRow, SessionTag, SummaryRow
from server.platform.notices import Notices
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.recorder import Recorder
from server.recording.session import SessionStateError
from tests.server.blocks import depth_block
from tests.server.features.exports.recordings import STARTED_STEADY, record
from tests.server.serving import Served

BOTH_DATABASES = True


def execute(store: Store, statement: Executable, *rows: dict[str, Any]) -> None:
    """Execute a statement, for each of these rows."""
    asyncio.run(store.write(lambda connection: connection.execute(statement, [*rows] or None)))


def add(store: Store, table: type[SQLModel], *rows: dict[str, Any]) -> None:
    """Insert rows."""
    execute(store, insert(table), *rows)


def session(number: int, **values: Any) -> dict[str, Any]:
    """Return the columns of a session."""
    row = SessionRow(
        id=number,
        name=f"dive {number}",
        note="",
        state="complete",
        robot="r",
        version="1",
        definitions="0",
        started=1.8e9,
        started_steady=100.0,
        configuration="",
        robot_state="null",
        topics="{}",
    )
    return row.model_dump() | values


def test_pages_follow_each_other_and_count_all(store: Store) -> None:
    add(store, SessionRow, *(session(number) for number in range(1, 8)))
    listing = Listing(store)
    results: list[list[int]] = []
    before: int | None = None
    while True:
        page = listing.page(limit=3, before=before)
        assert page.total == 7
        results.append([entry.id for entry in page.sessions])
        before = page.following
        if before is None:
            break
    assert results == [[7, 6, 5], [4, 3, 2], [1]]
    assert [len(part) for part in listing.pages(SessionSelection(search="dive"))] == [7]


def summary(number: int, **values: Any) -> dict[str, Any]:
    """Return the columns of a summary."""
    empty: dict[str, Any] = {
        "depth": None,
        "armed": 0,
        "controllers": [],
        "modes": [],
        "cards": [],
        "mission": "",
        "alarms": 0,
    }
    empty |= {"curve": [], "face": None, "damaged": False}
    return {"session_id": number, "document": json.dumps(empty | values)}


def numbers(page: SessionPage) -> list[int]:
    """Return the numbers of a page's sessions."""
    return [entry.id for entry in page.sessions]


def test_the_list_is_narrowed_by_what_the_summaries_say(store: Store) -> None:
    add(store, SessionRow, session(1), session(2, kept=True, origin="arming"), session(3, started=1.9e9))
    add(store, SummaryRow, summary(1, controllers=["PID", "Bang-bang"]), summary(2, controllers=["PID"]))
    chunk = {"session_id": 3, "topic": "film", "number": 0, "first_time": 0.0, "last_time": 1.0, "first": 0}
    add(store, Chunk, chunk | {"count": 1, "encoding": "", "data": b"", "run": ""})
    listing = Listing(store)

    def choose(**conditions: Any) -> list[int]:
        return numbers(listing.page(SessionSelection(**conditions)))

    assert [choose(controller=title) for title in ("PID", "Bang-bang", "B")] == [[2, 1], [1], []]
    assert [choose(kept=True), choose(film=True), choose(origin="arming")] == [[2], [3], [2]]
    moment = datetime.fromtimestamp(1.85e9, UTC)
    assert (choose(since=moment), choose(until=moment)) == ([3], [2, 1])
    assert listing.controllers() == ["Bang-bang", "PID"]
    assert [entry.film for entry in listing.page().sessions] == [True, False, False]
    assert listing.find(2).summary is not None
    assert listing.find(3).summary is None


def test_groups_follow_each_other_as_the_list_does(store: Store) -> None:
    names = ["", "b", "a", "b"]
    rows = [session(n, scenario_name=name, started=1.8e9 + n * 7200) for n, name in enumerate(names, 1)]
    add(store, SessionRow, *rows)
    add(store, SummaryRow, summary(2, mission="square"))
    listing = Listing(store)

    def groups(by: Grouping, **options: Any) -> list[tuple[str, int]]:
        named = listing.groups(SessionSelection(), by, **options)
        return [(group.name, group.count) for group in named]

    assert groups("scenario") == [("a", 1), ("b", 2), ("", 1)]
    assert numbers(listing.page(by="scenario")) == [3, 4, 2, 1]
    assert numbers(listing.page(by="scenario", skip=1, limit=2)) == [4, 2]
    assert groups("mission") == [("square", 1), ("", 3)]
    assert groups("none") == [("", 4)]
    # 1.8e9 is 08:00 UTC on 15 January 2027.
    assert groups("day") == [("2027-01-15", 4)]
    assert groups("day", zone=timezone(timedelta(hours=12))) == [("2027-01-16", 3), ("2027-01-15", 1)]


async def test_pages_of_a_grouped_list_follow_each_other_over_http(served: Served) -> None:
    store = served.get(Store)
    rows = [session(number, scenario_name=str(number % 2)) for number in range(1, 6)]
    await store.write(lambda connection: connection.execute(insert(SessionRow), rows))
    listed, address = [], "/api/sessions?by=scenario&limit=2"
    while address:
        answer = await served.api.get(address.removeprefix("/api"))
        listed += [entry["id"] for entry in answer.json()]
        address = answer.links.get("next", {}).get("url", "")
    assert listed == [4, 2, 5, 3, 1]
    groups = await served.api.get("/sessions/groups", params={"by": "scenario"})
    assert groups.json() == [{"name": "0", "count": 2}, {"name": "1", "count": 3}]
    nonsense = await served.api.get("/sessions/groups", params={"by": "day", "zone": "../etc/passwd"})
    assert (nonsense.status_code, "knows no time zone" in nonsense.json()["detail"]) == (422, True)


def test_a_page_is_filled_with_sessions_that_match(store: Store) -> None:
    rows = (session(number, note="" if number % 3 else "ÄRGER") for number in range(1, 10))
    add(store, SessionRow, *rows)
    add(store, SessionTag, {"session_id": 1, "tag": "Übung"}, {"session_id": 2, "tag": "sea"})
    listing = Listing(store)
    page = listing.page(SessionSelection(search="ärger"), limit=2)
    assert ([entry.id for entry in page.sessions], page.total, page.following) == ([9, 6], 3, 6)
    assert [entry.id for entry in listing.page(SessionSelection(search="übung")).sessions] == [1]
    assert [entry.tags for entry in listing.page(SessionSelection(tag=["ÜBUNG"])).sessions] == [["Übung"]]
    assert listing.page(SessionSelection(search="100%")).sessions == []


def test_tags_in_use_are_listed_up_to_a_number(store: Store) -> None:
    add(store, SessionRow, session(1), session(2), session(3, deleted=1.8e9))
    add(store, SessionTag, *({"session_id": 1, "tag": f"tag {n:04}"} for n in range(TAGS_SHOWN + 5)))
    add(store, SessionTag, {"session_id": 2, "tag": "tag 0104"}, {"session_id": 3, "tag": "binned"})
    tags = Listing(store).tags()
    assert (tags[0], len(tags)) == ("tag 0104", TAGS_SHOWN)


async def test_the_interface_gives_a_page_its_total_and_the_next_address(served: Served) -> None:
    for number in range(5):
        started = (await served.api.post("/sessions", json={"name": f"dive {number}"})).json()
        await served.api.post(f"/sessions/{started['id']}/stop")
    address = "/api/sessions?limit=2&search=dive"
    results = []
    while address:
        answer = await served.api.get(address.removeprefix("/api"))
        assert answer.headers["total-count"] == "5"
        results.append([tag["name"] for tag in answer.json()])
        address = answer.links.get("next", {}).get("url", "")
    assert results == [["dive 4", "dive 3"], ["dive 2", "dive 1"], ["dive 0"]]
    for query in ("limit=0", "limit=501", "before=0", "before=x"):
        assert (await served.api.get(f"/sessions?{query}")).status_code == 422


def test_an_answer_about_a_session_has_a_limit(store: Store, settings: Settings) -> None:
    number = record(store, settings, [depth_block(0, 5)])
    count = SHOWN_MAX + 500
    times = [STARTED_STEADY + 0.001 * (count - position) for position in range(count)]
    gap = {"session_id": number, "topic": "depth", "kind": "missed", "missed": 1}
    mark = {"session_id": number, "text": "here", "made": 1.8e9}
    add(store, Gap, *(gap | {"time": time} for time in times))
    add(store, BookmarkRow, *(mark | {"time": time} for time in times))
    detail = Listing(store).detail(number)
    assert (detail.markers, detail.gap_count) == (count, count)
    for shown in ([moment.time for moment in detail.marks], [moment.time for moment in detail.gaps]):
        assert len(shown) == SHOWN_MAX
        assert shown == sorted(shown)
        assert shown[0] == pytest.approx(0.001)
    assert len(read_timeline(Recording.open(store, number)).markers) == SHOWN_MAX


def test_topics_of_a_million_columns_are_cut_off(store: Store, settings: Settings) -> None:
    number = record(store, settings, [depth_block(0, 5)])
    field = {"code": "b", "count": 1000, "scale": 1, "unit": "", "meaning": ""}
    fields = [field | {"name": f"wide_{position}"} for position in range(1000)]
    topics = {"depth": {"meaning": "", "kind": "rows", "row_bytes": 8, "fields": fields}}
    execute(store, update(SessionRow).values(topics=json.dumps(topics)))
    assert sum(len(topic.columns) for topic in Listing(store).detail(number).topics) == COLUMNS_SHOWN


def test_a_full_session_takes_no_more_bookmarks(store: Store, settings: Settings) -> None:
    number = record(store, settings, [depth_block(0, 5)])
    mark = {"session_id": number, "text": "here", "made": 1.8e9, "time": STARTED_STEADY}
    add(store, BookmarkRow, *[mark] * SHOWN_MAX)
    clock = SimulatedClock(STARTED_STEADY)
    recorder = Recorder(store, clock, Notices(clock, lambda _: None), lambda: None)
    bookmarks = Bookmarks(store, clock, recorder)
    tries: list[Callable[[], Any]] = [
        lambda: bookmarks.add(number, 0.0, "one more"),
        lambda: bookmarks.add_once(number, STARTED_STEADY, "one more"),
    ]
    for attempt in tries:
        with pytest.raises(SessionStateError, match=f"has {SHOWN_MAX} bookmarks"):
            asyncio.run(attempt())


@pytest.mark.parametrize("start", [-1.0, 0.0, 59.0, 60.0, 60.5, 60.98, 61.0, 62.0])
@pytest.mark.parametrize("history", [None, 30.0])
def test_chunks_whose_times_are_not_those_of_their_samples_are_read(
    store: Store, settings: Settings, start: float, history: float | None
) -> None:
    number = record(store, settings, [depth_block(0, 50)])
    shift = {"first_time": col(Chunk.first_time) + 60, "last_time": col(Chunk.last_time) + 60}
    execute(store, update(Chunk).values(shift))
    begin = STARTED_STEADY + start
    blocks_between = read_blocks_between(Recording.open(store, number), begin, begin + 1, history)
    assert blocks_between.left_out == 0
