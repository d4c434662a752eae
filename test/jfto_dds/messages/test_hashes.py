"""Type hashes and field types are those that a real ROS 2 installs."""

from jfto_dds.messages.definitions import definition
from jfto_dds.messages.hashes import type_hash


def test_hashes_are_those_of_ros(recorded_types):
    """Messages, services, their halves and events hash as in Jazzy, ``char`` fields included."""
    assert "std_msgs/msg/Char" in recorded_types
    assert "std_srvs/srv/Trigger" in recorded_types
    wrong = [name for name, kind in recorded_types.items() if type_hash(name) != kind["type_hash"]]
    assert wrong == []


def test_fields_are_those_of_ros(recorded_types):
    """Field names, order and types are those of rosidl."""
    for name, kind in recorded_types.items():
        if "fields" in kind:
            shown = [(field, str(field_type)) for field, field_type in definition(name).fields]
            assert shown == list(kind["fields"].items()), name
