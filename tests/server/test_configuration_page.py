"""The reference of robot.toml."""

import re

import pytest

from robot_runtime.places import DEFAULT_CONFIG
from server.configuration_page import configuration_page, read_comments


def test_the_reference_has_every_entry_of_the_configuration_with_the_comment_beside_it() -> None:
    text = DEFAULT_CONFIG.read_text()
    page = configuration_page(text)
    assert "- `undo_days` (0 to 3650; default `7.0`): days in the bin before" in page
    with pytest.raises(ValueError, match=r"no comment beside sessions\.undo_days"):
        configuration_page(re.sub(r"(undo_days = 7\.0).*", r"\1", text))


def test_a_comment_of_several_lines_is_read_whole() -> None:
    text = "[a]\nx = 1  # one,\n        # two\n\n# of its own\ny = 2\n"
    assert read_comments(text) == {"a.x": "one, two", "a.y": ""}
