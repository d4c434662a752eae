"""Makes ``rclpy`` and the message packages importable where ROS 2 is not installed.

The finder goes to the end of ``sys.meta_path``: everything that is really installed is found
before it is asked.
"""

from __future__ import annotations

import importlib.machinery
import importlib.util
import sys
import types
from collections.abc import Sequence
from importlib.abc import Loader, MetaPathFinder
from pathlib import Path

from jfto_dds.messages import packages
from jfto_dds.messages.slot_types import fill_rosidl_parser

_HERE = Path(__file__).parent
# Real Python files under this folder, imported under their ROS names.
_SOURCE_PACKAGES = ("rclpy", "rosidl_runtime_py")


class _MessageLoader(Loader):
    """Fills modules that have no file."""

    def create_module(self, spec: importlib.machinery.ModuleSpec) -> None:  # noqa: ARG002
        return None

    def exec_module(self, module: types.ModuleType) -> None:
        if module.__name__ == "rosidl_parser.definition":
            fill_rosidl_parser(module)
        elif not module.__name__.startswith("rosidl_parser"):
            packages.fill_module(module)


class RosFinder(MetaPathFinder):
    """Finds ``rclpy``, message packages and the few rosidl modules that nodes import."""

    def find_spec(
        self,
        fullname: str,
        path: Sequence[str] | None = None,  # noqa: ARG002
        target: types.ModuleType | None = None,  # noqa: ARG002
    ) -> importlib.machinery.ModuleSpec | None:
        """Say how to load a module, or None where it is not ours."""
        if fullname in _SOURCE_PACKAGES:
            folder = _HERE / fullname
            return importlib.util.spec_from_file_location(
                fullname, folder / "__init__.py", submodule_search_locations=[str(folder)]
            )
        if fullname in ("rosidl_parser", "rosidl_parser.definition"):
            is_package = fullname == "rosidl_parser"
        elif packages.is_message_module(fullname):
            is_package = packages.is_message_package(fullname)
        else:
            return None
        return importlib.machinery.ModuleSpec(
            fullname, _MessageLoader(), origin="jfto_dds", is_package=is_package
        )


def install() -> None:
    """Append the finder to ``sys.meta_path``; doing it again changes nothing."""
    if not any(isinstance(finder, RosFinder) for finder in sys.meta_path):
        sys.meta_path.append(RosFinder())
