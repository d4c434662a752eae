"""A supervised process ends when its supervisor does, however that ends."""

from __future__ import annotations

import ctypes
import os
import signal
import sys

# Set by the supervisor to its own process number.
SUPERVISOR = "JFTO_SUPERVISOR"
_PR_SET_PDEATHSIG = 1


def die_with_parent() -> None:
    """Ask the kernel for SIGTERM when the supervisor is gone; nothing where there is none.

    Only Linux can do this; elsewhere nodes of a killed supervisor have to be stopped by hand.
    """
    supervisor = os.environ.get(SUPERVISOR, "")
    if not supervisor or not sys.platform.startswith("linux"):
        return
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)
    if str(os.getppid()) != supervisor:
        # It died before the kernel was asked.
        sys.exit("The supervisor is gone.")
