"""QoS overrides by parameters, which are not supported."""

from __future__ import annotations

from typing import Any


class QoSOverridingOptions:
    """Would let parameters override the QoS of an endpoint."""

    def __init__(self, *_args: Any, **_kwargs: Any) -> None:
        msg = "jfto_dds does not support QoSOverridingOptions: set the QoS in the code"
        raise NotImplementedError(msg)
