"""Whether the page that scripts/demo names shows what the script promises: python3 demo_page.py FOLDER [SCENES]

A card for every scenes/*.json (or a word on why it was left out), its pictures projected and ray traced, not empty, the
difference, a plot, and a link to the scene's own page."""
import base64
import pathlib
import re
import sys

import pictures

SOURCE = pathlib.Path(__file__).resolve().parents[2]


def problems(folder, scenes):
    page = folder / "report.html"
    if not page.exists():
        return [f"there is no {page}"]
    text = page.read_text()
    found = []
    cards = dict(re.findall(r'<h3><a href="([^"/]+)/report\.html">(.*?)</section>', text, re.S))
    for scene in scenes:
        card = cards.get(scene.stem)
        if card is None:
            if f"left out of the sweep: {scene.parent.name}/{scene.name}" not in text:
                found.append(f"{scene.name} is neither on the page nor said to be left out")
            continue
        if not (folder / scene.stem / "report.html").exists():
            found.append(f"the link of {scene.stem} leads nowhere")
        shown = dict(re.findall(r'<img [^>]*alt="([^"]*)"[^>]*src="data:image/png;base64,([^"]*)"', card))
        for name in ("projected", "truth"):
            try:
                pictures.require_png(base64.b64decode(shown.get(name, "")), f"{scene.stem}: {name}")
            except pictures.Blank as blank:
                found.append(str(blank))
        # What is exact says so in the place of a black picture and an empty plot.
        if not any(name.startswith("|projected") for name in shown) and "difference: none" not in card:
            found.append(f"{scene.stem} has no picture of the difference")
        if "<svg" not in card and "zero wherever it was measured" not in card:
            found.append(f"{scene.stem} has no plot")
    if not cards:
        found.append("the page shows no scene")
    return found


if __name__ == "__main__":
    of_scenes = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else SOURCE / "scenes"
    found = problems(pathlib.Path(sys.argv[1]), sorted(of_scenes.glob("*.json")))
    for problem in found:
        print("demo page:", problem, file=sys.stderr)
    sys.exit(1 if found else 0)
