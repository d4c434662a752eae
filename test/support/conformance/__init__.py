"""Replaying recordings of a real autopilot against the simulator, and comparing the answers."""

from support.conformance.compare import Score, compare
from support.conformance.recording import Recording, read_recording
from support.conformance.replay import replay

__all__ = ["Recording", "Score", "compare", "read_recording", "replay"]
