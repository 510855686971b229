"""Scenes whose size can be chosen: random triangles, and bent rays through any number of facets."""
import json
import math
import pathlib
import random

ROOT = pathlib.Path(__file__).resolve().parents[2]

# One facet and one triangle each, searched for the shapes that the triangle breaks into (thesis, table 4.1).
CONFIGURATIONS = {
    "(2,2,2,3)": "fig_4_1_2223", "(2,3)": "fig_8_1_23", "(3,3,3)": "fig_4_2_333", "(4,2,3)": "fig_4_3_423",
    "(4,5)": "fig_4_4_45", "(6,3)": "fig_4_5_63", "(9)": "fig_4_7_9",
}


def configuration_file(name):
    return ROOT / "scenes" / "thesis" / f"{CONFIGURATIONS[name]}.json"


def bent_rays(n):
    """A rayMesh camera of 2 n^2 facets that fills the film: rays that leave a plane and turn as they go out."""
    points, directions, screen, triangles = [], [], [], []
    for j in range(n + 1):
        for i in range(n + 1):
            u, v = i / n, j / n
            x, y = 2 * u - 1, 1 - 2 * v
            turn = 0.9 * x * y
            points.append([round(x, 9), round(y, 9), 0])
            directions.append([round(0.25 * x * math.cos(turn) - 0.5 * y * math.sin(turn), 9),
                               round(0.5 * x * math.sin(turn) + 0.25 * y * math.cos(turn), 9), -1])
            screen.append([u, v])
    for j in range(n):
        for i in range(n):
            a, b, c, d = j * (n + 1) + i, j * (n + 1) + i + 1, (j + 1) * (n + 1) + i + 1, (j + 1) * (n + 1) + i
            triangles += [[a, b, c], [a, c, d]]
    return {"name": "main", "type": "rayMesh", "points": points, "directions": directions, "screen": screen, "triangles": triangles}


def random_points(count, seed):
    """Corners of `count` random triangles in the rays' way; the more there are, the smaller, so that together they
    hide about as much."""
    draw = random.Random(seed)
    size = 0.9 * count ** -0.5 + 0.02
    points = []
    for _ in range(count):
        middle = [draw.uniform(-1.2, 1.2), draw.uniform(-1.2, 1.2), draw.uniform(-3, -0.5)]
        points += [[round(c + size * draw.gauss(0, 1), 6) for c in middle] for _ in range(3)]
    return points


def random_scene(folder, triangles, facets_across=1, seed=8):
    """Writes the scene and returns its file."""
    file = pathlib.Path(folder) / f"random_{triangles}_{facets_across}.json"
    scene = {
        "version": 1,
        "film": {"width": 400, "height": 400, "spp": 1},
        "cameras": [bent_rays(facets_across)],
        "background": {"color": [0.02, 0.025, 0.035]},
        "materials": [{"name": "paper", "baseColorFactor": [0.8, 0.7, 0.5], "unlit": True}],
        "meshes": [{"name": "triangles", "role": "object", "material": "paper", "points": random_points(triangles, seed),
                    "faceVertexCounts": [3] * triangles, "faceVertexIndices": list(range(3 * triangles))}],
        "lights": [],
    }
    file.write_text(json.dumps(scene))
    return file
