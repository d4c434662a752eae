"""Whether a page is well formed and loads nothing."""

from __future__ import annotations

from html.parser import HTMLParser

# Elements that HTML never closes.
_VOID = {"meta", "img", "input", "br"}


class HtmlChecker(HTMLParser):
    """Counts elements that are left open or closed out of turn, and references to elsewhere."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.amiss: list[str] = []
        self.outside: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.outside += [
            value
            for name, value in attrs
            if name in {"src", "href"} and value and not value.startswith(("data:", "#"))
        ]
        if tag not in _VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if not self.open or self.open.pop() != tag:
            self.amiss.append(tag)
