"""Numbers in queries: what is no finite number is refused everywhere."""

import asyncio

import pytest

from server.platform.settings import Settings
from tests.server.serving import serve


def is_number(schema: dict[str, object]) -> bool:
    options = schema.get("anyOf", [schema])
    assert isinstance(options, list)
    return any(one.get("type") == "number" for one in options)


@pytest.mark.parametrize("number", ["nan", "inf", "-inf", "1e999"])
def test_numbers_that_are_not_finite_are_refused(settings: Settings, number: str) -> None:
    async def run() -> None:
        async with serve(settings) as served:
            document = (await served.api.get("/openapi.json")).raise_for_status().json()
            asked = []
            for path, operations in document["paths"].items():
                for method, operation in operations.items():
                    for parameter in operation.get("parameters", []):
                        if parameter["in"] == "query" and is_number(parameter["schema"]):
                            url = path.removeprefix("/api").replace("{", "").replace("}", "")
                            for name in ("session", "run", "profile"):
                                url = url.replace(f"/{name}/", "/1/")
                            answer = await served.api.request(method, url, params={parameter["name"]: number})
                            assert answer.status_code == 422, (url, parameter["name"], answer.text)
                            assert parameter["name"] in answer.json()["detail"], (url, answer.text)
                            asked.append(parameter["name"])
            assert {"view_start", "history", "time"} <= set(asked)

    asyncio.run(run())
