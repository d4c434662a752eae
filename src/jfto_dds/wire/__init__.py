"""The network side: DDS entities that look like those of rmw_cyclonedds_cpp (Jazzy)."""
