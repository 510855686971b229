#!/usr/bin/python3
"""Makes what Sphinx reads: the pages of docs/, and those that are generated from the program itself.

    python3 generate.py --trilens PROGRAM --headers FOLDER --python FOLDER OUT

Generated are the pages of the commands (from `trilens man`), of scene files (from `trilens scene schema`, with a picture
for each camera and surface), of the examples (with their pictures), of the Python module (from its .pyi, with docstrings
where the module is built), of the C++ headers, and the tables of results/. Pictures are drawn by the program of now and
kept in OUT until it changes."""
import argparse
import csv
import itertools
import pathlib
import re
import shutil

import figures
from command_pages import write_commands
from program import DOCS, SOURCE, Program, table
from python_pages import write_python
from scene_pages import write_scene_pages


MIRROR = """```{raw} html
<iframe src="mirror.html" title="A mirror to bend" loading="lazy" style="width: 100%; max-width: 660px; height: calc(0.75 * min(100vw, 640px) + 150px); border: 0"></iframe>
<p><em>The projector itself, compiled for browsers: a mirror to bend, projected anew in each picture. <a href="mirror.html">By itself</a>.</em></p>
```"""


def first_comment(text):
    """What a scene's first comment says of it."""
    found = re.search(r"^\s*//(.*(?:\n\s*//.*)*)", text, re.M)
    if not found or text[:found.start()].count("\n") > 2:
        return ""
    lines = [line.strip().removeprefix("//") for line in found[0].strip().split("\n")]
    text = ""
    for is_code, part in itertools.groupby(lines, lambda line: line.startswith("     ")):
        part = [line.strip() for line in part]
        text += "\n\n```text\n" + "\n".join(part) + "\n```\n\n" if is_code else " ".join(part)
    return text.strip()


def write_examples(program, out):
    text = ("# Examples\n\nScenes to start from, each with its picture. Those of the program are printed by `trilens scene "
            "example NAME`; the others lie in the folder `scenes` of the source, and in `share/doc` of an installation.\n\n"
            "## Of the program\n")
    for line in program.text("scene", "example", "list").strip().split("\n"):
        name, _, about = line.partition(": ")
        scene = program.text("scene", "example", name)
        text += (f"\n### {name}\n\n{about[:1].upper() + about[1:].rstrip('.')}.\n\n{first_comment(scene)}\n\n"
                 f"![{about}]({program.draw('example-' + name, scene, '--size', '480x360', '--spp', '2')})\n")
    text += "\n## Of the folder scenes\n"
    for file in [*sorted((SOURCE / "scenes").glob("*.json")), *sorted((SOURCE / "scenes/cameras").glob("*.json")),
                 *sorted((SOURCE / "scenes/paths").glob("*.json"))]:
        name = file.relative_to(SOURCE)
        small = ("--size", "320x240", "--spp", "2")
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
    page("max-error", "What --max-error 0.5 does",
         "By scene: displacement in pixels (99th percentile, mean, largest), the "
         "share of traced pixels, facets and seconds, and the uniform grid of the same 99th percentile. Made by "
         "`bench/max_error.py`.", rows[0], rows[1:])
    rows = csv_rows(results / "certify.csv")
    page("certify", "What --certify proves",
         "`--max-error 0.5 --certify --facets all` on films of 320 x 240, one sample a pixel. Of the optics' pixels the share that is "
         "proven, and traced; the largest bound in pixels. Proven pixels that `project` was asked of, how many lie beyond their bound, "
         "and the bound over the distance to the image that it finds (median, worst). Pixels that `compare` held against `trace`, and "
         "those beyond. The processor's seconds with the proof and without, on a busy machine. Made by `bench/certify.py`.",
         rows[0], rows[1:])
    rows = csv_rows(results / "reference/convergence.csv")
    page("convergence", "Convergence of every scene",
         "Displacement over n at 160 x 120 pixels, with corner rays that are exact (interpolated) and fitted. Every run of the "
         "tests measures it anew. Made by `scripts/reference-results`.", rows[0], rows[1:])
    rows = csv_rows(results / "fitted-rays.csv")
    kept = [rows[0].index(name) for name in ("scene", "way", "n", "layer", "mean", "p99", "max", "pixels", "lost", "facets")]
    page("fitted-rays", "Fitted rays, exact corner rays, flat facets, environment maps",
         "Displacement in pixels of a film of "
         "320 x 240. Made by `bench_fitted`, drawn by `bench/fitted_plot.py`.", [rows[0][k] for k in kept],
         [[row[k] for k in kept] for row in rows[1:]])
    lines = [[cell.strip() for cell in line.strip("|").split("|")]
             for line in (results / "kernel/table.md").read_text().split("\n") if line.startswith("|")]
    kept = [lines[0].index(name) for name in ("workload", "triangles", "n", "film", "threads", "isa", "visible", "written",
                                              "whole", "samples per facet")]
    page("kernel", "The projector against Embree, all rows", "Embree's time over the projector's, on the same rays: "
         "`visible`, which triangle each sample sees; `written`, a hit for every sample; `whole`, trees, rays and samples too. "
         "Above 1 the projector is faster. Made by `scripts/bench`.", [lines[0][k] for k in kept],
         [[line[k] for k in kept] for line in lines[2:]])
    for name, title, intro in (("table", "Whole commands", "Seconds and memory of whole commands."),
                               ("profile", "Where the time goes", "Shares of the processor's time of one `render`.")):
        text = "\n".join(re.sub(r"\|[^|]*\|$", "|", line) if name == "table" else line
                         for line in (results / f"frame/{name}.md").read_text().strip().split("\n"))
        (folder / f"frame-{name}.md").write_text(
            f"---\norphan: true\n---\n\n# {title}\n\n{intro} Made by `scripts/bench`.\n\n{text}\n")
    evaluation = (results / "evaluation/README.md").read_text()
    evaluation = re.sub(r"\]\((\w+\.svg)\)", r"](../results/evaluation/\1)", evaluation)
    (folder / "evaluation.md").write_text("---\norphan: true\n---\n\n" + evaluation)


def write_headers(folder, out):
    """The public headers and what each is for."""
    rows = []
    for file in sorted((SOURCE / "src/trilens").glob("*.h")):
        if not folder.exists() or (folder / "trilens" / file.name).exists():
            rows.append((f"`<trilens/{file.name}>`", file.read_text().split("\n")[0].removeprefix("// ")))
    (out / "cpp-headers.md").write_text(
        "---\norphan: true\n---\n\n# Public headers\n\nWhat each public header is for. Each begins with an example, which the "
        "tests compile and run.\n\n" + table(("header", "what it is for"), rows))


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
        if (SOURCE / "build/browser/mirror.html").exists():
            text = text.replace("<!-- the projector in a page -->", MIRROR)
        (out / file.name).write_text(text)


def main():
    parser = argparse.ArgumentParser(description="Makes what Sphinx reads")
    parser.add_argument("--trilens", required=True)
    parser.add_argument("--headers", type=pathlib.Path, default=SOURCE / "build/release/include")
    parser.add_argument("--python", type=pathlib.Path, default=SOURCE / "build/release/python")
    parser.add_argument("--draft", action="store_true", help="small pictures")
    parser.add_argument("out", type=pathlib.Path)
    asked = parser.parse_args()
    out = asked.out
    # Pictures are kept; pages that are no more must not be.
    for file in out.rglob("*.md"):
        file.unlink()
    out.mkdir(parents=True, exist_ok=True)
    program = Program(asked.trilens, out / "pictures", asked.draft)
    copy_pages(out)
    write_commands(program, out)
    write_scene_pages(program, out)
    write_examples(program, out)
    write_results(out)
    write_python(asked.python, out)
    write_headers(asked.headers, out)
    print(f"generate: {program.drawn} pictures drawn")


if __name__ == "__main__":
    main()
