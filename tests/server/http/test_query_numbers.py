"""Numbers in queries: what is no finite number is refused everywhere."""

import re
from collections.abc import Iterator
from typing import Any

from server.platform.settings import Settings
from tests.server.blocks import depth_block
from tests.server.features.exports.recordings import record_batches
from tests.server.new_database import new_store
from tests.server.serving import serve


def list_numbers(document: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    """URL, method and name of each number in a query; paths are of the first of everything."""
    for path, operations in document["paths"].items():
        for method, operation in operations.items():
            for parameter in operation.get("parameters", []):
                if parameter["in"] == "query" and is_number(parameter["schema"]):
                    yield re.sub(r"\{\w+\}", "1", path.removeprefix("/api")), method, parameter["name"]


def is_number(schema: dict[str, object]) -> bool:
    options = schema.get("anyOf", [schema])
    assert isinstance(options, list)
    return any(option.get("type") == "number" for option in options)


async def test_what_is_no_finite_number_is_refused(settings: Settings) -> None:
    with new_store(settings.data) as store:
        await record_batches(store, settings, [depth_block(0, 5)])

    async with serve(settings) as served:
        document = (await served.api.get("/openapi.json")).raise_for_status().json()
        asked = []
        for url, method, name in list_numbers(document):
            for number in ("nan", "inf", "-inf", "1e999", "true"):
                answer = await served.api.request(method, url, params={name: number})
                assert answer.status_code == 422, (url, name, answer.text)
                assert name in answer.json()["detail"], (url, answer.text)
            asked.append(name)
        assert {"view_start", "history", "time"} <= set(asked)
