"""ROS 2 without ROS: the used part of rclpy over Eclipse Cyclone DDS.

``jfto_dds.install()`` makes ``import rclpy`` and ``import std_msgs.msg`` work on a machine that
has no ROS 2, in the wire conventions of rmw_cyclonedds_cpp (Jazzy). Where ROS 2 is installed the
real modules are found first.
"""

from jfto_dds.importer import RosFinder, install

__all__ = ["RosFinder", "install"]
