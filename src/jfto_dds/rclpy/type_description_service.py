"""The service that describes the types a node uses."""

from __future__ import annotations

from typing import Any

from rcl_interfaces.msg import ParameterDescriptor
from type_description_interfaces.msg import (
    Field,
    FieldType,
    IndividualTypeDescription,
    TypeDescription,
)
from type_description_interfaces.srv import GetTypeDescription

from jfto_dds.messages.hashes import individual_description, referenced_types, type_hash

START_TYPE_DESCRIPTION_SERVICE_PARAM = "start_type_description_service"


class TypeDescriptionService:
    """Answers with descriptions; sources of .msg files are not available here."""

    def __init__(self, node: Any) -> None:
        if not node.has_parameter(START_TYPE_DESCRIPTION_SERVICE_PARAM):
            node.declare_parameter(
                START_TYPE_DESCRIPTION_SERVICE_PARAM,
                True,
                ParameterDescriptor(
                    description="If enabled, start the ~/get_type_description service.",
                    read_only=True,
                ),
            )
        self.enabled = node.get_parameter(START_TYPE_DESCRIPTION_SERVICE_PARAM).value
        if self.enabled:
            node.create_service(
                GetTypeDescription, f"{node.get_name()}/get_type_description", self._describe
            )

    def _describe(self, request: Any, response: Any) -> Any:
        try:
            known = type_hash(request.type_name)
        except (KeyError, ValueError):
            response.failure_reason = f"Type not currently in use by this node: {request.type_name}"
            return response
        if request.type_hash and request.type_hash != known:
            response.failure_reason = "Type hash does not match"
            return response
        response.type_description = TypeDescription(
            type_description=_individual(request.type_name),
            referenced_type_descriptions=[
                _individual(name) for name in referenced_types(request.type_name)
            ],
        )
        response.successful = True
        return response


def _individual(full_name: str) -> Any:
    plain: Any = individual_description(full_name)
    return IndividualTypeDescription(
        type_name=plain["type_name"],
        fields=[
            Field(name=field["name"], type=FieldType(**field["type"])) for field in plain["fields"]
        ],
    )
