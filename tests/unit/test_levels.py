"""Which build of the kernels a wheel with several of them loads."""

from pathlib import Path

import pytest

import rdpm
from rdpm import _core
from rdpm.errors import CaseError
from rdpm.parallel.levels import ASKED, choose_level, kernel_folder, processor_flags

V3 = ASKED["x86-64-v2"] | ASKED["x86-64-v3"]
V4 = V3 | ASKED["x86-64-v4"]
BUILT = ("x86-64", "x86-64-v3", "x86-64-v4")


def a_package(folder: Path, levels=BUILT) -> Path:
    for level in levels:
        (folder / "levels" / level).mkdir(parents=True)
    return folder


@pytest.mark.parametrize(
    ("flags", "level"),
    [(V4, "x86-64-v4"), (V3, "x86-64-v3"), (V3 - {"fma"}, "x86-64"), (V4 - {"avx2"}, "x86-64"), ((), "x86-64")],
)
def test_the_highest_level_that_the_processor_has_whole_is_taken(flags, level) -> None:
    assert choose_level(BUILT, flags) == level


def test_a_lower_level_may_be_asked_for() -> None:
    assert choose_level(BUILT, V4, "x86-64-v3") == "x86-64-v3"


@pytest.mark.parametrize(
    ("asked", "reason"),
    [("x86-64-v4", "processor lacks it"), ("x86-64-v2", "not built for it"), ("AVX2", "not built for it")],
)
def test_a_level_that_cannot_run_is_refused(asked, reason) -> None:
    with pytest.raises(CaseError, match=reason) as refused:
        choose_level(BUILT, V3, asked)
    assert "must be one of x86-64, x86-64-v3" in str(refused.value)


def test_a_processor_below_every_level_is_told_so() -> None:
    with pytest.raises(CaseError, match="has kernels for x86-64-v4 only"):
        choose_level(["x86-64-v4"], V3)


def test_the_folder_follows_the_processor_and_the_wish(tmp_path, monkeypatch) -> None:
    package = a_package(tmp_path)
    monkeypatch.delenv("RDPM_SIMD", raising=False)
    assert kernel_folder(package) == package / "levels" / choose_level(BUILT, processor_flags())
    monkeypatch.setenv("RDPM_SIMD", "x86-64")
    assert kernel_folder(package) == package / "levels/x86-64"


def test_a_wish_is_refused_where_there_is_one_build(tmp_path, monkeypatch) -> None:
    monkeypatch.setenv("RDPM_SIMD", "x86-64")
    with pytest.raises(CaseError, match="built once"):
        kernel_folder(tmp_path)


def test_flags_are_those_of_the_list_of_the_system(tmp_path) -> None:
    (tmp_path / "cpuinfo").write_text("processor : 0\nflags\t\t: fpu avx2 fma\nprocessor : 1\nflags : fpu\n")
    assert processor_flags(tmp_path / "cpuinfo") == {"fpu", "avx2", "fma"}


def test_the_kernels_say_what_they_were_built_for() -> None:
    build = _core.build_info()
    assert build["level"] in {"native", *ASKED}
    assert Path(_core.__file__).is_relative_to(Path(rdpm.__file__).parent)
