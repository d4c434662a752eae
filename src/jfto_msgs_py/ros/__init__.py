"""Records to stock common_interfaces messages and back: the only place that writes or parses them.

Message classes are imported when a function is called, so that the vocabulary itself loads on
machines that have neither ROS 2 nor its stand-in.
"""
