from typing import Any

from fastapi import FastAPI
from httpx import ASGITransport, AsyncClient

from server.http.operations import Identifier, Operations
from server.http.sign_in.policy import Need, list_needs
from server.platform.errors import ApiError
from server.recording.session import UnknownSessionError


class KettleError(ApiError):
    """It is a teapot

    What follows the first line is for whoever reads the source.
    """

    status = 418


def describe(router: Operations) -> tuple[FastAPI, dict[str, Any]]:
    """Return an application with these operations, and the paths of its document."""
    app = FastAPI()
    app.router.routes.extend(router.build())
    return app, app.openapi()["paths"]


def test_an_operation_is_named_by_its_function_and_described_by_its_docstring() -> None:
    router = Operations(prefix="/api")

    @router.operation("GET /things", Need.OPERATOR)
    def list_all_things() -> list[int]:
        """List the things, newest first.

        Old ones are left out.
        """
        return []

    @router.operation("DELETE /things", Need.CONTROL)
    def delete_things() -> None:
        """Delete them."""

    app, paths = describe(router)
    things, deletion = paths["/api/things"]["get"], paths["/api/things"]["delete"]
    assert (things["operationId"], things["summary"]) == ("listAllThings", "List the things, newest first")
    assert things["description"] == "List the things, newest first.\n\nOld ones are left out."
    assert set(things["responses"]) == {"200"}
    assert set(deletion["responses"]) == {"204", "423"}
    assert list_needs(app.routes) == {"listAllThings": Need.OPERATOR, "deleteThings": Need.CONTROL}


def test_documented_answers_come_from_the_errors() -> None:
    router = Operations(prefix="/api")

    @router.operation(
        "GET /tea", Need.VIEWER, KettleError, UnknownSessionError, {409: "Refused now"}, media_type="text/tea"
    )
    def get_tea() -> str:
        """Return tea."""
        return ""

    answers = describe(router)[1]["/api/tea"]["get"]["responses"]
    assert answers.pop("200")["content"] == {"text/tea": {}}
    assert {status: answer["description"] for status, answer in answers.items()} == {
        "418": "It is a teapot",
        "404": "There is no such session",
        "409": "Refused now",
    }


async def test_a_route_is_built_for_its_first_request_and_others_are_found_without() -> None:
    router = Operations(prefix="/api")

    @router.operation("GET /things/{number}", Need.NOTHING)
    def get_thing(number: Identifier) -> int:
        """Return a thing."""
        return number

    @router.operation("DELETE /things/{number}", Need.NOTHING)
    def delete_thing(number: Identifier) -> None:
        """Delete a thing."""

    app = FastAPI()
    app.router.routes.extend(routes := router.build())
    assert not any("dependant" in vars(route) for route in routes)
    async with AsyncClient(transport=ASGITransport(app), base_url="http://robot") as client:
        assert (await client.get("/api/things/3")).json() == 3
        assert (await client.get("/api/things/none")).status_code == 422
        assert (await client.post("/api/things/3")).status_code == 405
    assert ["dependant" in vars(route) for route in routes] == [True, False]
    assert not hasattr(routes[1], "no_such_attribute")
