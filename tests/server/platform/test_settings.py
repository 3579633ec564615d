"""The sections of robot.toml that are not the robot's: errors are named, features are switched."""

from pathlib import Path

import pytest

from robot_runtime.places import DEFAULT_CONFIG
from server.feature import Feature, list_features
from server.features.events.config import EventsConfig
from server.platform.settings import Settings, SetupError, read_settings


def read(folder: Path, text: str) -> Settings:
    """Read this robot.toml."""
    path = folder / "robot.toml"
    path.write_text(text, encoding="utf-8")
    return read_settings(path, folder / "data", None, None, {})


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("[sesions]\nkeep_days = 3", r"'sesions' is not known here; known are robot, .*, sessions"),
        ("[sessions]\nkeep_dais = 3", r"sessions: 'keep_dais' is not known here"),
        ("[sessions]\nkeep_days = -1", r"sessions.*keep_days is -1; it must lie between 0 and"),
        ("[server]\nport = 0", "port is 0; it must lie between 1 and 65535"),
        (
            "[server]\npublic_url = 'robots.lab'",
            r"robot.toml.* server: public_url is 'robots.lab'; write it like",
        ),
        (
            "[server]\ntrusted_proxies = ['nginx']",
            r"robot.toml.* server: trusted_proxies has 'nginx', which is",
        ),
        ("doors = 3", "doors must be a table"),
        ("[features]\nsessions = false", r"sessions is no optional feature; there are .*identification"),
        ("[features]\nidentification = 'no'", "must be true or false"),
        ("[events]\nmqtt = 'broker.lab'", r"events.mqtt is 'broker.lab'; use mqtt://NAME or mqtts://NAME"),
        ("[events]\nmqtt = 'mqtt://turtle:word@broker.lab'", "events.mqtt is"),
        ("[events]\nmqtt = 'mqtt://broker.lab/topic'", "ends with the broker's name"),
        ("[events]\nmqtt = 'mqtt://lab..example'", "events.mqtt is"),
        ("[events]\nmqtt_user = 'turtle'", "go together"),
        (
            "[events]\nmqtt = 'mqtt://broker.lab'\nmqtt_user = 'turtle'\nmqtt_password_file = 'word'",
            "would send the password for everybody to read; use mqtts://",
        ),
        ("[events]\nwebhook = 'https://lab.example'", "events.*webhook is no longer there"),
    ],
)
def test_errors_are_named(tmp_path: Path, text: str, why: str) -> None:
    with pytest.raises(SetupError, match=why):
        read(tmp_path, text)


def test_the_shipped_file_holds_the_defaults_of_every_feature(tmp_path: Path) -> None:
    shipped, plain = read(tmp_path, DEFAULT_CONFIG.read_text(encoding="utf-8")), read(tmp_path, "")
    for feature in list_features().values():
        if (section := feature.section_class) is not None:
            assert shipped.section(section) == plain.section(section)
    assert shipped.server == plain.server


def on(settings: Settings, name: str) -> bool:
    """Return True where this feature is on."""
    feature: Feature = list_features()[name]
    return settings.has(feature)


def test_an_optional_feature_is_switched_off_and_one_without_anything_to_do_is_off(tmp_path: Path) -> None:
    plain = read(tmp_path, "")
    assert (on(plain, "identification"), on(plain, "doors"), on(plain, "sessions")) == (True, False, True)
    assert not on(read(tmp_path, "[features]\nidentification = false"), "identification")
    assert on(read(tmp_path, "[doors]\nfoxglove = true"), "doors")


def test_empty_entries_of_earlier_versions_are_passed_over(tmp_path: Path) -> None:
    assert read(tmp_path, "[events]\nwebhook = ''\nwebhook_token_file = ''").section(EventsConfig).mqtt == ""
