import pytest

from robot_runtime.clock import SimulatedClock
from server.http.sign_in.pairing_codes import CODES_MAX, PairingCodes, TooManyTriesError, WrongCodeError
from server.http.sign_in.tokens import CODE_ALPHABET, CODE_LENGTH, make_code, make_token

NEAR = "127.0.0.1"


@pytest.fixture
def clock() -> SimulatedClock:
    return SimulatedClock(1000.0)


@pytest.fixture
def codes(clock: SimulatedClock) -> PairingCodes:
    return PairingCodes(clock)


def try_wrong(codes: PairingCodes) -> None:
    with pytest.raises(WrongCodeError):
        codes.use("wrong", NEAR)


def test_a_code_works_once(codes: PairingCodes) -> None:
    code = codes.make("operator")
    assert codes.any_valid
    assert codes.use(code, NEAR) == "operator"
    assert not codes.any_valid
    with pytest.raises(WrongCodeError):
        codes.use(code, NEAR)


def test_a_code_may_be_typed_as_people_type(codes: PairingCodes) -> None:
    code = codes.make("viewer")
    assert codes.use(f" {code.lower().replace('-', ' ')} ", NEAR) == "viewer"


def test_each_code_has_its_own_role(codes: PairingCodes) -> None:
    viewer, operator = codes.make("viewer"), codes.make("operator")
    assert (codes.use(operator, NEAR), codes.use(viewer, NEAR)) == ("operator", "viewer")


def test_a_code_is_void_after_ten_minutes(codes: PairingCodes, clock: SimulatedClock) -> None:
    early, late = codes.make("operator"), codes.make("operator")
    clock.forward(599.9)
    assert codes.use(early, NEAR) == "operator"
    clock.forward(0.1)
    assert not codes.any_valid
    with pytest.raises(WrongCodeError):
        codes.use(late, NEAR)


def test_an_address_tries_once_a_second(codes: PairingCodes, clock: SimulatedClock) -> None:
    code = codes.make("operator")
    try_wrong(codes)
    clock.forward(0.5)
    for typed in (code, "wrong"):
        with pytest.raises(TooManyTriesError, match="1 s") as refused:
            codes.use(typed, NEAR)
        assert refused.value.headers == {"retry-after": "1"}
    clock.forward(0.5)
    assert codes.use(code, NEAR) == "operator"


def test_a_stranger_keeps_nobody_at_another_address_from_pairing(
    codes: PairingCodes, clock: SimulatedClock
) -> None:
    for _ in range(100):
        with pytest.raises(WrongCodeError):
            codes.use("wrong", "192.0.2.7")
        clock.forward(1.0)
    with pytest.raises(WrongCodeError):
        codes.use("wrong", "192.0.2.7")
    assert codes.use(codes.make("operator"), NEAR) == "operator"


def test_many_wrong_codes_within_a_minute_are_noticed(codes: PairingCodes, clock: SimulatedClock) -> None:
    seen = []
    for _ in range(3):
        try_wrong(codes)
        seen.append(codes.many_wrong)
        clock.forward(25.0)
    assert seen == [False, False, True]
    assert not codes.many_wrong


def test_valid_codes_do_not_count_as_attempts(codes: PairingCodes) -> None:
    for _ in range(11):
        codes.use(codes.make("viewer"), NEAR)


def test_the_oldest_code_is_dropped_for_a_new_one(codes: PairingCodes, clock: SimulatedClock) -> None:
    made = [codes.make("viewer") for _ in range(CODES_MAX + 1)]
    with pytest.raises(WrongCodeError):
        codes.use(made[0], NEAR)
    clock.forward(1.0)
    assert all(codes.use(code, NEAR) == "viewer" for code in made[1:])


def test_codes_are_not_stored_in_plain_text(codes: PairingCodes) -> None:
    code = codes.make("operator")
    assert code.replace("-", "") not in repr(vars(codes))


def test_codes_and_tokens_are_not_alike() -> None:
    made = {make_code() for _ in range(200)}
    assert len(made) == 200
    assert {len(code) for code in made} == {CODE_LENGTH + 1}
    assert set("".join(made)) == set(CODE_ALPHABET) | {"-"}
    tokens = {make_token("mucat_") for _ in range(200)}
    assert {len(token) for token in tokens} == {len("mucat_") + 43}
    assert len(tokens) == 200
