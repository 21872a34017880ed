"""The folder of compiled kernels: what is in it is run, so it is the user's own or it is not used."""

from __future__ import annotations

import os
from pathlib import Path

import numba
import pytest

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
    monkeypatch.setattr(cache, "_told", set())
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
    monkeypatch.setattr(cache, "_told", set())
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
