"""Orders to a bridge that runs on this computer, over a socket of its own: a line there and back.

It imports nothing heavy: from the key to the vehicles must take no longer than half a second.
"""

from __future__ import annotations

import json
import os
import socket
import stat
import tempfile
from pathlib import Path

from jfto_msgs_py.errors import InputError

# An order waits for the vehicles to be seen to obey.
_ANSWER_S = 90.0
_LINE_MAX = 100_000
# The orders that a bridge takes, and its services of the same effect.
VERBS = {"home": "abort", "return": "abort", "hold": "pause", "pause": "pause",
         "resume": "resume", "land": "land"}  # fmt: skip


def order_socket(domain: int | str | None = None) -> Path:
    """Where the bridge of a ROS domain listens, of this user's; the environment's where None."""
    if domain is None:
        domain = os.environ.get("ROS_DOMAIN_ID") or 0
    own = os.environ.get("XDG_RUNTIME_DIR") or tempfile.gettempdir()
    return Path(own) / f"jfto-{os.getuid()}" / f"orders-{domain}.sock"


def make_order_folder(path: Path) -> None:
    """The folder of a socket, which nobody else may enter; raises InputError."""
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        found = path.parent.lstat()
    except OSError as error:
        raise InputError(f"{path.parent}: cannot be made: {error.strerror}.") from None
    if found.st_uid != os.getuid() or stat.S_IMODE(found.st_mode) & 0o077:
        raise InputError(f"{path.parent}: belongs to somebody else, or others may enter it.")


def send_order(verb: str, domain: int | str | None = None) -> tuple[bool, str]:
    """Give the fleet an order of VERBS; returns whether all obeyed, and what each does.

    Raises InputError where no bridge listens, naming those that do.
    """
    path = order_socket(domain)
    with socket.socket(socket.AF_UNIX) as line:
        line.settimeout(_ANSWER_S)
        try:
            line.connect(str(path))
            line.sendall(f"{VERBS[verb]}\n".encode())
            answer = json.loads(_read_line(line))
        except TimeoutError:
            raise InputError(
                f"{verb}: the bridge took the order and has not answered for {_ANSWER_S:g} s."
            ) from None
        except (OSError, ValueError):
            raise InputError(_nobody(path)) from None
    return bool(answer["success"]), str(answer["text"])


def _read_line(line: socket.socket) -> bytes:
    got = b""
    while not got.endswith(b"\n") and len(got) < _LINE_MAX:
        more = line.recv(4096)
        if not more:
            break
        got += more
    return got


def _nobody(path: Path) -> str:
    others = sorted(each.stem.partition("-")[2] for each in path.parent.glob("orders-*.sock"))
    domain = path.stem.partition("-")[2]
    here = [each for each in others if each != domain]
    cure = f" Bridges have listened on {', '.join(here)}: set ROS_DOMAIN_ID." if here else ""
    return (
        f"no bridge runs on this computer on ROS domain {domain}.{cure} Or name the links "
        "themselves: --vehicles."
    )
