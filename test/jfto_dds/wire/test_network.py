"""The environment variables that choose the network."""

import xml.etree.ElementTree as ET

import pytest

from jfto_dds.wire import network


def _parsed(**environment):
    text = network.configuration(environment)
    return ET.fromstring(text.split(">,", 1)[0] + (">" if ">," in text else ""))


def _peers(tree):
    return [peer.get("address") for peer in tree.iter("Peer")]


def test_loopback_only_by_default():
    """Nothing said means this machine only, without multicast."""
    tree = _parsed()
    assert [e.get("name") for e in tree.iter("NetworkInterface")] == ["lo"]
    assert [e.text for e in tree.iter("AllowMulticast")] == ["false"]
    assert _peers(tree) == ["127.0.0.1"]


def test_static_peers_open_other_interfaces():
    """With peers given, packets must leave the machine; still no multicast."""
    tree = _parsed(ROS_STATIC_PEERS="10.0.0.2;10.0.0.3 ;")
    assert list(tree.iter("NetworkInterface")) == []
    assert [e.text for e in tree.iter("AllowMulticast")] == ["false"]
    assert _peers(tree) == ["127.0.0.1", "10.0.0.2", "10.0.0.3"]


def test_subnet_uses_multicast():
    """SUBNET leaves multicast to Cyclone and adds the static peers."""
    tree = _parsed(ROS_AUTOMATIC_DISCOVERY_RANGE="SUBNET", ROS_STATIC_PEERS="host")
    assert list(tree.iter("AllowMulticast")) == []
    assert _peers(tree) == ["host"]


def test_off_finds_nobody():
    """OFF: no peers, a tag that nobody shares."""
    tree = _parsed(ROS_AUTOMATIC_DISCOVERY_RANGE="OFF", ROS_STATIC_PEERS="host")
    assert _peers(tree) == []
    assert next(tree.iter("Tag")).text.startswith("ros_discovery_off_")


def test_localhost_only_ignores_peers():
    """The deprecated ROS_LOCALHOST_ONLY wins over everything."""
    tree = _parsed(
        ROS_LOCALHOST_ONLY="1", ROS_AUTOMATIC_DISCOVERY_RANGE="SUBNET", ROS_STATIC_PEERS="host"
    )
    assert _peers(tree) == ["127.0.0.1"]


def test_cyclonedds_uri_comes_last():
    """The user's configuration is appended, and alone with SYSTEM_DEFAULT."""
    text = network.configuration({"CYCLONEDDS_URI": "file:///etc/cyclone.xml"})
    assert text.endswith(",file:///etc/cyclone.xml")
    assert "NetworkInterface" not in text
    alone = {
        "CYCLONEDDS_URI": "file:///x.xml",
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "SYSTEM_DEFAULT",
    }
    assert network.configuration(alone) == "file:///x.xml"
    assert network.configuration({"ROS_AUTOMATIC_DISCOVERY_RANGE": "SYSTEM_DEFAULT"}) is None


@pytest.mark.parametrize(("text", "expected"), [("", 0), ("7", 7), ("232", 232)])
def test_domain_id(text, expected):
    """ROS_DOMAIN_ID is a small integer, 0 where nothing is said."""
    assert network.domain_id({"ROS_DOMAIN_ID": text}) == expected


@pytest.mark.parametrize("text", ["x", "-1", "233", "1.5"])
def test_illegal_domain_id(text):
    """Anything else is an error that says what would be right."""
    with pytest.raises(network.NetworkSettingError, match="must be an integer from 0 to 232"):
        network.domain_id({"ROS_DOMAIN_ID": text})
