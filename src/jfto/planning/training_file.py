"""Training configurations on disk."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import yaml

from jfto_msgs_py.errors import InputError

if TYPE_CHECKING:
    from jfto_planner.policy.training.config import TrainingConfig


def read_training(path: Path) -> TrainingConfig:
    """Settings of a training run; raises InputError naming file, key and reason."""
    try:
        values = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read ({error}).") from error
    except yaml.YAMLError as error:
        raise InputError(f"{path}: is not YAML: {error}") from error
    if not isinstance(values, dict):
        raise InputError(f"{path}: holds no keys; config/train_rl_tp.yaml is an example.")

    from jfto_planner.policy.training.config import from_dict

    try:
        return from_dict(values)
    except (InputError, TypeError) as error:
        raise InputError(f"{path}: {error}") from error
