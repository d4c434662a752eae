"""The array types that signatures of all rooms name; docstrings give shapes and units."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]
AnyArray = NDArray[Any]

# Height z of the ground at (x, y), ENU metres, of one shape.
GroundHeight = Callable[[Array, Array], Array]
