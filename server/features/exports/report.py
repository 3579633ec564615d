"""The report: a session's figures and charts as one HTML file, as the page's comparison shows them."""

from typing import BinaryIO

from server.features.comparison.schemas import DEFAULT_SIGNALS, ComparisonQuery
from server.features.exports.selection import ExportSelection
from server.platform.store import Reader

POINTS = 2000
"""Columns of a chart; each has its least and its most value."""


def write_session_report(store: Reader, source: ExportSelection, output: BinaryIO) -> None:
    """The report of a whole session. Raises StoreError, RecordingError."""
    from server.features.comparison.comparer import Comparer  # NumPy and Plotly, only for this format
    from server.features.comparison.report import write_report

    assert source.row.id is not None
    query = ComparisonQuery(sessions=[source.row.id], signals=list(DEFAULT_SIGNALS), points=POINTS)
    output.write(write_report(Comparer(store).compare(query)).encode())
