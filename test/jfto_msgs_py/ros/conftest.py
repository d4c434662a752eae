"""Message classes: the real ones where ROS 2 is installed, otherwise the stand-in's."""

import jfto_dds

jfto_dds.install()
