"""Errors as answers: each with its HTTP status, and its text as `detail`."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse

from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.problems import DocumentEntry, EntryProblem
from robot_runtime.contract.text_input import TextError
from robot_runtime.errors import RefusedError
from server.http.dependencies import find_service
from server.platform.errors import ApiError
from server.platform.memory_reserve import SHORT, MemoryReserve


def add_error_handlers(app: FastAPI) -> None:
    """Add answers for the server's errors, the runtime's, and invalid requests."""
    app.add_exception_handler(ApiError, _answer_api_error)
    app.add_exception_handler(RefusedError, _answer_refusal)
    app.add_exception_handler(ConfigError, _answer_config_error)
    app.add_exception_handler(RequestValidationError, _answer_invalid_request)
    app.add_exception_handler(400, _answer_unreadable_body)
    app.add_exception_handler(MemoryError, _answer_lack_of_memory)


async def _answer_api_error(_: Request, problem: Exception) -> JSONResponse:
    assert isinstance(problem, ApiError)
    return _answer(problem.status, problem.detail, problem.headers, kind=problem.kind)


async def _answer_refusal(_: Request, problem: Exception) -> JSONResponse:
    return _answer(409, str(problem))


async def _answer_config_error(_: Request, problem: Exception) -> JSONResponse:
    assert isinstance(problem, ConfigError)
    return _answer(422, "\n".join(problem.texts), problems=problem.problems)


async def _answer_invalid_request(_: Request, problem: Exception) -> JSONResponse:
    assert isinstance(problem, RequestValidationError)
    problems = [
        DocumentEntry(".".join(map(str, error["loc"])), tuple(error["loc"])).sentence(error["msg"])
        for error in problem.errors()[:5]
    ]
    reasons = "; ".join(problem.text for problem in problems)
    return _answer(422, f"The request is not valid. {reasons}", problems=problems)


async def _answer_unreadable_body(_: Request, problem: Exception) -> JSONResponse:
    cause = problem.__cause__
    reason = str(cause) if isinstance(cause, TextError) else "is not JSON in UTF-8"
    return _answer(422, f"The request is not valid. Its body {reason}.")


async def _answer_lack_of_memory(request: Request, _: Exception) -> JSONResponse:
    find_service(request, MemoryReserve).open()
    return _answer(503, SHORT)


def _answer(
    status: int,
    detail: str,
    headers: Mapping[str, str] | None = None,
    problems: Sequence[EntryProblem] = (),
    kind: str = "",
) -> JSONResponse:
    body = (
        {"detail": detail}
        | ({"kind": kind} if kind else {})
        | ({"problems": [asdict(problem) for problem in problems]} if problems else {})
    )
    return JSONResponse(body, status, headers)
