"""The folder of compiled kernels: what is in it is run, so it is the user's own or it is not used."""

from __future__ import annotations

import errno
import gc
import os
import sys
import weakref
from itertools import product
from pathlib import Path

import numba
import pytest
from numba.core.caching import IndexDataCacheFile

from rows import each_row
from stickslip.engine import cache, trust


def test_a_truncated_cache_is_compiled_again(tmp_path, monkeypatch, capfd):
    monkeypatch.setenv("STICKSLIP_CACHE_DIR", str(tmp_path))
    source = 'from numba import njit\n@njit("float64(float64)", cache=CACHE)\ndef double(x):\n    return 2 * x\n'
    assert cache.load(source, "truncated", "a test").double(2.0) == 4.0
    for file in (tmp_path / "__pycache__").glob("*.nb*"):
        file.write_bytes(file.read_bytes()[:10])
    monkeypatch.setattr(cache, "_loaded", {})
    assert cache.load(source, "truncated", "a test").double(3.0) == 6.0
    assert "compiling a test, once" in capfd.readouterr().err


def test_a_folder_that_cannot_be_written_compiles_in_memory(tmp_path, monkeypatch, capfd):
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    monkeypatch.setenv("STICKSLIP_CACHE_DIR", str(blocked))
    source = 'from numba import njit\n@njit("float64(float64)", cache=CACHE)\ndef triple(x):\n    return 3 * x\n'
    assert cache.load(source, "blocked", "a test").triple(2.0) == 6.0
    assert "in memory" in capfd.readouterr().err


_HALF = 'from numba import njit\n@njit("float64(float64)", cache=CACHE)\ndef half(x):\n    return x / 2\n'


@pytest.fixture
def unsafe_place(tmp_path, monkeypatch):
    """A cache folder to be spoilt; the private one lies beside it."""
    monkeypatch.setattr(trust.tempfile, "tempdir", str(tmp_path))
    monkeypatch.setattr(cache, "_reported", set())
    monkeypatch.setattr(cache, "_loaded", {})
    trust.private_folder.cache_clear()
    place = tmp_path / "kernels"
    (place / "__pycache__").mkdir(parents=True)
    monkeypatch.setenv("STICKSLIP_CACHE_DIR", str(place))
    yield place
    trust.private_folder.cache_clear()


@pytest.mark.skipif(os.name == "nt", reason="folders have no mode on Windows")
@pytest.mark.parametrize("spoilt", [".", "__pycache__", ".."])
def test_a_cache_folder_that_everybody_may_write_is_not_used(unsafe_place, spoilt, capfd):
    (unsafe_place / spoilt).chmod(0o777)
    module = cache.load(_HALF, "half", "a test")
    assert module.half(3.0) == 1.5
    assert not list(unsafe_place.glob("*.py"))
    place = cache.folder()
    assert place != unsafe_place and place.stat().st_mode & 0o077 == 0 and place in Path(module.__file__).parents
    told = capfd.readouterr().err
    assert told.count("every user") == 1 and "STICKSLIP_CACHE_SHARED=1" in told


@pytest.mark.skipif(os.name == "nt", reason="folders have no owner on Windows")
def test_a_cache_folder_of_another_user_is_not_used(unsafe_place, monkeypatch, capfd):
    mine = os.geteuid()
    monkeypatch.setattr(trust.os, "geteuid", lambda: mine + 4242)
    monkeypatch.setattr(trust, "_ROOT", -1)  # so that it holds for root too
    place = cache.folder()
    assert place != unsafe_place
    assert "belongs to another user" in capfd.readouterr().err


@pytest.mark.skipif(os.name == "nt", reason="folders have no mode on Windows")
def test_a_shared_cache_folder_is_used_where_sharing_is_meant(unsafe_place, monkeypatch, capfd):
    unsafe_place.chmod(0o777)
    monkeypatch.setenv("STICKSLIP_CACHE_SHARED", "1")
    assert cache.folder() == unsafe_place
    assert capfd.readouterr().err == ""


@pytest.mark.skipif(os.name == "nt", reason="there is no umask on Windows")
@pytest.mark.parametrize("umask", [0o000, 0o002, 0o022, 0o077])
def test_what_the_cache_makes_itself_is_used_again_whatever_the_umask(unsafe_place, umask, monkeypatch, capfd):
    """Two loads with nothing in memory: the second finds what the first compiled."""
    monkeypatch.setenv("STICKSLIP_CACHE_DIR", str(unsafe_place / "new" / "place"))
    before = os.umask(umask)
    try:
        for _ in range(2):
            monkeypatch.setattr(cache, "_loaded", {})
            assert cache.load(_HALF, "half", "a test").half(3.0) == 1.5
    finally:
        os.umask(before)
    assert capfd.readouterr().err == "compiling a test, once …\n"


@pytest.mark.skipif(os.name == "nt" or os.getuid() != 0, reason="only root can give a file to another user")
def test_what_another_user_has_put_into_the_cache_is_deleted_and_not_run(unsafe_place, monkeypatch, capfd):
    cache.load(_HALF, "half", "a test")
    planted = list((unsafe_place / "__pycache__").iterdir())
    for file in planted:
        os.chown(file, 4243, -1)
    monkeypatch.setattr(cache, "_loaded", {})
    monkeypatch.setattr(cache, "_reported", set())
    assert cache.load(_HALF, "half", "a test").half(3.0) == 1.5
    assert capfd.readouterr().err == 2 * "compiling a test, once …\n"
    assert len(planted) >= 2 and {file.stat().st_uid for file in (unsafe_place / "__pycache__").iterdir()} == {0}


def test_numba_s_own_cache_folder_is_not_used_for_kernels(unsafe_place, tmp_path, monkeypatch):
    monkeypatch.setattr(numba.core.config, "CACHE_DIR", str(tmp_path / "elsewhere"))
    assert cache.load(_HALF, "half", "a test").half(3.0) == 1.5
    assert not (tmp_path / "elsewhere").exists() and list((unsafe_place / "__pycache__").glob("*.nbi"))


def test_a_user_without_a_home_has_a_private_cache_folder(unsafe_place, monkeypatch, capfd):
    def homeless():
        raise RuntimeError("Could not determine home directory.")

    for name in ("STICKSLIP_CACHE_DIR", "XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(cache.Path, "home", homeless)
    assert cache.folder() == trust.private_folder()
    assert "no home folder" in capfd.readouterr().err


def test_the_cache_follows_the_environment(tmp_path, monkeypatch):
    monkeypatch.setenv("STICKSLIP_CACHE_DIR", str(tmp_path / "own"))
    assert cache.folder() == tmp_path / "own"
    monkeypatch.delenv("STICKSLIP_CACHE_DIR")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache.folder() == tmp_path / "stickslip"


def _flip(file, place=0.5):
    """One bit of a file, at a part of its length."""
    content = bytearray(file.read_bytes())
    content[int(place * (len(content) - 1))] ^= 4
    file.write_bytes(content)


def _as_folder(file):
    file.unlink()
    file.mkdir()


def _as_full_folder(file):
    _as_folder(file)
    (file / "something").write_text("of somebody")


def _as_link(file):
    file.unlink()
    file.symlink_to("/nowhere/at/all")


@pytest.fixture
def compiled_half(tmp_path, monkeypatch):
    """A cache with one compiled kernel, and how to load it as a new process would."""
    monkeypatch.setenv("STICKSLIP_CACHE_DIR", str(tmp_path))

    def load():
        monkeypatch.setattr(cache, "_loaded", {})
        monkeypatch.setattr(cache, "_reported", set())
        return cache.load(_HALF, "half", "a test").half(3.0)

    assert load() == 1.5
    return tmp_path, load


def _file_of(place, ending):
    (file,) = [file for file in (*place.glob("*.py"), *(place / "__pycache__").iterdir()) if file.name.endswith(ending)]
    return file


@each_row(("ending", "place"), product([".nbc", ".nbi"], [0.1, 0.3, 0.5, 0.7, 0.9, 1.0]))
def test_a_bit_flipped_in_compiled_code_is_compiled_again_and_not_run(compiled_half, ending, place, capfd):
    folder, load = compiled_half
    sound = _file_of(folder, ending).read_bytes()
    _flip(_file_of(folder, ending), place)
    capfd.readouterr()
    assert load() == 1.5
    assert "is damaged; compiling a test again" in capfd.readouterr().err
    assert len(_file_of(folder, ending).read_bytes()) == pytest.approx(len(sound), rel=0.1)
    assert load() == 1.5 and capfd.readouterr().err == ""


@each_row(
    ("ending", "damage"),
    product(
        [".nbc", ".nbi", ".py", ".sums.json"],
        [_as_folder, _as_link, _flip, lambda f: f.write_bytes(b""), lambda f: f.write_bytes(bytes(100))],
    ),
)
def test_whatever_stands_where_a_cache_file_should_be_gives_way_to_it(compiled_half, ending, damage, capfd):
    folder, load = compiled_half
    damage(_file_of(folder, ending))
    assert load() == 1.5
    capfd.readouterr()
    assert load() == 1.5 and capfd.readouterr().err == "", "and only once"
    assert _file_of(folder, ending).is_file()


@pytest.mark.parametrize("ending", [".nbc", ".nbi", ".py"])
def test_a_folder_with_something_in_it_is_left_alone_and_named(compiled_half, ending, capfd):
    folder, load = compiled_half
    blocked = _file_of(folder, ending)
    _as_full_folder(blocked)
    for _ in range(2):
        capfd.readouterr()
        assert load() == 1.5
        told = capfd.readouterr().err
        assert f"{blocked} is a folder where a file should be; delete it" in told and "in memory" in told
    assert (blocked / "something").read_text() == "of somebody"


@pytest.mark.parametrize("damage", [lambda f: f.write_text("a file"), lambda f: f.symlink_to("/nowhere/at/all")])
def test_a_file_where_the_folder_of_compiled_code_should_be_gives_way_to_it(tmp_path, monkeypatch, damage, capfd):
    monkeypatch.setenv("STICKSLIP_CACHE_DIR", str(tmp_path))
    damage(tmp_path / "__pycache__")
    for said in ("compiling a test, once …\n", ""):
        monkeypatch.setattr(cache, "_loaded", {})
        monkeypatch.setattr(cache, "_reported", set())
        assert cache.load(_HALF, "half", "a test").half(3.0) == 1.5
        assert capfd.readouterr().err == said


@each_row("k", range(6))
def test_a_disk_that_is_full_at_the_kth_write_still_gives_the_kernel(tmp_path, monkeypatch, k, capfd):
    """Every file is opened for writing by one of two doors; the k-th opening and all after it fail."""
    monkeypatch.setenv("STICKSLIP_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(cache, "_loaded", {})
    monkeypatch.setattr(cache, "_reported", set())
    count, numbas, ours = iter(range(100)), IndexDataCacheFile._open_for_write, cache.write_whole

    def full(door):
        def opened(*given):
            if next(count) >= k:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "a file")
            return door(*given)

        return opened

    monkeypatch.setattr(IndexDataCacheFile, "_open_for_write", full(numbas))
    monkeypatch.setattr(cache, "write_whole", full(ours))
    assert cache.load(_HALF, "half", "a test").half(3.0) == 1.5
    assert ("in memory" in capfd.readouterr().err) == (k < 3)
    assert not [file for file in tmp_path.rglob("*") if ".tmp." in file.name or file.name.endswith(".part")]
    monkeypatch.undo()
    monkeypatch.setenv("STICKSLIP_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(cache, "_loaded", {})
    assert cache.load(_HALF, "half", "a test").half(3.0) == 1.5, "and what was left behind does no harm"


def test_compiled_code_of_an_earlier_version_is_taken_and_gets_its_checksums(compiled_half, capfd):
    folder, load = compiled_half
    _file_of(folder, ".sums.json").unlink()
    capfd.readouterr()
    assert load() == 1.5 and capfd.readouterr().err == ""
    _flip(_file_of(folder, ".nbc"))
    assert load() == 1.5 and "is damaged" in capfd.readouterr().err


def test_kernels_that_were_not_used_for_long_are_let_go_and_are_not_compiled_again(tmp_path, monkeypatch, capfd):
    monkeypatch.setenv("STICKSLIP_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(cache, "_loaded", {})
    monkeypatch.setattr(cache, "KEPT", 3)
    monkeypatch.setattr(cache, "_reported", set())
    sources = [_HALF.replace("x / 2", f"x / {n}") for n in range(1, 7)]
    for _ in range(2):
        assert [cache.load(source, "part", source[-2]).half(60.0) for source in sources] == [60.0 / n for n in range(1, 7)]
        assert len(cache._loaded) == 3
    here = [name for name in sys.modules if name.startswith("stickslip_kernel_part_")]
    assert len(here) == 3 and capfd.readouterr().err.count("compiling") == 6
    last = cache.load(sources[-1], "part", "a test")
    assert cache.load(sources[-1], "part", "a test") is last
    cache.load(sources[3], "part", "a test")
    cache.load(sources[0], "part", "a test")
    assert cache.load(sources[-1], "part", "a test") is last, "the one that was used last stays"


def test_kernels_without_a_file_stay_as_they_would_be_compiled_again(tmp_path, monkeypatch):
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    monkeypatch.setenv("STICKSLIP_CACHE_DIR", str(blocked))
    monkeypatch.setattr(cache, "_loaded", {})
    monkeypatch.setattr(cache, "KEPT", 1)
    sources = [_HALF.replace("x / 2", f"x / {n}") for n in (3, 4, 5)]
    first = [cache.load(source, "memory", "a test") for source in sources]
    assert [cache.load(source, "memory", "a test") for source in sources] == first


def test_compiled_functions_are_freed_with_the_last_who_holds_one(tmp_path, monkeypatch):
    """One is let go while somebody holds it, who may still call it; one that nobody holds is freed."""
    monkeypatch.setenv("STICKSLIP_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(cache, "_loaded", {})
    monkeypatch.setattr(cache, "KEPT", 1)
    more = '@njit("float64(float64)", cache=CACHE)\ndef more(x):\n    return half(x) + 1.0\n'
    held, *rest = (cache.load(_HALF.replace("x / 2", f"x / {n}") + more, "held", "a test").more for n in (2, 3, 4))
    freed = weakref.ref(rest[0])
    rest.clear()
    gc.collect()
    assert held(3.0) == 2.5 and freed() is None
