"""The ``key=value;`` text that ROS puts into the USER_DATA of participants and endpoints."""

from __future__ import annotations


def participant_user_data(enclave: str) -> bytes:
    """Build a participant's text, which names its security enclave."""
    return f"enclave={enclave};".encode()


def endpoint_user_data(type_hash: str, **identity: str) -> bytes:
    """Build an endpoint's text; ``serviceid=`` or ``clientid=`` goes in front of the hash."""
    parts = [f"{key}={value};" for key, value in identity.items()]
    return "".join([*parts, f"typehash={type_hash};"]).encode()


def parse_user_data(data: bytes) -> dict[str, str]:
    """Split the text into its pairs; what is not such a pair is left out."""
    pairs = (part.partition("=") for part in data.decode("utf-8", "replace").split(";"))
    return {key: value for key, separator, value in pairs if separator}


def service_identity(gid: bytes, number: int) -> str:
    """Write an id for one service or client: 12 bytes of the participant's gid and a counter."""
    raw = gid[:12] + number.to_bytes(4, "big")
    return ".".join(f"{byte:x}" for byte in raw)
