import pytest

from robot_runtime.clock import SimulatedClock
from server.http.sign_in.pairing_codes import CODES_MAX, PairingCodes, TooManyTriesError, WrongCodeError
from server.http.sign_in.tokens import CODE_ALPHABET, CODE_LENGTH, make_code, make_token


@pytest.fixture
def clock() -> SimulatedClock:
    return SimulatedClock(1000.0)


@pytest.fixture
def codes(clock: SimulatedClock) -> PairingCodes:
    return PairingCodes(clock)


def try_wrong(codes: PairingCodes) -> None:
    with pytest.raises(WrongCodeError):
        codes.use("wrong")


def test_a_code_works_once(codes: PairingCodes) -> None:
    code = codes.make("operator")
    assert codes.any_valid
    assert codes.use(code) == "operator"
    assert not codes.any_valid
    with pytest.raises(WrongCodeError):
        codes.use(code)


def test_a_code_may_be_typed_as_people_type(codes: PairingCodes) -> None:
    code = codes.make("viewer")
    assert codes.use(f" {code.lower().replace('-', ' ')} ") == "viewer"


def test_each_code_has_its_own_role(codes: PairingCodes) -> None:
    viewer, operator = codes.make("viewer"), codes.make("operator")
    assert (codes.use(operator), codes.use(viewer)) == ("operator", "viewer")


def test_a_code_is_void_after_ten_minutes(codes: PairingCodes, clock: SimulatedClock) -> None:
    early, late = codes.make("operator"), codes.make("operator")
    clock.forward(599.9)
    assert codes.use(early) == "operator"
    clock.forward(0.1)
    assert not codes.any_valid
    with pytest.raises(WrongCodeError):
        codes.use(late)


def test_three_wrong_codes_a_minute(codes: PairingCodes, clock: SimulatedClock) -> None:
    code = codes.make("operator")
    for _ in range(3):
        try_wrong(codes)
        clock.forward(10.0)
    with pytest.raises(TooManyTriesError, match="30 s") as refused:
        codes.use(code)
    assert refused.value.headers == {"retry-after": "30"}
    clock.forward(29.9)
    with pytest.raises(TooManyTriesError):
        codes.use("wrong")
    clock.forward(0.1)
    assert codes.use(code) == "operator"


def test_ten_wrong_codes_an_hour(codes: PairingCodes, clock: SimulatedClock) -> None:
    for _ in range(10):
        try_wrong(codes)
        clock.forward(60.0)
    code = codes.make("operator")
    with pytest.raises(TooManyTriesError, match="50 minutes") as refused:
        codes.use(code)
    assert refused.value.headers == {"retry-after": "3000"}
    clock.forward(2999.9)
    code = codes.make("operator")
    with pytest.raises(TooManyTriesError):
        codes.use(code)
    clock.forward(0.1)
    assert codes.use(code) == "operator"


def test_refused_attempts_do_not_prolong_the_wait(codes: PairingCodes, clock: SimulatedClock) -> None:
    for _ in range(3):
        try_wrong(codes)
    for _ in range(100):
        with pytest.raises(TooManyTriesError):
            codes.use("wrong")
    clock.forward(60.0)
    try_wrong(codes)


def test_valid_codes_do_not_count_as_attempts(codes: PairingCodes) -> None:
    for _ in range(11):
        codes.use(codes.make("viewer"))


def test_the_oldest_code_is_dropped_for_a_new_one(codes: PairingCodes) -> None:
    made = [codes.make("viewer") for _ in range(CODES_MAX + 1)]
    with pytest.raises(WrongCodeError):
        codes.use(made[0])
    assert all(codes.use(code) == "viewer" for code in made[1:])


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
