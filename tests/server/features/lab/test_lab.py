"""A lab: the same server without a robot."""

import json
from dataclasses import replace

import pytest

from server.feature import list_features
from server.health.monitor import HealthMonitor
from server.platform.last_configuration import read_usable_settings
from server.platform.settings import Settings, SetupError
from server.processes.supervisor import plan
from server.startup import _become_lab
from server.stream.bridge import Bridge
from tests.server.features.lab.labs import serve_lab
from tests.server.new_database import place_empty
from tests.server.waiting import until

ROBOTS_OWN = {"operate", "lease", "tuning", "vision", "recording", "snapshots", "board", "bring_up", "doors"}


async def test_it_has_sessions_and_no_robot(settings: Settings) -> None:
    async with serve_lab(settings) as lab:
        api = lab.api
        me = (await api.get("/access/me")).json()
        assert me["lab"] is True
        assert (await api.get("/sessions")).json() == []
        monitor = lab.get(HealthMonitor)
        await until(lambda: monitor.health().status == "ok", "the router")
        health = (await api.get("/health")).json()
        parts = [part["name"] for part in health["parts"]]
        assert (health["status"], parts) == ("ok", ["server", "database", "router", "robots"])
        assert (await api.get("/alive")).status_code == 204
        for gone in ("/robot", "/control", "/vision", "/link/frames", "/parameters"):
            assert (await api.get(gone)).status_code == 404, gone
        assert (await api.post("/robot/stop")).status_code == 404


async def test_it_sends_no_heartbeat_and_starts_no_process(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    beats: list[int] = []
    monkeypatch.setattr(Bridge, "send_heartbeat", lambda *_: beats.append(1))
    async with serve_lab(settings) as lab:
        assert lab.get(Bridge) is not None
    assert (plan(replace(settings, lab=True)), beats) == ([], [])


def test_a_robot_has_nothing_of_a_lab_and_a_lab_nothing_of_a_robot(settings: Settings) -> None:
    def names(settings: Settings) -> set[str]:
        return {feature.name for feature in list_features().values() if settings.has(feature)}

    robot, lab = names(settings), names(replace(settings, lab=True))
    assert ("lab" in lab, "lab" in robot) == (True, False)
    assert not lab & ROBOTS_OWN
    assert robot >= ROBOTS_OWN - {"doors"}
    assert {"sessions", "exports", "comparison", "live", "people"} <= robot & lab


def test_a_folder_is_a_lab_s_or_a_robot_s(settings: Settings) -> None:
    place_empty(settings.data)
    with pytest.raises(SetupError, match="recordings of a robot"):
        _become_lab(settings)
    settings.data.database.unlink()
    assert _become_lab(settings).lab
    place_empty(settings.data)
    again = read_usable_settings(settings.config, settings.data.path, None, None, {})
    assert again.lab
    assert _become_lab(again).lab


@pytest.mark.parametrize("text", ["mysql://lab", "postgresql:///mucat", "mucat.db"])
def test_another_database_is_refused_with_what_to_write(settings: Settings, text: str) -> None:
    settings.config.write_text(f"[lab]\ndatabase = {json.dumps(text)}\n")
    with pytest.raises(SetupError, match=r"lab.*postgresql\+psycopg:///mucat"):
        read_usable_settings(settings.config, settings.data.path, None, None, {})
