"""Layouts of panels: stored by name, refused where invalid."""

from typing import Any

import pytest
from pydantic import ValidationError
from sqlmodel import insert

from robot_runtime.errors import RefusedError
from server.features.layouts.document import LayoutDocument
from server.features.layouts.library import LAYOUTS_MOST, Layouts, UnknownLayoutError
from server.platform.models import LayoutRow
from server.platform.store import Store
from tests.server.serving import Served

SHELL = "the shell of this computer"
CAMERA = {"id": "camera", "panel": "camera", "x": 0, "y": 0, "width": 17, "height": 11}
CHART = {
    "id": "chart 2",
    "panel": "chart",
    "x": 17,
    "y": 0,
    "width": 7,
    "height": 5,
    "chart": {"signals": ["depth.depth", "motor.angle_2"], "seconds": 60},
}


def layout(*panels: dict[str, Any], **changes: Any) -> dict[str, Any]:
    return {"format": "mucat-layout", "version": 1, "panels": list(panels)} | changes


def document(*panels: dict[str, Any]) -> LayoutDocument:
    return LayoutDocument.model_validate(layout(*panels))


async def test_a_layout_is_stored_and_listed(served: Served) -> None:
    whole = layout(CAMERA, CHART)
    stored = await served.api.post("/layouts", json={"name": " Pool day ", "document": whole})
    assert stored.status_code == 201
    assert stored.json()["name"] == "Pool day"
    assert (await served.api.get("/layouts")).json() == [stored.json()]
    path = f"/layouts/{stored.json()['id']}"
    assert (await served.api.get(path)).json() == stored.json() | {"document": whole}
    assert (await served.api.delete(path)).status_code == 204
    for gone in (await served.api.get(path), await served.api.delete(path)):
        assert gone.status_code == 404
        assert "no layout 1" in gone.json()["detail"]


async def test_saving_under_the_same_name_replaces(store: Store) -> None:
    layouts = Layouts(store)
    first = await layouts.save("pool", document(CAMERA))
    other = await layouts.save("Lab", document())
    again = await layouts.save("pool", document(CHART))
    assert again.id == first.id
    assert [layout.id for layout in layouts.list()] == [other.id, first.id]
    assert layouts.get(first.id).document["panels"] == [CHART]


async def test_a_layout_that_somebody_has_saved_meanwhile_is_not_replaced_unasked(served: Served) -> None:

    async def save(*panels: Any, **more: Any) -> Any:
        body = {"name": "pool", "document": layout(*panels), **more}
        return await served.api.post("/layouts", json=body)

    first = (await save(CAMERA, base=0)).json()
    assert (first["version"], first["author"]) == (1, SHELL)
    assert (await save(CHART, base=1)).json()["version"] == 2
    for base in (0, 1):
        refused = await save(base=base)
        assert (refused.status_code, refused.json()["kind"]) == (409, "changed")
        assert f"“pool” was saved by {SHELL} since you opened it" in refused.json()["detail"]
    assert (await save(base=2)).json() | {"saved": ""} == first | {"version": 3, "saved": ""}
    await served.api.delete(f"/layouts/{first['id']}")
    assert "was deleted" in (await save(base=3)).json()["detail"]
    assert (await save(base=0)).json()["id"] > first["id"]


async def test_the_number_of_layouts_is_limited(store: Store) -> None:
    layouts = Layouts(store)
    rows = [{"name": f"n{number}", "document": "{}", "saved": 0.0} for number in range(LAYOUTS_MOST)]
    await store.write(lambda connection: connection.execute(insert(LayoutRow), rows))
    with pytest.raises(RefusedError, match="Delete one"):
        await layouts.save("one more", document())
    assert (await layouts.save("n3", document())).name == "n3"
    with pytest.raises(UnknownLayoutError):
        await layouts.delete(LAYOUTS_MOST + 1)


@pytest.mark.parametrize(
    ("given", "why"),
    [
        (layout(CAMERA, version=2), "is of version 2; this program reads version 1"),
        ({"format": "mucat-layout", "version": "{2}", "slots": []}, "is of version {2}"),
        (layout(version=True), "is of version True"),
        (layout(CAMERA, format="grafana"), "Input should be 'mucat-layout'"),
        (layout(CAMERA, CAMERA), "the same id"),
        (layout(CAMERA, CHART | {"x": 16}), "camera and chart lie over each other"),
        (layout(CHART | {"x": 18}), "chart does not fit into 24 columns"),
        (layout(CAMERA | {"y": 95}), "camera does not fit"),
        (layout(CAMERA | {"x": -1}), "greater than or equal to 0"),
        (layout(CAMERA | {"width": 2.5}), "valid integer"),
        (layout(CAMERA | {"panel": "../../etc/passwd"}), "match pattern"),
        (layout(CAMERA | {"colour": "red"}), "not permitted"),
        (layout(CHART | {"chart": {"signals": [], "seconds": float("nan")}}), "finite number"),
        (layout(CHART | {"chart": {"signals": ["a"] * 13, "seconds": 60}}), "at most 12"),
        (layout(CHART | {"chart": {"signals": ["a", "b", "a"], "seconds": 60}}), "names a signal twice"),
        (layout(*({**CAMERA, "id": str(number)} for number in range(41))), "at most 40"),
        ([], "valid dictionary"),
    ],
)
def test_an_invalid_layout_is_refused_with_the_reason(given: object, why: str) -> None:
    with pytest.raises(ValidationError) as refused:
        LayoutDocument.model_validate(given)
    assert why in refused.value.errors()[0]["msg"]


async def test_a_layout_of_another_version_is_refused_and_changes_nothing(served: Served) -> None:
    request = {"name": "pool", "document": layout(CAMERA, version=2)}
    answer = await served.api.post("/layouts", json=request)
    assert answer.status_code == 422
    assert "This layout is of version 2; this program reads version 1." in answer.json()["detail"]
    assert (await served.api.get("/layouts")).json() == []
