from pathlib import Path

import pytest

from tests.checks.topics import find_compared_names


def check(root: Path, text: str, path: str = "server/stream/hub.py") -> list[str]:
    """Return the problems of a tree with this one file."""
    file = root / path
    file.parent.mkdir(parents=True)
    file.write_text(text)
    return find_compared_names(root)


@pytest.mark.parametrize(
    "text",
    [
        'if block.topic.name == "depth": ...',
        'if "depth" != block.topic.name: ...',
        'if chosen["topic"] == "depth": ...',
        'if own_topic in ("imu", "depth"): ...',
        'if "depth" not in recording.topics: ...',
        'if topics & {"depth"}: ...',
        'if sample.source == "depth": ...',
        'match block.topic.name:\n    case "imu" | "depth": ...',
        'topic = BY_NAME["depth"]',
        'described = recording.topics["depth"]',
        'described = recording.topics.get("depth")',
        'title = {"depth": "Depth"}.get(topic, "")',
        'title = {"depth": "Depth"}[block.topic.name]',
        'def see(block):\n    name = block.topic.name\n    return name == "depth"',
    ],
)
def test_a_topic_that_is_compared_with_a_name_is_found(tmp_path: Path, text: str) -> None:
    problems = check(tmp_path, text)
    assert problems
    assert any(
        problem.startswith("server/stream/hub.py:") and "use topics.DEPTH" in problem for problem in problems
    )


@pytest.mark.parametrize(
    "text",
    [
        "if block.topic is DEPTH: ...",
        "if DEPTH.name in recording.topics: ...",
        'if loop.name == "depth": ...',
        'if document["depth"] > 1: ...',
        'values = {"depth": topic.name}',
        'if topic.kind == "rows": ...',
        'if topic.name == "no topic": ...',
        'query = f"/{topic.name}" + "depth"',
        'def see(loop):\n    name = loop.name\n    return name == "depth"',
    ],
)
def test_fields_and_words_are_not(tmp_path: Path, text: str) -> None:
    assert check(tmp_path, text) == []


def test_the_contract_may_name_its_topics(tmp_path: Path) -> None:
    assert check(tmp_path, 'if topic.name == "depth": ...', "robot_runtime/contract/topics.py") == []
