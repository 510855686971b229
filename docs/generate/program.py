"""The program that the pages tell of: what it answers, and the pictures that it draws; and what pages are made of."""
import pathlib
import re
import subprocess

DOCS = pathlib.Path(__file__).resolve().parents[1]
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
    """The trilens that the pages tell of, and the pictures that it draws; of a draft small ones, to see that they can be."""

    def __init__(self, path, pictures, draft=False):
        self.path, self.pictures, self.draft = path, pictures, draft
        self.drawn = 0
        pictures.mkdir(parents=True, exist_ok=True)

    def text(self, *words):
        return subprocess.run([self.path, *words], check=True, capture_output=True, text=True).stdout

    @staticmethod
    def small(words):
        """The same picture with a quarter of the rows and columns and one sample a pixel."""
        size = words[words.index("--size") + 1] if "--size" in words else "320x240"
        quarter = "x".join(str(max(int(side) // 4, 1)) for side in size.split("x"))
        kept = [word for i, word in enumerate(words)
                if word not in ("--size", "--spp") and (i == 0 or words[i - 1] not in ("--size", "--spp"))]
        return (*kept, "--size", quarter, "--spp", "1")

    def draw(self, name, scene, *words):
        """pictures/name.png of a scene: a file, or its text. Drawn again where scene, words or program are newer."""
        target, asked = self.pictures / f"{name}.png", self.pictures / f"{name}.asked"
        text = scene.read_text() if isinstance(scene, pathlib.Path) else scene
        if self.draft:
            words = self.small(words)
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
