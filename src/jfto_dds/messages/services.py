"""Service definitions that rosbags does not ship: request and response lines as in .srv files."""

from __future__ import annotations

_LIFECYCLE = "lifecycle_msgs/srv/"
_PARAMETER = "rcl_interfaces/srv/"

SERVICES: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "action_msgs/srv/CancelGoal": (
        ("GoalInfo goal_info",),
        (
            "int8 ERROR_NONE =0",
            "int8 ERROR_REJECTED =1",
            "int8 ERROR_UNKNOWN_GOAL_ID =2",
            "int8 ERROR_GOAL_TERMINATED =3",
            "int8 return_code",
            "GoalInfo[] goals_canceling",
        ),
    ),
    "diagnostic_msgs/srv/AddDiagnostics": (
        ("string load_namespace",),
        ("bool success", "string message"),
    ),
    "diagnostic_msgs/srv/SelfTest": (
        (),
        ("string id", "byte passed", "DiagnosticStatus[] status"),
    ),
    _LIFECYCLE + "ChangeState": (("Transition transition",), ("bool success",)),
    _LIFECYCLE + "GetAvailableStates": ((), ("State[] available_states",)),
    _LIFECYCLE + "GetAvailableTransitions": (
        (),
        ("TransitionDescription[] available_transitions",),
    ),
    _LIFECYCLE + "GetState": ((), ("State current_state",)),
    "nav_msgs/srv/GetMap": ((), ("OccupancyGrid map",)),
    "nav_msgs/srv/GetPlan": (
        (
            "geometry_msgs/PoseStamped start",
            "geometry_msgs/PoseStamped goal",
            "float32 tolerance",
        ),
        ("Path plan",),
    ),
    "nav_msgs/srv/LoadMap": (
        ("string map_url",),
        (
            "uint8 RESULT_SUCCESS =0",
            "uint8 RESULT_MAP_DOES_NOT_EXIST =1",
            "uint8 RESULT_INVALID_MAP_DATA =2",
            "uint8 RESULT_INVALID_MAP_METADATA =3",
            "uint8 RESULT_UNDEFINED_FAILURE =255",
            "OccupancyGrid map",
            "uint8 result",
        ),
    ),
    "nav_msgs/srv/SetMap": (
        ("OccupancyGrid map", "geometry_msgs/PoseWithCovarianceStamped initial_pose"),
        ("bool success",),
    ),
    _PARAMETER + "DescribeParameters": (
        ("string[] names",),
        ("ParameterDescriptor[] descriptors",),
    ),
    _PARAMETER + "GetLoggerLevels": (("string[] names",), ("LoggerLevel[] levels",)),
    _PARAMETER + "GetParameterTypes": (("string[] names",), ("uint8[] types",)),
    _PARAMETER + "GetParameters": (("string[] names",), ("ParameterValue[] values",)),
    _PARAMETER + "ListParameters": (
        ("uint64 DEPTH_RECURSIVE =0", "string[] prefixes", "uint64 depth"),
        ("ListParametersResult result",),
    ),
    _PARAMETER + "SetLoggerLevels": (
        ("LoggerLevel[] levels",),
        ("SetLoggerLevelsResult[] results",),
    ),
    _PARAMETER + "SetParameters": (("Parameter[] parameters",), ("SetParametersResult[] results",)),
    _PARAMETER + "SetParametersAtomically": (
        ("Parameter[] parameters",),
        ("SetParametersResult result",),
    ),
    "std_srvs/srv/Empty": ((), ()),
    "std_srvs/srv/SetBool": (("bool data",), ("bool success", "string message")),
    "std_srvs/srv/Trigger": ((), ("bool success", "string message")),
    "tf2_msgs/srv/FrameGraph": ((), ("string frame_yaml",)),
    "type_description_interfaces/srv/GetTypeDescription": (
        ("string type_name", "string type_hash", "bool include_type_sources"),
        (
            "bool successful",
            "string failure_reason",
            "TypeDescription type_description",
            "TypeSource[] type_sources",
            "KeyValue[] extra_information",
        ),
    ),
    "visualization_msgs/srv/GetInteractiveMarkers": (
        (),
        ("uint64 sequence_number", "InteractiveMarker[] markers"),
    ),
}
