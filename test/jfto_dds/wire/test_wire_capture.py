"""A node looks on the network as a real one does: names, types, USER_DATA, QoS, payloads."""

import re
import threading
import time

import pytest
import rclpy
from cyclonedds.core import Listener
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSProfile,
    qos_profile_sensor_data,
)
from std_msgs.msg import Float64MultiArray, String
from std_srvs.srv import Trigger

from jfto_dds.messages.message_class import message_class
from jfto_dds.wire.entities import Reader, Writer
from jfto_dds.wire.idl_types import topic_type
from jfto_dds.wire.participant import Participant
from jfto_dds.wire.qos_settings import QosSettings
from jfto_dds.wire.user_data import endpoint_user_data

_LIMIT_S = 20.0
_LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def _wire_demo():
    """Build the node that was recorded."""
    from geometry_msgs.msg import PoseStamped
    from nav_msgs.msg import Path

    node = Node("wire_demo", namespace="/uav1")
    for name, value in (
        ("speed", 1.5),
        ("name", "alpha"),
        ("ids", [1, 2, 3]),
        ("flag", True),
        ("names", ["a", "b"]),
    ):
        node.declare_parameter(name, value)
    node.create_publisher(PoseStamped, "pose", 10)
    node.create_publisher(Path, "plan", _LATCHED)
    node.create_publisher(Float64MultiArray, "sensor", qos_profile_sensor_data)
    manual = QoSProfile(
        depth=3,
        deadline=Duration(seconds=2),
        lifespan=Duration(seconds=5),
        liveliness=LivelinessPolicy.MANUAL_BY_TOPIC,
        liveliness_lease_duration=Duration(seconds=4),
    )
    node.create_publisher(String, "deadline", manual)
    node.create_publisher(String, "keepall", QoSProfile(history=HistoryPolicy.KEEP_ALL))
    node.create_subscription(String, "cmd", print, 10)
    node.create_subscription(PoseStamped, "goal", print, qos_profile_sensor_data)
    node.create_subscription(Path, "mission", print, _LATCHED)

    def arm(_request, response):
        response.success, response.message = True, "armed"
        return response

    node.create_service(Trigger, "arm", arm)
    node.create_client(Trigger, "/gcs/land")
    return node


@pytest.fixture
def watched():
    """The demo node, and a second participant that sees the network as others do."""
    rclpy.init(args=[])
    node = _wire_demo()
    other = Participant(rclpy.get_default_context().get_domain_id())
    yield node, other
    other.close()


def _identity_hidden(user_data):
    return re.sub(r"(serviceid|clientid)=[^;]*;", r"\1=<id>;", user_data)


def _seen(other, node):
    """All endpoints of the node as the binding's builtin topics report them."""
    from cyclonedds.builtin import (
        BuiltinDataReader,
        BuiltinTopicDcpsPublication,
        BuiltinTopicDcpsSubscription,
    )
    from cyclonedds.core import Policy

    from jfto_dds.wire.entities import delete_entity

    found = {}
    for kind, topic in (
        ("writer", BuiltinTopicDcpsPublication),
        ("reader", BuiltinTopicDcpsSubscription),
    ):
        reader = BuiltinDataReader(other._entity, topic, listener=Listener())
        for sample in reader.take(1000):
            if sample.key.bytes[:12] != node._participant.gid[:12]:
                continue
            user_data = sample.qos[Policy.Userdata]
            text = user_data.data.decode() if user_data is not None else ""
            qos = sample.qos.asdict()
            found[kind, sample.topic_name] = (sample.type_name, text, qos)
        delete_entity(reader)
    return found


def test_endpoints_are_those_of_a_real_node(watched, recorded_wire):
    """Topic, type, USER_DATA and every QoS policy that was recorded."""
    node, other = watched
    end = time.monotonic() + _LIMIT_S
    expected = recorded_wire["endpoints"]
    seen = _seen(other, node)
    while len(seen) < len(expected) and time.monotonic() < end:
        seen = _seen(other, node)
    for endpoint in expected:
        type_name, user_data, qos = seen[endpoint["kind"], endpoint["topic"]]
        assert type_name == endpoint["type"]
        assert _identity_hidden(user_data) == _identity_hidden(endpoint["user_data"])
        for policy, value in endpoint["qos"].items():
            assert qos.get(policy) == value, (endpoint["kind"], endpoint["topic"], policy)


def test_service_ids_pair_reader_and_writer(watched):
    """Request and reply side of a service or client carry the same id, others another one."""
    node, other = watched
    ids = {}
    for (_, topic), (_, user_data, _) in _seen(other, node).items():
        match = re.match(r"(?:serviceid|clientid)=([^;]*);", user_data)
        if match:
            ids.setdefault(match[1], set()).add(re.sub(r"^r[qr]|Request$|Reply$", "", topic))
    assert all(len(topics) == 1 for topics in ids.values())
    assert len(ids) == 9


def test_discovery_info_lists_the_node(watched, recorded_wire):
    """``ros_discovery_info`` names the node with as many readers and writers as recorded."""
    node, other = watched
    recorded = recorded_wire["ros_discovery_info"]["nodes"][0]
    found = []

    def listed():
        found[:] = [n for n in other.graph.nodes() if n.name == recorded["name"]]
        return bool(found) and len(found[0].reader_gids) == len(recorded["readers"])

    assert other.graph.wait_until(listed, _LIMIT_S)
    assert found[0].namespace == recorded["namespace"]
    assert len(found[0].writer_gids) == len(recorded["writers"])
    assert found[0].participant_gid == node._participant.gid


def test_discovery_info_payload(recorded_wire):
    """The recorded announcement decodes to what was recorded and encodes to the same bytes."""
    support = message_class("rmw_dds_common/msg/ParticipantEntitiesInfo")._TYPE_SUPPORT
    payload = bytes.fromhex(recorded_wire["ros_discovery_info"]["payload"])
    info = support.deserialize(payload)
    assert bytes(bytearray(info.gid.data)).hex() == recorded_wire["participant"]["guid"]
    encoded = support.serialize(info)
    assert payload.startswith(encoded)
    assert len(payload) - len(encoded) < 4


def _call_raw(other, service, full_name, request):
    """Send a recorded request as another participant would, and return the raw reply."""
    entry = other.add_node("/", "prober")
    arrived = threading.Event()
    identity = {"clientid": other.new_identity()}
    options = {"service": True, "identity": identity}
    reader = other.create_reader(
        entry, f"rr{service}Reply", f"{full_name}_Response", QosSettings(), arrived.set, **options
    )
    writer = other.create_writer(
        entry, f"rq{service}Request", f"{full_name}_Request", QosSettings(), **options
    )
    return reader, writer, arrived, request


def test_service_replies_are_those_of_a_real_node(watched, recorded_wire):
    """Recorded requests get the recorded replies, header and all."""
    node, other = watched
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    tried = 0
    for sample in recorded_wire["samples"]:
        if "request" not in sample:
            continue
        service = sample["topic"].removeprefix("rr").removesuffix("Reply")
        full_name = sample["type"].removesuffix("_Response")
        reader, writer, arrived, request = _call_raw(other, service, full_name, sample["request"])
        end = time.monotonic() + _LIMIT_S
        while (not writer.matched_count() or not reader.matched_count()) and time.monotonic() < end:
            executor.spin_once(timeout_sec=0.02)
        writer.write(bytes.fromhex(request))
        while not arrived.is_set() and time.monotonic() < end:
            executor.spin_once(timeout_sec=0.05)
        came = reader.take()[0].payload.hex()
        assert came.startswith(sample["payload"]), sample["topic"]
        assert len(came) - len(sample["payload"]) < 8
        tried += 1
    assert tried >= 5


def test_request_header_of_client(watched, recorded_wire):
    """A client numbers its requests from one, behind its writer's instance handle."""
    node, _ = watched
    recorded = next(s for s in recorded_wire["samples"] if s["topic"] == "rq/gcs/landRequest")
    server, got = Node("server"), []
    server.create_service(Trigger, "/gcs/land", lambda request, response: response)
    client = next(iter(node.clients))
    assert client.wait_for_service(_LIMIT_S)
    spy = Reader(
        server._participant._entity,
        "rq/gcs/landRequest",
        topic_type("std_srvs/srv/Trigger_Request", service=True),
        QosSettings(),
        endpoint_user_data("RIHS01_" + "0" * 64),
        lambda: None,
    )
    end = time.monotonic() + _LIMIT_S
    while client._writer.matched_count() < 2 and time.monotonic() < end:
        pass
    client.call_async(Trigger.Request())
    while not got and time.monotonic() < end:
        got = spy.take()
    payload = got[0].payload
    spy.close()
    assert len(payload) - len(bytes.fromhex(recorded["payload"])) in (0, 3)
    assert payload[:4] == b"\0\1\0\0"
    assert int.from_bytes(payload[4:12], "little") == client._writer.instance_handle % 2**64
    assert int.from_bytes(payload[12:20], "little") == 1


def test_parameters_of_the_demo(watched):
    """The demo has the recorded parameters."""
    node, _ = watched
    assert node.get_parameter("ids").type_ == Parameter.Type.INTEGER_ARRAY


def test_entities_can_be_closed_twice(watched):
    """Closing again changes nothing; using a closed one says so."""
    _, other = watched
    entry = other.add_node("/", "x")
    writer = other.create_writer(entry, "rt/x", "std_msgs/msg/String", QosSettings())
    writer.close()
    writer.close()
    assert isinstance(writer, Writer)
    assert writer.is_closed
