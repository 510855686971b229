"""Pages of the commands, from the manual pages in roff that the program writes."""
import pathlib
import re
import tempfile

from program import table


def roff_text(line):
    """Inline roff as Markdown."""
    line = re.sub(r"\\f([BIR])", lambda m: {"B": "\1", "I": "\2", "R": "\3"}[m[1]], line)
    line = line.replace("\\-", "-").replace("\\(aq", "'").replace("\\e", "\\\\").replace("\\&", "")
    line = re.sub(r"([*_<>])", r"\\\1", line)
    line = re.sub("\x01([^\x01-\x03]*)\x03", r"**\1**", line)
    return re.sub("\x02([^\x01-\x03]*)\x03", r"*\1*", line)


def roff_line(line):
    """A line, with its macro, as Markdown."""
    for macro, marks in ((".BR ", ("**", "")), (".RI ", ("", "*")), (".B ", ("**",)), (".I ", ("*",)), (".IR ", ("*", ""))):
        if line.startswith(macro):
            rest = line[len(macro):]
            words = [rest.replace('"', "")] if len(marks) == 1 else rest.split(" ")
            return "".join(f"{marks[i % len(marks)]}{roff_text(word)}{marks[i % len(marks)]}"
                           for i, word in enumerate(words))
    return roff_text(line)


def manual_page(roff, names):
    """(what it is about, Markdown) of a manual page; what names another page links to it."""
    out, lines, i = [], roff.split("\n"), 0
    plain, name_part, about = False, False, ""

    def linked(text):
        found = re.match(r"\*\*(trilens[\w-]*)\*\*\((\d)\)", text)
        return f"[{found[1].replace('-', ' ')}]({found[1]}.md)" if found and found[1] in names else text

    while i < len(lines):
        line = lines[i]
        i += 1
        if line.startswith(".TH "):
            continue
        if line.startswith(".SH "):
            heading = line[4:].strip('" ')
            plain = name_part = False
            if heading == "NAME":
                name_part = True
            elif heading == "DESCRIPTION" and " ".join(lines[i:i + 3]).startswith(about):
                i += lines[i:].index(next(one for one in lines[i:] if one.startswith(".SH")))  # says the name's words again
            else:
                out.append(f"\n## {heading.capitalize()}\n")
        elif line.startswith((".TP", ".IP")):
            term, words = linked(roff_line(lines[i])), []
            i += 1
            while i < len(lines) and not lines[i].startswith((".TP", ".SH", ".IP")):
                if lines[i].strip() and lines[i] not in (".PP", ".br", ".EX", ".EE", ".nf", ".fi"):
                    words.append(roff_line(lines[i]))
                i += 1
            out.append(f"\n{term}\n: {' '.join(words) or '(no more)'}\n")
        elif line in (".nf", ".EX"):
            plain = True
            out.append("\n```text")
        elif line in (".fi", ".EE"):
            plain = False
            out.append("```\n")
        elif line in (".PP", ".br", ".P") or line.startswith(('.\\"', ".ad", ".nh", ".hy", ".RS", ".RE")):
            out.append("")
        elif line.strip():
            if name_part:
                about = (about + " " + re.sub(r"^trilens[\w -]* - ", "", line.replace("\\-", "-"))).strip()
                continue
            if not plain and line.startswith((".BR ", ".B ")) and "(" in line:
                line = re.sub(r"\.BR? (\S+) (\(1\)).*", r".BR \1 \2", line)
                out.append(linked(roff_line(line)) + " ")
                continue
            out.append(line.replace("\\-", "-").replace("\\e", "\\") if plain else roff_line(line) + " ")
    return roff_text(about[:1].upper() + about[1:] + "."), "\n".join(out)


def write_commands(program, out):
    folder = out / "commands"
    folder.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as made:
        program.text("man", "--all", made)
        pages = {file.stem: file.read_text() for file in sorted(pathlib.Path(made).glob("*.1"), key=lambda one: one.stem)}
    about = {}
    for name, roff in pages.items():
        about[name], text = manual_page(roff, pages)
        (folder / f"{name}.md").write_text(f"# {name.replace('-', ' ', 2)}\n\n{about[name]}\n\n{text}\n")
    listed = "\n".join(f"{name}" for name in pages)
    (folder / "index.md").write_text(
        "# Commands\n\nWhat every command does, with all of its options, as `trilens help COMMAND` and the manual pages "
        "say it. These pages are made from the program itself. Each ends with the exit codes that scripts can rely on.\n\n"
        + table(("command", "what it does"), [(f"[{n.replace('-', ' ', 2)}]({n}.md)", about[n]) for n in pages])
        + f"\n```{{toctree}}\n:hidden:\n\n{listed}\n```\n")
