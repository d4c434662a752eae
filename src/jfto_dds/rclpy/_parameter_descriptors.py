"""Whether a value fits a parameter's descriptor: type, range, step, read-only."""

from __future__ import annotations

import math
from typing import Any

from rcl_interfaces.msg import SetParametersResult

from .parameter import Parameter

PARAM_REL_TOL = 1e-6


def _refuse(reason: str) -> Any:
    return SetParametersResult(successful=False, reason=reason)


def apply_descriptor(
    parameter: Parameter, descriptor: Any, *, declared: bool, check_read_only: bool
) -> Any:
    """Check a parameter against a descriptor, which takes over its name and dynamic type.

    A range is only looked at where the value's type fits it, as in rclpy.
    """
    descriptor.name = parameter.name
    kind = parameter.type_
    if check_read_only and descriptor.read_only:
        return _refuse(f"Trying to set a read-only parameter: {parameter.name}.")
    if descriptor.dynamic_typing:
        descriptor.type = kind.value
    elif declared and kind is Parameter.Type.NOT_SET:
        return _refuse("Static parameter cannot be undeclared")
    elif kind is not Parameter.Type.NOT_SET and kind.value != descriptor.type:
        expected = Parameter.Type(descriptor.type)
        return _refuse(f"Wrong parameter type, expected '{expected}' got '{kind}'")
    if kind is Parameter.Type.INTEGER and descriptor.integer_range:
        return _check_integer(parameter, descriptor.integer_range[0])
    if kind is Parameter.Type.DOUBLE and descriptor.floating_point_range:
        return _check_double(parameter, descriptor.floating_point_range[0])
    return SetParametersResult(successful=True)


def _check_integer(parameter: Parameter, allowed: Any) -> Any:
    low, high = sorted((allowed.from_value, allowed.to_value))
    value = parameter.value
    if value in (low, high):
        # The edges are always legal, even off the step.
        return SetParametersResult(successful=True)
    if not low < value < high:
        return _refuse(
            f"Parameter {parameter.name} out of range. Min: {low}, Max: {high}, value: {value}"
        )
    if allowed.step and (value - low) % allowed.step:
        return _refuse(
            f"The parameter value for {parameter.name} is not a valid step. "
            f"Min: {low}, max: {high}, value: {value}, step: {allowed.step}"
        )
    return SetParametersResult(successful=True)


def _check_double(parameter: Parameter, allowed: Any) -> Any:
    low, high = sorted((allowed.from_value, allowed.to_value))
    value = parameter.value
    if any(math.isclose(value, edge, rel_tol=PARAM_REL_TOL) for edge in (low, high)):
        return SetParametersResult(successful=True)
    if not low < value < high:
        return _refuse(
            f"Parameter {parameter.name} out of range Min: {low}, Max: {high}, value: {value}"
        )
    if allowed.step:
        nearest = low + round((value - low) / allowed.step) * allowed.step
        if not math.isclose(nearest, value, rel_tol=PARAM_REL_TOL):
            return _refuse(
                f"The parameter value for {parameter.name} is not close enough to a valid step. "
                f"Min: {low}, max: {high}, value: {value}, step: {allowed.step}"
            )
    return SetParametersResult(successful=True)
