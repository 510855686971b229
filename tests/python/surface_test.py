"""Surfaces and RayMeshes against formulas of their own."""
import gc

import numpy as np
import pytest

import trilens

SQUARE = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]


def b_spline(t):
    """The uniform cubic B-spline's four weights, and their first and second derivatives."""
    t = np.asarray(t)[:, None]
    c = np.array([[1, 4, 1, 0], [-3, 0, 3, 0], [3, -6, 3, 0], [-1, 3, -3, 1]]) / 6
    k = np.arange(4)
    first = np.where(k > 0, k * t ** np.maximum(k - 1, 0), 0)
    second = np.where(k > 1, k * (k - 1) * t ** np.maximum(k - 2, 0), 0)
    return t**k @ c, first @ c, second @ c


def test_a_regular_patch_is_a_bicubic_b_spline():
    rng = np.random.default_rng(5)
    x, y = np.meshgrid(np.arange(4.0), np.arange(4.0))
    points = np.stack([x, y, rng.normal(size=(4, 4))], -1) + rng.normal(size=(4, 4, 3)) * 0.1
    faces = [[4 * j + i, 4 * j + i + 1, 4 * j + i + 5, 4 * j + i + 4] for j in range(3) for i in range(3)]
    surface = trilens.limit_surface(points.reshape(-1, 3), faces)
    assert surface.face_count == 9 and surface.domain(4) == "square"
    uv = rng.uniform(0, 1, (50, 2))
    got = surface.eval(4, uv)
    (u, du, duu), (v, dv, dvv) = b_spline(uv[:, 0]), b_spline(uv[:, 1])
    for name, (a, b) in {"position": (u, v), "du": (du, v), "dv": (u, dv), "duu": (duu, v), "duv": (du, dv), "dvv": (u, dvv)}.items():
        assert got[name].shape == (50, 3)
        assert np.allclose(got[name], np.einsum("ni,nj,jik->nk", a, b, points), atol=1e-12), name
    normal = np.cross(got["du"], got["dv"])
    assert np.allclose(got["normal"], normal / np.linalg.norm(normal, axis=1)[:, None], atol=1e-12)


def test_faces_may_differ_from_point_to_point():
    surface = trilens.primitive_surface("sphere", center=(1, 2, 3), radius=0.5)
    rng = np.random.default_rng(6)
    faces, uv = rng.integers(0, surface.face_count, 200), rng.uniform(0, 1, (200, 2))
    bulk = surface.eval(faces, uv)
    out = bulk["position"] - (1, 2, 3)
    assert np.allclose(np.linalg.norm(out, axis=1), 0.5, atol=1e-14)
    assert np.allclose(bulk["normal"], out / 0.5, atol=1e-12)
    for i in range(0, 200, 20):
        one = surface.eval(int(faces[i]), uv[i : i + 1])
        assert all(np.array_equal(one[name][0], bulk[name][i]) for name in one)


def test_derivatives_are_those_of_positions():
    surface = trilens.primitive_surface("paraboloid", radius=2, focal_length=0.7)
    uv, step = np.random.default_rng(8).uniform(0.1, 0.9, (20, 2)), 1e-5
    for face in range(surface.face_count):
        at = surface.eval(face, uv)
        for name, move in {"du": (step, 0), "dv": (0, step)}.items():
            ahead, behind = surface.eval(face, uv + move), surface.eval(face, uv - move)
            slope = (ahead["position"] - behind["position"]) / (2 * step)
            assert np.allclose(at[name], slope, atol=1e-8)


def test_creases_and_corners_sharpen():
    smooth = trilens.limit_surface([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 1], [2, 1, 1]], [[0, 1, 2, 3], [1, 4, 5, 2]])
    sharp = trilens.limit_surface([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 1], [2, 1, 1]], [[0, 1, 2, 3], [1, 4, 5, 2]], creases=[([1, 2], 10)])
    edge = [[1.0, 0.5]]
    assert np.allclose(sharp.eval(0, edge)["position"], [[1, 0.5, 0]], atol=1e-12)
    assert smooth.eval(0, edge)["position"][0, 2] > 0.01
    with pytest.raises(trilens.UsageError):
        trilens.limit_surface(SQUARE, [[0, 1, 2, 3]], scheme="loup")


def test_bad_cages_and_faces_are_refused():
    with pytest.raises(trilens.InputError):
        trilens.limit_surface(SQUARE, [[0, 1, 2, 9]])
    with pytest.raises(trilens.InputError):
        trilens.primitive_surface("sphere", radius=-1)
    with pytest.raises(trilens.UsageError):
        trilens.primitive_surface("ball")
    surface = trilens.limit_surface(SQUARE, [[0, 1, 2, 3]])
    with pytest.raises(trilens.UsageError, match="no face 1"):
        surface.eval(1, [[0, 0]])
    with pytest.raises(trilens.UsageError):
        surface.eval([0, 0, 0], [[0, 0]])
    with pytest.raises(trilens.UsageError):
        surface.eval(0.5, [[0, 0]])
    with pytest.raises(trilens.InputError):
        surface.eval(0, [[0, np.nan]])
    with pytest.raises(trilens.InputError):
        surface.grid(0)


def test_a_grid_lies_on_its_surface_and_its_arrays_are_views():
    surface = trilens.primitive_surface("sphere", radius=2)
    grid = surface.grid(3)
    facets, points, corner_point = grid.facets, grid.points, grid.corner_point
    assert facets.shape == (6 * 18, 3) and grid.facet_uv.shape == (108, 3, 2) and facets.dtype == np.uint32
    assert np.shares_memory(grid.points, points) and points.base is grid and not points.flags.writeable
    assert np.allclose(np.linalg.norm(points, axis=1), 2, atol=1e-14)
    for k in range(3):
        on_face = surface.eval(grid.facet_face, grid.facet_uv[:, k])["position"]
        assert np.allclose(on_face, points[corner_point[facets[:, k]]], atol=1e-12)
    del grid
    gc.collect()
    assert np.allclose(np.linalg.norm(points, axis=1), 2, atol=1e-14)


def brute_force(origins, directions, corners):
    """The nearest triangle along each ray, and how far the ray is from all edges (Moller and Trumbore)."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    normal = np.cross(b - a, c - a)
    with np.errstate(all="ignore"):
        t = np.einsum("rtk,tk->rt", a[None] - origins[:, None], normal) / (directions @ normal.T)
        hit = origins[:, None] + t[..., None] * directions[:, None]
        area = np.einsum("tk,tk->t", normal, normal)
        w = np.stack([np.einsum("rtk,tk->rt", np.cross(q - p, hit - p), normal) / area for p, q in ((b, c), (c, a), (a, b))], -1)
    inside = (w > 0).all(-1) & (t >= 0)
    nearest = np.where(inside, t, np.inf).argmin(1)
    clear = (np.abs(w) > 1e-6).all((1, 2))
    seen = inside.any(1)
    return np.where(seen, nearest, trilens.NONE), np.where(seen, t[np.arange(len(t)), nearest], np.nan), clear


@pytest.mark.parametrize("side", [1, 2])
def test_what_a_pinhole_sees_is_what_brute_force_finds(side):
    rng = np.random.default_rng(9)
    points = rng.uniform(-2, 2, (60, 3))
    triangles = rng.permutation(60).reshape(20, 3)
    camera = trilens.make_perspective(eye=(0, 0, 6), width=40, height=30)
    mesh = trilens.camera_mesh(camera, 40, 30)
    hits = trilens.draw_through(mesh, points, triangles, (4, 2, 36, 28), side)
    shape = (26, 32) if side == 1 else (26, 32, 2, 2)
    assert hits["triangle"].shape == shape and hits["barycentric"].shape == shape + (2,)

    # The samples' rays, from the film's geometry alone.
    offset = (np.arange(side) + 0.5) / side
    y = (np.arange(2, 28)[:, None] + offset).reshape(26, 1, side, 1)
    x = (np.arange(4, 36)[:, None] + offset).reshape(1, 32, 1, side)
    half = np.tan(np.radians(20))
    x, y = np.broadcast_arrays((2 * x - 40) / 30 * half, (15 - y) / 15 * half)
    directions = np.stack([x, y, -np.ones_like(x)], -1).reshape(-1, 3)
    triangle, t, clear = brute_force(np.broadcast_to([0.0, 0, 6], directions.shape), directions, points[triangles])
    assert clear.mean() > 0.9 and 50 < (triangle != trilens.NONE).sum()
    assert np.array_equal(hits["triangle"].ravel()[clear], triangle[clear])
    assert np.allclose(hits["t"].ravel()[clear], t[clear], rtol=1e-9, equal_nan=True)

    visible = trilens.visible_through(mesh, points, triangles, (4, 2, 36, 28), side)
    assert np.array_equal(visible["triangle"], hits["triangle"])
    seen = hits["triangle"] != trilens.NONE
    low, high = (visible[name].astype(float) for name in ("t_low", "t_high"))
    assert (low[seen] <= hits["t"][seen]).all() and (hits["t"][seen] <= high[seen]).all()
    assert np.median(high[seen] / low[seen] - 1) < 1e-3 and np.isinf(low[~seen]).all() and np.isinf(high[~seen]).all()
    seen = hits["triangle"] != trilens.NONE
    corners = points[triangles[hits["triangle"][seen]]]
    beta, gamma = hits["barycentric"][seen].T
    at = corners[:, 0] + beta[:, None] * (corners[:, 1] - corners[:, 0]) + gamma[:, None] * (corners[:, 2] - corners[:, 0])
    assert np.allclose(at, ([0, 0, 6] + hits["t"].reshape(-1)[:, None] * directions)[seen.ravel()], atol=1e-9)


def test_a_flat_mirror_shows_points_where_their_mirror_images_are():
    rng = np.random.default_rng(10)
    plane = trilens.primitive_surface("plane", axis=(0, 0, 1), tangent=(1, 0, 0), size=(20, 20))
    camera = trilens.make_perspective(eye=(0.3, 0.2, 5), at=(0, 0, 0), width=100, height=80)
    mesh = trilens.mirror_mesh(plane.grid(2), camera)
    points = rng.uniform([-1, -1, 1], [1, 1, 4], (30, 3))
    images = mesh.images(points)
    x, y, w = camera.project(points * [1, 1, -1]).T
    assert np.array_equal(images["point"], np.arange(30))
    assert np.allclose(images["x"], x / w, atol=1e-9) and np.allclose(images["y"], y / w, atol=1e-9)
    corners = mesh.facets[images["facet"]]
    origin = np.einsum("nk,nkc->nc", images["weights"], mesh.origins[corners])
    direction = np.einsum("nk,nkc->nc", images["weights"], mesh.directions[corners])
    assert np.allclose(origin + images["t"][:, None] * direction, points, atol=1e-9)


def test_a_ray_mesh_of_ones_own_is_the_cameras():
    camera = trilens.make_orthographic(eye=(0, 0, 3), width=32, height=24)
    given = trilens.camera_mesh(camera, 32, 24)
    own = trilens.RayMesh(given.origins, given.directions, given.screen[:, :2], given.facets)
    assert np.array_equal(own.screen, given.screen) and np.array_equal(own.facets, given.facets)
    assert np.array_equal(own.origins, given.origins) and np.array_equal(own.directions, given.directions)
    assert own.origins.base is own and camera.parallel and camera.view_direction == (0, 0, -1)
    triangle = ([[-1, -1, 0], [1, -1, 0], [0, 1, 0.5]], [[0, 1, 2]], (0, 0, 32, 24))
    a, b = trilens.draw_through(own, *triangle), trilens.draw_through(given, *triangle)
    assert all(np.array_equal(a[name], b[name], equal_nan=name != "triangle") for name in a)
    assert (a["triangle"] == 0).any()


def test_a_lens_bends_by_snells_law():
    plane = trilens.primitive_surface("plane", axis=(0, 0, 1), tangent=(1, 0, 0), size=(4, 4))
    eye, point = np.array([0, 0.1, 5]), np.array([0.4, 0.3, -2])
    camera = trilens.make_perspective(eye=eye, width=64, height=48)
    for ior in (1.0, 1.33, 1.5):
        image = trilens.lens_mesh(plane.grid(64), camera, ior).images([point])
        assert len(image["x"]) == 1

        # From the pixel alone: the ray to the plane, its direction behind it, and where that meets the point's depth.
        half = np.tan(np.radians(20))
        forward = -eye / np.linalg.norm(eye)
        right = np.cross(forward, [0, 1, 0]) / np.linalg.norm(np.cross(forward, [0, 1, 0]))
        x, y = (image["x"][0] - 32) / 24 * half, (24 - image["y"][0]) / 24 * half
        ray = forward + x * right + y * np.cross(right, forward)
        ray /= np.linalg.norm(ray)
        across = ray[:2] / ior
        behind = np.array([*across, -np.sqrt(1 - across @ across)])
        at = eye + eye[2] / -ray[2] * ray
        assert np.allclose(at + point[2] / behind[2] * behind, point, atol=1e-9 if ior == 1 else 1e-4)


def test_what_is_no_ray_mesh_is_refused():
    good = {"origins": np.zeros((3, 3)), "directions": np.eye(3), "screen": np.zeros((3, 2)), "facets": [[0, 1, 2]]}
    trilens.RayMesh(**good)
    trilens.RayMesh(**{**good, "facets": [[trilens.NONE] * 3]})
    for name, bad, error in [
        ("facets", [[0, 1, 3]], trilens.InputError),
        ("facets", [[0, 1, -1]], trilens.UsageError),
        ("facets", [[0.0, 1.5, 2]], trilens.UsageError),
        ("directions", np.eye(3) * np.nan, trilens.InputError),
        ("directions", np.zeros((2, 3)), trilens.UsageError),
        ("screen", np.zeros((2, 2)), trilens.InputError),
    ]:
        with pytest.raises(error):
            trilens.RayMesh(**{**good, name: bad})
    with pytest.raises(trilens.InputError):
        trilens.draw_through(trilens.RayMesh(**good), SQUARE, [[0, 1, 7]], (0, 0, 4, 4))
    with pytest.raises(trilens.InputError):
        trilens.draw_through(trilens.RayMesh(**good), SQUARE, [[0, 1, 2]], (0, 0, 0, 4))
