"""Takes orders from programs on this computer, which need no ROS for it."""

from __future__ import annotations

import json
import socket
import threading
from collections.abc import Callable
from pathlib import Path

from jfto_msgs_py.errors import InputError
from jfto_msgs_py.order_socket import VERBS, make_order_folder

_LINE_MAX = 100
_HURRY_S = 5.0


class OrderServer:
    """Listens at `path` until closed; `obey` carries an order out: success, and words.

    Raises InputError where another bridge listens there, or nobody can.
    """

    def __init__(self, path: Path, obey: Callable[[str], tuple[bool, str]]) -> None:
        self._path, self._obey = path, obey
        make_order_folder(path)
        self._socket = socket.socket(socket.AF_UNIX)
        try:
            if _answers(path):
                raise InputError(f"{path}: another bridge takes orders there.")
            path.unlink(missing_ok=True)
            self._socket.bind(str(path))
            self._socket.listen()
        except (OSError, InputError) as error:
            self._socket.close()
            raise InputError(str(error)) from None
        threading.Thread(target=self._listen, name="orders", daemon=True).start()

    def close(self) -> None:
        """Take no more orders."""
        self._path.unlink(missing_ok=True)
        # Wakes whoever waits in accept.
        self._socket.shutdown(socket.SHUT_RDWR)
        self._socket.close()

    def _listen(self) -> None:
        while True:
            try:
                caller, _ = self._socket.accept()
            except OSError:
                return
            threading.Thread(target=self._serve, args=(caller,), daemon=True).start()

    def _serve(self, caller: socket.socket) -> None:
        with caller:
            try:
                caller.settimeout(_HURRY_S)
                verb = caller.recv(_LINE_MAX).decode(errors="replace").strip()
                success, text = False, f"{verb!r} is no order."
                if verb in VERBS.values():
                    success, text = self._obey(verb)
                caller.sendall((json.dumps({"success": success, "text": text}) + "\n").encode())
            except OSError:
                # Who has asked is gone; the order was carried out.
                return


def _answers(path: Path) -> bool:
    with socket.socket(socket.AF_UNIX) as line:
        try:
            line.connect(str(path))
        except OSError:
            return False
    return True
