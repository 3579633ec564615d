"""The vision settings over HTTP: passed on completely, refused where invalid, and as TOML."""

import tomllib
from pathlib import Path
from typing import Any

import tomli_w
from hypothesis import given
from hypothesis import strategies as st

from robot_runtime.contract.parsing import parse
from robot_runtime.contract.vision_settings import COLOURS, SINCE_0_2, ColourRange, VisionSettings
from server.features.vision.routes import read_document
from server.platform.settings import Settings
from tests.server.serving import Served, serve

SETTINGS = VisionSettings(
    rate=12.5,
    colour="Boje",
    colours={"Boje": COLOURS["green"], "red": COLOURS["red"]},
    markers="4x4_50",
    marker_numbers=(3, 7),
    white_balance="underwater",
    actions={"marker 7": 1.5, "red": 0.25},
).table()

SET = "/robot/commands/vision_settings"


async def test_settings_are_passed_on_completely_and_read_back(served: Served) -> None:
    assert (await served.api.post(SET, json=SETTINGS)).status_code == 200
    assert served.runtime.asked == [("vision_settings", SETTINGS)]
    usual = VisionSettings().table()
    assert (await served.api.get("/vision")).json() == {"settings": usual, "configured": usual}


async def test_settings_that_have_changed_meanwhile_are_not_replaced_unasked(
    settings: Settings,
) -> None:
    usual = VisionSettings().table()

    async with serve(settings) as served:
        edit = {"settings": SETTINGS, "base": usual | {"rate": 2.0}}
        refused = await served.api.put("/vision", json=edit)
        assert (refused.status_code, refused.json()["kind"]) == (409, "changed")
        assert refused.json()["detail"].startswith("A vision setting (rate) was saved since you opened it.")
        assert served.runtime.asked == []
        assert (await served.api.put("/vision", json=edit | {"base": usual})).status_code == 204
        assert (await served.api.put("/vision", json={"settings": SETTINGS})).status_code == 204
        assert served.runtime.asked == 2 * [("vision_settings", SETTINGS)]


async def test_settings_of_a_client_of_version_0_2_are_passed_on_and_leave_the_others(served: Served) -> None:
    usual = VisionSettings().table()
    older, before = (
        {name: value for name, value in table.items() if name not in SINCE_0_2} for table in (SETTINGS, usual)
    )
    assert (await served.api.post(SET, json=older)).status_code == 200
    assert (await served.api.put("/vision", json={"settings": older, "base": before})).status_code == 204
    assert served.runtime.asked == 2 * [("vision_settings", older)]


WRONG: list[tuple[dict[str, Any], str]] = [
    ({"rate": 31}, "less than or equal to 30"),
    ({"rate": None}, "rate"),
    ({"rate": "fast"}, "rate"),
    ({"area_min": 0.5, "area_max": 0.4}, "area_min is 0.5, above area_max"),
    ({"colour": "pink"}, "colour is 'pink'; it must be one of Boje, red"),
    ({"colours": {}}, "colours"),
    ({"colours": {"Boje": {"hue": [0, 180], "saturation": [0, 1], "value": [0, 1]}}}, "179"),
    ({"colours": {"Boje": {"hue": [0, 17], "saturation": [9, 1], "value": [0, 1]}}}, "saturation is"),
    ({"colours": {"Boje": {"hue": [0.5, 17], "saturation": [0, 1], "value": [0, 1]}}}, "hue"),
    ({"actions": {"marker x": 1.0}}, "no colour and no marker"),
    ({"actions": {"red": 10.5}}, "less than or equal to 10"),
    ({"white_balance": "magic"}, "white_balance"),
    ({"marker_numbers": [1024]}, "marker_numbers"),
    ({"shutter": 3}, "shutter"),
]


async def test_invalid_settings_are_refused_by_the_server(served: Served) -> None:
    for change, message in WRONG:
        answer = await served.api.post(SET, json={**SETTINGS, **change})
        assert answer.status_code == 422, change
        assert message in answer.json()["detail"]
    short = {name: value for name, value in SETTINGS.items() if name != "opening"}
    assert (await served.api.post(SET, json=short)).status_code == 422
    text = '{"rate": NaN}'
    json = {"Content-Type": "application/json"}
    assert (await served.api.post(SET, content=text, headers=json)).status_code == 422
    assert served.runtime.asked == []


async def test_picking_returns_the_runtime_s_answer(served: Served) -> None:
    answer = await served.api.post("/vision/pick", json={"x": 0.25, "y": 1})
    red = VisionSettings().table()["colours"]["red"]
    assert answer.json() == {"colour": red, "share": 0.25, "mask": "AAAA"}
    assert served.runtime.picked == [{"x": 0.25, "y": 1.0, "radius": 0.02}]
    for wrong in (
        {"x": 0.25},
        {"x": 1.25, "y": 0},
        {"x": 0, "y": 0, "radius": 0.5},
        {"x": 0, "y": "low"},
    ):
        assert (await served.api.post("/vision/pick", json=wrong)).status_code == 422
    served.runtime.refusal = "There is no colour at this place: it is grey."
    answer = await served.api.post("/vision/pick", json={"x": 0.25, "y": 1})
    assert (answer.status_code, answer.json()["detail"]) == (409, served.runtime.refusal)


async def test_the_table_of_robot_toml_is_downloaded_and_uploaded(served: Served) -> None:
    answer = await served.api.get("/vision/toml")
    assert 'filename="vision.toml"' in answer.headers["content-disposition"]
    assert read_document(answer.text) == VisionSettings().table()
    read = await served.api.post("/vision/read", json={"text": Path("robot.toml").read_text()})
    assert read.json() == VisionSettings().table()
    for text, message in (
        ("[vision", "not TOML"),
        ("[robot]", "no table [vision]"),
        ("vision = 3", "must be a table"),
        ("[vision]\nrate = 99", "between 2 and 30"),
        ("[vision]\ncolour = 'pink'", "colour is 'pink'"),
    ):
        answer = await served.api.post("/vision/read", json={"text": text})
        assert answer.status_code == 422, text
        assert message in answer.json()["detail"]
    assert served.runtime.asked == []


NAMES = st.from_regex(r"\A[A-Za-zäöüß][\w .-]{0,31}\Z").filter(lambda name: not name.startswith("marker"))
BYTES = st.tuples(st.integers(0, 255), st.integers(0, 255)).map(lambda pair: (min(pair), max(pair)))
RANGES = st.builds(
    ColourRange,
    hue=st.tuples(st.integers(0, 179), st.integers(0, 179)),
    saturation=BYTES,
    value=BYTES,
)


@st.composite
def any_settings(draw: st.DrawFn) -> VisionSettings:
    colours = draw(st.dictionaries(NAMES, RANGES, min_size=1, max_size=4))
    named = st.sampled_from([*colours, "marker 0", "marker 1023"])
    return VisionSettings(
        rate=draw(st.floats(2, 30)),
        colour=draw(st.sampled_from(sorted(colours))),
        colours=colours,
        aspect=(draw(st.floats(0.05, 1)), draw(st.floats(1, 20))),
        marker_numbers=tuple(draw(st.lists(st.integers(0, 1023), max_size=5))),
        actions=draw(st.dictionaries(named, st.floats(0, 10), max_size=4)),
    )


@given(any_settings())
def test_any_settings_survive_toml(settings: VisionSettings) -> None:
    text = tomli_w.dumps({"vision": settings.table()})
    assert read_document(text) == settings.table()
    # The order of priority is preserved.
    assert list(tomllib.loads(text)["vision"].get("actions", {})) == list(settings.actions)
    assert parse(VisionSettings, read_document(text)) == settings
