"""Replaying recordings of a real autopilot against the simulator, and comparing the answers."""

from jfto_sim.conformance.compare import Score, compare
from jfto_sim.conformance.recording import Recording, read_recording
from jfto_sim.conformance.replay import replay

__all__ = ["Recording", "Score", "compare", "read_recording", "replay"]
