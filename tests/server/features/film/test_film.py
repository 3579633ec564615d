"""The film of a session over HTTP: recorded, described, played in parts, exported; refusals in words."""

import asyncio
import base64
import json
import re
import sys
import time
from dataclasses import replace
from io import BytesIO
from itertools import accumulate, pairwise
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import av
import cv2
import numpy as np
import pyarrow.parquet as pq
import pytest
from mcap.reader import make_reader
from sqlalchemy import update
from sqlmodel import col

from robot_runtime.clock import Clock, SimulatedClock
from robot_runtime.contract.film_picture import FilmPicture
from robot_runtime.contract.topics import BY_NAME
from robot_runtime.transport.blocks import Block
from robot_runtime.vision.film import JpegFilmCoder, open_coder
from server.features.exports import film_file
from server.features.exports.formats import check
from server.features.exports.schemas import ExportOptions
from server.features.exports.selection import ExportSelection
from server.features.film import choice, plug
from server.features.film.config import FilmConfig
from server.features.film.plug import LEASE_SECONDS
from server.library.content import Recording, RecordingError
from server.library.film import SPANS_SHOWN, describe_film, film_part
from server.library.retention import RetentionWorker
from server.platform.models import Chunk
from server.platform.notices import Notices
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.recorder import Recorder
from server.recording.session import find_row, new_row
from tests.film import HEIGHT, RATE, WIDTH, code_numbers, read_film, read_number
from tests.server.blocks import depth_block, film_block, state_block
from tests.server.serving import Served, serve
from tests.server.waiting import until

COUNT = 60
Pictures = list[tuple[float, bytes]]


def h264(start: float) -> Pictures:
    return code_numbers(open_coder(RATE, "medium", (WIDTH, HEIGHT)), range(COUNT), start)


async def record(served: Served, pictures: Pictures) -> int:
    """Record these pictures in a session of their own; return its number."""
    session: int = (await served.api.post("/sessions", json={"name": "Dive"})).json()["id"]
    served.runtime.publish(*(film_block(number, *picture) for number, picture in enumerate(pictures)))
    recorder = served.get(Recorder)

    async def arrived() -> bool:
        await recorder.flush()
        return recorder.session is not None and recorder.session.samples >= len(pictures)

    while not await arrived():
        pass
    await served.api.post(f"/sessions/{session}/stop")
    return session


def now(served: Served) -> float:
    return served.get(Clock).now()  # type: ignore[type-abstract]


async def test_a_film_is_described_and_every_picture_is_played_at_its_time(served: Served) -> None:
    start = now(served) + 1.0
    session = await record(served, h264(start))
    assert (await served.api.get(f"/sessions/{session}/timeline")).json()["filmed"]
    film = (await served.api.get(f"/sessions/{session}/film")).json()
    assert film["pictures"] == COUNT
    assert film["codec"].startswith("avc1.")
    (span,) = film["spans"]
    assert span["end"] - span["start"] == pytest.approx((COUNT - 1) / RATE)
    answer = await served.api.get(
        f"/sessions/{session}/film/part", params={"start": span["start"], "seconds": 30}
    )
    assert answer.headers["content-type"] == "video/mp4"
    assert float(answer.headers["film-start"]) == pytest.approx(span["start"], abs=1e-5)
    played = read_film(answer.content)
    assert [number for _, number in played] == list(range(COUNT))
    assert [time for time, _ in played] == pytest.approx([number / RATE for number in range(COUNT)], abs=1e-5)


async def test_a_part_begins_with_a_key_picture_and_ends_before_one(served: Served) -> None:
    session = await record(served, h264(now(served) + 1.0))
    (span,) = (await served.api.get(f"/sessions/{session}/film")).json()["spans"]
    answer = await served.api.get(
        f"/sessions/{session}/film/part", params={"start": span["start"] + 2.5, "seconds": 1}
    )
    assert float(answer.headers["film-start"]) == pytest.approx(span["start"] + 2.0, abs=0.07)
    numbers = [number for _, number in read_film(answer.content)]
    assert numbers == list(range(numbers[0], numbers[-1] + 1))
    assert numbers[0] == round((float(answer.headers["film-start"]) - span["start"]) * RATE)
    assert numbers[-1] == 4 * int(RATE) - 1, "it ends before a key picture"


async def test_after_a_hole_it_goes_on_with_a_picture_that_needs_none_before_it(
    store: Store, settings: Settings
) -> None:
    clock = SimulatedClock(100.0)
    recorder = Recorder(store, clock, Notices(clock, lambda _: None), lambda: None)
    session = await recorder.start(new_row(settings, clock, "holed", "", "null"))
    for number, picture in enumerate(h264(100.0)):
        if number not in range(20, 25):
            recorder.add(film_block(number, *picture))
    await recorder.stop(session.id)
    recording = Recording(store, find_row(store, session.id))
    assert len(list(recording.film())) == COUNT - 5
    _, part = film_part(recording, 100.0, 60.0)
    assert [number for _, number in read_film(part)] == [*range(20), *range(2 * int(RATE), COUNT)]


async def test_a_film_of_jpeg_files_is_played_too(served: Served) -> None:
    jpegs = code_numbers(JpegFilmCoder("high", (WIDTH, HEIGHT)), range(COUNT), now(served) + 1.0)
    session = await record(served, jpegs)
    film = (await served.api.get(f"/sessions/{session}/film")).json()
    assert film["codec"].startswith("avc1.")
    part = await served.api.get(
        f"/sessions/{session}/film/part", params={"start": film["spans"][0]["start"], "seconds": 30}
    )
    assert [number for _, number in read_film(part.content)] == list(range(COUNT))


async def test_pictures_of_one_time_are_played_one_after_the_other(served: Served) -> None:
    start = now(served) + 1.0
    session = await record(served, [(start, picture) for _, picture in h264(start)])
    (span,) = (await served.api.get(f"/sessions/{session}/film")).json()["spans"]
    part = await served.api.get(f"/sessions/{session}/film/part", params={"start": span["start"]})
    assert [number for _, number in read_film(part.content)] == list(range(COUNT))


async def test_a_pause_of_the_film_parts_its_times(served: Served) -> None:
    start = now(served) + 1.0
    first = h264(start)
    later = code_numbers(open_coder(RATE, "medium", (WIDTH, HEIGHT)), range(COUNT, 2 * COUNT), start + 60.0)
    session: int = (await served.api.post("/sessions", json={"name": "Dive"})).json()["id"]
    recorder = served.get(Recorder)
    for number, pictures in enumerate((first, later)):
        served.runtime.publish(
            *(film_block(COUNT * number + index, *picture) for index, picture in enumerate(pictures))
        )
        while recorder.session is None or recorder.session.samples < COUNT * (number + 1):
            await recorder.flush()
    await served.api.post(f"/sessions/{session}/stop")
    spans = (await served.api.get(f"/sessions/{session}/film")).json()["spans"]
    assert [span["end"] - span["start"] for span in spans] == pytest.approx([(COUNT - 1) / RATE] * 2)


async def test_of_very_many_pauses_the_longest_are_told(store: Store, settings: Settings) -> None:
    pauses = [3.0 + number % 2 * 7.0 for number in range(2 * SPANS_SHOWN - 10)]
    starts = list(accumulate(pauses, initial=100.0))
    key = code_numbers(open_coder(RATE, "low", (WIDTH, HEIGHT)), range(1), 0.0)[0][1]
    clock = SimulatedClock(100.0)
    recorder = Recorder(store, clock, Notices(clock, lambda _: None), lambda: None)
    session = await recorder.start(new_row(settings, clock, "paused", "", "null"))
    for number, start in enumerate(starts):
        recorder.add(film_block(number, start, key))
        await recorder.flush()
    await recorder.stop(session.id)
    spans = describe_film(Recording.open(store, session.id)).spans
    assert len(spans) == (len(pauses) // 2) + 1
    assert all(later.start - earlier.end == pytest.approx(10.0) for earlier, later in pairwise(spans))


async def ask(served: Served, session: int) -> list[tuple[int, str]]:
    """Return status and text of the answers for its description and a part."""
    answers = [
        await served.api.get(f"/sessions/{session}/film"),
        await served.api.get(f"/sessions/{session}/film/part", params={"start": 0}),
    ]
    return [(answer.status_code, answer.json()["detail"]) for answer in answers]


async def test_a_session_without_a_film_says_so(served: Served) -> None:
    session: int = (await served.api.post("/sessions", json={"name": "Dive"})).json()["id"]
    served.runtime.publish(depth_block(0, 10, start=now(served)))
    assert [status for status, _ in await ask(served, session)] == [404, 404]
    assert all("was not filmed there" in text for _, text in await ask(served, session))


async def test_without_pyav_it_says_what_to_install(served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    session = await record(served, code_numbers(JpegFilmCoder("low", (WIDTH, HEIGHT)), range(5), now(served)))
    monkeypatch.setitem(sys.modules, "av", None)
    assert [status for status, _ in await ask(served, session)] == [503, 503]
    assert all("pip install av" in text for _, text in await ask(served, session))


@pytest.mark.parametrize("junk", [b"\0\0\1\x65" + bytes(50), b"\xff\xd8 no picture", b"\0"])
async def test_a_damaged_film_is_refused_in_words(served: Served, junk: bytes) -> None:
    start = now(served) + 1.0
    session = await record(served, [(start + number / RATE, junk) for number in range(5)])
    for status, text in await ask(served, session):
        assert status in (404, 500)
        assert "not filmed there" in text or "cannot be read whole" in text


async def test_a_film_of_another_version_is_refused_in_words_and_the_rest_is_read(
    served: Served, tmp_path: Path
) -> None:
    session = await dive_filmed(served)
    later = update(Chunk).where(col(Chunk.topic) == "film").values(encoding="film-2")
    await served.get(Store).write(lambda connection: connection.execute(later))
    sentence = "film is of another version: it is encoded as 'film-2'.* Update µ-CAT on this computer"
    assert all(status == 500 and re.search(sentence, text) for status, text in await ask(served, session))
    with pytest.raises(RecordingError, match=sentence):
        await asyncio.to_thread(export, served, session, tmp_path, format="mp4")
    tables = await asyncio.to_thread(export, served, session, tmp_path, format="csv", topics=["depth"])
    with ZipFile(BytesIO(tables)) as archive:
        assert len(archive.read("depth.csv").splitlines()) == 401


async def test_a_film_that_is_cut_off_plays_to_its_end(served: Served) -> None:
    pictures = h264(now(served) + 1.0)
    session = await record(served, [*pictures[:40], (pictures[40][0], pictures[40][1][:9])])
    (span,) = (await served.api.get(f"/sessions/{session}/film")).json()["spans"]
    part = await served.api.get(
        f"/sessions/{session}/film/part", params={"start": span["start"], "seconds": 30}
    )
    assert [number for _, number in read_film(part.content)][:40] == list(range(40))


async def test_a_film_is_asked_for_while_a_session_is_recorded(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(plug, "RENEWAL_SECONDS", 0.02)
    async with serve(settings.with_section(FilmConfig(record=True, rate=10.0, quality="low"))) as served:
        filmed = served.runtime.filmed
        assert filmed == []
        session: int = (await served.api.post("/sessions", json={"name": "Dive"})).json()["id"]
        await until(lambda: len(filmed) >= 3, "the film to be asked for again and again")
        assert filmed[0] == {"seconds": LEASE_SECONDS, "rate": 10.0, "quality": "low"}
        assert filmed[-1] == filmed[0]
        await served.api.post(f"/sessions/{session}/stop")
        await until(lambda: filmed[-1]["seconds"] == 0.0, "the film to be ended")


async def test_a_runtime_that_starts_is_asked_again_at_once(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(plug, "RENEWAL_SECONDS", 1000.0)
    async with serve(settings.with_section(FilmConfig(record=True))) as served:
        filmed = served.runtime.filmed
        served.runtime.refusal = "It starts."
        await served.api.post("/sessions", json={"name": "Dive"})
        await until(lambda: filmed != [], "a refusal")
        served.runtime.refusal = None
        await until(lambda: len(filmed) > 1, "another try")
        before = len(filmed)
        served.runtime.publish(state_block(0))
        await until(lambda: len(filmed) > before, "the run that speaks to be told")


async def test_no_film_is_asked_for_where_robot_toml_does_not_say_so(served: Served) -> None:
    session: int = (await served.api.post("/sessions", json={"name": "Dive"})).json()["id"]
    await served.api.post(f"/sessions/{session}/stop")
    assert served.runtime.filmed == []


async def test_the_choice_is_shown_with_its_space_and_holds_from_now_on(settings: Settings) -> None:
    order = {"record": True, "rate": 5.0, "quality": "high"}
    async with serve(settings) as served:
        plan = (await served.api.get("/film")).json()
        assert (plan["record"], plan["rate"], plan["quality"]) == (False, 15.0, "medium")
        assert plan["coding"] == "h264"
        assert not plan["measured"]
        assert plan["picture_bytes"]["low"] < plan["picture_bytes"]["medium"] < plan["picture_bytes"]["high"]
        await served.api.post("/sessions", json={"name": "Dive"})
        for wrong in ({"rate": 1.0}, {"quality": "best"}, {"record": "yes"}, {"more": 1}):
            assert (await served.api.put("/film", json=order | wrong)).status_code == 422
        assert (await served.api.put("/film", json=order)).status_code == 204
        await until(lambda: bool(served.runtime.filmed), "the film to be asked for")
        assert served.runtime.filmed[-1] == {"seconds": LEASE_SECONDS, "rate": 5.0, "quality": "high"}
        assert (await served.api.put("/film", json=order | {"record": False})).status_code == 204
        await until(lambda: served.runtime.filmed[-1]["seconds"] == 0.0, "the film to be ended")
        assert (await served.api.put("/film", json=order)).status_code == 204
    async with serve(settings) as served:
        plan = (await served.api.get("/film")).json()
        assert (plan["record"], plan["rate"], plan["quality"]) == (True, 5.0, "high")


async def test_the_space_is_that_of_this_robots_own_films(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(choice, "PICTURES_MEASURED", COUNT)
    pictures = h264(100.0)
    async with serve(settings.with_section(FilmConfig(record=True, quality="medium"))) as served:
        usual = (await served.api.get("/film")).json()["picture_bytes"]
        await record(served, pictures)
        await until(lambda: served.get(choice.FilmChoice).is_measured, "the size to be stored")
        plan = (await served.api.get("/film")).json()
    size = sum(len(picture) for _, picture in pictures) / COUNT
    assert plan["measured"]
    assert plan["picture_bytes"]["medium"] == pytest.approx(size)
    assert plan["picture_bytes"]["high"] == pytest.approx(size * usual["high"] / usual["medium"])


async def test_in_the_lean_profile_nothing_is_filmed_and_it_says_why(settings: Settings) -> None:
    lean = replace(settings, robot=replace(settings.robot, profile="lean")).with_section(
        FilmConfig(record=True)
    )
    async with serve(lean) as served:
        plan = (await served.api.get("/film")).json()
        assert not plan["record"]
        assert "lean profile" in plan["refusal"]


async def test_a_damaged_choice_falls_back_to_that_of_robot_toml(settings: Settings) -> None:
    settings.data.film.parent.mkdir(parents=True, exist_ok=True)
    settings.data.film.write_text('{"choice": {"record": "perhaps"}}')
    async with serve(settings) as served:
        assert not (await served.api.get("/film")).json()["record"]


async def test_pages_and_their_history_are_not_sent_the_film(served: Served) -> None:
    async with served.connect() as socket:
        await socket.recv()
        served.runtime.publish(*(film_block(number, *picture) for number, picture in enumerate(h264(100.0))))
        served.runtime.publish(depth_block(0, 1, start=now(served)))
        names: set[str] = set()
        while "depth" not in names:
            message: Any = await socket.recv()
            names |= topics_of(message)
    assert "film" not in names


def topics_of(message: str | bytes) -> set[str]:
    from robot_runtime.transport.blocks import read_blocks

    blocks: list[Block] = [] if isinstance(message, str) else read_blocks(message)
    return {block.topic.name for block in blocks if block.topic.name in BY_NAME}


@pytest.fixture
async def filmed(served: Served) -> tuple[int, float]:
    """Return a session with a film, and the time of its first picture (s since the session's start)."""
    session = await record(served, h264(now(served) + 1.0))
    start = (await served.api.get(f"/sessions/{session}/film")).json()["spans"][0]["start"]
    return session, start


def export(served: Served, session: int, tmp_path: Path, **options: Any) -> bytes:
    """Return what an export of these options writes."""
    path = tmp_path / "export"
    store = served.get(Store)
    chosen = ExportOptions(**options)
    with path.open("wb") as file:
        source = ExportSelection(store, find_row(store, session), chosen)
        check(chosen).write_unpurged(store, source, file)
    return path.read_bytes()


async def test_the_film_is_exported_as_an_mp4_file(
    served: Served, filmed: tuple[int, float], tmp_path: Path
) -> None:
    whole = await asyncio.to_thread(export, served, filmed[0], tmp_path, format="mp4")
    assert whole == await asyncio.to_thread(export, served, filmed[0], tmp_path, format="mp4")
    assert [number for _, number in read_film(whole)] == list(range(COUNT))


async def dive_filmed(served: Served) -> int:
    """Record a film and the depth samples of the same time, 0.5 m to 0.8 m; return the session's number."""
    start = now(served) + 1.0
    served_depths = depth_block(0, 400, start=start)
    session: int = (await served.api.post("/sessions", json={"name": "Dive"})).json()["id"]
    served.runtime.publish(served_depths, state_block(0, time=start, armed=True, mode="automatic"))
    pictures = h264(start)
    served.runtime.publish(*(film_block(number, *picture) for number, picture in enumerate(pictures)))
    recorder = served.get(Recorder)
    while recorder.session is None or recorder.session.samples < COUNT + 401:
        await recorder.flush()
    await served.api.post(f"/sessions/{session}/stop")
    return session


def texts_of(mp4: bytes) -> list[tuple[float, str]]:
    """Return the times (s) and the texts of an MP4 file's subtitles."""
    with av.open(BytesIO(mp4), "r") as file:
        return [
            (float(packet.pts * packet.time_base), bytes(packet)[2:].decode())
            for packet in file.demux(subtitles=0)
            if packet.pts is not None and packet.size > 2 and packet.time_base
        ]


async def test_subtitles_say_the_values_of_their_moment(served: Served, tmp_path: Path) -> None:
    session = await dive_filmed(served)
    mp4 = await asyncio.to_thread(export, served, session, tmp_path, format="mp4", overlay="subtitles")
    assert [number for _, number in read_film(mp4)] == list(range(COUNT))
    texts = texts_of(mp4)
    assert len(texts) == pytest.approx(COUNT / RATE / 0.5, abs=1)
    recording = Recording.open(served.get(Store), session)
    times, columns = recording.columns("depth", ["depth"])
    first = next(iter(recording.film()))[0]
    for moment, text in texts:
        depth = columns["depth"][int(np.searchsorted(times, first + moment + 1e-6, "right")) - 1]
        assert f"{depth:z.2f} m" in text
        assert "ARMED  automatic" in text


async def test_lines_are_drawn_into_every_picture(served: Served, tmp_path: Path) -> None:
    session = await dive_filmed(served)
    plain = await asyncio.to_thread(export, served, session, tmp_path, format="mp4")
    drawn = await asyncio.to_thread(export, served, session, tmp_path, format="mp4", overlay="lines")
    assert [time for time, _ in read_film(drawn)] == pytest.approx(
        [time for time, _ in read_film(plain)], abs=1e-5
    )
    with av.open(BytesIO(plain), "r") as before, av.open(BytesIO(drawn), "r") as after:
        for clean, lined in zip(before.decode(video=0), after.decode(video=0), strict=True):
            apart = np.abs(clean.to_ndarray(format="gray").astype(int) - lined.to_ndarray(format="gray"))
            # The tape of the depth and its value stand on the right.
            assert apart[:, WIDTH * 3 // 4 :].max() > 40


async def test_small_pictures_of_a_session_that_has_none_are_made_of_its_film(
    served: Served, filmed: tuple[int, float]
) -> None:
    session, start = filmed
    for since, number in ((-1.0, 0), (0.0, 0), (2.5, 2 * int(RATE)), (60.0, None)):
        answer = await served.api.get(f"/sessions/{session}/thumbnail", params={"time": start + since})
        if number is None:
            assert answer.status_code == 404
            continue
        assert answer.headers["content-type"] == "image/jpeg"
        picture = cv2.imdecode(np.frombuffer(answer.content, np.uint8), cv2.IMREAD_COLOR)
        assert picture is not None
        assert picture.shape == (120, 160, 3)
        assert read_number(cv2.resize(picture, (WIDTH, HEIGHT)).astype(np.uint8)) == number


async def test_values_go_over_a_film_alone(served: Served, filmed: tuple[int, float]) -> None:
    body = {"session": filmed[0], "format": "csv", "overlay": "lines"}
    refused = await served.api.post("/exports", json=body)
    assert (refused.status_code, refused.json()["detail"]) == (
        422,
        "Subtitles and lines are chosen for mp4 alone.",
    )


async def test_without_opencv_lines_are_refused_in_words(
    served: Served, filmed: tuple[int, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(film_file, "find_spec", lambda name: None if name == "cv2" else name)
    body = {"session": filmed[0], "format": "mp4", "overlay": "lines"}
    refused = await served.api.post("/exports", json=body)
    assert refused.status_code == 422
    assert "cv2 is not installed" in refused.json()["detail"]


async def test_tables_have_the_film_beside_them(
    served: Served, filmed: tuple[int, float], tmp_path: Path
) -> None:
    data = await asyncio.to_thread(export, served, filmed[0], tmp_path, format="csv")
    with ZipFile(BytesIO(data)) as archive:
        assert [number for _, number in read_film(archive.read("film.mp4"))] == list(range(COUNT))
    table = await asyncio.to_thread(export, served, filmed[0], tmp_path, format="parquet")
    with ZipFile(BytesIO(table)) as archive:
        rows = pq.read_table(BytesIO(archive.read("film.parquet")))
    assert rows.num_rows == COUNT
    assert FilmPicture(rows["picture"][0].as_py()).is_key


async def test_mcap_has_the_film_as_video(served: Served, filmed: tuple[int, float], tmp_path: Path) -> None:
    session, start = filmed
    data = await asyncio.to_thread(export, served, session, tmp_path, format="mcap")
    messages = [
        (schema.name if schema else "", message.log_time, json.loads(message.data))
        for schema, channel, message in make_reader(BytesIO(data)).iter_messages(topics=["/film"])
    ]
    assert {name for name, _, _ in messages} == {"foxglove.CompressedVideo"}
    row = find_row(served.get(Store), session)
    times = [log_time / 1e9 - row.started - start for _, log_time, _ in messages]
    assert times == pytest.approx([number / RATE for number in range(COUNT)], abs=1e-4)
    decoder = av.CodecContext.create("h264", "r")
    assert isinstance(decoder, av.VideoCodecContext)
    frames = [
        frame
        for _, _, message in messages
        for frame in decoder.decode(av.Packet(base64.b64decode(message["data"])))
    ]
    numbers = [read_number(frame.to_ndarray(format="bgr24").astype(np.uint8)) for frame in frames]
    assert numbers == list(range(len(numbers)))
    assert len(numbers) >= COUNT - 1


async def test_an_archive_brings_the_film_to_another_computer(
    served: Served, filmed: tuple[int, float], tmp_path: Path
) -> None:
    session, start = filmed
    archive = await asyncio.to_thread(export, served, session, tmp_path, format="archive")
    await served.api.delete(f"/sessions/{session}")
    await served.api.post(f"/sessions/{session}/purge")
    retention = served.get(RetentionWorker)
    await retention.apply(time.time())
    answer = await served.api.post("/imports", content=archive)
    assert answer.status_code == 201, answer.text
    imported = answer.json()["id"]
    part = await served.api.get(f"/sessions/{imported}/film/part", params={"start": start, "seconds": 30})
    assert [number for _, number in read_film(part.content)] == list(range(COUNT))


async def test_the_film_is_no_block_of_a_replay(served: Served, filmed: tuple[int, float]) -> None:
    session, start = filmed
    answer = await served.api.get(f"/sessions/{session}/blocks", params={"start": start, "end": start + 5.0})
    assert answer.status_code == 200
    assert "film" not in topics_of(answer.content)
