"""Pages of scene files, from the JSON Schema that the program prints: a table for each object, a picture for each camera and
surface."""
import json
import pathlib
import re

from program import DOCS, SOURCE, table, without_comments


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


def field_table(rows):
    """A table of fields, which pages.css folds where the window is narrow."""
    return "```{rst-class} fields\n```\n\n" + table(("field", "type", "default", "meaning"), rows)


# What stands on a page of its own; everything else is on the page of the scene file.
CAMERA_PARTS = ("camera", "lookAt", "placedRay", "view")
SURFACE_PARTS = ("mesh", "primitive", "displacement", "normals", "transform", "rotation", "fit")


def section(schema, name, level="##", text=""):
    definition = schema.definitions[name]
    title = definition.get("title", name)
    return (f"\n{level} {title[:1].upper() + title[1:]}\n\n{definition.get('description', '')}\n\n{text}"
            + field_table(schema.rows(definition, required=definition.get("required", []))))


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
        text += field_table(rows)
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
            shown[kind] = (program.draw(f"camera-{kind}", text, *words),
                           f"The example `cameras` by its camera \"{camera['name']}\"")
    context = SOURCE / "scenes/context.json"
    if "planarContext" not in shown and context.exists():
        shown["planarContext"] = (program.draw("camera-planarContext", context, "--size", "320x240"),
                                  "`scenes/context.json`")
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
    "cone": {"type": "cone", "center": [0, 0.1, 0], "axis": [0.1, 1, 0.3], "radius": 1.1, "height": 1.7},
    "plane": {"type": "plane", "center": [0, 1, -0.5], "normal": [0.3, 0.2, 1], "size": [2.2, 1.8]},
    "lens": {"type": "lens", "center": [0, 1, 0.4], "axis": [0.2, 0.1, -1], "thickness": 0.8,
             "front": {"radius": 1.8, "aperture": 1.1}, "back": {"radius": -2.2, "aperture": 1}},
    "box": {"type": "box", "center": [0, 0.7, 0], "axis": [0.2, 1, 0.1], "size": [1.6, 1.2, 1]},
    "disk": {"type": "disk", "center": [0, 1, 0], "normal": [0.3, 0.6, 1], "radius": 0.9},
}
OF_OBJECTS = ("box", "disk")
NORMALS = {"smooth": {"type": "smooth"}, "sphere": {"type": "sphere", "center": [0, 0.2, 0]},
           "noise": {"type": "noise", "seed": 7, "amplitude": 0.2, "scale": 3}}


def surface_pictures(program):
    size = ("--size", "320x240")
    primitives = {}
    for name, shape in PRIMITIVES.items():
        mesh = {"primitive": shape} | ({"role": "object", "material": "yellow"} if name in OF_OBJECTS else {})
        primitives[name] = (program.draw(f"surface-{name}", surface_scene(program, mesh), *size),
                            f"{'An object' if name in OF_OBJECTS else 'A mirror'}: `{json.dumps(shape)}`")
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
    text = (hand + "\n## A scene\n\n" + root.get("description", "") + "\n\n"
            + field_table(schema.rows(root, required=root["required"])))
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
        def link(found):
            there = where.get(found[1], page)
            return f"]({'' if there == page else there}#{found[1]})"

        (out / page).write_text(re.sub(r"\]\(#([\w-]+)\)", link, text))

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
              + table(("`catmullClark`", "`catmullClark`, upper edges creased"),
                      [tuple(f"![{n}]({cages[n]})" for n in ("catmullClark", "crease"))])
              + "\n" + table(("`bilinear`", "`loop`, of triangles"),
                             [tuple(f"![{n}]({cages[n]})" for n in ("bilinear", "loop"))]))
    for name, drawn in (("primitive", primitives), ("normals", normals)):
        definition = schema.definitions[name]
        title = definition.get("title", name)
        pages += (f"\n## {title[:1].upper() + title[1:]}\n\n{definition.get('description', '')}\n"
                  + kinds_of(schema, name, drawn))
    for name in ("displacement", "transform", "rotation", "fit"):
        pages += section(schema, name)
    write("scene-surfaces.md", pages)
