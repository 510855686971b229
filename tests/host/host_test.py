"""The command on machines that are in trouble, or odd: names of files, decimal commas, full disks, little memory, pipes that close.

    python3 host_test.py BUILD FOLDER

Whatever happens ends with an exit code of the interface and one message, and leaves nothing half-written."""
import json
import os
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import sys
import time

BUILD, FOLDER = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
PROGRAM = BUILD / "trilens"


def trilens(*words, limits=(), environment=None, **more):
    """The finished run; limits: (resource, bytes) pairs of the new process alone."""
    def set_limits():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        for what, size in limits:
            resource.setrlimit(what, (size, size))
    return subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=600,
                          env={**os.environ, **(environment or {})}, preexec_fn=set_limits, restore_signals=False, **more)


def small_scene():
    text = trilens("scene", "example", "mirror-sphere").stdout
    scene = json.loads(re.sub(r"^\s*//.*$", "", text, flags=re.M))
    scene["film"] = {"width": 64, "height": 48}
    scene["lights"] = [{"type": "point", "position": [1, 3, 3], "intensity": 20}]  # soft ones take time
    return json.dumps(scene)


def files_below(folder):
    return sorted(str(file.relative_to(folder)) for file in folder.rglob("*") if file.is_file())


def names_of_files(scene):
    """Spaces, quotes, line ends, other scripts, a leading hyphen, and 4,000 characters."""
    odd = ["with space", "it's \"quoted\"", "line\nend", "Spiegelfläche 鏡 зеркало", "100%$HOME`x`;&|", "-n"]
    for name in odd:
        folder = FOLDER / name
        folder.mkdir()
        file = folder / f"{name}.json"
        file.write_text(scene)
        for command, out in (("render", "a.exr"), ("trace", "b.exr"), ("render", "c.png")):
            run = trilens(command, "-q", file, "-o", folder / out)
            assert run.returncode == 0, (name, command, run.stderr)
        run = trilens("compare", "-q", folder / "b.exr", folder / "a.exr", "--json")
        assert run.returncode in (0, 1) and json.loads(run.stdout), (name, run.stderr)
        run = trilens("sweep", "run", "-q", file, "--over", "resolution=1..2:x2", "-o", folder / "sweep")
        assert run.returncode == 0 and (folder / "sweep/report.html").stat().st_size > 1000, (name, run.stderr)
    # From its own folder, by a name that begins with a hyphen.
    run = trilens("render", "-q", "-o", "d.exr", "--", "-n.json", cwd=FOLDER / "-n")
    assert run.returncode == 0, run.stderr

    deep = FOLDER
    while len(str(deep)) < 4000 - 201:
        deep = deep / ("d" * 200)
    os.makedirs(deep)
    (deep / "s.json").write_text(scene)
    run = trilens("render", "-q", deep / "s.json", "-o", deep / "a.exr")
    assert run.returncode == 0 and (deep / "a.exr").exists(), run.stderr
    run = trilens("render", "-q", deep / "s.json", "-o", deep / ("e" * 255) / "a.exr")
    assert run.returncode == 4 and run.stderr.count("\n") == 1, (run.returncode, run.stderr)
    shutil.rmtree(FOLDER / ("d" * 200))


def decimal_commas(scene):
    """The same bytes where numbers are written with commas; False: this machine has no such locale, nor what makes one."""
    if not shutil.which("localedef") or not pathlib.Path("/usr/share/i18n/locales/de_DE").exists():
        return False
    locales = FOLDER / "locales"
    locales.mkdir()
    subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", locales / "de_DE.UTF-8"], check=True, capture_output=True)
    (FOLDER / "comma.json").write_text(scene)
    german = {"LOCPATH": str(locales), "LC_ALL": "de_DE.UTF-8", "LANG": "de_DE.UTF-8"}
    plain = {"LC_ALL": "C"}
    seen = subprocess.run(["printf", "%.1f", "1,5"], env={**os.environ, **german}, capture_output=True, text=True).stdout
    assert seen == "1,5", f"the locale has no decimal commas: {seen}"
    for words in (["render", "-o", "comma.exr"], ["render", "-o", "comma.svg"], ["project", "--point", "0.5,0.25,1.5"]):
        answers = []
        for environment in (plain, german):
            run = trilens(*words[:1], "comma.json", "-q", *words[1:], environment=environment, cwd=FOLDER)
            assert run.returncode == 0, run.stderr
            answers.append((run.stdout, (FOLDER / words[-1]).read_bytes() if "-o" in words else b""))
        assert answers[0] == answers[1], words
    return True


def full_disk(scene):
    """Files that cannot grow: exit code 4, what was there before stays, nothing else is left."""
    folder = FOLDER / "full"
    folder.mkdir()
    (folder / "s.json").write_text(scene)
    (folder / "old.exr").write_bytes(b"what was there before")
    for words in (["render", "s.json", "-o", "old.exr"], ["render", "s.json", "-o", "new.png"], ["render", "s.json", "-o", "new.svg"],
                  ["render", "s.json", "-o", "f.####.exr", "--turntable", "2"], ["trace", "s.json", "-o", "new.exr"]):
        for size in (0, 1000):
            run = trilens(*words, "-q", limits=[(resource.RLIMIT_FSIZE, size)], cwd=folder)
            assert run.returncode == 4, (words, size, run.returncode, run.stderr)
            assert run.stderr.count("\n") == 1, run.stderr
            assert files_below(folder) == ["old.exr", "s.json"], (words, files_below(folder))
    assert (folder / "old.exr").read_bytes() == b"what was there before"
    run = trilens("render", "s.json", "-q", "-o", "/dev/full", "--format", "png", cwd=folder)
    assert run.returncode == 4, (run.returncode, run.stderr)
    with open("/dev/full", "w") as full:
        run = subprocess.run([PROGRAM, "scene", "example", "mirror-sphere"], stdout=full, stderr=subprocess.PIPE, text=True)
    assert run.returncode == 4 and run.stderr, (run.returncode, run.stderr)


def little_memory(scene):
    """Ever less of it, until the program itself does not start: a picture, or exit code 5 and one message, and no signal."""
    folder = FOLDER / "memory"
    folder.mkdir()
    (folder / "s.json").write_text(scene)
    needed = None
    refused = 0
    for size in range(1600, 0, -40):
        run = trilens("-t", 1, "render", "s.json", "-q", "-n", 64, "--set", "/film/width=900", "--set", "/film/height=600", "-o", "a.exr",
                      limits=[(resource.RLIMIT_AS, size << 20)], cwd=folder)
        if run.returncode == 127 or "error while loading shared libraries" in run.stderr:
            break
        if run.returncode == 0:
            needed = size
            (folder / "a.exr").unlink()
            continue
        assert run.returncode == 5, (size, run.returncode, run.stderr)
        assert run.stderr.count("\n") == 1 and "memory" in run.stderr, (size, run.stderr)
        assert files_below(folder) == ["s.json"], files_below(folder)
        refused += 1
    assert needed and refused > 0, (needed, refused)
    return needed, refused


def closed_pipes(scene):
    """Whoever reads may leave."""
    (FOLDER / "pipe.json").write_text(scene)
    for words in (["scene", "schema"], ["render", "pipe.json", "-q", "--format", "png", "-o", "-"]):
        run = subprocess.Popen([PROGRAM, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=FOLDER)
        run.stdout.read(10)
        run.stdout.close()
        said = run.stderr.read().decode()
        code = run.wait(timeout=120)
        assert code in (0, 4, -signal.SIGPIPE) and said.count("\n") <= 1, (words, code, said)
    run = subprocess.run(["sh", "-c", 'exec "$0" render pipe.json -o closed.exr >&- 2>&-', PROGRAM], cwd=FOLDER)
    assert run.returncode in (0, 4) and (FOLDER / "closed.exr").exists(), run.returncode  # its name cannot be printed


def signals(scene):
    """Told to stop in the middle: exit code 130 or 143, and no file."""
    folder = FOLDER / "signals"
    folder.mkdir()
    (folder / "s.json").write_text(scene)
    for one in (signal.SIGINT, signal.SIGTERM):
        run = subprocess.Popen([PROGRAM, "trace", "s.json", "-q", "--size", "4000x3000", "--spp", "4", "-o", "a.exr"], cwd=folder,
                               stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        time.sleep(1.5)
        assert run.poll() is None, "it has ended before it was told to"
        run.send_signal(one)
        code = run.wait(timeout=60)
        assert code in (130, 128 + one), (one, code)
        assert files_below(folder) == ["s.json"], files_below(folder)


def main():
    shutil.rmtree(FOLDER, ignore_errors=True)
    FOLDER.mkdir(parents=True)
    scene = small_scene()
    names_of_files(scene)
    print("names of files: six odd ones, and 4,000 characters")
    commas = decimal_commas(scene)
    print("decimal commas:", "the same bytes" if commas else "skipped: no locale de_DE, nor what makes one")
    full_disk(scene)
    print("full disks: exit code 4, nothing half-written")
    needed, refused = little_memory(scene)
    print(f"little memory: {needed} MiB of addresses suffice; of less, {refused} amounts end with a message")
    closed_pipes(scene)
    print("closed pipes: no one minds")
    signals(scene)
    print("signals: nothing half-written")


main()
