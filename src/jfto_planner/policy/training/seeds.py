"""Random numbers of one step of one worker: a function of these alone, so that a run that is
resumed draws what the run that was killed would have drawn.
"""

from __future__ import annotations

import torch

# Streams of random numbers that must not meet.
TRAINING, EVALUATION, TEACHER, HELD_OUT = range(4)


def generator_of(seed: int, stream: int, number: int, rank: int = 0) -> torch.Generator:
    """Generator of one step, evaluation or shard."""
    mixed = ((seed * 4 + stream) * 1_000_003 + number) * 64 + rank
    return torch.Generator().manual_seed(mixed % 2**63)


def between(limits: tuple[int, int], generator: torch.Generator) -> int:
    """Whole number drawn from a closed range."""
    return int(torch.randint(limits[0], limits[1] + 1, (1,), generator=generator))
