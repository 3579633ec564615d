"""The link driver, which several threads use."""

from collections.abc import Callable

import pytest

from robot_runtime.clock import SimulatedClock
from robot_runtime.link.link_driver import LinkDriver
from robot_runtime.link.session import LinkSession


@pytest.mark.parametrize(
    ("look", "use"),
    [("due", LinkDriver.wait), ("statistics", LinkDriver.statistics), ("poll", LinkDriver.poll)],
)
def test_nobody_sends_while_the_messages_under_way_are_looked_at(
    look: str, use: Callable[[LinkDriver], object], monkeypatch: pytest.MonkeyPatch
) -> None:
    driver = LinkDriver("none", 250_000, SimulatedClock(), 1, lambda _: None, lambda: None)
    original = getattr(LinkSession, look)
    may_send: list[bool] = []

    def watched(*arguments: object) -> object:
        may_send.append(not driver._writing.locked())
        return original(*arguments)

    monkeypatch.setattr(LinkSession, look, watched)
    use(driver)
    assert may_send == [False]
