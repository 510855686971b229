// What callers hand to the core: errors come of it where it is no data, and nothing else does.
#include "support/callers_data.h"

#include <vector>

#include "camera/camera.h"
#include "camera/linear/linear_cameras.h"
#include "core/ray_mesh.h"
#include "support/test.h"
#include "trilinear/points/point_images.h"

using namespace trilens;
using namespace trilens_test;

namespace {

const std::vector<Vec3> kOddVectors = [] {
    std::vector<Vec3> all;
    for (const double x : kOddNumbers) {
        all.emplace_back(x, 0, 0);
        all.emplace_back(x);
        all.emplace_back(1, -2, x);
    }
    return all;
}();

RayMesh film_of_4() {
    return make_camera_mesh(make_perspective({{}, 40, 4, 4}), 4, 4);
}

TriangleScene one_triangle() {
    TriangleScene scene;
    scene.points = {{-1, -1, -1}, {1, -1, -1}, {0, 1, -1}};
    scene.triangles = {{0, 1, 2}};
    scene.object = scene.primitive = {0};
    return scene;
}

SurfaceGrid one_facet() {
    SurfaceGrid grid;
    grid.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    grid.corner_point = {0, 1, 2};
    grid.corner_normal = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
    grid.facets = {{0, 1, 2}};
    return grid;
}

/// RayMeshes that are none, or that only look like it.
std::vector<RayMesh> odd_meshes() {
    std::vector<RayMesh> all(1);
    const auto add = [&](const auto& change) { change(all.emplace_back(film_of_4())); };
    for (const Vec3& v : kOddVectors) {
        add([&](RayMesh& mesh) { mesh.rays[0].origin = v; });
        add([&](RayMesh& mesh) { mesh.rays[1].direction = v; });
        add([&](RayMesh& mesh) { mesh.screen[2] = v; });
        add([&](RayMesh& mesh) {
            for (Ray& ray : mesh.rays) ray = {v, v};
        });
    }
    add([](RayMesh& mesh) { mesh.rays.clear(); });
    add([](RayMesh& mesh) { mesh.screen.pop_back(); });
    add([](RayMesh& mesh) { mesh.facets[1] = {0, 1, 99}; });
    add([](RayMesh& mesh) { mesh.facets[1] = {0, kNone, 1}; });
    add([](RayMesh& mesh) { mesh.facets[1] = {kNone, kNone, kNone}; });
    add([](RayMesh& mesh) { mesh.facets[1] = {1, 1, 1}; });
    return all;
}

/// All descriptions of a kind with one thing odd; `member` of a kind is passed by where it has none.
#define ODD(member, value)                                                  \
    [&](auto& odd) {                                                        \
        if constexpr (requires { odd.member = value; }) odd.member = value; \
    }

std::vector<CameraDescription> odd_descriptions(const CameraKind& kind) {
    CameraDescription plain;
    plain.kind = kind, plain.facets = 4;
    std::vector<CameraDescription> all{plain};
    const auto add = [&](const auto& change) { change(all.emplace_back(plain)); };
    const auto add_kind = [&](const auto&... changes) {
        CameraDescription& changed = all.emplace_back(plain);
        (std::visit(changes, changed.kind), ...);
    };
    for (const Vec3& v : kOddVectors) {
        add([&](CameraDescription& c) { c.eye = v; });
        add([&](CameraDescription& c) { c.up = v; });
        add_kind(ODD(travel, v));
        add_kind(ODD(center, v), ODD(ground_normal, v));
        add_kind(ODD(slits[0], (WorldLine{v, v})), ODD(placed_rays[2], (PlacedRay{v, v, {}})));
        add_kind(ODD(points, (std::vector<Vec3>{v, v, v})), ODD(directions, (std::vector<Vec3>{v, v, v})),
                 ODD(triangles, (std::vector<IdTriple>{{0, 1, 2}})));
        add_kind(ODD(vpn, v));
        add_kind(ODD(prp, v));
    }
    for (const double x : kOddNumbers) {
        add_kind(ODD(yfov, x), ODD(hfov, x), ODD(vfov, x), ODD(fov, x), ODD(context_fov, x));
        add_kind(ODD(ymag, x), ODD(scale, x), ODD(radius, x), ODD(bend, x), ODD(blend, x));
        add_kind(ODD(shift, Vec2(x)), ODD(angle, x));
        add_kind(ODD(near_depth, x));
        add_kind(ODD(far_depth, x));
        add_kind(ODD(window, (std::array<double, 4>{x, 1, x, 1})),
                 ODD(detail, (std::array<double, 4>{x, 1, x, 1})));
        // The refinement is one for all kinds, and ends only at its limit of facets: one kind is enough.
        if (std::holds_alternative<SphericalCamera>(kind))
            add([&](CameraDescription& c) { c.tolerance = x; });
        add_kind(ODD(fx, x), ODD(distortion, (std::vector<double>{x, x, x, x})));
        add_kind(ODD(front, x));
    }
    for (const int n : kOddInts) add([&](CameraDescription& c) { c.facets = n; });
    add_kind(ODD(distortion, (std::vector<double>{1})));
    add_kind(ODD(screen, (std::vector<Vec2>{{0, 0}, {1, 0}, {0, 1}})),
             ODD(triangles, (std::vector<IdTriple>{{0, 1, 7}})));
    add_kind(ODD(views, (std::vector<WindowedCamera>{{plain, {1, 0, 0, 0}}, {plain, {kNaN, 0, 1, 1}}})));
    for (CameraDescription& c : all)
        if (c.facets == 0 && c.tolerance == 0) c.facets = 2;
    return all;
}

#undef ODD

}  // namespace

TEST_CASE("a window of samples that is none, or too many, is refused by its name", "[core][bad-input]") {
    const RayMesh mesh = film_of_4();
    const TriangleScene scene = one_triangle();
    constexpr int kLeast = -2147483647 - 1, kMost = 2147483647;
    for (const SampleGrid& grid :
         {SampleGrid{0, 0, 64, 48, 65536}, SampleGrid{0, 0, 50000, 1, 50000}, SampleGrid{0, 0, 1, 1, 46341},
          SampleGrid{kLeast, 0, kMost, 1, 1}, SampleGrid{0, kLeast, 1, kMost, 1},
          SampleGrid{0, 0, 65536, 65536, 1}, SampleGrid{0, 0, 0, 0, 1}, SampleGrid{0, 0, 4, 4, 0},
          SampleGrid{0, 0, 4, 4, -3}, SampleGrid{4, 0, 0, 4, 1}, SampleGrid{kMost - 1, 0, kMost, 1, 1}}) {
        CAPTURE(grid.x0, grid.y0, grid.x1, grid.y1, grid.side);
        CHECK(refusal([&] { draw_through(mesh, scene, grid); }).rfind("grid: ", 0) == 0);
        CHECK(refusal([&] { visible_through(mesh, scene, grid); }).rfind("grid: ", 0) == 0);
    }
    CHECK(draw_through(mesh, scene, {0, 0, 4, 4, 3}).size() == 144);
    // Far from the film there are samples too, which no facet covers.
    for (const Hit& hit : draw_through(mesh, scene, {-kFarthestPixel, 0, -kFarthestPixel + 2, 2, 1}))
        CHECK_FALSE(hit.seen());
    for (const Visible& seen : visible_through(mesh, scene, {-kFarthestPixel, 0, -kFarthestPixel + 2, 2, 1}))
        CHECK_FALSE(seen.seen());
}

TEST_CASE("a camera without film or rays is refused", "[core][bad-input]") {
    const LinearCamera camera = make_perspective({});
    for (const double size : {0.0, -1.0, kNaN, kInfinity}) {
        CHECK(refusal([&] { make_camera_mesh(camera, size, 480); }).rfind("film: ", 0) == 0);
        CHECK(refusal([&] { make_camera_mesh(camera, 4, size); }).rfind("film: ", 0) == 0);
    }
    CHECK(refusal([&] { make_camera_mesh(camera, 4, 4, kNaN); }).rfind("from: ", 0) == 0);
    CHECK(refusal([] { make_camera_mesh({}, 640, 480); }).rfind("camera: ", 0) == 0);
    CHECK(refusal([] { film_ray({}, {0, 0}); }).rfind("camera: ", 0) == 0);
    LinearCamera odd = camera;
    odd.screen_x.x = kNaN;
    CHECK(refusal([&] { make_camera_mesh(odd, 640, 480); }).rfind("camera: ", 0) == 0);
}

TEST_CASE("meshes that are none are refused wherever rays are looked through", "[core][bad-input]") {
    std::size_t refused = 0;
    for (const RayMesh& mesh : odd_meshes()) {
        only_errors("draw_through", [&] { draw_through(mesh, one_triangle(), {0, 0, 4, 4, 2}); });
        only_errors("visible_through", [&] { visible_through(mesh, one_triangle(), {0, 0, 4, 4, 2}); });
        only_errors("MeshPointImages", [&] {
            const MeshPointImages images(mesh);
            images.images(Vec3(0, 0, -1));
        });
        only_errors("facet_kinds", [&] { facet_kinds(mesh); });
        for (const std::size_t facet : {std::size_t{0}, std::size_t{1}, std::size_t{9}})
            for (const Vec3& axis : {Vec3(0), Vec3(0, 0, -1), Vec3(kNaN), Vec3(1e308)})
                only_errors("facet_kind", [&] { facet_kind(mesh, facet, axis); });
        try {
            check_ray_mesh(mesh);
        } catch (const InputError&) {
            ++refused;
        }
    }
    CHECK(refused > 20);
    CHECK(refused < odd_meshes().size());

    const MeshPointImages images(film_of_4());
    for (const Vec3& v : kOddVectors) {
        only_errors("images", [&] { images.images(v); });
        only_errors("images of many", [&] { images.images(std::vector<Vec3>{{0, 0, -1}, v}); });
    }
    CHECK(refusal([&] { images.images(Vec3(kNaN)); }).rfind("point: ", 0) == 0);
}

TEST_CASE("triangles and grids that are none are refused", "[core][bad-input]") {
    const RayMesh mesh = film_of_4();
    const LinearCamera camera = make_perspective({});
    const auto with_scene = [&](const auto& change) {
        TriangleScene scene = one_triangle();
        change(scene);
        only_errors("draw_through", [&] { draw_through(mesh, scene, {0, 0, 4, 4, 1}); });
    };
    const auto with_grid = [&](const auto& change) {
        SurfaceGrid grid = one_facet();
        change(grid);
        only_errors("make_mirror_mesh", [&] { make_mirror_mesh(grid, camera); });
        only_errors("make_lens_mesh", [&] { make_lens_mesh(grid, camera, 1.5); });
    };
    for (const Vec3& v : kOddVectors) {
        with_scene([&](TriangleScene& scene) { scene.points[1] = v; });
        with_scene([&](TriangleScene& scene) { scene.points = {v, v, v}; });
        with_grid([&](SurfaceGrid& grid) { grid.points[0] = v; });
        with_grid([&](SurfaceGrid& grid) { grid.corner_normal[2] = v; });
    }
    with_scene([](TriangleScene& scene) { scene = {}; });
    with_scene([](TriangleScene& scene) { scene.points.clear(); });
    with_scene([](TriangleScene& scene) { scene.object.clear(); });
    with_scene([](TriangleScene& scene) { scene.triangles[0][1] = kNone; });
    with_grid([](SurfaceGrid& grid) { grid = {}; });
    with_grid([](SurfaceGrid& grid) { grid.corner_point.pop_back(); });
    with_grid([](SurfaceGrid& grid) { grid.facets[0] = {0, 1, kNone}; });
    with_grid([](SurfaceGrid& grid) { grid.corner_point[0] = kNone; });
    for (const double x : kOddNumbers) {
        only_errors("make_lens_mesh", [&] { make_lens_mesh(one_facet(), camera, x); });
        LinearCamera odd = camera;
        odd.screen_w.w = x, odd.eye.x = x, odd.view_direction.z = x;
        only_errors("make_mirror_mesh", [&] { make_mirror_mesh(one_facet(), odd); });
        only_errors("make_lens_mesh", [&] { make_lens_mesh(one_facet(), odd, 1.5); });
    }
    only_errors("make_mirror_mesh", [&] { make_mirror_mesh(one_facet(), {}); });
}

TEST_CASE("cameras of numbers that are none are refused or have rays", "[core][bad-input]") {
    for (const double x : kOddNumbers) {
        for (const Vec3& v : kOddVectors) {
            only_errors("make_perspective", [&] {
                make_perspective({{v, {}, {0, 1, 0}}, 40, 4, 4, {x, 0}});
            });
            only_errors("make_orthographic", [&] { make_orthographic({{v, {}, {0, 1, 0}}, 2, x, 4}); });
        }
        only_errors("make_perspective", [&] { make_perspective({{}, x}); });
        only_errors("make_perspective", [&] { make_perspective({{}, 40, x, x}); });
        only_errors("make_orthographic", [&] { make_orthographic({{}, x}); });
        only_errors("make_oblique", [&] { make_oblique({{}, 2, x, x, x, 4}); });
        only_errors("film_ray", [&] { film_ray(make_perspective({}), {x, -x}); });
        only_errors("make_film_axes", [&] { make_film_axes({{x, 0, 0}, {0, x, 0}, {x, x, x}}); });
        only_errors("require_film", [&] { require_film(x, 5); });
        const std::vector<Vec3> v{{x, 0, 0}, {0, x, 0}, {0, 0, x}};
        const std::vector<Vec2> s{{x, 0}, {1, x}, {0, 1}};
        const std::vector<IdTriple> t{{0, 1, 2}}, far{{0, 1, 3}};
        only_errors("make_ray_mesh", [&] { make_ray_mesh({v, v, s, t}, 4, 4); });
        only_errors("make_ray_mesh", [&] { make_ray_mesh({v, v, s, far}, 4, x); });
        only_errors("make_ray_mesh", [&] { make_ray_mesh({v, {}, {}, t}, 4, 4); });
    }
    for (const CameraDescription& c : odd_descriptions(ViewVolume())) {
        const ViewVolume& volume = std::get<ViewVolume>(c.kind);
        only_errors("check_view_volume", [&] { check_view_volume(volume); });
        only_errors("make_view_volume", [&] { make_view_volume(volume, {4, 4}); });
        only_errors("depth_range", [&] { depth_range(volume); });
    }
}

TEST_CASE("every kind of camera meets descriptions, films, places and points that are none",
          "[core][bad-input]") {
    only_errors("exact_ray", [] { exact_ray({}, {0, 0}); });
    only_errors("film_positions", [] { film_positions({}, {0, 0, 0}); });
    only_errors("facet_kinds", [] { facet_kinds(Camera()); });
    std::vector<CameraKind> kinds;
    [&]<std::size_t... I>(std::index_sequence<I...>) {
        (kinds.push_back(std::variant_alternative_t<I, CameraKind>()), ...);
    }
    (std::make_index_sequence<std::variant_size_v<CameraKind>>());
    for (const CameraKind& kind : kinds) {
        INFO(kind.index());
        for (const double x : kOddNumbers) {
            CameraDescription plain;
            plain.kind = kind, plain.facets = 2;
            only_errors("make_camera", [&] { make_camera(plain, {x, 4}); });
            only_errors("make_camera", [&] { make_camera(plain, {4, x}); });
        }
        for (const CameraDescription& from : odd_descriptions(kind)) {
            only_errors("make_camera", [&] {
                const Camera camera = make_camera(from, {4, 3});
                exact_ray(camera, {kNaN, 0});
                exact_ray(camera, {1e308, -1e308});
                film_positions(camera, Vec3(kNaN));
                film_positions(camera, Vec3(1e308, kInfinity, 0));
                film_positions(camera, from.eye);
                facet_kinds(camera);
                if (camera.model) film_spread(*camera.model, {1, kNaN}, 0);
            });
        }
    }
}

TEST_CASE("facets by themselves answer numbers that are none", "[core][bad-input]") {
    for (const Vec3& v : kOddVectors) {
        const std::array<Ray, 3> rays{Ray{v, {0, 0, 1}}, Ray{{1, 0, 0}, v}, Ray{{0, 1, 0}, {0, 0, 1}}};
        only_errors("general_linear_camera", [&] { general_linear_camera(rays, {0, 0, 1}); });
        only_errors("general_linear_camera", [&] { general_linear_camera(rays, v, kNaN); });
        const Coplanarity facet = make_coplanarity({rays});
        only_errors("point_images", [&] { point_images(facet, v, {true, true}); });
        only_errors("point_images", [&] { point_images(facet, {0, 0, 1}); });
        only_errors("weights", [&] { weights_in_parametric_triangle(facet, v.x, v); });
        only_errors("may_hold", [&] { may_hold(facet, make_facet_beam(facet), v); });
        only_errors("ray_spread", [&] { ray_spread({rays[0], rays[1], rays[2]}).roots(); });
        only_errors("roots", [&] { RaySpread{v.x, v.y, v.z}.roots(); });
    }
}
