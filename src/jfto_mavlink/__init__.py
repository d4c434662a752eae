"""MAVLink bridge: links, mission protocol, mission files, telemetry and flight control."""
