"""How ROS names and types are spelled on the DDS network, and back."""

from __future__ import annotations

TOPIC, REQUEST, REPLY = "rt", "rq", "rr"


def topic_name(name: str) -> str:
    """Spell a fully qualified topic, ``/uav1/pose`` -> ``rt/uav1/pose``."""
    return TOPIC + name


def request_name(service: str) -> str:
    """Spell the request topic of a fully qualified service name."""
    return f"{REQUEST}{service}Request"


def reply_name(service: str) -> str:
    """Spell the reply topic of a fully qualified service name."""
    return f"{REPLY}{service}Reply"


def type_name(full_name: str) -> str:
    """Spell a type, ``std_msgs/msg/String`` -> ``std_msgs::msg::dds_::String_``."""
    package, kind, name = full_name.split("/")
    return f"{package}::{kind}::dds_::{name}_"


def ros_topic(dds_topic: str) -> str | None:
    """Recover the ROS topic of a DDS topic; None where it is not one."""
    return dds_topic[len(TOPIC) :] if dds_topic.startswith(TOPIC + "/") else None


def ros_service(dds_topic: str) -> str | None:
    """Recover the ROS service of a request or reply topic; None where it is not one."""
    if dds_topic.startswith(REQUEST + "/") and dds_topic.endswith("Request"):
        return dds_topic[len(REQUEST) : -len("Request")]
    if dds_topic.startswith(REPLY + "/") and dds_topic.endswith("Reply"):
        return dds_topic[len(REPLY) : -len("Reply")]
    return None


def ros_type(dds_type: str) -> str:
    """Recover a ROS type; a DDS type that is none of ROS is returned as it is."""
    parts = dds_type.split("::")
    if len(parts) == 4 and parts[2] == "dds_" and parts[3].endswith("_"):
        return f"{parts[0]}/{parts[1]}/{parts[3][:-1]}"
    return dds_type


def ros_service_type(dds_type: str) -> str:
    """Recover a service type from that of its request or reply."""
    name = ros_type(dds_type)
    for suffix in ("_Request", "_Response"):
        name = name.removesuffix(suffix)
    return name
