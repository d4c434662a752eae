"""The package as colcon, ament and pip take it."""

from __future__ import annotations

import configparser
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from catkin_pkg.package import parse_package

import jfto

ROOT = Path(__file__).parents[2]
SCENES = ("demo", "wanglang", "wanglang_gaussian", "small", "wanghai")


@pytest.fixture(scope="module")
def setup_cfg() -> configparser.ConfigParser:
    """The declarative set-up."""
    parser = configparser.ConfigParser()
    parser.read(ROOT / "setup.cfg")
    return parser


def test_package_xml_is_accepted() -> None:
    """catkin_pkg takes package.xml without a warning, as an ament_python package."""
    warnings: list[str] = []
    package = parse_package(str(ROOT / "package.xml"), warnings=warnings)
    package.validate(warnings=warnings)
    assert warnings == []
    assert package.package_format == 3
    assert [str(name) for name in package.licenses] == ["Apache-2.0"]
    assert package.get_build_type() == "ament_python"
    assert package.build_depends == []


def test_one_name_and_one_version(setup_cfg: configparser.ConfigParser) -> None:
    """package.xml, setup.cfg and the module agree."""
    package = parse_package(str(ROOT / "package.xml"))
    assert package.name == setup_cfg["metadata"]["name"] == "jfto"
    assert setup_cfg["metadata"]["version"] == "attr: jfto.__version__"
    assert package.version == jfto.__version__


def test_every_requirement_is_pinned(setup_cfg: configparser.ConfigParser) -> None:
    """constraints.txt pins each requirement and each development tool exactly, for each Python."""
    pinned = set()
    for line in (ROOT / "constraints.txt").read_text().splitlines():
        if line and not line.startswith("#"):
            pin = re.fullmatch(r"([\w.-]+)==[\w.]+(; python_version (<|>=) \"3\.11\")?", line)
            assert pin is not None, line
            pinned.add(pin.group(1).lower())
    extras = setup_cfg["options.extras_require"]
    wanted = [setup_cfg["options"]["install_requires"], *extras.values()]
    for line in "\n".join(wanted).splitlines():
        name = re.match(r"[\w.-]*", line.strip())
        assert name is not None
        if name.group():
            assert name.group().lower().replace("_", "-") in pinned


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> zipfile.ZipFile:
    """The built wheel."""
    folder = tmp_path_factory.mktemp("wheel")
    build = (
        "import sys; from setuptools.build_meta import build_wheel; "
        "sys.stdout.write(build_wheel(sys.argv[1]))"
    )
    # Built from a copy, so that no build directory is left in the tree.
    source = tmp_path_factory.mktemp("source")
    tracked = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    for name in filter(None, tracked.split("\0")):
        if name.startswith(("test/", "bench/")) or not (ROOT / name).is_file():
            continue
        (source / name).parent.mkdir(parents=True, exist_ok=True)
        (source / name).write_bytes((ROOT / name).read_bytes())
    subprocess.run(
        [sys.executable, "-c", build, str(folder)], cwd=source, capture_output=True, check=True
    )
    return zipfile.ZipFile(next(folder.glob("*.whl")))


@pytest.mark.slow
def test_the_wheel_holds_what_ament_looks_for(wheel: zipfile.ZipFile) -> None:
    """Resource index, package.xml and scenarios land below share/, the entry point is declared."""
    names = wheel.namelist()
    share = [name.split(".data/data/", 1)[1] for name in names if ".data/data/" in name]
    assert "share/ament_index/resource_index/packages/jfto" in share
    assert "share/jfto/package.xml" in share
    assert {f"share/jfto/config/{scene}.yaml" for scene in SCENES} <= set(share)
    entry = next(name for name in names if name.endswith("entry_points.txt"))
    assert "jfto = jfto.cli:main" in wheel.read(entry).decode()


@pytest.mark.slow
def test_the_wheel_holds_every_module_and_data_file(wheel: zipfile.ZipFile) -> None:
    """All of src/ is in it, the report's style and script and the type marker included."""
    names = set(wheel.namelist())
    for path in (ROOT / "src").rglob("*.py"):
        if path.is_file() and "egg-info" not in str(path):
            assert str(path.relative_to(ROOT / "src")) in names
    assert {"jfto/reporting/static/report.css", "jfto/reporting/static/scene.js"} <= names
    assert "jfto_msgs_py/ros/fast_dds.xml" in names
    assert "jfto/py.typed" in names


@pytest.mark.parametrize("scene", SCENES)
def test_shipped_scenarios_are_valid(scene: str) -> None:
    """Every shipped scenario loads and describes a heterogeneous or identical fleet in full."""
    from jfto.planning.scenario_file import load_scenario

    fleet = load_scenario(ROOT / "config" / f"{scene}.yaml").scenario.fleet
    assert len(fleet.ids) == len(fleet.p_max_dbm) == len(fleet.energy_j) == fleet.count >= 3
