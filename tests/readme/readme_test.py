"""Runs what the README tells its reader to type, from its text, in a fresh folder, and looks at what comes of it.

    python3 readme_test.py BUILD FOLDER [README]

Indented blocks are shell lines, C++, Python, JSON or a quotation; anything else is a mistake of the README or of this
test. Shell lines run as they stand, in one shell, one after the other. C++ is compiled and run by tests/examples, Python
by tests/python/readme_test.py; here each is only looked for. What takes a quarter of an hour, or tests everything, is run by
continuous integration itself (.ci/run, and scripts/check studies with less to do): here it must be named there."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

import pictures

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SHELL = re.compile(r"(\$?trilens[ =]|scripts/|mkdir |echo |cmake |cd |pip |doxygen )")
ELSEWHERE = re.compile(r"scripts/(\S+)")
WRITTEN = re.compile(r"\s-o (\S+)|>\s*(\S+)")


class Wrong(Exception):
    """What is not as the README says."""


def blocks_of(text):
    """The indented blocks as (kind, lines without the indent). Programs may have empty lines in them."""
    # Fenced blocks are indented ones.
    text = re.sub(r"^```\w*\n(.*?)^```$", lambda fenced: "\n" + re.sub(r"^", "    ", fenced[1].rstrip(), flags=re.M) + "\n",
                  text, flags=re.M | re.S)
    found, after_text = [], True
    for part in re.split(r"\n(?:[ \t]*\n)+", text):
        lines = part.strip("\n").split("\n")
        # What is indented less belongs to a paragraph, or a paragraph to it.
        if not all(line.startswith("    ") for line in lines):
            after_text = True
            continue
        lines = [line[4:] for line in lines]
        if not after_text and found[-1][0] in ("C++", "Python") and not SHELL.match(lines[0]):
            found[-1][1].extend(["", *lines])
        else:
            found.append((kind_of(lines), lines))
        after_text = False
    return found


def kind_of(block):
    first = block[0]
    if all(SHELL.match(line) for line in block):
        return "shell"
    if first.startswith("#include"):
        return "C++"
    if first.startswith("import "):
        return "Python"
    if first.startswith('"'):
        return "JSON"
    if first[0].isupper() and not any(c in first for c in "$=`"):
        return "quotation"
    raise Wrong(f"nobody runs the README's block that begins with: {first}")


class Reader:
    """Someone who types the README's lines."""

    def __init__(self, build, folder):
        self.folder, self.ran, self.problems = folder, 0, []
        self.continuous = (SOURCE / ".ci/run").read_text() + (SOURCE / "scripts/check").read_text()
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        # What a clone has, and what was built in it; results go here.
        for name in ("scenes", "examples", "bench", "LICENSE"):
            (folder / name).symlink_to(SOURCE / name)
        (folder / "build").mkdir()
        (folder / "build/release").symlink_to(build)
        self.variables = ""

    def check(self, where, work):
        """Notes what goes wrong; the others go on."""
        try:
            work()
        except (Wrong, pictures.Blank, OSError, ValueError) as error:
            self.problems.append(f"{where}: {error}")

    def shell(self, line):
        named = ELSEWHERE.match(line)
        if named:
            if not re.search(rf"scripts/{named[1]}\b", self.continuous):
                raise Wrong("continuous integration does not run it")
            return
        if re.match(r"\w+=\S+$", line):
            self.variables += line + "\n"
            return
        # The machine's own folders stay as they are.
        line = line.replace("--prefix /usr/local", "--prefix installed")
        begin = time.monotonic()
        run = subprocess.run(["bash", "-euo", "pipefail", "-c", self.variables + line], cwd=self.folder,
                             capture_output=True, text=True, stdin=subprocess.DEVNULL)
        print(f"{time.monotonic() - begin:6.1f} s  {line}", flush=True)
        self.ran += 1
        if run.returncode != 0:
            raise Wrong(f"ends with {run.returncode}: {(run.stdout + run.stderr)[-600:]}")
        self.look_at_results(line.split("  #")[0], run.stdout)

    def look_at_results(self, line, out):
        """Files that a line names are there and show something; what it prints says something."""
        for output, redirected in WRITTEN.findall(line):
            path = self.folder / (output or redirected)
            if output and "--print" not in line and path.is_dir():
                pictures.require_file(path / "report.html")
            elif "--print" not in line:
                pictures.require_file(path)
            if path.suffix == ".apng":
                self.look_at_frames(path)
        if not WRITTEN.search(line) and re.match(r"\$trilens", line) and not out.strip():
            raise Wrong("prints nothing")
        if " project " in line:
            rows = [row.split(",") for row in out.split()]
            images = [dict(zip(rows[0], row)) for row in rows[1:]]
            if not any(image["path"] != "direct" and image["visible"] == "1" for image in images):
                raise Wrong(f"the point is seen in no optic: {out}")
            if any(image["visible"] != "1" for image in images):
                raise Wrong(f"an image of the point is hidden: {out}")

    def look_at_frames(self, path):
        """No frame shows far less than the others, such as a wall that the camera went behind."""
        shares = [deflated / raw for _, _, deflated, raw in pictures.png_frames(path.read_bytes(), path.name)]
        if len(shares) < 12 or min(shares) < max(shares) / 6:
            raise Wrong(f"{path.name}: {len(shares)} frames, the emptiest with {min(shares):.4f}, the fullest {max(shares):.4f}")

    def json(self, block):
        """A part of a scene file: it makes the scene that the README works on another one."""
        scene = json.loads(re.sub(r"^\s*//.*$", "", (self.folder / "my.json").read_text(), flags=re.M))
        scene.update(json.loads("{" + "\n".join(block) + "}"))
        (self.folder / "part.json").write_text(json.dumps(scene))
        self.shell("$trilens scene validate part.json")


def inline_commands(text):
    """What stands in the sentences: `$trilens scene schema`, `trilens scene example crystal-ball`; not the mere names of
    commands."""
    found = re.findall(r"`\$?trilens ([a-z]+ [^`]*)`", re.sub(r"\s+", " ", text))
    return ["$trilens " + command.replace("COMMAND", "render") for command in found]


def check_links(reader, text):
    for shown, name in re.findall(r"(!?)\[[^]]*\]\(([^)#\s]+)\)", text):
        if "://" in name:
            continue
        path = SOURCE / name
        reader.check(name, lambda: pictures.require_file(path) if shown else path.stat())
    for name in re.findall(r"`((?:scripts|bench|scenes|examples|results|tests|src|python|docs)/[\w./-]+)`", text):
        if not (SOURCE / name).exists() and not name.startswith("results/out"):
            reader.problems.append(f"there is no {name}")


def main():
    build, folder = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    text = pathlib.Path(sys.argv[3] if len(sys.argv) > 3 else SOURCE / "README.md").read_text()
    reader = Reader(build, folder)
    kinds = []
    for kind, block in blocks_of(text):
        kinds.append(kind)
        if kind == "shell":
            for line in block:
                reader.check(line, lambda: reader.shell(line))
        elif kind == "JSON":
            reader.check(block[0], lambda: reader.json(block))
    for line in inline_commands(text):
        reader.check(line, lambda: reader.shell(line))
    check_links(reader, text)
    if reader.ran < 10 or not {"shell", "C++", "Python"} <= set(kinds):
        reader.problems.append(f"the README has hardly anything to try: {reader.ran} commands, {sorted(set(kinds))}")
    for problem in reader.problems:
        print("README:", problem)
    print(f"{reader.ran - min(reader.ran, len(reader.problems))} passed, {len(reader.problems)} failed, 0 skipped")
    return 1 if reader.problems else 0


if __name__ == "__main__":
    sys.exit(main())
