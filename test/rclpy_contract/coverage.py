"""Which recorded observations are tried by hand-written tests, and which are left out, and why.

All others are tried as they stand by ``test_recorded_lines.py`` and ``test_command_line.py``.
``test_coverage.py`` checks that every observation has its place and that named tests exist.
"""

_CHECKED = "fields are always checked in these tests"
_OUR_SPLIT = "text of a class's private structure"
_TIMING = "a duration in milliseconds of one machine"

# section -> {line number: test}
BY_HAND = {
    "node": dict.fromkeys(range(5), "test_before_and_after_init"),
    "overrides": dict.fromkeys((12, 13, 16), "test_overrides_meet_ranges_and_read_only"),
    "publishing": {18: "test_raw_and_message_info"},
    "parameter_callbacks": dict.fromkeys(range(12), "test_callbacks_and_events")
    | {
        12: "test_bad_on_set_callbacks",
        13: "test_bad_on_set_callbacks",
        14: "test_bad_on_set_callbacks",
        15: "test_callbacks_run_last_added_first",
        16: "test_removing_unknown_callback",
        17: "test_on_set_callback_sees_declarations",
        18: "test_on_set_callback_sees_declarations",
    },
    "parameter_services": dict.fromkeys(range(22), "test_parameter_services"),
    "qos_incompatible": {
        0: "test_incompatible_qos_events",
        1: "test_other_type_on_topic",
        2: "test_matched_events",
        3: "test_event_callback_containers",
    },
    "timers": {
        0: "test_timer_ticks",
        1: "test_overrunning_timer_does_not_catch_up",
        2: "test_timer_of_period_zero",
        4: "test_timer_interface",
        5: "test_reset_and_new_period",
        6: "test_missed_ticks_are_not_made_up",
        7: "test_timer_without_autostart",
        8: "test_timer_callback_with_argument",
    },
    "rate": {
        0: "test_rate_sleeps_periods",
        1: "test_rate_remembers_one_tick",
        2: "test_destroyed_rate",
        3: "test_destroyed_rate",
        4: "test_illegal_rates",
        5: "test_illegal_rates",
        6: "test_destroyed_rate",
        7: "test_rate_of_unspun_node_blocks_until_destroyed",
        8: "test_rate_of_unspun_node_blocks_until_destroyed",
    },
    "sim_time": dict.fromkeys(range(22), "test_simulated_time")
    | {
        22: "test_sleep_on_simulated_time",
        **dict.fromkeys(range(23, 27), "test_jump_thresholds"),
        27: "test_clocks_have_no_timers",
        28: "test_clocks_have_no_timers",
    },
    "executors": dict.fromkeys(range(7), "test_overlap")
    | dict.fromkeys(range(7, 31), "test_executor_interface")
    | {31: "test_spin_once_inside_callback", 32: "test_global_spin_once_inside_callback"},
    "exceptions": dict.fromkeys(range(5), "test_exception_leaves_spin")
    | {5: "test_subscription_exception_leaves_spin"}
    | dict.fromkeys(range(6, 12), "test_failing_service_callbacks"),
    "services": dict.fromkeys(range(14), "test_service_client"),
    "call": {
        0: "test_blocking_call",
        1: "test_blocking_call_times_out",
        3: "test_call_in_callback_deadlocks",
        4: "test_call_in_callback_with_threads",
        5: "test_awaiting_in_own_group_deadlocks",
        6: "test_awaiting_other_groups",
    },
    "future": {19: "test_done_callback_in_executor", 20: "test_done_callback_that_raises"},
    "guard": {0: "test_guard_condition"},
    "delivery": dict.fromkeys(range(13), "test_bursts"),
    "order": {0: "test_order_of_callbacks"},
    "start_events": {0: "test_events_of_starting_node"},
    "same_name": {0: "test_two_nodes_of_one_name"},
    "lifecycle": dict.fromkeys(range(23), "test_lifecycle"),
    "lifecycle_errors": dict.fromkeys(range(8), "test_lifecycle_results"),
    "lifecycle_services": dict.fromkeys(range(18), "test_lifecycle_services")
    | {18: "test_plain_timer_of_lifecycle_node"},
    "graph": dict.fromkeys(range(24), "test_graph")
    | {24: "test_other_process_comes_and_goes", 25: "test_other_process_comes_and_goes"},
    "process": {
        0: "test_uncaught_sigint",
        1: "test_uncaught_sigterm",
        3: "test_try_shutdown_after_sigint",
        4: "test_caught_sigterm",
        5: "test_sigint_in_multi_threaded_executor",
        6: "test_sigint_while_callback_sleeps",
        7: "test_sigint_in_spin_once_loop",
        8: "test_sigint_while_nobody_spins",
        9: "test_sigint_with_spinning_thread",
        10: "test_no_handlers_sigint",
        11: "test_no_handlers_sigterm",
        12: "test_shutdown_from_callback",
        13: "test_shutdown_from_other_thread",
        14: "test_executor_shutdown_from_other_thread",
        15: "test_system_exit_in_callback",
        16: "test_uncaught_exception_in_callback",
        17: "test_after_shutdown",
        18: "test_on_shutdown_callback",
        19: "test_end_without_shutdown",
        20: "test_second_sigint",
    },
    "logging": {
        0: "test_severities",
        **dict.fromkeys((2, 3, 4, 5), "test_log_level_arguments"),
        6: "test_log_to_stdout",
        7: "test_colours",
        8: "test_console_format",
        9: "test_console_format_times",
        10: "test_logger_interface",
        11: "test_rosout",
    },
}

# section -> {line number: reason}
LEFT_OUT = {
    "node": {5: "annotations of a signature"},
    "names": {26: "class name of rclpy's C handle"},
    "topics": {32: _OUR_SPLIT},
    "parameter_types": {37: _CHECKED},
    "declare": {38: _CHECKED},
    "publishing": {
        7: "Cyclone 11 refuses bytes without a CDR header, RCLError; rclpy sends the junk",
        19: "assigning a private slot past the checks",
    },
    "constructor": {
        58: "check_fields=False has no effect in jfto_dds: fields are always checked",
    },
    "checked": {},
    "unchecked": dict.fromkeys(range(40), _CHECKED),
    "introspection": {24: _CHECKED},
    "time": {18: _CHECKED, 29: "rclpy makes a string of a gigabyte here, jfto_dds a TypeError"},
    "timers": {3: _TIMING},
    "call": {2: "annotations of a signature"},
    "order": {
        1: "empty spins that follow from how rcl's wait set is triggered; nothing to rely on",
    },
    "graph": {26: "takes ten seconds: the lease of a killed participant"},
    "process": {2: "a race that the recording itself calls undecided"},
    "logging": {1: "debug output of rcl and rmw_cyclonedds, which are not there"},
    "cli": {43: "a map inside a list is an error in jfto_dds; rcl makes a list parameter of it"},
}

# Words of Python itself: as recorded under 3.11 only.
PYTHON_3_11 = {
    "context": {28},
    "qos": {45},
    "assignment": {56},
    "introspection": {35},
    "rosidl_runtime": {1},
}
