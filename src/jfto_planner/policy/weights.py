"""The trained weights that ship with the package: safetensors, checked by hash, never a pickle."""

from __future__ import annotations

import hashlib
import json
from importlib import resources
from pathlib import Path

from safetensors import SafetensorError
from safetensors.torch import load, save

from jfto_msgs_py.errors import InputError
from jfto_planner.policy.model import Policy, PolicyShape

NAME = "rl_tp.safetensors"
HASH_SUFFIX = ".sha256"


def save_weights(policy: Policy, path: Path) -> str:
    """Write weights and, beside them, their SHA-256; both appear whole or not at all."""
    data = save(
        {key: value.detach().cpu().contiguous() for key, value in policy.state_dict().items()},
        metadata={"shape": json.dumps(vars(policy.shape), sort_keys=True)},
    )
    digest = hashlib.sha256(data).hexdigest()
    for target, content in ((path, data), (_hash_path(path), f"{digest}\n".encode())):
        draft = target.with_name(target.name + ".tmp")
        draft.write_bytes(content)
        draft.replace(target)
    return digest


def load_weights(path: Path | None = None) -> Policy:
    """Policy with the shipped weights, or those of a file, ready for inference.

    Raises InputError if the file is missing, was changed, or holds no policy.
    """
    path = path or Path(str(resources.files("jfto_planner") / "weights" / NAME))
    try:
        data = path.read_bytes()
        expected = _hash_path(path).read_text().strip()
    except OSError as error:
        raise InputError(f"{path}: cannot read the weights or their hash ({error}).") from error
    digest = hashlib.sha256(data).hexdigest()
    if digest != expected:
        raise InputError(
            f"{path}: SHA-256 is {digest[:12]}…, expected {expected[:12]}…; "
            "the file is damaged or was replaced. Install it again."
        )
    try:
        tensors = load(data)
        header = json.loads(data[8 : 8 + int.from_bytes(data[:8], "little")])
        policy = Policy(PolicyShape(**json.loads(header["__metadata__"]["shape"])))
        policy.load_state_dict(tensors)
    except (SafetensorError, KeyError, TypeError, ValueError, RuntimeError) as error:
        raise InputError(f"{path}: holds no RL-TP policy ({error}).") from error
    return policy.eval()


def _hash_path(path: Path) -> Path:
    return path.with_name(path.name + HASH_SUFFIX)
