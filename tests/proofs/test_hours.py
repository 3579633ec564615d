"""Twenty minutes of `make hours`."""

from pathlib import Path

from tests.proofs.hours import Hours


def test_a_long_recording_is_whole_and_its_end_is_read_right(tmp_path: Path) -> None:
    report = Hours(tmp_path, 1200.0).run()
    assert report.problems == []
    assert report.samples > 300_000
