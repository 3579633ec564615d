"""The OpenAPI document: a program made from it can sign in, and its examples are valid."""

from dataclasses import replace
from typing import Any

import jsonschema_rs
import pytest

from server.app import create_app
from server.http.description import BODIES, COOKIE, SECRET, TOKEN
from server.platform.settings import Settings
from tests.server.features.doors.rig import make_token
from tests.server.serving import Served


def operations(document: dict[str, Any]) -> list[tuple[str, str, dict[str, Any]]]:
    return [
        (method, path, operation)
        for path, methods in document["paths"].items()
        for method, operation in methods.items()
    ]


def test_every_example_of_a_body_is_valid(settings: Settings) -> None:
    document = create_app(replace(settings, every_feature=True)).openapi()
    results = {operation["operationId"]: operation for _, _, operation in operations(document)}
    assert results.keys() >= BODIES.keys()
    for name in BODIES:
        content = results[name]["requestBody"]["content"]["application/json"]
        schema = content["schema"] | {"components": document["components"]}
        jsonschema_rs.validate(schema, content["example"])


@pytest.mark.parametrize("name", ["checkMission", "checkScenario"])
async def test_the_example_of_a_document_has_no_problem(name: str, served: Served) -> None:
    path = {"checkMission": "/missions/check", "checkScenario": "/scenarios/check"}[name]
    answer = await served.api.post(path, json=BODIES[name])
    assert answer.json()["problems"] == [], answer.text


async def test_a_program_signs_in_as_the_document_says(served: Served) -> None:
    token = await make_token(served, "read")
    document = (await served.api.get("/openapi.json")).json()
    schemes = document["components"]["securitySchemes"]
    assert (schemes[TOKEN]["type"], schemes[TOKEN]["scheme"]) == ("http", "bearer")
    assert document["servers"][0]["url"] == "/"
    asked = 0
    for method, path, operation in operations(document):
        if method != "get" or "{" in path or operation["x-need"] not in ("nothing", "viewer"):
            continue
        answer = await served.api.get(path.removeprefix("/api"), auth=None)
        assert (answer.status_code == 401) is bool(operation["security"]), (path, answer.text)
        if operation["security"]:
            assert {TOKEN: []} in operation["security"]
            headers = {"authorization": f"Bearer {token}"}
            answer = await served.api.get(path.removeprefix("/api"), headers=headers, auth=None)
            assert answer.status_code not in (401, 403), path
            asked += 1
    assert asked > 15


def test_a_browser_shows_cookie_and_secret_but_for_what_the_page_links_to(settings: Settings) -> None:
    document = create_app(replace(settings, every_feature=True)).openapi()
    schemes = document["components"]["securitySchemes"]
    assert (schemes[COOKIE]["in"], schemes[SECRET]["in"]) == ("cookie", "header")
    results = {operation["operationId"]: operation["security"] for _, _, operation in operations(document)}
    assert {COOKIE: [], SECRET: []} in results["getRobot"]
    assert {COOKIE: []} in results["downloadExport"]
    assert results["pairBrowser"] == []
