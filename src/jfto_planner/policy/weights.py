"""The trained weights that ship with the package: safetensors, checked by hash, never a pickle."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from importlib import resources
from pathlib import Path

import numpy as np
from safetensors import SafetensorError
from safetensors.numpy import load, save

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.types import AnyArray
from jfto_planner.policy.compiled_policy import CompiledPolicy, PolicyShape

NAME = "rl_tp.safetensors"
HASH_SUFFIX = ".sha256"


def save_weights(weights: Mapping[str, AnyArray], shape: PolicyShape, path: Path) -> str:
    """Write weights and, beside them, their SHA-256; both appear whole or not at all."""
    data = save(
        {key: np.array(value, order="C") for key, value in weights.items()},
        metadata={"shape": json.dumps(vars(shape), sort_keys=True)},
    )
    digest = hashlib.sha256(data).hexdigest()
    for target, content in ((path, data), (_hash_path(path), f"{digest}\n".encode())):
        draft = target.with_name(target.name + ".tmp")
        draft.write_bytes(content)
        draft.replace(target)
    return digest


def load_weights(path: Path | None = None) -> CompiledPolicy:
    """Policy with the shipped weights, or those of a file.

    Raises InputError if the file is missing, was changed, or holds no policy.
    """
    path = path or Path(str(resources.files("jfto_planner") / "weights" / NAME))
    try:
        data = path.read_bytes()
        expected = _hash_path(path).read_text().strip()
    except OSError as error:
        raise InputError(
            f"{path}: cannot read the weights or their hash ({error}). Install JFTO again, or plan "
            "with --method search."
        ) from error
    digest = hashlib.sha256(data).hexdigest()
    if digest != expected:
        raise InputError(
            f"{path}: SHA-256 is {digest[:12]}…, expected {expected[:12]}…; "
            "the file is damaged or was replaced. Install it again."
        )
    try:
        weights = load(data)
        header = json.loads(data[8 : 8 + int.from_bytes(data[:8], "little")])
        shape = PolicyShape(**json.loads(header["__metadata__"]["shape"]))
        return CompiledPolicy(weights, shape)
    except (SafetensorError, KeyError, TypeError, ValueError) as error:
        raise InputError(f"{path}: holds no RL-TP policy ({error}).") from error


def _hash_path(path: Path) -> Path:
    return path.with_name(path.name + HASH_SUFFIX)
