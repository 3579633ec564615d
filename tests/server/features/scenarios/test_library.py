"""The scenarios of the data folder."""

from pathlib import Path

import pytest

from robot_runtime.errors import RefusedError
from robot_runtime.experiments.scenario.library import SHIPPED
from server.features.scenarios import library
from server.features.scenarios.library import keep_scenario, list_scenarios


def test_one_more_scenario_than_there_may_be_is_refused_and_a_stored_one_may_change(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(library, "SCENARIOS_MAX", 2)
    text = list_scenarios(tmp_path)[0].text
    for name in ("one", "two"):
        keep_scenario(tmp_path, text.replace(f'"{SHIPPED[0]}"', f'"{name}"', 1))
    with pytest.raises(RefusedError, match="There are 2 scenarios already"):
        keep_scenario(tmp_path, text.replace(f'"{SHIPPED[0]}"', '"three"', 1))
    keep_scenario(tmp_path, text.replace(f'"{SHIPPED[0]}"', '"two"', 1) + "# changed\n")
    assert [scenario.name for scenario in list_scenarios(tmp_path) if not scenario.shipped] == ["one", "two"]
