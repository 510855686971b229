"""Lines of each room that fuzzers reach, as CSV: lines_by_room.py LLVM_COV.json SOURCE

LLVM_COV.json: of `llvm-cov export -summary-only`. The source's own files alone, and of these not the fuzzers'."""
import collections
import json
import pathlib
import sys


def room_of(file, source):
    """A file's room as the source has it, src/scene or reflect; none of files from elsewhere."""
    try:
        parts = pathlib.PurePath(file).relative_to(source).parts
    except ValueError:
        return None
    if parts[0] in ("build", "fuzz", "tests"):
        return None
    return "/".join(parts[:2]) if parts[0] == "src" else parts[0]


def main():
    counted, source = json.loads(pathlib.Path(sys.argv[1]).read_text()), sys.argv[2]
    rooms = collections.defaultdict(lambda: [0, 0])
    for file in counted["data"][0]["files"]:
        room = room_of(file["filename"], source)
        if room:
            lines = file["summary"]["lines"]
            rooms[room][0] += lines["count"]
            rooms[room][1] += lines["covered"]
    if not rooms:
        sys.exit(f"lines_by_room: {sys.argv[1]} has no file of {source}")
    rooms["all"] = [sum(column) for column in zip(*rooms.values())]
    print("room,lines,reached,percent")
    for room, (lines, reached) in rooms.items():
        print(f"{room},{lines},{reached},{100 * reached / max(lines, 1):.1f}")


main()
