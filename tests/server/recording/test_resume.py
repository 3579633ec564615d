"""Resuming the session of a killed server: a second recorder follows the first."""

import json
from dataclasses import replace

import pytest
from sqlalchemy import update

import robot_runtime.transport.replay_cache as cache_module
from robot_runtime.contract.packets.layout import Record
from robot_runtime.contract.topics import BY_NAME, SENT_BY
from robot_runtime.transport.blocks import NUMBERS, Block, row
from robot_runtime.transport.replay_cache import BacklogReply, ReplayCache, write_question
from server.library.bookmarks import Bookmarks
from server.library.catalogue import Catalogue
from server.platform.models import Chunk, SessionRow
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.resume import MissingSamples, find_missing
from tests.server.blocks import debug_block, depth_block
from tests.server.recording.recorder_rig import RecorderRig


def truth_block(first: int, count: int, start: float = 100.0) -> Block:
    topic = BY_NAME["truth"]
    assert issubclass(topic.record, Record)
    rows = [
        row(start + 0.05 * position, bytes(topic.record.layout.size))
        for position in range(first, first + count)
    ]
    return Block.of(topic, count, first, b"".join(rows))


def parameters_block(number: int, time: float = 40.0) -> Block:
    payload = json.dumps([{"time": time, "parameters": []}]).encode()
    return Block.of(BY_NAME["parameters"], 1, number, payload)


class Wreck:
    """A recorder that stops without an end, and processes that go on sending."""

    def __init__(self, store: Store, settings: Settings) -> None:
        self.before = RecorderRig(store, settings)
        self.after = RecorderRig(store, settings)
        self.runs = {name: f"{name} run" for name in SENT_BY}
        self.caches = {name: ReplayCache(run, self.before.clock) for name, run in self.runs.items()}
        self.following = {name: dict.fromkeys(BY_NAME, 0) for name in SENT_BY}
        self.session = 0

    def send(self, *blocks: Block, heard: bool = True) -> None:
        """Send blocks, into the replay cache too."""
        for block in blocks:
            name = "simulator" if block.topic.name == "truth" else "runtime"
            self.following[name][block.topic.name] = block.following
            self.caches[name].add(block.data, self.following[name])
            if heard:
                self.before.recorder.add(replace(block, run=self.runs[name]))

    def restart(self, name: str) -> None:
        self.runs[name] = f"another {name} run"
        self.caches[name] = ReplayCache(self.runs[name], self.before.clock)
        self.following[name] = dict.fromkeys(BY_NAME, 0)

    def answers(self) -> dict[str, BacklogReply]:
        question = write_question(dict.fromkeys(BY_NAME, 0))
        return {name: BacklogReply.from_bytes(cache.answer(question)) for name, cache in self.caches.items()}

    async def start(self, first: int = 0) -> None:
        """Record for a while; some samples are stored, some later ones are not."""
        self.session = await self.before.start("dive")
        self.send(depth_block(first % NUMBERS, 5), debug_block(0, "a"), truth_block(0, 3))
        await self.before.recorder.flush()
        self.send(depth_block((first + 5) % NUMBERS, 5), truth_block(3, 3))
        self.before.clock.forward(3)
        self.after.clock.forward(3)
        await self.before.recorder.flush()
        self.send(depth_block((first + 10) % NUMBERS, 5))
        self.send(depth_block((first + 15) % NUMBERS, 5), debug_block(1, "b"), truth_block(6, 3), heard=False)

    async def resume(self) -> dict[str, MissingSamples]:
        """Start the next server."""
        remaining = await self.after.recorder.recover()
        assert remaining is not None
        answers = self.answers()
        missing = {name: find_missing(remaining, SENT_BY[name], stored) for name, stored in answers.items()}
        await self.after.recorder.resume(remaining, missing)
        for saved in answers.values():
            for block in saved.blocks:
                self.after.recorder.add(block)
        self.after.recorder.caught_up()
        return missing

    @property
    def state(self) -> str:
        (session,) = Catalogue(self.after.store).page().sessions
        return session.state


@pytest.fixture
def wreck(store: Store, settings: Settings) -> Wreck:
    return Wreck(store, settings)


@pytest.mark.parametrize("first", [0, 1000, NUMBERS - 12])
async def test_a_resumed_session_has_no_gap_and_no_duplicate(wreck: Wreck, first: int) -> None:
    await wreck.start(first)
    missing = await wreck.resume()
    assert all(part.same_run and part.whole for part in missing.values())
    session = wreck.after.recorder.session
    assert session is not None
    assert (session.id, session.samples, session.duration) == (wreck.session, 17, 3.0)
    wreck.after.recorder.add(replace(depth_block((first + 20) % NUMBERS, 5), run=wreck.runs["runtime"]))
    wreck.after.clock.forward(2)
    done = await wreck.after.recorder.stop(wreck.session)
    assert (done.state, done.duration, done.samples) == ("complete", 5.0, 25 + 2 + 9)
    assert wreck.after.numbers() == [(first + position) % NUMBERS for position in range(25)]
    assert wreck.after.numbers("debug") == [0, 1]
    assert wreck.after.numbers("truth") == list(range(9))
    assert wreck.after.gaps() == []
    assert [chunk.number for chunk in wreck.after.chunks()] == [0, 1, 2]
    assert wreck.after.notice_texts[0].startswith("The server was killed. Recording of “dive” continues")


async def test_a_resumed_session_shows_its_tags_and_bookmarks(wreck: Wreck) -> None:
    await wreck.start()
    before = wreck.before
    await Catalogue(before.store, before.recorder).change(wreck.session, tags=["pool", "Fins"])
    await Bookmarks(before.store, before.clock, before.recorder).add(wreck.session, None, "here")
    await wreck.resume()
    session = wreck.after.recorder.session
    assert session is not None
    assert (session.tags, session.markers) == (["Fins", "pool"], 1)


async def test_parameters_sent_before_the_session_do_not_prevent_resuming(wreck: Wreck) -> None:
    wreck.send(parameters_block(7))
    wreck.before.clock.forward(3)
    wreck.after.clock.forward(3)
    await wreck.start()
    missing = await wreck.resume()
    assert all(part.same_run and part.whole for part in missing.values())
    assert wreck.state == "recording"


async def test_a_session_without_stored_samples_resumes_only_with_its_own_runtime(wreck: Wreck) -> None:
    await wreck.before.start("dive")
    wreck.send(depth_block(0, 5), truth_block(0, 3))
    remaining = await wreck.after.recorder.recover()
    assert remaining is not None
    answers = wreck.answers()
    for state, same in (
        ({"run": answers["runtime"].run}, True),
        ({"run": "another"}, False),
        (None, False),
    ):
        remaining.row.robot_state = json.dumps(state)
        assert find_missing(remaining, SENT_BY["runtime"], answers["runtime"]).same_run is same
    assert find_missing(remaining, SENT_BY["simulator"], answers["simulator"]).same_run


async def test_notices_are_numbered_on(wreck: Wreck) -> None:
    wreck.before.record_notices()
    wreck.after.record_notices()
    await wreck.start()
    await wreck.resume()
    await wreck.after.recorder.stop(wreck.session)
    assert wreck.after.numbers("notice") == [0, 1]
    assert wreck.after.gaps() == []


async def test_samples_older_than_the_session_are_not_recorded(wreck: Wreck) -> None:
    # Board time 50 s is the session's start.
    wreck.send(debug_block(0, "before", start=40.0), heard=False)
    wreck.session = await wreck.before.start("dive")
    wreck.send(depth_block(0, 5))
    await wreck.before.recorder.flush()
    wreck.send(debug_block(1, "since"), heard=False)
    await wreck.resume()
    await wreck.after.recorder.stop(wreck.session)
    assert wreck.after.numbers("debug") == [1]
    assert wreck.after.gaps() == []


async def test_a_session_resumes_after_an_earlier_restart_though_some_topics_sent_nothing_since(
    wreck: Wreck,
) -> None:
    await wreck.start()
    wreck.send(debug_block(2, "d"))
    # The killed server has recorded the new runtime, but nothing yet of its debug lines.
    wreck.restart("runtime")
    wreck.send(depth_block(0, 5))
    await wreck.before.recorder.flush()
    wreck.send(depth_block(5, 5), debug_block(0, "c"), heard=False)
    missing = await wreck.resume()
    assert missing["runtime"].same_run
    assert missing["runtime"].whole
    done = await wreck.after.recorder.stop(wreck.session)
    assert done.state == "complete"
    # The received samples of the old runtime, and all samples of the new one.
    assert wreck.after.numbers() == [*range(15), *range(10)]
    assert wreck.after.numbers("debug") == [0, 2, 0]


async def test_a_session_resumes_though_no_parameters_were_sent_since(wreck: Wreck) -> None:
    wreck.send(parameters_block(7))
    await wreck.start()
    wreck.restart("runtime")
    wreck.send(depth_block(0, 5))
    await wreck.before.recorder.flush()
    wreck.send(parameters_block(0, time=200.0), heard=False)
    missing = await wreck.resume()
    assert missing["runtime"].same_run
    assert missing["runtime"].whole
    assert missing["runtime"].sent["parameters"] == 1
    await wreck.after.recorder.stop(wreck.session)
    assert wreck.after.numbers("parameters") == [7, 0]


async def test_a_later_restart_is_recorded_from_its_first_number(wreck: Wreck) -> None:
    wreck.session = await wreck.before.start("dive")
    wreck.send(depth_block(0, 5), debug_block(0, "a"), debug_block(1, "b"))
    await wreck.before.recorder.flush()
    await wreck.resume()
    # Neither topic has sent anything since the server was killed.
    wreck.after.recorder.add(debug_block(0, "anew"))
    wreck.after.recorder.add(depth_block(0, 3))
    await wreck.after.recorder.stop(wreck.session)
    assert wreck.after.numbers("debug") == [0, 1, 0]
    assert wreck.after.numbers() == [*range(5), *range(3)]
    assert sorted(wreck.after.gaps()) == [("debug", "restarted", 0), ("depth", "restarted", 0)]


async def test_another_run_of_the_runtime_is_another_recording(wreck: Wreck) -> None:
    await wreck.start()
    wreck.restart("runtime")
    # Its numbers are beyond the recorded ones.
    wreck.send(*(depth_block(5 * position, 5, start=200.0) for position in range(9)), heard=False)
    missing = await wreck.resume()
    assert not missing["runtime"].same_run
    assert (wreck.state, wreck.after.recorder.session) == ("interrupted", None)
    assert wreck.after.numbers() == list(range(10))
    assert "The server was killed while “dive” was recorded" in wreck.after.notice_texts[0]


async def test_another_run_that_has_sent_the_same_samples_is_another_recording(wreck: Wreck) -> None:
    await wreck.start()
    wreck.restart("runtime")
    # Numbers and times equal the stored ones: only the name of the run differs.
    wreck.send(depth_block(0, 5), depth_block(5, 5), depth_block(10, 5), heard=False)
    missing = await wreck.resume()
    assert not missing["runtime"].same_run
    assert wreck.state == "interrupted"


async def test_a_session_of_a_version_that_did_not_store_runs_ends(wreck: Wreck) -> None:
    await wreck.start()
    await wreck.before.store.write(lambda connection: connection.execute(update(Chunk).values(run="")))
    assert not (await wreck.resume())["runtime"].same_run
    assert wreck.state == "interrupted"
    assert wreck.after.numbers() == list(range(10))


async def test_a_new_run_whose_number_happens_to_follow_is_stored_apart(wreck: Wreck) -> None:
    wreck.session = await wreck.before.start("dive")
    wreck.send(depth_block(0, 5))
    wreck.restart("runtime")
    wreck.send(depth_block(5, 5))
    await wreck.before.recorder.flush()
    assert [(chunk.first, chunk.count, chunk.run) for chunk in wreck.before.chunks()] == [
        (0, 5, "runtime run"),
        (5, 5, "another runtime run"),
    ]


async def test_samples_beyond_the_replay_cache_end_the_session(
    wreck: Wreck, monkeypatch: pytest.MonkeyPatch
) -> None:
    await wreck.start()
    monkeypatch.setattr(cache_module, "BYTES_MAX", 10)
    wreck.send(depth_block(20, 5), heard=False)
    assert not (await wreck.resume())["runtime"].whole
    assert wreck.state == "interrupted"
    missed = [("depth", "missed", 15), ("debug", "missed", 1), ("truth", "missed", 3)]
    assert sorted(wreck.after.gaps()) == sorted(missed)
    assert "19 samples sent since are lost" in wreck.after.notice_texts[0]


async def test_without_an_answer_of_the_runtime_the_session_ends(wreck: Wreck) -> None:
    await wreck.start()
    del wreck.caches["runtime"]
    await wreck.resume()
    assert wreck.state == "interrupted"


async def test_a_restarted_simulator_is_recorded_as_a_gap(wreck: Wreck) -> None:
    await wreck.start()
    wreck.restart("simulator")
    wreck.send(truth_block(0, 20, start=200.0), heard=False)
    await wreck.resume()
    await wreck.after.recorder.stop(wreck.session)
    assert wreck.after.numbers("truth") == [*range(6), *range(20)]
    assert wreck.after.gaps() == [("truth", "restarted", 0)]
    assert wreck.after.numbers() == list(range(20))


@pytest.mark.parametrize(
    "change",
    [{"boot": "another"}, {"boot": ""}, {"origin": "simulated"}],
)
async def test_sessions_of_an_earlier_boot_and_simulated_runs_are_not_resumed(
    wreck: Wreck, change: dict[str, str]
) -> None:
    await wreck.start()
    await wreck.before.store.write(
        lambda connection: connection.execute(update(SessionRow).values(**change)) and None
    )
    assert await wreck.after.recorder.recover() is None
    assert wreck.state == "interrupted"
