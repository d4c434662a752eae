"""Type hashes as endpoint information shows them."""

from __future__ import annotations


class TypeHash:
    """A RIHS hash: version and 32 bytes."""

    __slots__ = ["_value", "_version"]

    def __init__(self, version: int = -1, value: bytes = bytes(32)) -> None:
        self._version = version
        self._value = value

    @property
    def version(self) -> int:
        """Version of the hash, -1 where there is none."""
        return self._version

    @property
    def value(self) -> bytes:
        """The hash itself."""
        return self._value

    @classmethod
    def _from_text(cls, text: str) -> TypeHash:
        prefix, _, digits = text.partition("_")
        if not prefix.startswith("RIHS") or len(digits) != 64:
            return cls()
        return cls(int(prefix[4:]), bytes.fromhex(digits))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, TypeHash):
            return False
        return (self._version, self._value) == (other._version, other._value)

    def __hash__(self) -> int:
        return hash((self._version, self._value))

    def __str__(self) -> str:
        if self._version <= 0:
            return "INVALID"
        return f"RIHS{self._version:02d}_{self._value.hex()}"

    def __repr__(self) -> str:
        return f"{type(self).__name__}(version={self._version}, value={self._value.hex()})"
