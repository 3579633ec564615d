"""Texts are found however they were typed."""

import pytest

from server.platform.searching import fold


@pytest.mark.parametrize(
    ("typed", "stored"),
    [
        ("öõäü", "ÖÕÄÜ"),
        ("O\u0308", "ö"),
        ("STRASSE", "Straße"),
        ("e", "É"),
        ("fin", "ﬁn"),
        ("ΣΑΣ", "σας"),
        ("ёж", "ЁЖ"),
        ("海龟", "海龟"),
    ],
)
def test_what_a_person_types_is_found(typed: str, stored: str) -> None:
    assert fold(typed) in fold(stored)


def test_other_letters_and_vowel_signs_are_not_the_same() -> None:
    assert fold("д") != fold("d")
    assert fold("की") != fold("का")
