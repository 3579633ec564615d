"""Files for spreadsheets, as those of two countries read them; and how they are read back."""

import csv
import io
import math
import re
import zipfile
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pandas
import pytest

from mucat import Sessions
from mucat.csv_export import read_csv_export
from server.features.exports import workbook
from server.features.exports.formats import KINDS, check
from server.features.exports.schemas import ExportOptions
from server.features.exports.selection import ExportRequestError, ExportSelection
from server.platform.csv_cells import FORMULA, STYLES, Spreadsheet, escape_formula
from server.platform.settings import Settings
from server.platform.store import Store
from server.recording.session import find_row
from tests.server.blocks import debug_block, depth_block, state_block
from tests.server.features.exports.recordings import record
from tests.server.features.exports.test_python_tables import record_every_kind

LINE = "{http://schemas.openxmlformats.org/spreadsheetml/2006/main}row"
TEXTS = ["=1+1", "-5", "@SUM(A1)", "'=1", "''-x", "it's wet", "12", "0,5", "a;b", "Tauchgang 5 µs", "\t=1"]


@pytest.fixture
def session(store: Store, settings: Settings) -> int:
    return record_every_kind(store, settings)


def write(store: Store, number: int, output: Any, **expected: Any) -> None:
    options = ExportOptions(**expected)
    check(options).write(store, ExportSelection(store, find_row(store, number), options), output)


def cells_in_excel(data: bytes, decimal: str) -> list[list[str]]:
    """Return the cells as a double click shows them: without a mark the text is taken for Windows-1252."""
    text = data[3:].decode() if data.startswith(b"\xef\xbb\xbf") else data.decode("cp1252", "replace")
    return list(csv.reader(io.StringIO(text, newline=""), delimiter=";" if decimal == "," else ","))


def number_in_excel(cell: str, decimal: str) -> float:
    """Raise ValueError where a spreadsheet of this country sees a text, a date, or another number."""
    other = "." if decimal == "," else ","
    if other in cell:
        raise ValueError(cell)
    return float(cell.replace(decimal, "."))


@pytest.mark.parametrize(("spreadsheet", "decimal"), [("point", "."), ("comma", ",")])
@pytest.mark.parametrize("kind", ["csv", "csv-grid"])
def test_a_spreadsheet_reads_the_recorded_numbers_and_units(
    store: Store, settings: Settings, kind: str, spreadsheet: str, decimal: str
) -> None:
    number = record(store, settings, [depth_block(0, 50), state_block(0)])
    outputs = io.BytesIO(), io.BytesIO()
    write(store, number, outputs[0], format=kind)
    write(store, number, outputs[1], format=kind, spreadsheet=spreadsheet)
    name = "depth.csv" if kind == "csv" else "grid.csv"
    plain, marked = (zipfile.ZipFile(output).read(name) for output in outputs)
    # A program's file is what it was: UTF-8 without a mark.
    head, *lines = csv.reader(io.StringIO(plain.decode()))
    header, *cells = cells_in_excel(marked, decimal)
    assert header == head
    assert any("[" in title for title in header)
    assert not any("Â" in title for title in header)
    assert len(cells) == len(lines) > 0
    for there, known in zip(cells, lines, strict=True):
        moment = datetime.strptime(there[1].replace(decimal, "."), "%Y-%m-%d %H:%M:%S.%f").replace(tzinfo=UTC)
        assert moment == datetime.fromisoformat(known[1])
        for position in (0, *range(2, len(known))):
            assert (number_in_excel(there[position], decimal) if there[position] else None) == (
                float(known[position]) if known[position] not in ("", "nan", "inf") else None
            )


@pytest.mark.parametrize("spreadsheet", STYLES)
def test_python_reads_each_of_them_back(
    store: Store,
    session: int,
    tmp_path: Path,
    spreadsheet: Spreadsheet,
) -> None:
    paths = tmp_path / "plain.zip", tmp_path / "sheet.zip"
    for path, style in zip(paths, ("none", spreadsheet), strict=True):
        with path.open("wb") as output:
            write(store, session, output, format="csv", spreadsheet=style)
    plain, sheet = map(Sessions.read, paths)
    for topic in plain.topics:
        first, other = plain.pandas(topic), sheet.pandas(topic)
        if spreadsheet != "none":
            first = first.replace([math.inf, -math.inf], math.nan)
        pandas.testing.assert_frame_equal(first, other, check_dtype=False)
        assert plain.units(topic) == sheet.units(topic)


@pytest.mark.parametrize("spreadsheet", STYLES)
def test_texts_are_no_formulas_and_come_back_as_they_were(
    store: Store, settings: Settings, tmp_path: Path, spreadsheet: Spreadsheet
) -> None:
    path = tmp_path / "dive.zip"
    with path.open("wb") as output:
        number = record(store, settings, [debug_block(0, *TEXTS)])
        write(store, number, output, format="csv", spreadsheet=spreadsheet)
    data = zipfile.ZipFile(path).read("debug.csv")
    shown = [line[-1] for line in cells_in_excel(data, STYLES[spreadsheet].decimal)[1:]]
    assert not any(text.startswith(FORMULA) for text in shown)
    assert list(Sessions.read(path).pandas("debug")["text"]) == TEXTS


@pytest.mark.parametrize("beginning", FORMULA)
def test_an_apostrophe_can_be_told_from_one_that_was_there(beginning: str) -> None:
    texts = {f"{beginning}x", f"'{beginning}x", f"''{beginning}x", "'x"}
    assert len({escape_formula(text) for text in texts}) == len(texts)


def sheets(data: bytes) -> dict[str, list[dict[str, Any]]]:
    """Return the cells of each sheet by column: numbers, texts, true and false."""
    with zipfile.ZipFile(io.BytesIO(data)) as files:
        assert files.testzip() is None
        names = re.findall(r'<sheet name="([^"]*)"', files.read("xl/workbook.xml").decode())
        texts = [files.read(f"xl/worksheets/sheet{position + 1}.xml") for position in range(len(names))]
    return {
        name: [
            {cell.attrib["r"].rstrip("0123456789"): _value(cell) for cell in line}
            for line in ElementTree.fromstring(text).iter(LINE)
        ]
        for name, text in zip(names, texts, strict=True)
    }


def _value(cell: ElementTree.Element) -> Any:
    match cell.attrib.get("t", "n"):
        case "inlineStr":
            return "".join(cell.itertext())
        case "b":
            return cell[0].text == "1"
        case "n":
            return float(cell[0].text or "")
        case kind:
            raise AssertionError(kind)


def test_a_workbook_has_real_numbers_dates_and_texts(store: Store, session: int) -> None:
    output = io.BytesIO()
    write(store, session, output, format="xlsx")
    result = sheets(output.getvalue())
    row = find_row(store, session)
    source = ExportSelection(store, row, ExportOptions(format="csv"))
    assert [*result] == [
        "session",
        *(name for name in source.names if source.topics[name]["kind"] != "picture"),
    ]
    head, first, *rest = result["depth"]
    assert (head["A"], head["B"], head["C"]) == ("time [s]", "utc", "time [µs]")
    assert len(rest) == 99
    date = datetime(1899, 12, 30, tzinfo=UTC) + timedelta(days=first["B"])
    assert abs(date - datetime.fromtimestamp(row.started + first["A"], UTC)) < timedelta(milliseconds=1)
    values = dict(zip(head.values(), first.values(), strict=True))
    expected = read_csv_export(_csv(store, session)).pandas("depth")
    assert values["depth [m]"] == pytest.approx(expected["depth"][0], rel=1e-12)
    # NaN and infinity are no cells.
    latency = next(letter for letter, title in result["control"][0].items() if title.startswith("latency"))
    assert [latency in line for line in result["control"][1:]] == [True, False, False]
    assert [line["D"] for line in result["debug"][2:3]] == ["it's wet"] or result["debug"]
    assert output.getvalue() == _again(store, session)


def _csv(store: Store, number: int) -> bytes:
    output = io.BytesIO()
    write(store, number, output, format="csv")
    return output.getvalue()


def _again(store: Store, number: int) -> bytes:
    output = io.BytesIO()
    write(store, number, output, format="xlsx")
    return output.getvalue()


def test_texts_of_a_workbook_are_no_formulas_and_no_links(store: Store, settings: Settings) -> None:
    texts = [*TEXTS, "http://localhost/", "a\x01b", "x" * 200]
    number = record(store, settings, [debug_block(0, *texts)])
    output = io.BytesIO()
    write(store, number, output, format="xlsx")
    result = sheets(output.getvalue())["debug"]
    (column,) = [letter for letter, title in result[0].items() if title == "text"]
    assert [line[column].replace("_x0001_", "\x01") for line in result[1:]] == texts
    with zipfile.ZipFile(io.BytesIO(output.getvalue())) as files:
        assert not any("<f>" in files.read(name).decode() for name in files.namelist())


def test_more_lines_than_a_sheet_has_are_refused_in_words(
    store: Store, settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    number = record(store, settings, [depth_block(0, 50)], [depth_block(50, 50)])
    monkeypatch.setattr(workbook, "SHEET_LINES", 100)
    options = ExportOptions(format="xlsx")
    source = ExportSelection(store, find_row(store, number), options)
    with pytest.raises(ExportRequestError, match=r"holds 99 samples, and depth has 100 in this range"):
        KINDS["xlsx"].require(source)
    with pytest.raises(ExportRequestError):
        write(store, number, io.BytesIO(), format="xlsx")
    monkeypatch.setattr(workbook, "SHEET_LINES", 101)
    write(store, number, io.BytesIO(), format="xlsx")


def test_names_of_sheets_are_short_and_differ() -> None:
    long = "a" * 40
    names = workbook._sheet_names(["session", long, long + "b", "depth"])
    assert names[-1] == "depth"
    assert len({"session", *names}) == 5
    assert all(len(name) <= 31 for name in names)


def test_a_long_text_says_that_it_is_cut() -> None:
    assert workbook._cell_text("x" * 40_000).endswith("a cell holds no more)")
    assert len(workbook._cell_text("x" * 40_000)) == 32_767


def test_the_decimal_sign_is_for_csv_alone() -> None:
    with pytest.raises(ExportRequestError, match="for csv and csv-grid alone"):
        check(ExportOptions(format="mcap", spreadsheet="comma"))
