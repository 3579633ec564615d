"""Services are made once, of what the types of their makers name."""

import pytest

from server.services import Services, UnknownServiceError


class Clockwork:
    def __init__(self) -> None:
        self.turns = 0


class Bell:
    def __init__(self, clockwork: Clockwork, loudness: float = 0.5) -> None:
        self.clockwork = clockwork
        self.loudness = loudness


class Tower:
    def __init__(self, height: float) -> None:
        self.height = height


class Chicken:
    def __init__(self, egg: "Egg") -> None:
        self.egg = egg


class Egg:
    def __init__(self, chicken: Chicken) -> None:
        self.chicken = chicken


def test_a_service_is_made_once_of_others_by_their_types() -> None:
    services = Services()
    bell = services.get(Bell)
    assert bell.clockwork is services.get(Clockwork)
    assert bell.loudness == 0.5
    assert services.get(Bell) is bell


def test_what_is_there_already_is_taken() -> None:
    services, clockwork = Services(), Clockwork()
    services.add(Clockwork, clockwork)
    assert services.get(Bell).clockwork is clockwork


def test_a_function_makes_what_no_class_can_make_itself() -> None:
    def build(clockwork: Clockwork) -> Tower:
        clockwork.turns += 1
        return Tower(30.0)

    services = Services()
    services.offer(build)
    assert services.get(Tower).height == 30.0
    assert services.get(Tower) is services.get(Tower)
    assert services.get(Clockwork).turns == 1


def test_what_cannot_be_made_is_named_with_who_asked() -> None:
    with pytest.raises(UnknownServiceError, match="Tower asks for height, which is no service"):
        Services().get(Tower)
    with pytest.raises(UnknownServiceError, match=r"Chicken needs itself \(made: Egg for Chicken\)"):
        Services().get(Chicken)
