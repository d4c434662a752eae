"""Print how much of each recording of a real ArduCopter the simulator answers alike.

Usage: python bench/conformance.py FOLDER [NUMBER ...] [--missed]
"""

from __future__ import annotations

import argparse
import statistics
import sys
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "test"))

from support.conformance import compare, read_recording, replay
from support.conformance.compare import ANSWERS, key


def groups(folder: Path) -> list[list[Path]]:
    """Recordings of a folder; the two ports of recording 07 belong together."""
    files = sorted([*folder.glob("*.tlog"), *folder.glob("*.tlog.xz")])
    together: dict[str, list[Path]] = {}
    for path in files:
        name = path.name.split(".")[0]
        stem = name[:-2] if name.endswith(("_a", "_b")) else name
        together.setdefault(stem, []).append(path)
    return list(together.values())


def main() -> None:
    """Replay, compare, print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("number", nargs="*", help="first characters of recordings to run")
    parser.add_argument("--missed", action="store_true", help="list what did not match")
    args = parser.parse_args()
    print(f"{'recording':34} answers  share  telemetry  share  extra  time error mean / worst, s")
    for paths in groups(args.folder):
        if args.number and not paths[0].name.startswith(tuple(args.number)):
            continue
        recording = read_recording(*paths)
        score = compare(recording.name, *replay(recording))
        extra = [a for a in score.extra if a.message.get_type() in ANSWERS]
        errors = [abs(e) for e in score.errors_s] or [0.0]
        print(
            f"{score.name:34} {score.answers:7} {score.share:6.1%} {score.telemetry:10} "
            f"{score.telemetry_share:6.1%} {len(extra):6}  "
            f"{statistics.fmean(errors):.3f} / {max(errors):.2f}"
        )
        if args.missed:
            for a in score.missed[:60]:
                print(f"   missed {a.system}:{a.port} {a.epoch} {a.time_s:9.3f} {key(a.message)}")
            for a in extra[:60]:
                print(f"   extra  {a.system}:{a.port} {a.epoch} {a.time_s:9.3f} {key(a.message)}")
            print("   missed by type:", Counter(a.message.get_type() for a in score.missed))


if __name__ == "__main__":
    main()
