"""Lenses by their prescriptions, from Python and by the command."""
import csv
import math

import numpy as np
import pytest

import trilens
from conftest import SOURCE

TRIPLET = SOURCE / "scenes/lenses/cooke-triplet.zmx"
GAUSS = SOURCE / "scenes/lenses/double-gauss.seq"


def test_first_order_and_seidel_sums_are_the_published_ones():
    triplet = trilens.load_lens(TRIPLET)
    assert (triplet.name, triplet.surface_count) == ("Cooke triplet, f/3.5", 7)
    assert triplet.first_order()["focal_length"] == pytest.approx(101.181, abs=5e-4)
    sums = triplet.seidel(14.6, 0.21)
    assert sums["surfaces"][2]["spherical"] / (2 * sums["image_slope"]) == pytest.approx(2.049816, abs=1e-5)
    assert sums["sum"]["distortion"] / (2 * sums["image_slope"]) == pytest.approx(0.142422, abs=1e-5)
    assert trilens.load_lens(GAUSS).first_order()["back_focal_length"] == pytest.approx(56.424, abs=2e-3)
    assert {"N-BK7", "N-SF11", "F2"} <= set(trilens.glass_names())


def test_a_ray_near_the_axis_crosses_it_in_the_focus():
    triplet = trilens.load_lens(TRIPLET)
    first = triplet.first_order()
    (x, y, z), (dx, dy, dz) = triplet.trace((0, 1e-3, -1), (0, 0, 1))
    assert z - y * dz / dy == pytest.approx(first["length"] + first["back_focal_length"], abs=1e-6)
    assert triplet.trace((0, 20, -1), (0, 0, 1)) is None


def test_the_command_tells_what_python_tells(command, tmp_path):
    spot = tmp_path / "spot.csv"
    run, answer = command("lens", TRIPLET, "--field", "6", "-o", spot)
    triplet = trilens.load_lens(TRIPLET)
    assert answer["first_order"] == triplet.first_order()
    found = triplet.spot(field=6)
    assert answer["spot"]["rms_radius"] == found["rms_radius"]
    with spot.open(newline="") as rows:
        points = [(float(row["x"]), float(row["y"])) for row in csv.DictReader(rows)]
    assert points == found["points"]
    slope = math.tan(math.radians(6))
    sums = triplet.seidel(triplet.first_order()["entrance_radius"], slope)["sum"]
    assert answer["seidel"]["sum"] == pytest.approx(sums, rel=1e-12)


def test_a_spot_without_rays_has_no_radius(command):
    code, answer = command("lens", TRIPLET, "--field", "60")
    assert code == 0 and any("no ray" in warning for warning in answer["warnings"])
    assert answer["spot"] == {"rays": 0, "asked": 217, "centroid": None, "rms_radius": None, "radius": None}
    found = trilens.load_lens(TRIPLET).spot(field=60)
    assert not found["points"] and math.isnan(found["rms_radius"]) and math.isnan(found["centroid"][0])


def test_a_lens_primitive_has_its_sides():
    lens = trilens.primitive_surface("lens", axis=(0, 0, 1), thickness=0.5, front=(4, 1), back=(-4, 0.9, -1, 0, 0.001))
    assert lens.face_count == 14
    with pytest.raises(trilens.InputError, match="turns back"):
        trilens.primitive_surface("lens", front=(1, 1))
    with pytest.raises(trilens.UsageError, match="front is"):
        trilens.primitive_surface("lens", front=(1,))
    # Coefficients one after the other, and as a sequence.
    flat, nested = (
        trilens.primitive_surface("lens", front=side) for side in [(3, 1, -0.5, 0, 0.01), (3, 1, -0.5, [0, 0.01])]
    )
    places = [(0.2, 0.3), (0.9, 0.4)]
    for face in range(flat.face_count):
        assert np.array_equal(flat.eval(face, places)["position"], nested.eval(face, places)["position"])
    for side in [(3, 1, [0, 0.01]), (3, 1, -0.5, [0], 0.01), ([3], 1), (3, 1, 0, [0] * 99)]:
        with pytest.raises(trilens.UsageError, match="front is"):
            trilens.primitive_surface("lens", front=side)


def front_points(front):
    """Of a lens whose back is flat: (r^2, z) all over its front."""
    lens = trilens.primitive_surface("lens", axis=(0, 0, 1), thickness=3, front=front, back=(0, 5))
    places = [(u / 7, v / 7) for u in range(8) for v in range(8)]
    points = np.concatenate([lens.eval(face, places)["position"] for face in range(lens.face_count)])
    squares = points[:, 0] ** 2 + points[:, 1] ** 2
    on_front = (points[:, 2] < 1.5) & (squares < 24.9)
    return squares[on_front], points[on_front, 2]


def test_sides_of_a_lens_primitive_have_the_keys_of_scenes():
    sphere = lambda s: s / 20 / (1 + np.sqrt(1 - s / 400))
    cosine = lambda s: np.sqrt(1 - s / 400)
    # Forbes' first two polynomials: Qcon 1 and 6 u^2 - 5; Qbfs 1 and (13 - 16 u^2) / sqrt(19).
    cases = [
        ({"coefficients": [0, 1e-4]}, lambda s: 1e-4 * s**2),
        ({"normalDepartures": [1e-3, -2e-5]}, lambda s: (1e-3 * s - 2e-5 * s**2) / cosine(s)),
        ({"qcon": [0.1, 0.02]}, lambda s: (s / 25) ** 2 * (0.1 + 0.02 * (6 * s / 25 - 5))),
        (
            {"qbfs": np.array([0.1, 0.02]), "normalizationRadius": 6},
            lambda s: s / 36 * (1 - s / 36) * (0.1 + 0.02 * (13 - 16 * s / 36) / math.sqrt(19)) / cosine(s),
        ),
    ]
    for keys, departure in cases:
        squares, z = front_points({"radius": 20, "aperture": 5, **keys})
        assert len(squares) > 100
        assert z == pytest.approx(sphere(squares) + departure(squares), abs=1e-12)
    squares, z = front_points((20, 5))
    assert z == pytest.approx(sphere(squares), abs=1e-13)


@pytest.mark.parametrize(
    "side, message",
    [
        ({"radius": 4}, "^front: .*aperture"),
        ({"radius": 4, "aperture": 1, "sag": 1}, "^front: /sag: "),
        ({"radius": 4, "aperture": 1, "conic": -1, "qbfs": [1]}, "^front: /qbfs: .*conic must be 0"),
        ({"aperture": 1, "qcon": [0] * 8}, "^front: /qcon: "),
        ({"aperture": -1}, "^front: /aperture: "),
    ],
)
def test_a_side_that_is_none_is_refused_with_its_key(side, message):
    with pytest.raises(trilens.InputError, match=message):
        trilens.primitive_surface("lens", front=side)


def test_unknown_glass_is_refused_with_its_line(tmp_path):
    file = tmp_path / "bad.zmx"
    file.write_text(TRIPLET.read_text().replace("SF2", "SF22"))
    with pytest.raises(trilens.InputError, match="line [0-9]+: unknown glass 'SF22'; did you mean"):
        trilens.load_lens(file)
    with pytest.raises(trilens.InputError, match="/lenses/0/file: .*unknown glass 'SF22'"):
        trilens.load_scene(SOURCE / "scenes/lenses/cooke-triplet.json", {"/lenses/0/file": str(file)})


def test_telescopes_have_their_focal_lengths_and_glasses_come_from_catalogues(command, tmp_path):
    newtonian = trilens.load_lens(SOURCE / "scenes/lenses/newtonian.zmx")
    assert not newtonian.is_centred and trilens.load_lens(TRIPLET).is_centred
    assert newtonian.first_order()["focal_length"] == pytest.approx(500, abs=1e-9)
    assert newtonian.spot(rings=3)["radius"] < 1e-10
    origin, direction = newtonian.trace((30, 10, -900), (0, 0, 1))
    way = [f - o for f, o in zip((0, -120, -380), origin)]
    assert way == pytest.approx([math.dist((0, 0, 0), way) * d for d in direction], abs=1e-10)
    _, answer = command("lens", SOURCE / "scenes/lenses/newtonian.zmx")
    assert any("as if none were tilted" in warning for warning in answer["warnings"])
    catalogue, file = tmp_path / "mine.agf", tmp_path / "mine.zmx"
    catalogue.write_text("NM MINE 2 0 0 0\nCD 1.03961212 0.00600069867 0.231792344 0.0200179144 1.01046945 103.560653\n")
    file.write_text("SURF 0\n DISZ INFINITY\nSURF 1\n CURV 0.02\n DISZ 4\n DIAM 9\n GLAS MINE\nSURF 2\n DIAM 9\nSURF 3\n")
    lens = trilens.load_lens(file, glasses=catalogue)
    assert lens.first_order()["focal_length"] == pytest.approx(50 / 0.5168, abs=1e-3)
    _, answer = command("lens", file, "--glasses", catalogue)
    assert answer["first_order"] == lens.first_order()
    with pytest.raises(trilens.InputError, match="line 7: unknown glass 'MINE'"):
        trilens.load_lens(file)


def test_a_lens_primitive_has_a_hole():
    ring = trilens.primitive_surface("lens", axis=(0, 0, 1), front=(4, 1), back=(-4, 0.9), hole=0.3)
    assert ring.face_count == 16
    with pytest.raises(trilens.InputError, match="hole is not smaller"):
        trilens.primitive_surface("lens", hole=1)


def test_terms_that_end_within_the_rim_are_warned_of(command, tmp_path):
    file = tmp_path / "q.seq"
    for radius, told in (7, 1), (8, 0):
        file.write_text(
            f"RDM\nSO 0 1E13\nS 60 4 NBK7\n CIR 8\n SPS QBF; SCO C1 {radius}; SCO C3 0.01\nS 0 90\n CIR 8\nSI 0 0\n"
        )
        _, answer = command("lens", file)
        assert sum("line 3: its aperture is larger" in warning for warning in answer["warnings"]) == told


def test_an_anamorphic_lens_has_two_focal_lengths(command, tmp_path):
    file = tmp_path / "cylinder.seq"
    file.write_text("RDM\nSO 0 1E13\nS 60 4 NBK7\n CIR 8\n YTO; RDX 30\nS 0 90\n CIR 8\nSI 0 0\n")
    lens = trilens.load_lens(file)
    assert not lens.is_round and trilens.load_lens(TRIPLET).is_round
    assert lens.first_order() == lens.first_order(section="y")
    assert lens.first_order(section="y")["focal_length"] == pytest.approx(60 / 0.5168, rel=1e-12)
    assert lens.first_order(section="x")["focal_length"] == pytest.approx(30 / 0.5168, rel=1e-12)
    _, answer = command("lens", file)
    assert answer["first_order_x"] == lens.first_order(section="x")
    assert any("section along y" in warning for warning in answer["warnings"])
    flat = tmp_path / "flat.seq"
    flat.write_text(file.read_text().replace("RDX 30", "RDX 0"))
    _, answer = command("lens", flat)
    assert answer["first_order_x"] is None
    with pytest.raises(trilens.InputError, match="no focal length"):
        trilens.load_lens(flat).first_order(section="x")
    assert trilens.load_lens(flat).imaging_section == "y"
    across = tmp_path / "across.seq"
    across.write_text("RDM\nSO 0 1E13\nS 0 4 NBK7\n CIR 8\n CYL; RDX 30\nS 0 54.4\n CIR 8\nSI 0 0\n")
    lens = trilens.load_lens(across)
    assert lens.imaging_section == "x"
    _, answer = command("lens", across, "--pupil", 1)
    assert answer["first_order"] is None
    assert answer["first_order_x"] == lens.first_order(section="x")
    assert answer["first_order_x"]["focal_length"] == pytest.approx(30 / 0.5168, rel=1e-12)
    assert answer["seidel"]["sum"] == lens.seidel(1, 0, section="x")["sum"]
    assert answer["spot"]["radius"] == pytest.approx(1, rel=1e-3)
    assert any("along y it has no focal length" in warning for warning in answer["warnings"])
    run, answer = command("lens", across, "--field", 20, "--pupil", 1)
    (x, y), height = answer["spot"]["centroid"], answer["seidel"]["image_height"]
    assert height == pytest.approx(21.13, abs=0.01)
    assert x == pytest.approx(height, rel=0.01) and y == pytest.approx(0, abs=1e-9)
    assert lens.spot(pupil_radius=1, field=20)["centroid"] == (x, y)
    side = {"aperture": 1, "radius": 3, "rotationRadius": -4, "profileAlong": "x"}
    bowl = trilens.primitive_surface("lens", axis=(0, 0, 1), front=side, back=(0, 1), thickness=1)
    assert bowl.face_count == 14
    with pytest.raises(trilens.InputError, match="radiusX"):
        trilens.primitive_surface("lens", front={"aperture": 1, "conicX": 2})
