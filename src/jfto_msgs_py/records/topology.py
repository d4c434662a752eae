"""The forms of C-TOP, by the names that scenarios, plans and nodes have for them."""

from __future__ import annotations

# The default; Algorithm 2; and Algorithm 2 with powers up to the next candidate's.
ELASTIC, LITERAL, CLOSED = TOPOLOGY_FORMS = ("elastic", "literal", "closed")
