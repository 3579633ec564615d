from typing import Any

import pytest

from robot_runtime.contract.topics import BY_NAME
from server.library.upgrade import NoCounterpartError, rewrite_document


def document_of(value: Any) -> dict[str, Any]:
    """Return a `parameters` document with this value, and with a field unknown to this version."""
    parameter = {
        "name": "depth.pid.kp",
        "type": "number",
        "value": value,
        "default": value,
        "minimum": None,
        "maximum": 50.0,
        "unit": "",
        "meaning": "",
        "choices": [],
        "where": "runtime",
        "while_armed": True,
        "pending": False,
        "gone": 1,
    }
    return {"time": 1.0, "parameters": [parameter]}


@pytest.mark.parametrize("value", [7, 7.5, "pid", True])
def test_a_value_of_a_union_is_rewritten_by_its_own_type(value: object) -> None:
    (parameter,) = rewrite_document(document_of(value), BY_NAME["parameters"])["parameters"]
    assert (parameter["value"], type(parameter["value"])) == (value, type(value))
    assert (parameter["minimum"], parameter["maximum"]) == (None, 50.0)
    assert "gone" not in parameter


@pytest.mark.parametrize("value", [None, [], {}])
def test_a_value_of_no_type_of_the_union_is_left_out(value: object) -> None:
    with pytest.raises(NoCounterpartError, match="is no"):
        rewrite_document(document_of(value), BY_NAME["parameters"])
