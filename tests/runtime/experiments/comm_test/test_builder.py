"""Compilation of the sketch, with the firmware's flags, once for each set of inputs."""

import shutil
import subprocess
from pathlib import Path

import pytest

from robot_runtime.experiments.comm_test import builder as module
from robot_runtime.experiments.comm_test.builder import Builder, SketchBuildError
from tests.board.rig import ROOT
from tests.runtime.experiments.comm_test.conftest import make_test


def makefile_flags(variable: str) -> list[str]:
    command = ["make", "--no-print-directory", "-s", "-C", str(ROOT / "firmware")]
    command += [f"--eval=flags: ; @echo $({variable})", "flags"]
    made = subprocess.run(command, capture_output=True, text=True, check=True)
    return [flag for flag in made.stdout.split() if flag not in ("-MMD", "-MP")]


def test_the_flags_are_those_of_the_firmware() -> None:
    assert makefile_flags("CXX_AVR") == list(module.CXX)
    assert makefile_flags("COMMON") == list(module.COMMON)
    assert makefile_flags("LINK") == list(module.LINK)
    assert makefile_flags("OWN")[:3] == list(module.OWN)


def test_every_parameter_changes_the_product_and_equal_parameters_reuse_it(builder: Builder) -> None:
    first = builder.build(make_test(), 9600, 0.1)
    made = first.elf.stat().st_mtime_ns
    assert builder.build(make_test(name="another", delay=(3.0,)), 9600, 0.1) == first
    assert first.elf.stat().st_mtime_ns == made
    assert first.hex.read_text().startswith(":")
    others = [
        builder.build(make_test(), 2400, 0.1),
        builder.build(make_test(), 9600, 0.0),
        builder.build(make_test(framing="plain"), 9600, 0.1),
        builder.build(make_test(framing="robot"), 9600, 0.1),
        builder.build(make_test(framing="robot"), 2400, 0.1),
        builder.build(make_test(direction="both"), 9600, 0.1),
        builder.build(make_test(from_val=2), 9600, 0.1),
        builder.build(make_test(to_val=100), 9600, 0.1),
    ]
    assert len({product.inputs for product in [first, *others]}) == 9
    assert len({product.hex.read_bytes() for product in [first, *others]}) == 9


def test_another_source_is_another_firmware(
    builder: Builder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sketch = tmp_path / "comm_test"
    sketch.mkdir()
    for path in (module.SKETCHES / "comm_test").iterdir():
        (sketch / path.name).write_bytes(path.read_bytes())
    monkeypatch.setattr(module, "SKETCHES", tmp_path)
    assert Builder(tmp_path / "made").firmware_hash == builder.firmware_hash
    (sketch / "counts.h").write_text("#error broken\n")
    broken = Builder(tmp_path / "made")
    assert broken.firmware_hash != builder.firmware_hash
    with pytest.raises(SketchBuildError, match="broken"):
        broken.build(make_test(), 9600, 0.0)
    assert list((tmp_path / "made").iterdir()) == []


def test_another_library_is_another_firmware(
    builder: Builder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    library = tmp_path / "src"
    shutil.copytree(module.LIBRARY, library)
    monkeypatch.setattr(module, "LIBRARY", library)
    assert Builder(tmp_path / "made").firmware_hash == builder.firmware_hash
    (library / "link/baud.h").write_text("#error broken\n")
    broken = Builder(tmp_path / "made")
    assert broken.firmware_hash != builder.firmware_hash
    with pytest.raises(SketchBuildError, match="broken"):
        broken.build(make_test(framing="robot"), 9600, 0.0)
    broken.build(make_test(framing="plain"), 9600, 0.0)


def test_a_compiler_that_is_not_there_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(SketchBuildError, match="install the package gcc-avr"):
        Builder(tmp_path)
