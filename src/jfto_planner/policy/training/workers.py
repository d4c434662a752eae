"""Data parallel training over the processes that torchrun starts."""

from __future__ import annotations

import os

import torch
from torch import distributed
from torch.nn import Module


class Workers:
    """One process among its equals; alone unless torchrun's environment says otherwise."""

    def __init__(self) -> None:
        self.count = int(os.environ.get("WORLD_SIZE", "1"))
        self.rank = int(os.environ.get("RANK", "0"))
        if self.count > 1 and not distributed.is_initialized():
            distributed.init_process_group("nccl" if torch.cuda.is_available() else "gloo")

    def average_gradients(self, module: Module) -> None:
        """Replace every gradient by its mean over all workers, in one exchange."""
        if self.count == 1:
            return
        gradients = [p.grad for p in module.parameters() if p.grad is not None]
        flat = torch.cat([gradient.flatten() for gradient in gradients])
        distributed.all_reduce(flat)
        flat /= self.count
        for gradient, part in zip(
            gradients, flat.split([g.numel() for g in gradients]), strict=True
        ):
            gradient.copy_(part.view_as(gradient))

    def share_buffers(self, module: Module) -> None:
        """Give every worker the first one's running statistics, so that all judge alike."""
        if self.count == 1:
            return
        for buffer in module.buffers():
            distributed.broadcast(buffer, src=0)
