"""ROS 2 interface types: definitions, Python classes, CDR encoding and type hashes."""
