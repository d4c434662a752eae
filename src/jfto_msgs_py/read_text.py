"""Reading a text file that a user names, with every way it can fail said in words."""

from __future__ import annotations

from pathlib import Path

from jfto_msgs_py.errors import InputError


def read_text(path: Path, error: type[InputError], what: str, size_limit: int) -> str:
    """Text of a UTF-8 file of at most `size_limit` bytes; raises `error` if that fails.

    `what` names the kind of file that is asked for, such as "scenario".
    """
    if path.is_dir():
        raise error(f"{path}: is a directory. Name a {what} file.")
    try:
        if path.stat().st_size > size_limit:
            raise error(
                f"{path}: has {path.stat().st_size / 1e6:.1f} MB, more than any {what} file "
                f"({size_limit / 1e6:g} MB). Is it the right file?"
            )
        return path.read_bytes().decode("utf-8-sig")
    except FileNotFoundError:
        raise error(f"{path}: no such file.{_alternatives(path)}") from None
    except PermissionError:
        raise error(f"{path}: may not be read. Check its permissions.") from None
    except UnicodeDecodeError:
        raise error(f"{path}: is not a text file. Name a {what} file in UTF-8.") from None
    except OSError as cause:
        raise error(f"{path}: cannot be read: {cause.strerror}. Check the path.") from None


def _alternatives(path: Path) -> str:
    """Names of files of the same kind beside the missing one."""
    folder = path.parent
    if not folder.is_dir():
        return f" There is no directory {folder} either; check the path."
    names = sorted(entry.name for entry in folder.glob(f"*{path.suffix}") if entry.is_file())[:6]
    if not names or not path.suffix:
        return " Check the path."
    return f" {folder}/ has {', '.join(names)}."
