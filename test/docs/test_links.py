"""Links and paths that the pages name lead somewhere."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
_LINK = re.compile(r"\]\(([^)\s]+)\)")
_HEADING = re.compile(r"^#+ +(.*)$", re.MULTILINE)
_FENCED = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)
_PATH = re.compile(r"(?<![\w/.])(?:bench|config|docs|examples|scripts|src|test)/[\w./-]+")


def _pages() -> list[Path]:
    """Every Markdown file of the repository, those not committed yet included."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "*.md"]
    found = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    # A copy without git, such as a source archive, has the same folders.
    names = found.stdout.split() or [
        str(p.relative_to(ROOT)) for p in (ROOT / "docs").rglob("*.md")
    ]
    return sorted(ROOT / name for name in names if (ROOT / name).exists())


def _anchor(heading: str) -> str:
    """As GitHub makes it: lower case, punctuation gone, spaces to hyphens."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


@pytest.mark.parametrize("page", _pages(), ids=lambda path: str(path.relative_to(ROOT)))
def test_relative_links_lead_somewhere(page):
    """The file is there, and where a heading is named, it has that."""
    text = page.read_text(encoding="utf-8")
    for link in _LINK.findall(_FENCED.sub("", text)):
        if "://" in link or link.startswith("mailto:"):
            continue
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        assert target.exists(), f"{page.name} links to {link}, which is not there"
        if anchor:
            headings = _HEADING.findall(target.read_text(encoding="utf-8"))
            assert anchor in map(_anchor, headings), f"{page.name}: {path} has no heading {anchor}"


def test_every_page_is_in_the_index():
    """From docs/index.md, or the page that lists the benchmarks, one click leads to every page."""
    linked = set()
    for index in (ROOT / "docs/index.md", ROOT / "docs/benchmarks/index.md"):
        links = _LINK.findall(index.read_text(encoding="utf-8"))
        linked |= {(index.parent / link).resolve() for link in links} | {index.resolve()}
    pages = {path.resolve() for path in (ROOT / "docs").rglob("*.md")}
    assert pages - linked == set()


@pytest.mark.parametrize("page", _pages(), ids=lambda path: str(path.relative_to(ROOT)))
def test_files_that_pages_name_are_there(page):
    """A path under one of the project's folders is never left behind by a move."""
    text = _FENCED.sub("", page.read_text(encoding="utf-8"))
    named = [each.rstrip("./") for each in _PATH.findall(text)]
    gone = [each for each in named if not (ROOT / each).exists() and page.name != "CHANGELOG.md"]
    assert gone == []


@pytest.mark.parametrize("page", _pages(), ids=lambda path: str(path.relative_to(ROOT)))
def test_modules_that_pages_run_are_there(page):
    """What a page tells to run with python -m can be run."""
    for module in re.findall(r"python -m (jfto[\w.]*\w)", page.read_text(encoding="utf-8")):
        assert importlib.util.find_spec(module) is not None, f"{page.name} runs {module}"


@pytest.mark.slow
def test_the_picture_of_the_house_is_made_from_the_imports(tmp_path):
    """Every package of src/ is in it, and the same imports give the same bytes."""
    for name in ("first.svg", "second.svg"):
        command = [sys.executable, "scripts/draw_architecture.py", "--out", tmp_path / name]
        subprocess.run(command, cwd=ROOT, check=True)
    picture = (tmp_path / "first.svg").read_text(encoding="utf-8")
    assert picture == (tmp_path / "second.svg").read_text(encoding="utf-8")
    for package in (ROOT / "src").iterdir():
        if (package / "__init__.py").exists():
            assert f">{package.name}<" in picture
