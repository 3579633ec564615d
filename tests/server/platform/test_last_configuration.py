"""A configuration that a power cut has damaged: the last one that could be used takes its place."""

import re
from pathlib import Path

import pytest

from server.platform.last_configuration import keep_configuration, read_usable_settings
from server.platform.settings import Settings, SetupError

GOOD = '[robot]\nname = "nemo"\nmode = "robot"\n[link]\nport = "/dev/ttyAMA0"\n'


def read(settings: Settings) -> Settings:
    return read_usable_settings(settings.config, settings.data.path, None, None, {})


@pytest.fixture
def used(settings: Settings) -> Settings:
    """A robot whose configuration was in force once."""
    settings.config.write_text(GOOD)
    result = read(settings)
    assert (result.configuration_problem, result.config) == ("", settings.config)
    keep_configuration(result)
    return settings


@pytest.mark.parametrize("cut", range(0, len(GOOD), 3))
def test_a_file_that_was_cut_off_anywhere_starts_the_robot_that_it_was(used: Settings, cut: int) -> None:
    used.config.write_text(GOOD[:cut])
    result = read(used)
    assert (result.robot.name, result.robot.mode, result.link.port) == ("nemo", "robot", "/dev/ttyAMA0")
    assert "the last configuration that could be used is in force" in result.configuration_problem
    assert "\n" not in result.configuration_problem
    keep_configuration(result)
    assert used.data.last_config.read_text() == GOOD


def test_a_last_line_without_its_end_is_no_damage(used: Settings) -> None:
    used.config.write_text(GOOD.rstrip())
    assert read(used).configuration_problem == ""


def test_a_file_that_somebody_has_shortened_holds_without_the_copy(used: Settings) -> None:
    used.config.write_text(GOOD[: GOOD.index("[link]")])
    assert "or remove that copy" in read(used).configuration_problem
    used.data.last_config.unlink()
    assert (read(used).configuration_problem, read(used).link.port) == ("", "/dev/serial0")


@pytest.mark.parametrize("nonsense", [b"\0" * 300, b"\xff\xfe[robot]", b"[robot]\nmode = 3\n", b"[sever]\n"])
def test_nonsense_is_not_kept_and_the_robot_starts(used: Settings, nonsense: bytes) -> None:
    used.config.write_bytes(nonsense)
    result = read(used)
    keep_configuration(result)
    assert used.data.last_config.read_text() == GOOD
    assert result.robot.name == "nemo"


def test_a_file_that_is_gone_starts_the_robot_too(used: Settings) -> None:
    used.config.unlink()
    assert read(used).robot.name == "nemo"


def test_without_an_earlier_one_it_is_refused_in_one_line(settings: Settings) -> None:
    settings.config.write_text("[robot")
    with pytest.raises(SetupError, match=r"robot\.toml cannot be read") as refused:
        read(settings)
    assert "\n" not in str(refused.value)


def test_a_corrected_file_is_in_force_again_and_kept(used: Settings) -> None:
    used.config.write_text("[robot")
    assert read(used).configuration_problem
    used.config.write_text(GOOD.replace("nemo", "dory"))
    result = read(used)
    keep_configuration(result)
    assert (result.robot.name, result.configuration_problem) == ("dory", "")
    assert "dory" in used.data.last_config.read_text()


def test_a_disk_that_cannot_be_written_hinders_no_start(
    used: Settings, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def write(*_: Path | bytes) -> None:
        raise OSError(30, "Read-only file system")

    monkeypatch.setattr("server.platform.last_configuration.write_whole", write)
    used.config.write_text(GOOD + "baud = 115200\n")
    keep_configuration(read(used))
    assert re.search("not copied to .*robot.toml.last: .*Read-only", caplog.text)


def test_empty_text_is_the_default_robot_and_no_damage(settings: Settings) -> None:
    settings.config.write_text("")
    assert read(settings).robot.mode == "emulated"
