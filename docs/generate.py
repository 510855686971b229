#!/usr/bin/python3
"""Makes what Sphinx reads: the pages of docs/, and those that are generated from the program itself.

    python3 generate.py --trilens PROGRAM --headers FOLDER --python FOLDER OUT

Generated are the pages of the commands (from `trilens man`), of scene files (from `trilens scene schema`, with a picture
for each camera and surface), of the examples (with their pictures), of the Python module (from its .pyi, with docstrings
where the module is built), of the C++ headers, and the tables of results/. Pictures are drawn by the program of now and
kept in OUT until it changes."""
import argparse
import ast
import csv
import importlib
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import figures

DOCS = pathlib.Path(__file__).resolve().parent
SOURCE = DOCS.parent


def table(head, rows):
    """A Markdown table; cells may hold any text."""
    def row(cells):
        return "| " + " | ".join(str(cell).replace("|", "\\|").replace("\n", " ") for cell in cells) + " |"
    return "\n".join([row(head), "|" + "---|" * len(head), *(row(cells) for cells in rows)]) + "\n"


def without_comments(text):
    """A scene file as plain JSON."""
    return re.sub(r'("(?:[^"\\]|\\.)*")|//[^\n]*', lambda m: m[1] or "", text)


class Program:
    """The trilens that the pages tell of, and the pictures that it draws."""

    def __init__(self, path, pictures):
        self.path, self.pictures = path, pictures
        self.drawn = 0
        pictures.mkdir(parents=True, exist_ok=True)

    def text(self, *words):
        return subprocess.run([self.path, *words], check=True, capture_output=True, text=True).stdout

    def draw(self, name, scene, *words):
        """pictures/name.png of a scene: a file, or its text. Drawn again where scene, words or program are newer."""
        target, asked = self.pictures / f"{name}.png", self.pictures / f"{name}.asked"
        text = scene.read_text() if isinstance(scene, pathlib.Path) else scene
        wish = "\n".join([*words, text])
        library = pathlib.Path(self.path).resolve()
        if not (target.exists() and asked.exists() and asked.read_text() == wish
                and target.stat().st_mtime > library.stat().st_mtime):
            samples = () if "--spp" in words else ("--spp", "3")
            command = [self.path, "render", scene if isinstance(scene, pathlib.Path) else "-", "--tone", "neutral",
                       "-q", "-o", target, *samples, *words]
            done = subprocess.run(command, input=text, capture_output=True, text=True)
            if done.returncode:
                raise SystemExit(f"{name} cannot be drawn: {done.stderr}")
            asked.write_text(wish)
            self.drawn += 1
        return f"pictures/{name}.png"


# Pages of the commands, from manual pages in roff.

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


# Pages of scene files, from the schema.

class Schema:
    """The JSON Schema of scene files, and what its objects may hold."""

    def __init__(self, text):
        self.whole = json.loads(text)
        self.definitions = self.whole.get("definitions", self.whole.get("$defs", {}))

    def kind(self, node):
        """A field's type in words."""
        if "$ref" in node:
            name = node["$ref"].split("/")[-1]
            target = self.definitions.get(name, {})
            if "properties" in target:
                return f"[{name}](#{anchor_of(target.get('title', name))})"
            return self.kind({**target, **{k: v for k, v in node.items() if k != "$ref"}})
        if "const" in node:
            return f"`{json.dumps(node['const'])}`"
        if "enum" in node:
            return ", ".join(f"`{value}`" if isinstance(value, str) else f"`{json.dumps(value)}`" for value in node["enum"])
        for choice in ("oneOf", "anyOf"):
            if choice in node:
                return " or ".join(dict.fromkeys(self.kind(one) for one in node[choice]))
        kind = node.get("type", "any value")
        if isinstance(kind, list):
            return " or ".join(kind)
        if kind == "array":
            least, most = node.get("minItems"), node.get("maxItems")
            count = f"{least} " if least == most and least else ""
            items = node.get("items", {})
            target = self.definitions.get(items.get("$ref", "").split("/")[-1], items)
            if target.get("type") == "array":
                return f"list of {count}lists of {self.kind(target).removeprefix('list of ')}"
            inner = self.kind(items)
            return f"list of {count}{inner}" if "`" in inner or inner.startswith("[") else f"list of {count}{plural(inner)}"
        words = {"integer": "integer", "number": "number", "string": "text", "boolean": "`true` or `false`", "object": "object"}
        return words.get(kind, kind) + self.range_of(node)

    @staticmethod
    def range_of(node):
        least, most = node.get("minimum"), node.get("maximum")
        above, below = node.get("exclusiveMinimum"), node.get("exclusiveMaximum")
        small = least is not None and abs(least) < 1e29
        large = most is not None and abs(most) < 1e9
        parts = []
        if small:
            parts.append(f"{least:g}" + (" to" if large else " or more"))
        elif above is not None:
            parts.append(f"above {above:g}" + ("," if large or below is not None else ""))
        if large:
            parts.append(f"{most:g}" if small else f"at most {most:g}")
        elif below is not None:
            parts.append(f"below {below:g}")
        return f", {' '.join(parts)}" if parts else ""

    def rows(self, node, hidden=(), required=(), kind=None, kinds=()):
        """A table's rows of an object's fields: name, type, default, meaning."""
        rows = []
        for name, field in node["properties"].items():
            if name in hidden or name == "$schema":
                continue
            default = field.get("default")
            shown = "**required**" if name in required else "" if default is None else f"`{json.dumps(default)}`"
            rows.append((f"`{name}`", self.kind(field), shown, meaning(field.get("description", ""), kind, kinds)))
        return rows


def plural(word):
    head, _, rest = word.partition(",")
    return head + "s" + ("," + rest if rest else "")


def anchor_of(title):
    return re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-")


def meaning(text, kind, kinds):
    """Of a description with parts for several kinds ("oblique: ...; planarContext: ...") those that concern this one."""
    if kind is None:
        return text
    kept = []
    for part in re.split(r"; (?=\w[\w, ]*: )", text):
        found = re.match(r"(\w[\w, ]*): (.*)", part, re.S)
        named = [word.strip() for word in found[1].split(",")] if found else []
        if named and all(word in kinds for word in named):
            if kind in named:
                kept.append(found[2][:1].upper() + found[2][1:])
        else:
            kept.append(part)
    return "; ".join(kept)


def variants(definition):
    """[(value of "type", fields that it may not have, fields that it must have)] of an object with kinds."""
    found = []
    for rule in definition.get("allOf", []):
        wanted = rule.get("if", {}).get("properties", {}).get("type", {})
        then = rule.get("then", {})
        if "const" in wanted:
            hidden = [name for name, field in then.get("properties", {}).items() if field is False]
            found.append((wanted["const"], hidden, then.get("required", [])))
    return found


HEAD = ("field", "type", "default", "meaning")
# What stands on a page of its own; everything else is on the page of the scene file.
CAMERA_PARTS = ("camera", "lookAt", "placedRay", "view")
SURFACE_PARTS = ("mesh", "primitive", "normals", "transform")


def section(schema, name, level="##", text=""):
    definition = schema.definitions[name]
    title = definition.get("title", name)
    return (f"\n{level} {title[:1].upper() + title[1:]}\n\n{definition.get('description', '')}\n\n{text}"
            + table(HEAD, schema.rows(definition, required=definition.get("required", []))))


def kinds_of(schema, name, pictures, note=""):
    """A part for each kind of a camera, a primitive, ... with its picture and the fields that it has."""
    definition = schema.definitions[name]
    found = variants(definition)
    kinds = [kind for kind, _, _ in found]
    text = ""
    for kind, hidden, required in found:
        rows = schema.rows(definition, [*hidden, "type"], [*definition.get("required", []), *required], kind, kinds)
        text += f"\n### {kind}\n\n`\"type\": \"{kind}\"`{note}\n\n"
        if kind in pictures:
            text += f"![{pictures[kind][1]}]({pictures[kind][0]})\n\n"
        text += table(HEAD, rows)
    return text


def camera_pictures(program):
    """A picture for each type of camera: of the example, and of two that it has not."""
    text = program.text("scene", "example", "cameras")
    cameras = json.loads(without_comments(text))["cameras"]
    shown = {}
    for camera in cameras:
        kind = camera.get("type", "perspective")
        if kind not in shown:
            # OpenCV's lens is given in pixels of the film.
            size = () if kind == "opencv" else ("--size", "320x240")
            words = ("--camera", camera["name"], *size)
            shown[kind] = (program.draw(f"camera-{kind}", text, *words), f"The example `cameras` by its camera \"{camera['name']}\"")
    context = SOURCE / "scenes/context.json"
    if "planarContext" not in shown and context.exists():
        shown["planarContext"] = (program.draw("camera-planarContext", context, "--size", "320x240"), "`scenes/context.json`")
    thesis = SOURCE / "scenes/thesis/fig_4_3_423.json"
    if "rayMesh" not in shown and thesis.exists():
        shown["rayMesh"] = (program.draw("camera-rayMesh", thesis, "--size", "320x320"),
                            "`scenes/thesis/fig_4_3_423.json`: one triangle through one facet")
    return shown


def surface_scene(program, mesh):
    """The example of the mirror sphere with another mirror in its place."""
    scene = json.loads(without_comments(program.text("scene", "example", "mirror-sphere")))
    old = next(one for one in scene["meshes"] if one["role"] == "optic")
    scene["meshes"][scene["meshes"].index(old)] = {"name": old["name"], "role": "optic", "material": old["material"],
                                                   "resolution": 16, **mesh}
    return json.dumps(scene)


# Turned about Y, so that two sides show.
TURNED = {"transform": {"rotate": [0, 0.3007, 0, 0.9537]}}
CUBE = {"points": [[-0.8, 0.1, -0.8], [0.8, 0.1, -0.8], [0.8, 0.1, 0.8], [-0.8, 0.1, 0.8],
                   [-0.8, 1.7, -0.8], [0.8, 1.7, -0.8], [0.8, 1.7, 0.8], [-0.8, 1.7, 0.8]],
        "faceVertexCounts": [4] * 6, **TURNED,
        "faceVertexIndices": [0, 1, 2, 3, 4, 7, 6, 5, 0, 4, 5, 1, 1, 5, 6, 2, 2, 6, 7, 3, 3, 7, 4, 0]}
TRIANGLES = {"points": [[0, 3, 0], [1.7, 1.2, 0], [0, 1.2, 1.7], [-1.7, 1.2, 0], [0, 1.2, -1.7], [0, -0.6, 0]],
             "faceVertexCounts": [3] * 8, "subdivisionScheme": "loop", **TURNED,
             "faceVertexIndices": [0, 2, 1, 0, 3, 2, 0, 4, 3, 0, 1, 4, 5, 1, 2, 5, 2, 3, 5, 3, 4, 5, 4, 1]}
PRIMITIVES = {
    "sphere": {"type": "sphere", "center": [0, 1, 0]},
    "paraboloid": {"type": "paraboloid", "center": [0, 1, -0.8], "axis": [0.1, 0.1, 1], "radius": 1.1, "focalLength": 0.6},
    "cylinder": {"type": "cylinder", "center": [0, 1, 0], "axis": [0.3, 1, 0], "radius": 0.7, "height": 1.8},
    "plane": {"type": "plane", "center": [0, 1, -0.5], "normal": [0.3, 0.2, 1], "size": [2.2, 1.8]},
}
NORMALS = {"smooth": {"type": "smooth"}, "sphere": {"type": "sphere", "center": [0, 0.2, 0]},
           "noise": {"type": "noise", "seed": 7, "amplitude": 0.2, "scale": 3}}


def surface_pictures(program):
    size = ("--size", "320x240")
    primitives = {name: (program.draw(f"surface-{name}", surface_scene(program, {"primitive": shape}), *size),
                         f"A mirror: `{json.dumps(shape)}`") for name, shape in PRIMITIVES.items()}
    cages = {name: program.draw(f"cage-{name}", surface_scene(program, mesh), *size) for name, mesh in (
        ("catmullClark", CUBE), ("loop", TRIANGLES), ("bilinear", {**CUBE, "subdivisionScheme": "bilinear"}),
        ("crease", {**CUBE, "creaseIndices": [4, 5, 6, 7, 4], "creaseLengths": [5], "creaseSharpnesses": [10]}))}
    flat = PRIMITIVES["plane"]
    normals = {name: (program.draw(f"normals-{name}", surface_scene(program, {"primitive": flat, "normals": one}), *size),
                      f"A flat mirror with `\"normals\": {json.dumps(one)}`") for name, one in NORMALS.items()}
    return primitives, cages, normals


def write_scene_pages(program, out):
    schema = Schema(program.text("scene", "schema"))
    root = schema.whole
    hand = (DOCS / "scene.md").read_text()
    rest = [name for name, one in schema.definitions.items()
            if "properties" in one and name not in (*CAMERA_PARTS, *SURFACE_PARTS)]
    text = hand + "\n## A scene\n\n" + root.get("description", "") + "\n\n" + table(HEAD, schema.rows(root, required=root["required"]))
    for name in rest:
        definition = schema.definitions[name]
        text += section(schema, name) if not variants(definition) else (
            f"\n## {definition['title'].capitalize()}\n\n{definition.get('description', '')}\n" + kinds_of(schema, name, {}))
    # Parts on the two other pages are linked there.
    where = {anchor_of(schema.definitions[name].get("title", name)): page
             for page, names in (("scene-cameras.md", CAMERA_PARTS), ("scene-surfaces.md", SURFACE_PARTS))
             for name in names if name in schema.definitions}
    where |= {anchor_of(schema.definitions[name].get("title", name)): "scene.md" for name in rest}

    def write(page, text):
        linked = re.sub(r"\]\(#([\w-]+)\)", lambda m: f"]({'' if where.get(m[1]) == page else where.get(m[1], '')}#{m[1]})", text)
        (out / page).write_text(linked)

    write("scene.md", text)
    shown = camera_pictures(program)
    cameras = ("# Cameras\n\nEvery type of camera of a scene file: what it shows and the fields that it has. A picture of each "
               "is drawn by `trilens render`. Every camera also has `name` and `type`; angles are in degrees, and lengths on "
               "the film count from its top left corner.\n\nChoose one with `--camera NAME`; without it the first is used.\n")
    where["a-camera"] = "scene-cameras.md"
    write("scene-cameras.md", cameras + "\n## A camera\n\n" + kinds_of(schema, "camera", shown)
          + "".join(section(schema, name) for name in CAMERA_PARTS[1:] if name in schema.definitions))
    primitives, cages, normals = surface_pictures(program)
    pages = ("# Meshes and surfaces\n\nObjects, and the mirrors and glass among them: every field of a mesh, and every "
             "surface that an optic can have, with a picture of each. An optic is either a cage, whose limit surface it is, "
             "a file with one, or a primitive, which is exact.\n")
    pages += section(schema, "mesh")
    pages += ("\n## Cages\n\nOne cage of eight points by its `subdivisionScheme`, and with a crease. A cage is a control "
              "mesh: the surface is what repeated subdivision of it converges to.\n\n"
              + table(("`catmullClark`", "`catmullClark`, upper edges creased"), [tuple(f"![{n}]({cages[n]})" for n in ("catmullClark", "crease"))])
              + "\n" + table(("`bilinear`", "`loop`, of triangles"), [tuple(f"![{n}]({cages[n]})" for n in ("bilinear", "loop"))]))
    for name, drawn in (("primitive", primitives), ("normals", normals)):
        definition = schema.definitions[name]
        title = definition.get("title", name)
        pages += (f"\n## {title[:1].upper() + title[1:]}\n\n{definition.get('description', '')}\n"
                  + kinds_of(schema, name, drawn))
    pages += section(schema, "transform")
    write("scene-surfaces.md", pages)


# Examples, tables, reference lists.

def first_comment(text):
    """What a scene's first comment says of it."""
    found = re.search(r"^\s*//(.*(?:\n\s*//.*)*)", text, re.M)
    if not found or text[:found.start()].count("\n") > 2:
        return ""
    lines = [line.strip().removeprefix("//") for line in found[0].strip().split("\n")]
    return " ".join(line.strip() for line in lines if not line.startswith("     "))


def write_examples(program, out):
    text = ("# Examples\n\nScenes to start from, each with its picture. Those of the program are printed by `trilens scene "
            "example NAME`; the others lie in the folder `scenes` of the source, and in `share/doc` of an installation.\n\n"
            "## Of the program\n")
    for line in program.text("scene", "example", "list").strip().split("\n"):
        name, _, about = line.partition(": ")
        scene = program.text("scene", "example", name)
        text += (f"\n### {name}\n\n{about[:1].upper() + about[1:].rstrip('.')}.\n\n"
                 f"![{about}]({program.draw('example-' + name, scene, '--size', '480x360', '--spp', '2')})\n")
    text += "\n## Of the folder scenes\n"
    for file in [*sorted((SOURCE / "scenes").glob("*.json")), *sorted((SOURCE / "scenes/cameras").glob("*.json")),
                 *sorted((SOURCE / "scenes/paths").glob("*.json"))]:
        name = file.relative_to(SOURCE)
        small = ("--size", "320x240", "--spp", "1", "-n", "8")
        picture = program.draw(f"scene-{file.parent.name}-{file.stem}", file, *small)
        text += f"\n### {name}\n\n{first_comment(file.read_text())}\n\n![{name}]({picture})\n"
    (out / "examples.md").write_text(text)


def csv_rows(file):
    with open(file) as opened:
        return list(csv.reader(opened))


def write_results(out):
    """The kept tables as pages of their own."""
    folder = out / "tables"
    folder.mkdir(exist_ok=True)
    results = SOURCE / "results"

    def page(name, title, intro, head, rows):
        (folder / f"{name}.md").write_text(f"---\norphan: true\n---\n\n# {title}\n\n{intro}\n\n" + table(head, rows))

    rows = csv_rows(results / "max-error.csv")
    page("max-error", "What --max-error 0.5 does", "By scene: displacement in pixels (99th percentile, mean, largest), the "
         "share of traced pixels, facets and seconds, and the uniform grid of the same 99th percentile. Made by "
         "`bench/max_error.py`.", rows[0], rows[1:])
    rows = csv_rows(results / "reference/convergence.csv")
    page("convergence", "Convergence of every scene", "Displacement over n at 160 x 120 pixels, with corner rays that are exact "
         "(interpolated) and fitted. Every run of the tests measures it anew. Made by `scripts/reference-results`.", rows[0], rows[1:])
    rows = csv_rows(results / "fitted-rays.csv")
    kept = [rows[0].index(name) for name in ("scene", "way", "n", "layer", "mean", "p99", "max", "pixels", "lost", "facets")]
    page("fitted-rays", "Fitted rays, exact corner rays, flat facets, environment maps", "Displacement in pixels of a film of "
         "320 x 240. Made by `bench_fitted`, drawn by `bench/fitted_plot.py`.", [rows[0][k] for k in kept],
         [[row[k] for k in kept] for row in rows[1:]])
    lines = [[cell.strip() for cell in line.strip("|").split("|")] for line in (results / "kernel/table.md").read_text().split("\n")
             if line.startswith("|")]
    kept = [lines[0].index(name) for name in ("workload", "triangles", "n", "film", "threads", "isa", "visible", "written", "whole",
                                              "samples per facet")]
    page("kernel", "The projector against Embree, all rows", "Embree's time over the projector's, on the same rays: "
         "`visible`, which triangle each sample sees; `written`, a hit for every sample; `whole`, trees, rays and samples too. "
         "Above 1 the projector is faster. Made by `scripts/bench`.", [lines[0][k] for k in kept], [[line[k] for k in kept] for line in lines[2:]])
    for name, title, intro in (("table", "Whole commands", "Seconds and memory of whole commands."),
                               ("profile", "Where the time goes", "Shares of the processor's time of one `render`.")):
        text = "\n".join(re.sub(r"\|[^|]*\|$", "|", line) if name == "table" else line
                         for line in (results / f"frame/{name}.md").read_text().strip().split("\n"))
        (folder / f"frame-{name}.md").write_text(f"---\norphan: true\n---\n\n# {title}\n\n{intro} Made by `scripts/bench`.\n\n{text}\n")
    evaluation = (results / "evaluation/README.md").read_text()
    evaluation = re.sub(r"\]\((\w+\.svg)\)", r"](../results/evaluation/\1)", evaluation)
    (folder / "evaluation.md").write_text("---\norphan: true\n---\n\n" + evaluation)


def write_python(folder, out):
    """The names of the module, from its stub, with docstrings where the module is there."""
    module = None
    sys.path.insert(0, str(folder))
    try:
        module = importlib.import_module("trilens")
    except ImportError:
        print("generate: the Python module is not built; its page has no docstrings", file=sys.stderr)
    tree = ast.parse((SOURCE / "python/trilens/__init__.pyi").read_text())

    def doc(*names):
        found = module
        for name in names:
            found = getattr(found, name, None)
        words = (getattr(found, "__doc__", None) or "").strip()
        words = re.sub(r"^\w+\(.*?\)( -> .*)?\n\n", "", words)
        return re.sub(r"([*_<>`|])", r"\\\1", words)

    def listed(text):
        """A docstring's parameters as a list."""
        text = re.sub(r"\n[ \t]+", " ", text)
        text = re.sub(r"(?m)^(Raises|Returns) ", r"\n\1 ", text)
        return re.sub(r"(?m)^((?:[\w\\]+(?:, )?)+: )", r"\n- \1", text)

    def signature(node, width=10000):
        arguments = ast.unparse(node.args).replace("self, ", "").replace("self", "")
        returned = f" -> {ast.unparse(node.returns)}" if node.returns else ""
        if len(node.name) + len(arguments) + len(returned) > width:
            depth, broken = 0, ""
            for letter in arguments:  # one argument a line; commas inside of brackets stay
                depth += (letter in "[(") - (letter in "])")
                broken += letter if letter != "," or depth else ",\n   "
            arguments = f"\n    {broken}\n"
        return f"{node.name}({arguments}){returned}"

    text = ("# Python reference\n\nEvery public name of the module `trilens`, from its stub `__init__.pyi`, which editors and "
            "type checkers read too.\n\n")
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    classes = [node for node in tree.body if isinstance(node, ast.ClassDef)]
    text += "## Functions\n"
    for node in functions:
        text += f"\n### {node.name}\n\n```python\n{signature(node, 80)}\n```\n\n{listed(doc(node.name))}\n"
    text += "\n## Classes\n"
    for node in classes:
        bases = ", ".join(ast.unparse(base) for base in node.bases)
        text += f"\n### {node.name}\n\n{'A subclass of `' + bases + '`. ' if bases else ''}{doc(node.name)}\n\n"
        rows, methods = [], ""
        for member in node.body:
            if isinstance(member, ast.FunctionDef) and not (member.name.startswith("__") and member.name != "__getitem__"):
                is_property = any(ast.unparse(one) == "property" for one in member.decorator_list)
                if is_property:
                    rows.append((f"`{member.name}: {ast.unparse(member.returns)}`", doc(node.name, member.name)))
                else:
                    methods += (f"\n#### {node.name}.{member.name}\n\n```python\n{signature(member, 80)}\n```\n\n"
                                f"{listed(doc(node.name, member.name))}\n")
        text += (table(("attribute", "meaning"), rows) if rows else "") + methods
    (out / "python-reference.md").write_text(text)


def write_headers(folder, out):
    """The public headers and what each is for."""
    rows = []
    for file in sorted((SOURCE / "src/trilens").glob("*.h")):
        if not folder.exists() or (folder / "trilens" / file.name).exists():
            rows.append((f"`<trilens/{file.name}>`", file.read_text().split("\n")[0].removeprefix("// ")))
    (out / "cpp-headers.md").write_text("---\norphan: true\n---\n\n# Public headers\n\nWhat each public header is for. Each "
                                        "begins with an example, which the tests compile and run.\n\n" + table(("header", "what it is for"), rows))


def copy_pages(out):
    """The pages that are written by hand, and what they show from other folders of the source."""
    shutil.copytree(DOCS / "figures", out / "figures", dirs_exist_ok=True)
    figures.write(out / "generated")
    for folder in ("results", "examples"):
        for file in (SOURCE / folder).rglob("*"):
            if file.suffix in (".svg", ".jpg", ".png", ".cpp") and "out" not in file.relative_to(SOURCE).parts:
                target = out / file.relative_to(SOURCE)
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(file, target)
    for file in DOCS.glob("*.md"):
        text = file.read_text()
        text = re.sub(r"\]\(\.\./((?:results|examples/python)/[\w./-]+\.(?:svg|jpg|png))\)", r"](\1)", text)
        # Other files of the source are named, not linked.
        text = re.sub(r"(?<!!)\[([^]]*)\]\(\.\./([\w./-]+)\)", r"\1 (`\2`)", text)
        (out / file.name).write_text(text)


def main():
    parser = argparse.ArgumentParser(description="Makes what Sphinx reads")
    parser.add_argument("--trilens", required=True)
    parser.add_argument("--headers", type=pathlib.Path, default=SOURCE / "build/release/include")
    parser.add_argument("--python", type=pathlib.Path, default=SOURCE / "build/release/python")
    parser.add_argument("out", type=pathlib.Path)
    asked = parser.parse_args()
    out = asked.out
    # Pictures are kept; pages that are no more must not be.
    for file in out.rglob("*.md"):
        file.unlink()
    out.mkdir(parents=True, exist_ok=True)
    program = Program(asked.trilens, out / "pictures")
    copy_pages(out)
    write_commands(program, out)
    write_scene_pages(program, out)
    write_examples(program, out)
    write_results(out)
    write_python(asked.python, out)
    write_headers(asked.headers, out)
    # Pages of others, where they are there.
    for name in ("contributing", "laws"):
        if not (out / f"{name}.md").exists():
            index = out / "index.md"
            index.write_text(index.read_text().replace(f"\n{name}\n", "\n"))
    print(f"generate: {program.drawn} pictures drawn")


if __name__ == "__main__":
    main()
