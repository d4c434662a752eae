"""Quality of service profiles."""

from __future__ import annotations

import enum
from typing import Any

from .duration import Duration

_UNSET = Duration()
_BEST_AVAILABLE_NS = 2**63 - 2


class QoSPolicyKind(enum.IntEnum):
    """Names of the policies, numbered as in rmw."""

    INVALID = 1 << 0
    DURABILITY = 1 << 1
    DEADLINE = 1 << 2
    LIVELINESS = 1 << 3
    RELIABILITY = 1 << 4
    HISTORY = 1 << 5
    LIFESPAN = 1 << 6
    DEPTH = 1 << 7
    LIVELINESS_LEASE_DURATION = 1 << 8
    AVOID_ROS_NAMESPACE_CONVENTIONS = 1 << 9


def qos_policy_name_from_kind(policy_kind: int) -> str:
    """Name a policy."""
    return QoSPolicyKind(policy_kind).name


class InvalidQoSProfileException(Exception):
    """A profile lacks what it needs."""

    def __init__(self, *args: Any) -> None:
        Exception.__init__(self, "Invalid QoSProfile", *args)


class QoSPolicyEnum(enum.IntEnum):
    """Base of the policy values; short keys are what the command line uses."""

    @classmethod
    def short_keys(cls) -> list[str]:
        """All values in lower case."""
        return [name.lower() for name in cls.__members__]

    @classmethod
    def get_from_short_key(cls, name: str) -> int:
        """Look a value up by its name in any case; raises KeyError."""
        return cls[name.upper()].value

    @property
    def short_key(self) -> str:
        """The name in lower case."""
        return self.name.lower()


class HistoryPolicy(QoSPolicyEnum):
    """How many samples are kept."""

    SYSTEM_DEFAULT = 0
    KEEP_LAST = 1
    KEEP_ALL = 2
    UNKNOWN = 3


class ReliabilityPolicy(QoSPolicyEnum):
    """Whether lost samples are sent again."""

    SYSTEM_DEFAULT = 0
    RELIABLE = 1
    BEST_EFFORT = 2
    UNKNOWN = 3
    BEST_AVAILABLE = 4


class DurabilityPolicy(QoSPolicyEnum):
    """Whether late subscriptions get earlier samples."""

    SYSTEM_DEFAULT = 0
    TRANSIENT_LOCAL = 1
    VOLATILE = 2
    UNKNOWN = 3
    BEST_AVAILABLE = 4


class LivelinessPolicy(QoSPolicyEnum):
    """How a publisher shows that it is alive."""

    SYSTEM_DEFAULT = 0
    AUTOMATIC = 1
    MANUAL_BY_TOPIC = 3
    UNKNOWN = 4
    BEST_AVAILABLE = 5


QoSHistoryPolicy = HistoryPolicy
QoSReliabilityPolicy = ReliabilityPolicy
QoSDurabilityPolicy = DurabilityPolicy
QoSLivelinessPolicy = LivelinessPolicy

_ENUMS: dict[str, type[QoSPolicyEnum]] = {
    "history": HistoryPolicy,
    "reliability": ReliabilityPolicy,
    "durability": DurabilityPolicy,
    "liveliness": LivelinessPolicy,
}
_DURATIONS = ("lifespan", "deadline", "liveliness_lease_duration")


class QoSProfile:
    """A set of policies; a duration of zero means unset, which is infinite."""

    __slots__ = [  # noqa: RUF023 - rclpy's order, which str() shows
        "_history",
        "_depth",
        "_reliability",
        "_durability",
        "_lifespan",
        "_deadline",
        "_liveliness",
        "_liveliness_lease_duration",
        "_avoid_ros_namespace_conventions",
    ]
    __hash__ = None  # type: ignore[assignment]

    history: Any
    depth: Any
    reliability: Any
    durability: Any
    lifespan: Any
    deadline: Any
    liveliness: Any
    liveliness_lease_duration: Any
    avoid_ros_namespace_conventions: Any

    def __init__(self, **kwargs: Any) -> None:
        known = all(f"_{key}" in self.__slots__ for key in kwargs)
        assert known, f"Invalid arguments passed to constructor: {kwargs.keys()!r}"
        if "history" not in kwargs:
            if "depth" not in kwargs:
                msg = "History and/or depth settings are required."
                raise InvalidQoSProfileException(msg)
            kwargs["history"] = HistoryPolicy.KEEP_LAST
        self.history = kwargs["history"]
        if self.history == HistoryPolicy.KEEP_LAST and "depth" not in kwargs:
            msg = "History set to KEEP_LAST without a depth setting."
            raise InvalidQoSProfileException(msg)
        self.depth = kwargs.get("depth", 10)
        self.reliability = kwargs.get("reliability", ReliabilityPolicy.RELIABLE)
        self.durability = kwargs.get("durability", DurabilityPolicy.VOLATILE)
        self.lifespan = kwargs.get("lifespan", _UNSET)
        self.deadline = kwargs.get("deadline", _UNSET)
        self.liveliness = kwargs.get("liveliness", LivelinessPolicy.SYSTEM_DEFAULT)
        self.liveliness_lease_duration = kwargs.get("liveliness_lease_duration", _UNSET)
        self.avoid_ros_namespace_conventions = kwargs.get("avoid_ros_namespace_conventions", False)

    def get_c_qos_profile(self) -> _PlainProfile:
        """Return the plain values; ``to_dict()`` shows them."""
        return _PlainProfile(self)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, QoSProfile):
            return False
        return all(getattr(self, slot) == getattr(other, slot) for slot in self.__slots__)

    def __str__(self) -> str:
        values = ", ".join(f"{slot[1:]}={getattr(self, slot)}" for slot in self.__slots__)
        return f"QoSProfile({values})"


def _add_property(name: str) -> None:
    slot = f"_{name}"

    def read(self: QoSProfile) -> Any:
        return getattr(self, slot)

    def write(self: QoSProfile, value: Any) -> None:
        if name in _ENUMS:
            assert isinstance(value, int)
            value = _ENUMS[name](value)
        elif name in _DURATIONS:
            assert isinstance(value, Duration)
        else:
            assert isinstance(value, bool if name.startswith("avoid") else int)
        object.__setattr__(self, slot, value)

    setattr(QoSProfile, name, property(read, write, doc=f"Policy '{name}'."))


for _slot in QoSProfile.__slots__:
    _add_property(_slot[1:])


class _PlainProfile:
    def __init__(self, profile: QoSProfile) -> None:
        # rclpy's order, which is not that of the slots.
        names = ["depth", *(slot[1:] for slot in profile.__slots__ if slot != "_depth")]
        self._values = {name: getattr(profile, name) for name in names}

    def to_dict(self) -> dict[str, Any]:
        return {
            key: int(value) if isinstance(value, enum.IntEnum) else value
            for key, value in self._values.items()
        }


DeadlineBestAvailable = Duration(nanoseconds=_BEST_AVAILABLE_NS)
# Misspelt in rclpy too.
LivelinessLeaseDurationeBestAvailable = Duration(nanoseconds=_BEST_AVAILABLE_NS)


def _unknown_profile() -> QoSProfile:
    return QoSProfile(
        history=HistoryPolicy.UNKNOWN,
        depth=0,
        reliability=ReliabilityPolicy.UNKNOWN,
        durability=DurabilityPolicy.UNKNOWN,
        liveliness=LivelinessPolicy.UNKNOWN,
    )


qos_profile_unknown = _unknown_profile()
qos_profile_default = QoSProfile(depth=10)
qos_profile_system_default = QoSProfile(
    history=HistoryPolicy.SYSTEM_DEFAULT,
    depth=0,
    reliability=ReliabilityPolicy.SYSTEM_DEFAULT,
    durability=DurabilityPolicy.SYSTEM_DEFAULT,
)
qos_profile_sensor_data = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
qos_profile_services_default = QoSProfile(depth=10)
qos_profile_parameters = QoSProfile(depth=1000)
qos_profile_parameter_events = QoSProfile(depth=1000)
qos_profile_action_status_default = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
qos_profile_best_available = QoSProfile(
    depth=10,
    reliability=ReliabilityPolicy.BEST_AVAILABLE,
    durability=DurabilityPolicy.BEST_AVAILABLE,
    deadline=DeadlineBestAvailable,
    liveliness=LivelinessPolicy.BEST_AVAILABLE,
    liveliness_lease_duration=LivelinessLeaseDurationeBestAvailable,
)


class QoSPresetProfiles(enum.Enum):
    """The profiles above, by name; equal ones are aliases of the first."""

    UNKNOWN = qos_profile_unknown
    DEFAULT = qos_profile_default
    SYSTEM_DEFAULT = qos_profile_system_default
    SENSOR_DATA = qos_profile_sensor_data
    SERVICES_DEFAULT = qos_profile_services_default
    PARAMETERS = qos_profile_parameters
    PARAMETER_EVENTS = qos_profile_parameter_events
    ACTION_STATUS_DEFAULT = qos_profile_action_status_default
    BEST_AVAILABLE = qos_profile_best_available

    @classmethod
    def short_keys(cls) -> list[str]:
        """All names in lower case, aliases included."""
        return [name.lower() for name in cls.__members__]

    @classmethod
    def get_from_short_key(cls, name: str) -> QoSProfile:
        """Look a profile up by its name in any case; raises KeyError."""
        return cls[name.upper()].value


class QoSCompatibility(enum.IntEnum):
    """Whether two profiles work together."""

    OK = 0
    WARNING = 1
    ERROR = 2


def _duration_ns(duration: Duration) -> int:
    return duration.nanoseconds or 2**63 - 1


def qos_check_compatible(
    publisher_qos: QoSProfile, subscription_qos: QoSProfile
) -> tuple[QoSCompatibility, str]:
    """Say whether a publisher can serve a subscription, and if not, why."""
    reasons = []
    if (
        publisher_qos.reliability == ReliabilityPolicy.BEST_EFFORT
        and subscription_qos.reliability == ReliabilityPolicy.RELIABLE
    ):
        reasons.append("Best effort publisher and reliable subscription;")
    if (
        publisher_qos.durability == DurabilityPolicy.VOLATILE
        and subscription_qos.durability == DurabilityPolicy.TRANSIENT_LOCAL
    ):
        reasons.append("Volatile publisher and transient local subscription;")
    if _duration_ns(subscription_qos.deadline) < _duration_ns(publisher_qos.deadline):
        reasons.append("Deadline publisher is bigger than deadline subscription;")
    if (
        publisher_qos.liveliness == LivelinessPolicy.AUTOMATIC
        and subscription_qos.liveliness == LivelinessPolicy.MANUAL_BY_TOPIC
    ):
        reasons.append("Publisher liveliness is automatic, subscription is manual by topic;")
    lease = subscription_qos.liveliness_lease_duration
    if _duration_ns(lease) < _duration_ns(publisher_qos.liveliness_lease_duration):
        reasons.append("Liveliness lease duration of publisher is bigger than of subscription;")
    if reasons:
        return QoSCompatibility.ERROR, "ERROR: " + " ERROR: ".join(reasons)
    return QoSCompatibility.OK, ""
