"""Flies a plan over the node graph: link, upload, check, start, follow, home."""
