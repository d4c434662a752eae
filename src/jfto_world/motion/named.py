"""Time models by the name and parameters that a plan carries."""

from __future__ import annotations

from collections.abc import Mapping

from jfto_msgs_py.errors import InputError
from jfto_world.motion.time_model import ConstantSpeed, TimeModel

NAMES = ("arducopter", "constant_speed")


def time_model_named(name: str, parameters: Mapping[str, float] | None = None) -> TimeModel:
    """Return the time model of a name.

    Parameters
    ----------
    name
        As plans give it.
    parameters
        Those that the model gave as its `parameters()`, less any that have their defaults.

    Returns
    -------
    TimeModel
        The model.

    Raises
    ------
    InputError
        Lists the known names.
    """
    given = dict(parameters or {})
    if name == "constant_speed":
        if given:
            raise InputError(f"time_parameters has {sorted(given)[0]}, constant_speed takes none.")
        return ConstantSpeed()
    if name == "arducopter":
        # Loaded here: its compiler takes a second, which constant speed need not pay.
        from jfto_world.motion.arducopter import ArduCopter

        return ArduCopter.of_parameters(given)
    raise InputError(f"time_model is {name!r}, must be one of {', '.join(NAMES)}.")
