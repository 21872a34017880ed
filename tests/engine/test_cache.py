"""The folder of compiled kernels: what is in it is run, so it is the user's own or it is not used."""

from __future__ import annotations

import errno
import gc
import os
import weakref
from functools import partial

import pytest

from stickslip.engine import cache, trust
from stickslip.engine.kernel_text import KernelSource


def source(n=2):
    """A kernel with one function, a number over another."""
    return KernelSource(f"@typed(float64(float64))\ndef part(x):\n    return x / {float(n)}\n", {"part": "float64(float64)"})


def half():
    """What a kernel gives that is loaded, or compiled."""
    return cache.load(source(), "half", "a test")["part"](3.0)


def test_a_folder_that_cannot_be_written_compiles_in_memory(tmp_path, monkeypatch, capfd):
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    monkeypatch.setenv("STICKSLIP_CACHE_DIR", str(blocked))
    assert half() == 1.5
    assert "in memory" in capfd.readouterr().err


@pytest.fixture
def unsafe_place(tmp_path, monkeypatch):
    """A cache folder to be spoilt; the private one lies beside it."""
    monkeypatch.setattr(trust.tempfile, "tempdir", str(tmp_path))
    monkeypatch.setattr(cache, "_reported", set())
    monkeypatch.setattr(cache, "_loaded", {})
    trust.private_folder.cache_clear()
    place = tmp_path / "kernels"
    place.mkdir()
    monkeypatch.setenv("STICKSLIP_CACHE_DIR", str(place))
    yield place
    trust.private_folder.cache_clear()


@pytest.mark.skipif(os.name == "nt", reason="folders have no mode on Windows")
@pytest.mark.parametrize("spoilt", [".", ".."])
def test_a_cache_folder_that_everybody_may_write_is_not_used(unsafe_place, spoilt, capfd):
    (unsafe_place / spoilt).chmod(0o777)
    assert half() == 1.5
    assert not list(unsafe_place.iterdir())
    place = cache.folder()
    assert place != unsafe_place and place.stat().st_mode & 0o077 == 0 and list(place.glob("half_*.kernel"))
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
            assert half() == 1.5
    finally:
        os.umask(before)
    assert capfd.readouterr().err == "compiling a test, once …\n"


@pytest.mark.skipif(os.name == "nt" or os.getuid() != 0, reason="only root can give a file to another user")
def test_what_another_user_has_put_into_the_cache_is_deleted_and_not_run(unsafe_place, monkeypatch, capfd):
    half()
    planted = list(unsafe_place.iterdir())
    for file in planted:
        os.chown(file, 4243, -1)
    monkeypatch.setattr(cache, "_loaded", {})
    monkeypatch.setattr(cache, "_reported", set())
    assert half() == 1.5
    assert capfd.readouterr().err == 2 * "compiling a test, once …\n"
    assert len(planted) == 1 and {file.stat().st_uid for file in unsafe_place.iterdir()} == {0}


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
        return half()

    assert load() == 1.5
    return tmp_path, load


def _file_of(place):
    (file,) = place.iterdir()
    return file


def _cut_short(file):
    file.write_bytes(file.read_bytes()[:-9])


@pytest.mark.parametrize("damage", [*(partial(_flip, place=at) for at in (0.0, 0.1, 0.5, 1.0)), lambda f: f.write_bytes(b""), _cut_short])
def test_damaged_code_is_compiled_again_and_not_run(compiled_half, damage, capfd):
    folder, load = compiled_half
    sound = _file_of(folder).read_bytes()
    damage(_file_of(folder))
    capfd.readouterr()
    assert load() == 1.5
    assert "is damaged; compiling a test again" in capfd.readouterr().err
    assert _file_of(folder).read_bytes() == sound
    assert load() == 1.5 and capfd.readouterr().err == ""


@pytest.mark.parametrize("damage", [_as_folder, _as_link])
def test_whatever_stands_where_a_kernel_should_be_gives_way_to_it(compiled_half, damage, capfd):
    folder, load = compiled_half
    damage(_file_of(folder))
    assert load() == 1.5
    capfd.readouterr()
    assert load() == 1.5 and capfd.readouterr().err == "", "and only once"
    assert _file_of(folder).is_file()


def test_a_folder_with_something_in_it_is_left_alone_and_named(compiled_half, capfd):
    folder, load = compiled_half
    blocked = _file_of(folder)
    _as_full_folder(blocked)
    for _ in range(2):
        capfd.readouterr()
        assert load() == 1.5
        said = capfd.readouterr().err
        assert f"{blocked} is a folder where a file should be; delete it" in said and "in memory" in said
    assert (blocked / "something").read_text() == "of somebody"


def test_a_disk_that_is_full_still_gives_the_kernel(tmp_path, monkeypatch, capfd):
    monkeypatch.setenv("STICKSLIP_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(cache, "_loaded", {})
    monkeypatch.setattr(cache, "_reported", set())

    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "a file")

    monkeypatch.setattr(cache, "write_whole", full)
    assert half() == 1.5
    assert "cannot be written (No space left on device); compiling a test in memory" in capfd.readouterr().err
    assert half() == 1.5 and not list(tmp_path.iterdir()) and capfd.readouterr().err == "", "it is compiled once"


def test_kernels_that_were_not_used_for_long_are_let_go_and_are_not_compiled_again(tmp_path, monkeypatch, capfd):
    monkeypatch.setenv("STICKSLIP_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(cache, "_loaded", {})
    monkeypatch.setattr(cache, "KEPT", 3)
    monkeypatch.setattr(cache, "_reported", set())
    sources = [source(n) for n in range(1, 7)]
    for _ in range(2):
        kernels = [cache.load(each, "part", each.digest) for each in sources]
        assert [kernel["part"](60.0) for kernel in kernels] == [60.0 / n for n in range(1, 7)]
        assert len(cache._loaded) == 3
    assert capfd.readouterr().err.count("compiling") == 6
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
    sources = [source(n) for n in (3, 4, 5)]
    first = [cache.load(each, "memory", "a test") for each in sources]
    assert [cache.load(each, "memory", "a test") for each in sources] == first


def test_compiled_functions_are_freed_with_the_last_who_holds_one(tmp_path, monkeypatch):
    """One is let go while somebody holds it, who may still call it; one that nobody holds is freed."""
    monkeypatch.setenv("STICKSLIP_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(cache, "_loaded", {})
    monkeypatch.setattr(cache, "KEPT", 1)
    held, *rest = (cache.load(source(n), "held", "a test")["part"] for n in (2, 3, 4))
    freed = weakref.ref(rest[0]._code)
    rest.clear()
    gc.collect()
    assert held(3.0) == 1.5 and freed() is None
