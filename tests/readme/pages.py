"""What a page of Markdown asks its reader to type, and what it shows as the answer."""
import dataclasses
import re

SHELL = re.compile(r"(\$?trilens[ =]|scripts/|mkdir |echo |printf |cat |cmake |cd |pip |doxygen |export )")
LANGUAGES = {"sh": "shell", "text": "output", "python": "Python", "cpp": "C++", "js": "JSON", "json": "JSON", "": "figure",
             "cmake": "figure"}
NUMBER = re.compile(r"[-+]?\d[\d,]*\.?\d*(?:[eE][-+]?\d+)?")
# Numbers of a page may lie this far from those of another machine's libraries.
NEAR = 0.05


class Wrong(Exception):
    """What is not as the page says."""


@dataclasses.dataclass
class Block:
    kind: str
    lines: list
    reason: str = ""  # why it is not run


def kind_of_indented(lines):
    first = lines[0]
    if all(SHELL.match(line) for line in lines):
        return "shell"
    if first.startswith("#include"):
        return "C++"
    if first.startswith("import "):
        return "Python"
    raise Wrong(f"nobody runs the block that begins with: {first}")


def blocks_of(text):
    """The blocks of a page in their order, fenced or indented; programs may have empty lines in them."""
    found, lines, i, reason, after_text = [], text.split("\n"), 0, "", True
    while i < len(lines):
        line = lines[i]
        fence = re.match(r"(`{3,})([\w{}]*)", line)
        marked = re.match(r"<!-- not run: (.+) -->$", line)
        if fence:
            end = lines.index(fence[1], i + 1)
            language = fence[2]
            if not language.startswith("{"):
                if language not in LANGUAGES:
                    raise Wrong(f"a block of {language}: nobody knows what to do with it")
                found.append(Block(LANGUAGES[language], lines[i + 1:end], reason))
            i, reason, after_text = end + 1, "", True
        elif marked:
            reason = marked[1]
            i += 1
        elif line.startswith("    ") and (i == 0 or not lines[i - 1].strip()):
            end = i
            while end < len(lines) and (lines[end].startswith("    ") or not lines[end].strip()):
                end += 1
            block = [one[4:] for one in lines[i:end]]
            while not block[-1].strip():
                block.pop()
            found.append(Block(kind_of_indented(block), block, reason))
            i, reason = end, ""
        else:
            i += 1
    return found


def commands_of(lines):
    """A shell block's lines as commands: those that a backslash or a here-document joins are one."""
    commands, i = [], 0
    while i < len(lines):
        command = lines[i]
        i += 1
        while command.endswith("\\") and i < len(lines):
            command += "\n" + lines[i]
            i += 1
        here = re.search(r"<<'(\w+)'", command)
        while here and i < len(lines):
            command += "\n" + lines[i]
            i += 1
            if lines[i - 1] == here[1]:
                break
        if command.strip():
            commands.append(command)
    return commands


def inline_commands(text):
    """What stands in the sentences: `trilens scene schema`; not the mere names of commands, nor what has a placeholder."""
    text = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
    found = re.findall(r"`\$?trilens ([a-z]+ [^`]*)`", re.sub(r"\s+", " ", text))
    return list(dict.fromkeys("trilens " + command for command in found if not re.search(r"\b[A-Z]{2,}\b", command)))


def line_agrees(shown, printed):
    """Word for word, numbers nearly; "..." stands for the rest of a line, or for one word."""
    wanted, got = shown.split(), printed.split()
    if wanted and wanted[-1] == "..." and shown.strip() != "...":
        wanted, got = wanted[:-1], got[:len(wanted) - 1]
    if len(wanted) != len(got):
        return False
    for want, have in zip(wanted, got):
        if want in ("...", have):
            continue
        if NUMBER.sub("#", want) != NUMBER.sub("#", have):
            return False
        for a, b in zip(NUMBER.findall(want), NUMBER.findall(have)):
            a, b = float(a.replace(",", "")), float(b.replace(",", ""))
            if abs(a - b) > NEAR * max(abs(a), abs(b)) + 1e-9:
                return False
    return True


def check_output(shown, printed):
    """Raises Wrong where a command's answer is not what the page shows; a line "..." stands for any lines."""
    printed = [line.rstrip() for line in printed.split("\n")]
    at, skipping = 0, False
    for line in shown:
        if line.strip() == "...":
            skipping = True
            continue
        while skipping and at < len(printed) and not line_agrees(line, printed[at]):
            at += 1
        if at >= len(printed) or not line_agrees(line, printed[at]):
            raise Wrong(f"the page shows \"{line}\", the answer is \"{printed[at] if at < len(printed) else 'at its end'}\"")
        at, skipping = at + 1, False
    if not skipping and any(line.strip() for line in printed[at:]):
        raise Wrong(f"the page leaves out \"{printed[at]}\" without a word")
