"""Shipping weights."""

from __future__ import annotations

import pickle
from importlib import resources
from pathlib import Path

import numpy as np
import pytest

from jfto_msgs_py.errors import InputError
from jfto_planner.policy.network.model import Policy, arrays_of
from jfto_planner.policy.weights import NAME, load_weights, save_weights
from support.policy_cases import SMALL, instances


def test_weights_survive_the_file(tmp_path) -> None:
    """What was saved decides exactly as before."""
    policy = Policy(SMALL).eval()
    save_weights(arrays_of(policy), SMALL, tmp_path / "w.safetensors")
    batch = instances(2, 7, 4)
    loaded = load_weights(tmp_path / "w.safetensors")
    expected = policy(batch).choices.numpy()
    assert np.array_equal(loaded.roll_out(batch.numpy()).choices, expected)


def test_a_changed_file_is_refused(tmp_path) -> None:
    """One flipped bit is enough."""
    path = tmp_path / "w.safetensors"
    save_weights(arrays_of(Policy(SMALL)), SMALL, path)
    data = bytearray(path.read_bytes())
    data[-1] ^= 1
    path.write_bytes(bytes(data))
    with pytest.raises(InputError, match="damaged"):
        load_weights(path)


def test_a_pickle_is_never_loaded(tmp_path) -> None:
    """A pickle is no policy, even with a matching hash; nothing in it runs."""
    import hashlib

    path = tmp_path / "w.safetensors"
    path.write_bytes(pickle.dumps({"weights": 1}))
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    path.with_name(path.name + ".sha256").write_text(digest)
    with pytest.raises(InputError, match="no RL-TP policy"):
        load_weights(path)


def test_a_missing_file_is_named(tmp_path) -> None:
    """The path is in the message."""
    with pytest.raises(InputError, match=r"absent\.safetensors"):
        load_weights(tmp_path / "absent.safetensors")


def test_the_shipped_weights_are_whole_and_small() -> None:
    """They load, fit their hash and take at most 8 MB."""
    path = Path(str(resources.files("jfto_planner") / "weights" / NAME))
    assert path.stat().st_size <= 8_000_000
    assert load_weights().shape.width == 128
