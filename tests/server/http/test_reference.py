import shutil
import sys
from pathlib import Path
from typing import Any

import pytest

from server import openapi
from server.http.reference import http_page

DOCUMENT: dict[str, Any] = {
    "paths": {
        "/api/things": {
            "post": {
                "operationId": "makeThing",
                "x-need": "operator",
                "tags": ["things"],
                "summary": "Make a thing",
                "parameters": [{"in": "query", "name": "name", "required": True}],
                "requestBody": {
                    "content": {"application/json": {"schema": {"$ref": "#/components/schemas/Thing"}}}
                },
                "responses": {
                    "201": {"content": {"application/json": {"schema": {"type": "null"}}}},
                    "4XX": {},
                },
            }
        }
    },
    "components": {
        "schemas": {
            "Thing": {
                "description": "One thing.",
                "required": ["size"],
                "properties": {
                    "size": {"type": "number", "minimum": 0, "maximum": 10, "description": "m"},
                    "kind": {"anyOf": [{"enum": ["a", "b"]}, {"type": "null"}]},
                },
            }
        }
    },
}


def test_an_operation_and_its_types_are_described() -> None:
    page = http_page(DOCUMENT)
    assert "## Things\n" in page
    taken = "`?name` (required), [Thing](#thing)"
    assert f"- `POST /api/things` (operator; {taken}; gives 201 null): Make a thing.\n" in page
    assert "- `size` (number 0 to 10): m\n" in page
    assert "- `kind` (`a`, `b` or null, optional)\n" in page


def test_of_an_answer_the_type_is_named() -> None:
    answer = {"$ref": "#/components/schemas/Box"}
    operation = DOCUMENT["paths"]["/api/things"]["post"] | {
        "responses": {"200": {"content": {"application/json": {"schema": answer}}}}
    }
    box = {"properties": {"name": {"type": "string"}, "things": {"items": {"$ref": "#/.../Thing"}}}}
    schemas = DOCUMENT["components"]["schemas"] | {"Box": box}
    page = http_page({"paths": {"/api/things": {"post": operation}}, "components": {"schemas": schemas}})
    assert "`?name` (required), [Thing](#thing); gives `Box`): Make a thing.\n" in page
    assert "### Box" not in page


def test_the_check_fails_where_an_operation_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copy(openapi.SOURCES / "robot.toml", tmp_path)
    (tmp_path / "docs/reference").mkdir(parents=True)
    (tmp_path / "migrations").mkdir()
    reference = tmp_path / "docs/reference/http.md"
    monkeypatch.setattr(openapi, "SOURCES", tmp_path)
    monkeypatch.setattr(sys, "argv", ["openapi", "--reference"])
    assert openapi.main() == 0
    monkeypatch.setattr(sys, "argv", ["openapi", "--reference", "--check"])
    assert openapi.main() == 0
    lines = reference.read_text().splitlines(keepends=True)
    reference.write_text("".join(line for line in lines if "`POST /api/robot/stop`" not in line))
    assert openapi.main() == 1
    assert "http.md is not current" in capsys.readouterr().out
