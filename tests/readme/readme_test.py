"""Runs what the README and the pages of docs/ tell their reader to type, from their text, each in a fresh folder, looks at
what comes of it, and holds the answers that they show against those of the program.

    python3 readme_test.py BUILD FOLDER [PAGE.md or folder of pages ...]

Shell blocks run as they stand, in one shell, one after the other, unless a comment before them says why not. C++ of the
README is compiled and run by tests/examples, its Python by tests/python/readme_test.py; here each is only looked for.
Python of docs/ is run where the module is built. What takes a quarter of an hour, or tests everything, is run by
continuous integration itself (.ci/run, and scripts/check studies with less to do): here it must be named there."""
import concurrent.futures
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

import pages
import pictures
from pages import Wrong

SOURCE = pathlib.Path(__file__).resolve().parents[2]
ELSEWHERE = re.compile(r"scripts/(\S+)")
WRITTEN = re.compile(r"\s-o (\S+)|>\s*(\S+)")
# Made by docs/generate/generate.py; scripts/docs checks links to them.
GENERATED = re.compile(r"(scene-cameras|scene-surfaces|examples|python-reference|cpp-headers)\.md$"
                       r"|commands/|tables/|generated/")


class Reader:
    """Someone who types a page's lines."""

    def __init__(self, build, folder, page):
        self.build, self.folder, self.page = build, folder, page
        self.ran, self.skipped, self.problems, self.log = 0, 0, [], []
        self.lacks = ""
        self.continuous = "".join((SOURCE / name).read_text() for name in (".ci/run", "scripts/check", "scripts/bench"))
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        # What a clone has, and what was built in it; results go here.
        for name in ("scenes", "examples", "bench", "LICENSE"):
            (folder / name).symlink_to(SOURCE / name)
        (folder / "build").mkdir()
        (folder / "build/release").symlink_to(build)
        self.variables = ""
        self.environment = {**os.environ, "PATH": f"{build}:{os.environ['PATH']}"}

    def check(self, where, work):
        """Notes what goes wrong; the others go on."""
        try:
            return work()
        except (Wrong, pictures.Blank, OSError, ValueError) as error:
            self.problems.append(f"{where}: {error}")
        return ""

    def start(self, command, shown):
        begin = time.monotonic()
        run = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, stdin=subprocess.DEVNULL,
                             env=self.environment)
        self.log.append(f"{time.monotonic() - begin:6.1f} s  {shown}")
        self.ran += 1
        if run.returncode != 0:
            raise Wrong(f"ends with {run.returncode}: {(run.stdout + run.stderr)[-600:]}")
        return run.stdout

    def shell(self, command):
        """Runs it; returns what it prints."""
        named = ELSEWHERE.match(command)
        if named:
            if not re.search(rf"scripts/{named[1]}\b", self.continuous):
                raise Wrong("continuous integration does not run it")
            return ""
        if re.match(r"(export )?\w+=\S+$", command):
            self.variables += command + "\n"
            return ""
        if command.startswith("trilens cad ") and not (self.build / "trilens-cad").exists():
            self.skipped += 1  # OpenCASCADE is missing, and what the line would have written
            self.lacks = WRITTEN.search(command)[1]
            return ""
        if self.lacks and self.lacks in command.split():
            self.skipped += 1
            return ""
        # The machine's own folders stay as they are.
        command = command.replace("--prefix /usr/local", "--prefix installed")
        out = self.start(["bash", "-euo", "pipefail", "-c", self.variables + command], command.split("\n")[0])
        self.look_at_results(re.split(r"  #|<<'", command)[0], out)
        return out

    def look_at_results(self, line, out):
        """Files that a line names are there and show something; what it prints says something."""
        for output, redirected in WRITTEN.findall(line):
            path = self.folder / (output or redirected)
            if output and "--print" not in line and path.is_dir():
                if "--shard" not in line:  # parts have their page when they are merged
                    pictures.require_file(path / "report.html")
            elif "--print" not in line:
                pictures.require_file(path)
            if path.suffix == ".apng":
                self.look_at_frames(path)
        if not WRITTEN.search(line) and re.match(r"trilens", line) and not out.strip():
            raise Wrong("prints nothing")
        if " project " in line and not re.search("--(json|steps)", line):
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

    def json(self, lines):
        """A scene, which is valid, or a part of one, which makes the scene that the page works on another one."""
        text = re.sub(r"^\s*//.*$", "", "\n".join(lines), flags=re.M)
        if text.lstrip().startswith("{"):
            part = json.loads(text)
        else:
            part = json.loads(re.sub(r"^\s*//.*$", "", (self.folder / "my.json").read_text(), flags=re.M))
            part.update(json.loads("{" + text + "}"))
        (self.folder / "part.json").write_text(json.dumps(part))
        self.shell("trilens scene validate part.json")

    def python(self, lines):
        """A program of the page, where the module is built."""
        if not list((self.build / "python/trilens").glob("_trilens*.so")):
            self.skipped += 1
            return
        code = "import sys; sys.path.insert(0, 'build/release/python')\n" + "\n".join(lines)
        (self.folder / "results/out").mkdir(parents=True, exist_ok=True)
        if not self.start([sys.executable, "-B", "-c", code], f"Python: {lines[2]}").strip() and "print(" in code:
            raise Wrong("prints nothing")

    def read(self, text):
        """Types what the page says, from its beginning to its end."""
        is_readme = self.page.name == "README.md"
        kinds, printed = [], None
        for block in pages.blocks_of(text):
            kinds.append(block.kind)
            if block.kind == "output":
                if printed is None:
                    self.problems.append(f"an answer without a question: {block.lines[0]}")
                else:
                    self.check(block.lines[0], lambda: pages.check_output(block.lines, printed))
                printed = None
                continue
            printed = None
            if block.kind == "shell":
                for command in pages.commands_of(block.lines):
                    if block.reason and not ELSEWHERE.match(command):
                        continue
                    out = self.check(command, lambda: self.shell(command))
                    printed = (printed or "") + (out or "")
                printed = None if block.reason else printed
            elif block.kind == "JSON" and not block.reason:
                self.check(block.lines[0], lambda: self.json(block.lines))
            elif block.kind == "Python" and not is_readme and not block.reason and block.lines[0].startswith("import "):
                self.check(block.lines[2], lambda: self.python(block.lines))
        for line in pages.inline_commands(text):
            self.check(line, lambda: self.shell(line))
        self.check_links(text)
        if is_readme and (self.ran < 5 or not {"shell", "C++", "Python", "output"} <= set(kinds)):
            self.problems.append(f"the README has hardly anything to try: {self.ran} commands, {sorted(set(kinds))}")
        if is_readme and text.count("\n") > 150:
            self.problems.append(f"the README has {text.count(chr(10))} lines, and at most 150 are read")

    def check_links(self, text):
        prose = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
        for shown, name in re.findall(r"(!?)\[[^]]*\]\(([^)#\s]+)(?:#[^)]*)?\)", prose):
            if "://" in name or (self.page.name != "README.md" and GENERATED.match(name)):
                continue
            path = self.page.parent / name
            self.check(name, lambda: pictures.require_file(path) if shown else path.stat())
        for name in re.findall(r"`((?:scripts|bench|scenes|examples|results|tests|src|python|docs)/[\w./-]+)`", prose):
            if not (SOURCE / name).exists() and not re.search(r"NAME|^results/out", name):
                self.problems.append(f"there is no {name}")


def read_page(build, folder, page):
    reader = Reader(build, folder / page.stem, page)
    # Where a page speaks of a scene of the reader's own.
    with open(reader.folder / "my.json", "w") as own:
        subprocess.run([build / "trilens", "scene", "example", "mirror-sphere"], stdout=own, check=True)
    reader.check("its blocks", lambda: reader.read(page.read_text()))
    return reader


def main():
    build, folder = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    asked = [pathlib.Path(word).resolve() for word in sys.argv[3:]]
    asked = [page for word in asked or [SOURCE / "README.md", SOURCE / "docs"]
             for page in ([word] if word.is_file() else sorted(word.glob("*.md")))]
    passed = failed = skipped = 0
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        for reader in pool.map(lambda page: read_page(build, folder, page), asked):
            print(f"{reader.page.relative_to(SOURCE)}: {reader.ran} commands", flush=True)
            for line in [*reader.log, *(f"PROBLEM of {reader.page.name}: {one}" for one in reader.problems)]:
                print(line, flush=True)
            passed += max(reader.ran - len(reader.problems), 0)
            failed += len(reader.problems)
            skipped += reader.skipped
    print(f"{passed} passed, {failed} failed, {skipped} skipped")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
