#!/usr/bin/python3
"""Draws the figures that explain the ideas, as SVG: python3 docs/generate/figures.py [FOLDER]

Every curve is computed, not drawn by hand: rays are reflected by the law of reflection, edges are imaged by solving for
the place on the facet that sees each of their points. The README shows how-it-works.svg, which is kept in docs/figures
(`docs/generate/figures.py --check` says whether it is up to date); scripts/docs makes all of them in the built pages."""
import html
import math
import pathlib
import sys

KEPT = pathlib.Path(__file__).resolve().parents[1] / "figures/how-it-works.svg"
INK, BLUE, RED, GREEN, GREY, ORANGE = "#222", "#2c5d8a", "#c0392b", "#2e7d4f", "#8795a1", "#b86e00"


class Drawing:
    """An SVG document that grows by shapes; places are in pixels, y downwards."""

    def __init__(self, width, height):
        self.width, self.height, self.parts = width, height, []

    def path(self, points, colour=INK, width=1.5, fill="none", dash="", arrow=False, closed=False):
        place = "M" + "L".join(f"{x:.2f} {y:.2f}" for x, y in points) + ("Z" if closed else "")
        more = f' stroke-dasharray="{dash}"' if dash else ""
        more += f' marker-end="url(#{ {BLUE: "blue", RED: "red"}.get(colour, "grey")})"' if arrow else ""
        self.parts.append(f'<path d="{place}" fill="{fill}" stroke="{colour}" stroke-width="{width}"{more}/>')

    def dot(self, at, colour=INK, radius=3.5):
        self.parts.append(f'<circle cx="{at[0]:.2f}" cy="{at[1]:.2f}" r="{radius}" fill="{colour}"/>')

    def text(self, at, words, size=14, colour=INK, anchor="start", bold=False):
        weight = ' font-weight="bold"' if bold else ""
        self.parts.append(f'<text x="{at[0]:.1f}" y="{at[1]:.1f}" font-size="{size}" fill="{colour}" '
                          f'text-anchor="{anchor}"{weight}>{html.escape(words)}</text>')

    def lines(self, at, words, size=14, colour=INK, anchor="start", bold=False):
        for i, line in enumerate(words.split("\n")):
            self.text((at[0], at[1] + i * size * 1.35), line, size, colour, anchor, bold)

    def svg(self):
        markers = "".join(
            f'<marker id="{name}" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto">'
            f'<path d="M0 0L8 4L0 8z" fill="{colour}"/></marker>'
            for name, colour in (("blue", BLUE), ("red", RED), ("grey", GREY)))
        return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width} {self.height}" '
                f'width="{self.width}" font-family="DejaVu Sans, Verdana, sans-serif"><defs>{markers}</defs>\n'
                f'<rect width="{self.width}" height="{self.height}" fill="white"/>\n' + "\n".join(self.parts) + "\n</svg>\n")


# Small vectors.
def add(a, b, scale=1.0):
    return tuple(x + scale * y for x, y in zip(a, b))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def unit(a):
    return tuple(x / math.sqrt(dot(a, a)) for x in a)


def reflected(direction, normal):
    return add(direction, normal, -2 * dot(direction, normal))


def refracted(direction, normal, eta):
    """Snell's law; none where the light is totally reflected. The normal points against the direction."""
    cosine = -dot(direction, normal)
    k = 1 - eta * eta * (1 - cosine * cosine)
    return None if k < 0 else add(tuple(eta * x for x in direction), normal, eta * cosine - math.sqrt(k))


def circle_hit(origin, direction, centre, radius):
    """The first distance along a unit direction at which a ray meets a circle, beyond a hair; or none."""
    to = add(origin, centre, -1)
    b, c = dot(to, direction), dot(to, to) - radius * radius
    if b * b < c:
        return None
    return next((t for t in (-b - math.sqrt(b * b - c), -b + math.sqrt(b * b - c)) if t > 1e-6), None)


def solve3(rows, right):
    """Cramer's rule for three unknowns."""
    def det(m):
        return (m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
                + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]))
    whole = det(rows)
    return [det([[right[r] if c == k else rows[r][c] for c in range(3)] for r in range(3)]) / whole for k in range(3)]


def image_of(point, origins, directions, guess=(1 / 3, 1 / 3, 1.0)):
    """Newton's method for weights (a, b, 1 - a - b) and t with point = origin(weights) + t direction(weights)."""
    a, b, t = guess
    for _ in range(40):
        w = (a, b, 1 - a - b)
        corner = [add(o, d, t) for o, d in zip(origins, directions)]
        at = tuple(sum(w[k] * corner[k][i] for k in range(3)) for i in range(3))
        along = tuple(sum(w[k] * directions[k][i] for k in range(3)) for i in range(3))
        rows = [[corner[0][i] - corner[2][i], corner[1][i] - corner[2][i], along[i]] for i in range(3)]
        step = solve3(rows, [point[i] - at[i] for i in range(3)])
        a, b, t = a + step[0], b + step[1], t + step[2]
    return a, b, t


def draw_mirror(d, left, top, facets=4, labels=True):
    """An eye before a round mirror: corner rays, exact at the corners, and the chords between them."""
    eye, centre, radius = (left + 20, top + 150), (left + 300, top + 200), 130
    arc = [math.radians(a) for a in (150 + i * 75 / 60 for i in range(61))]
    on = [(centre[0] + radius * math.cos(a), centre[1] + radius * math.sin(a)) for a in arc]
    d.path(on, GREY, 4)
    corners = [on[i * 60 // facets] for i in range(facets + 1)]
    for corner in corners:
        normal = unit(add(corner, centre, -1))
        away = reflected(unit(add(corner, eye, -1)), normal)
        d.path([eye, corner], GREY, 1)
        d.path([corner, add(corner, away, 68)], BLUE, 1.5, arrow=True)
    d.path(corners, INK, 1.5)
    for corner in corners:
        d.dot(corner, RED)
    d.dot(eye)
    if labels:
        d.text((eye[0] - 8, eye[1] + 20), "eye", 13)
        d.text((centre[0] - 95, centre[1] + 5), "mirror", 13, GREY)


FACET_ORIGINS = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.1), (0.4, 0.9, 0.05))
FACET_DIRECTIONS = ((-0.9, 0.7, 1.0), (0.5, -0.9, 0.9), (0.9, 0.6, 1.1))
SCENE_TRIANGLE = ((-0.35, 0.45, 1.6), (1.7, -0.5, 1.4), (1.0, 1.25, 1.7))


def facet_image(left, top, size):
    """The film's triangle, and the image in it of the scene triangle's edges, in pixels."""
    film = ((left, top + size), (left + size, top + size * 0.86), (left + size * 0.42, top))
    curves = []
    for k in range(3):
        a, b = SCENE_TRIANGLE[k], SCENE_TRIANGLE[(k + 1) % 3]
        curve, guess = [], (1 / 3, 1 / 3, 1.0)
        for i in range(41):
            point = add(tuple((1 - i / 40) * x for x in a), b, i / 40)
            guess = image_of(point, FACET_ORIGINS, FACET_DIRECTIONS, guess)
            w = (guess[0], guess[1], 1 - guess[0] - guess[1])
            curve.append(tuple(sum(w[j] * film[j][c] for j in range(3)) for c in range(2)))
        curves.append(curve)
    return film, curves


def draw_facet(d, left, top, size, labels=True):
    film, curves = facet_image(left, top, size)
    d.path(film, INK, 1.5, fill="#eef4fa", closed=True)
    d.path([p for curve in curves for p in curve], ORANGE, 0.5, fill="#f6d9a8", closed=True)
    for k, curve in enumerate(curves):
        d.path(curve, (RED, GREEN, BLUE)[k], 2)
    for corner in film:
        d.dot(corner, RED)
    if labels:
        d.text((film[0][0] - 6, film[0][1] + 18), "corner ray 1", 12, RED)
        d.text((film[1][0] + 2, film[1][1] + 22), "2", 12, RED)
        d.text((film[2][0] + 8, film[2][1] + 4), "3", 12, RED)


def draw_displacement(d, left, top):
    """A pixel grid: where the truth shows a corner of a thing, and where the picture shows it."""
    cell = 34
    for i in range(7):
        d.path([(left + i * cell, top), (left + i * cell, top + 6 * cell)], "#dde3e8", 1)
        d.path([(left, top + i * cell), (left + 6 * cell, top + i * cell)], "#dde3e8", 1)
    truth, shown = (left + 2.2 * cell, top + 3.6 * cell), (left + 3.6 * cell, top + 2.7 * cell)
    for at, colour, dash in ((truth, GREEN, ""), (shown, BLUE, "5 3")):
        bow = [(at[0] + 0.55 * cell * s * s + 0.2 * cell * s, at[1] - 1.6 * cell * s)
               for s in (-1.4 + i * 0.05 for i in range(57))]
        d.path(bow, colour, 2, dash=dash)
        d.dot(at, colour, 4.5)
    d.path([truth, shown], RED, 2, arrow=True)
    d.text((truth[0] - 62, truth[1] + 24), "truth", 13, GREEN)
    d.text((shown[0] + 14, shown[1] + 14), "picture", 13, BLUE)
    d.text((left + 3.3 * cell, top + 4.6 * cell), "displacement", 13, RED)
    d.path([(left + 3.6 * cell, top + 4.2 * cell), (left + 3.0 * cell, top + 3.2 * cell)], "#d9a59e", 1)


def how_it_works():
    d = Drawing(1000, 400)
    for i, title in enumerate(("1  Corner rays", "2  Projection in closed form", "3  Error in pixels")):
        d.text((20 + 340 * i, 30), title, 17, BLUE, bold=True)
    draw_mirror(d, 10, -10)
    d.lines((20, 350),
            "The mirror becomes a grid of facets. At each\ncorner stands the ray that the mirror reflects.", 13)
    draw_facet(d, 390, 70, 215, labels=False)
    d.lines((360, 350), "Inside a facet rays are interpolated; a scene\nedge shows as a conic, exactly.", 13)
    draw_displacement(d, 715, 90)
    d.lines((700, 350), "Beside it stands the ray-traced truth: how far\noff what is seen lies, in pixels.", 13)
    return d.svg()


def ray_mesh():
    d = Drawing(760, 340)
    draw_mirror(d, 0, 0)
    d.lines((370, 60),
            "red: corners of the facets, on the mirror\nblack: facets, flat between their corners\n"
            "blue: corner rays, as the exact mirror sends them", 14)
    d.lines((370, 170),
            "The facets with their corner rays are a RayMesh.\nNeighbours share corners, so that what they\n"
            "show is continuous. Between the corners\norigin and direction are interpolated.", 14)
    return d.svg()


def facet():
    d = Drawing(760, 330)
    draw_facet(d, 40, 30, 250)
    d.lines((360, 70),
            "One facet on the film. Through it a triangle of the\nscene shows as the filled shape.\n\n"
            "Each of its three straight edges is seen as an arc of\n"
            "a conic (red, green, blue). At a pixel the signs of\n"
            "three quadratic forms tell whether the triangle\n"
            "covers it; their ratios say where on the triangle.", 14)
    return d.svg()


def histories():
    """A ray into a disk of glass, and what becomes of it."""
    d = Drawing(760, 340)
    centre, radius, ior = (270, 165), 110, 1.5
    d.path([(centre[0] + radius * math.cos(i * math.pi / 60), centre[1] + radius * math.sin(i * math.pi / 60))
            for i in range(120)], BLUE, 2, fill="#eef6fb", closed=True)
    eye, first = (20, 70), None
    direction = unit((1, 0.14))
    first = add(eye, direction, circle_hit(eye, direction, centre, radius))
    d.path([eye, first], INK, 2)
    d.dot(eye)
    normal = unit(add(first, centre, -1))
    d.path([first, add(first, reflected(direction, normal), 95)], RED, 2, arrow=True)
    inside = refracted(direction, normal, 1 / ior)
    second = add(first, inside, circle_hit(first, inside, centre, radius))
    d.path([first, second], INK, 2)
    normal = unit(add(centre, second, -1))
    d.path([second, add(second, refracted(inside, normal, ior), 90)], RED, 2, arrow=True)
    back = reflected(inside, normal)
    third = add(second, back, circle_hit(second, back, centre, radius))
    d.path([second, third], INK, 2)
    normal = unit(add(centre, third, -1))
    out = refracted(back, normal, ior)
    d.path([third, add(third, out, 80)], RED, 2, arrow=True)
    for i, at in enumerate((first, second, third)):
        d.dot(at, BLUE)
        d.text((at[0] + (-18, 10, 2)[i], at[1] + (20, -8, 18)[i]), "abc"[i], 14, BLUE, bold=True)
    d.text((14, 58), "eye", 13)
    d.lines((480, 50),
            "three histories of one optic:\n\na  reflected\n\na  entered, b  left\n\n"
            "a  entered, b  reflected inside, c  left", 14)
    d.lines((480, 262),
            "Each history is a RayMesh of its own:\nthe scene is projected through each,\n"
            "and the weights of light add up.", 14)
    return d.svg()


def nested():
    """Two mirror balls: the one shows the other, as an image with a grid of its own."""
    d = Drawing(760, 320)
    eye, near, far = (40, 270), ((390, 200), 100), ((180, 75), 52)
    for (centre, radius), colour, name in ((near, GREY, "B"), (far, ORANGE, "A")):
        d.path([(centre[0] + radius * math.cos(i * math.pi / 60), centre[1] + radius * math.sin(i * math.pi / 60))
                for i in range(120)], colour, 2, closed=True)
        d.text((centre[0] - 5, centre[1] + 5), name, 16, colour, bold=True)
    d.dot(eye)
    d.text((eye[0] - 10, eye[1] + 22), "eye", 13)
    # For corners of A's own grid, the place on B that shows each: bisection over B's rim for the law of reflection.
    centre, radius = near

    def turned(angle, target):
        at = (centre[0] + radius * math.cos(angle), centre[1] + radius * math.sin(angle))
        away = reflected(unit(add(at, eye, -1)), unit(add(at, centre, -1)))
        to = unit(add(target, at, -1))
        return at, away[0] * to[1] - away[1] * to[0]

    to_eye = math.atan2(eye[1] - centre[1], eye[0] - centre[0]) % (2 * math.pi)
    for i in range(5):
        angle = math.radians(-10 + 18 * i)
        target = (far[0][0] + far[1] * math.cos(angle), far[0][1] + far[1] * math.sin(angle))
        low, high = to_eye, to_eye + math.radians(100)
        for _ in range(60):
            middle = (low + high) / 2
            if turned(middle, target)[1] * turned(to_eye + 1e-3, target)[1] > 0:
                low = middle
            else:
                high = middle
        at = turned((low + high) / 2, target)[0]
        d.path([eye, at], GREY, 1)
        d.path([at, target], BLUE, 1.2)
        d.dot(target, ORANGE)
        d.dot(at, RED)
    d.lines((560, 60),
            "orange: corners of A's\nown grid\n\nred: where B shows each\nof them, exactly\n\n"
            "Seen in B, A is a nested\noptic: its grid is laid\nover what B shows\nwithout it.", 14)
    return d.svg()


def displacement():
    d = Drawing(760, 260)
    draw_displacement(d, 30, 25)
    d.lines((300, 60),
            "The truth shows a point of the scene at the green place,\n"
            "the picture at the blue one. The distance is the displacement,\n"
            "in pixels, measured for each pixel of what optics show.\n\n"
            "Colours would tell little: where an edge lies a tenth of a\n"
            "pixel off, the pixels on it differ by all there is.", 14)
    return d.svg()


def coverage():
    """A pixel that an arc of a conic divides, and its cells: surely behind the arc, surely before it, and open."""
    d = Drawing(760, 280)
    side, left, top = 240, 25, 20

    def inside(x, y):
        return 0.75 * x * x + x + 0.55 * y - 0.95

    def divide(x, y, size, level):
        values = [inside(x + size * i / 8, y + size * j / 8) for i in range(9) for j in range(9)]
        fill = "#dfe7ee" if max(values) < 0 else "#ffffff" if min(values) > 0 else ""
        if fill or level == 5:
            at = [(left + side * (x + size * i), top + side * (y + size * j)) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
            d.path(at, GREY, 0.6, fill or "#f6dfae", closed=True)
            return [size * size if max(values) < 0 else 0, 0 if min(values) > 0 else size * size]
        parts = [divide(x + size / 2 * i, y + size / 2 * j, size / 2, level + 1) for i in (0, 1) for j in (0, 1)]
        return [sum(part[k] for part in parts) for k in (0, 1)]

    least, most = divide(0, 0, 1, 0)
    arc = [(x, (0.95 - x - 0.75 * x * x) / 0.55) for x in [i / 400 for i in range(401)]]
    d.path([(left + side * x, top + side * y) for x, y in arc if 0 <= y <= 1], RED, 2)
    d.lines((310, 60), "blue: cells that surely show the mesh\nyellow: cells that may\nred: where its edge lies\n\n"
            f"coverage.min {least:.3f} (blue)\ncoverage.max {most:.3f} (blue and yellow)", 14)
    return d.svg()


FIGURES = {"how-it-works": how_it_works, "ray-mesh": ray_mesh, "facet": facet, "histories": histories, "nested": nested,
           "displacement": displacement, "coverage": coverage}


def write(folder):
    folder.mkdir(parents=True, exist_ok=True)
    for name, draw in FIGURES.items():
        (folder / f"{name}.svg").write_text(draw())


if __name__ == "__main__":
    if sys.argv[1:] == ["--check"]:
        if not KEPT.exists() or KEPT.read_text() != how_it_works():
            raise SystemExit("docs/figures/how-it-works.svg is not what docs/generate/figures.py draws: run it")
    elif sys.argv[1:]:
        write(pathlib.Path(sys.argv[1]))
    else:
        KEPT.write_text(how_it_works())
        print(KEPT)
