"""Keys on disk."""

from __future__ import annotations

import hashlib

import pytest

from jfto_mavlink.errors import SigningError
from jfto_mavlink.link.key_file import StampFile, create_key, read_key


def test_a_key_file_is_private_and_gives_its_key_back(tmp_path):
    """Mode 0600, 32 random bytes, never the same twice."""
    first, second = tmp_path / "a.key", tmp_path / "b.key"
    create_key(first)
    create_key(second)
    assert first.stat().st_mode & 0o777 == 0o600
    assert len(read_key(first)) == 32
    assert read_key(first) != read_key(second)


def test_a_passphrase_gives_the_key_that_other_stations_make_of_it(tmp_path):
    """SHA-256 of the text, as Mission Planner and MAVProxy do."""
    create_key(tmp_path / "k", "test key one")
    assert read_key(tmp_path / "k") == hashlib.sha256(b"test key one").digest()


def test_a_key_that_others_may_read_is_refused(tmp_path):
    """The message says what to run."""
    path = tmp_path / "k"
    create_key(path)
    path.chmod(0o640)
    with pytest.raises(SigningError, match="chmod 600"):
        read_key(path)


def test_an_existing_key_is_not_overwritten(tmp_path):
    """A key may be the only copy."""
    create_key(tmp_path / "k")
    with pytest.raises(SigningError, match="cannot be created"):
        create_key(tmp_path / "k")


@pytest.mark.parametrize("text", ["", "12ab", "00" * 32, "zz" * 32, "é"])
def test_a_bad_key_is_refused_without_showing_it(tmp_path, text):
    """Not even a wrong key stands in a message."""
    path = tmp_path / "k"
    path.write_text(text, encoding="utf-8")
    path.chmod(0o600)
    with pytest.raises(SigningError) as caught:
        read_key(path)
    assert not text or text not in str(caught.value)


def test_the_stamp_survives(tmp_path):
    """Saved stamps are read back; none is 0; nonsense is an error."""
    stamps = StampFile(tmp_path / "k")
    assert stamps.load() == 0
    stamps.save(123)
    stamps.save(456)
    assert StampFile(tmp_path / "k").load() == 456
    stamps.path.write_text("nonsense")
    with pytest.raises(SigningError, match="cannot be read"):
        stamps.load()
