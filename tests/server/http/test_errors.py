import asyncio

import httpx
import pytest
from fastapi import FastAPI

from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.problems import DocumentEntry
from robot_runtime.errors import RefusedError
from server.driving.lease import NotInControlError
from server.http.error_handlers import add_error_handlers
from server.http.sign_in.pairing_codes import TooManyTriesError
from server.library.content import RecordingError
from server.platform.errors import ApiError
from server.platform.sqlite import FULL
from server.platform.store import StoreError
from server.stream.bridge import RuntimeSilentError


class TeapotError(ApiError):
    """It is a teapot

    What follows the first line is for whoever reads the source.
    """

    status = 418


def ask(problem: Exception) -> httpx.Response:
    """Return the answer of an application whose route raises this error."""
    app = FastAPI()
    add_error_handlers(app)

    @app.get("/")
    async def fail() -> None:
        raise problem

    async def run() -> httpx.Response:
        transport = httpx.ASGITransport(app, raise_app_exceptions=False)
        async with httpx.AsyncClient(transport=transport, base_url="http://test") as client:
            return await client.get("/")

    return asyncio.run(run())


@pytest.mark.parametrize(
    ("problem", "status", "detail"),
    [
        (TeapotError("Short and stout."), 418, "Short and stout."),
        (NotInControlError("Take control first."), 423, "Take control first."),
        (RuntimeSilentError("It is not running.", waited=False), 503, "It is not running."),
        (RuntimeSilentError("It did not answer.", waited=True), 504, "It did not answer."),
        (StoreError("it is locked"), 503, "The database does not work: it is locked."),
        (StoreError(FULL), 507, f"The database does not work: {FULL}."),
        (RefusedError("Press STOP first."), 409, "Press STOP first."),
    ],
)
def test_an_error_is_answered_with_its_status_and_text(problem: Exception, status: int, detail: str) -> None:
    answer = ask(problem)
    assert (answer.status_code, answer.json()) == (status, {"detail": detail})


def test_problems_of_a_document_are_answered_with_the_paths_to_them() -> None:
    answer = ask(ConfigError(DocumentEntry("a", ("a",)).item(1).problem("is 9"), "b: unknown"))
    assert answer.status_code == 422
    assert answer.json() == {
        "detail": "a[1] is 9\nb: unknown",
        "problems": [
            {"path": ["a", 1], "text": "a[1] is 9", "words": "is 9"},
            {"path": [], "text": "b: unknown", "words": "b: unknown"},
        ],
    }


def test_an_unreadable_recording_does_not_affect_others() -> None:
    answer = ask(RecordingError("chunk 7 is damaged"))
    assert answer.status_code == 500
    assert "chunk 7 is damaged. Other sessions are not affected." in answer.json()["detail"]


def test_too_many_tries_are_answered_with_retry_after() -> None:
    answer = ask(TooManyTriesError(59.2))
    assert (answer.status_code, answer.headers["retry-after"]) == (429, "60")


def test_any_other_error_reveals_no_internals() -> None:
    answer = ask(ZeroDivisionError("secret"))
    assert (answer.status_code, answer.text) == (500, "Internal Server Error")
