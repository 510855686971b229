// Maps both ways: there and back, against each other, and as other programs read them.
#include <cmath>
#include <cstring>

#include "ball_worlds.h"
#include "base/util/error.h"
#include "inverse/maps/film_map.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

FilmMapRequest equirect_request(int width, MapWay way) {
    FilmMapRequest request;
    request.target = {TargetKind::kEquirect, width, width / 2};
    request.way = way;
    request.tolerance = 1e-3;
    return request;
}

/// The map between its pixel centres, bilinear; none beside what is not valid or across a seam.
std::optional<Vec2> value_at(const FilmMap& map, const Vec2& at) {
    const double x = at.x - 0.5, y = at.y - 0.5;
    const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
    if (x0 < 0 || y0 < 0 || x0 + 1 >= map.width || y0 + 1 >= map.height) return std::nullopt;
    Vec2 sum(0);
    for (int k = 0; k < 4; ++k) {
        const auto p = static_cast<std::size_t>((y0 + k / 2) * map.width + x0 + k % 2);
        if (!map.valid[p]) return std::nullopt;
        const double w = (k % 2 ? x - x0 : 1 - x + x0) * (k / 2 ? y - y0 : 1 - y + y0);
        sum += w * Vec2(map.x[p], map.y[p]);
    }
    return sum;
}

std::string dome_json() {
    return R"({"version": 1, "film": {"width": 640, "height": 360},
  "cameras": [{"name": "projector", "type": "perspective", "yfov": 22,
               "lookAt": {"eye": [0, -0.3, 0.7], "at": [0, -0.15, -0.55], "up": [0, 1, 0]}}],
  "materials": [{"name": "chrome", "metallicFactor": 1, "roughnessFactor": 0}],
  "meshes": [{"name": "ball", "role": "optic", "material": "chrome", "resolution": 8,
              "primitive": {"type": "sphere", "center": [0, -0.3, -0.8], "radius": 0.3}}],
  "render": {"maxDepth": 0}})";
}

FilmMapRequest dome_request() {
    FilmMapRequest request;
    request.target = {TargetKind::kFisheye, 1024, 1024};
    request.proxy.kind = ProxyKind::kSphere;
    request.proxy.radius = 3;
    request.center = Vec3(0);
    return request;
}

}  // namespace

TEST_CASE("there and back through maps of both ways ends where it began", "[inverse][law]") {
    const auto world = ball_under_sky(320, 320, 4, 64);
    const FilmMap unwraps = make_film_map(*world, equirect_request(2048, MapWay::kUnwrap));
    const FilmMap views = make_film_map(*world, equirect_request(2048, MapWay::kView));
    CHECK(unwraps.width == 2048);
    CHECK(views.width == 320);
    std::vector<double> off;
    for (int y = 0; y < 320; ++y)
        for (int x = 0; x < 320; ++x) {
            const auto p = static_cast<std::size_t>(y * 320 + x);
            if (!views.valid[p]) continue;
            const auto back = value_at(unwraps, {views.x[p], views.y[p]});
            if (back) off.push_back(length(*back - Vec2(x + 0.5, y + 0.5)));
        }
    REQUIRE(off.size() > 50000);
    std::sort(off.begin(), off.end());
    CHECK(off[off.size() / 2] < 1e-3);
    CHECK(off[off.size() * 99 / 100] < 0.01);
    // The two derivatives are inverse to each other.
    int checked = 0;
    for (int y = 5; y < 315; y += 13)
        for (int x = 5; x < 315; x += 13) {
            const auto p = static_cast<std::size_t>(y * 320 + x);
            if (!views.valid[p] || views.x[p] < 2 || views.x[p] > 2045) continue;
            if (std::hypot(x - 160, y - 160) > 100) continue;  // pixels differ too much at the rim
            const auto q =
                static_cast<std::size_t>(static_cast<int>(views.y[p]) * 2048 + static_cast<int>(views.x[p]));
            if (!unwraps.valid[q]) continue;
            const auto matrix = [](const FilmMap& map, std::size_t at) {
                return Mat2(Vec2(map.jacobian[0][at], map.jacobian[2][at]),
                            Vec2(map.jacobian[1][at], map.jacobian[3][at]));
            };
            const Mat2 both = matrix(unwraps, q) * matrix(views, p);
            CHECK(std::fabs(both[0][0] - 1) + std::fabs(both[1][1] - 1) < 0.2);
            ++checked;
        }
    CHECK(checked > 100);
}

TEST_CASE("a warp mesh is exact at its nodes and of second order between them", "[inverse][law]") {
    const auto world = world_of(dome_json());
    const FilmMapRequest request = dome_request();
    const WarpMesh coarse = make_warp_mesh(*world, request, {65, 37, 1});
    const WarpMesh fine = make_warp_mesh(*world, request, {129, 73, 1});
    CHECK(coarse.error_mean / fine.error_mean > 3);
    CHECK(coarse.drawn_count() > 300);

    // Closed form: the ray of the film's node, mirrored by the ball, to the dome.
    int checked = 0;
    const Vec3 eye(0, -0.3, 0.7), ball(0, -0.3, -0.8), ahead = normalize(Vec3(0, -0.15, -0.55) - eye);
    const Vec3 right = normalize(cross(ahead, Vec3(0, 1, 0))), up = cross(right, ahead);
    const double half = std::tan(11 * 3.14159265358979323846 / 180);
    for (const WarpNode& node : coarse.nodes) {
        if (node.intensity <= 0) continue;
        const double x = (2 * node.film.x - 640) / 360 * half, y = (1 - 2 * node.film.y / 360) * half;
        const Vec3 d = normalize(ahead + x * right + y * up), from = eye - ball;
        const double b = dot(from, d), t = -b - std::sqrt(b * b - dot(from, from) + 0.09);
        const Vec3 n = (from + t * d) / 0.3, m = d - 2 * dot(d, n) * n, p = ball + 0.3 * n;
        const double c = dot(p, m), s = -c + std::sqrt(c * c - dot(p, p) + 9);
        const Vec3 q = normalize(p + s * m);
        const double angle = std::atan2(std::hypot(q.x, q.z), q.y), r = angle / 3.14159265358979323846 * 1024;
        const Vec2 expected = Vec2(512) + r / std::hypot(q.x, q.z) * Vec2(q.x, -q.z);
        CHECK(length(node.target - expected) < 1e-6);
        ++checked;
    }
    CHECK(checked > 300);
    WarpMeshParams chosen;
    chosen.max_error = 2;
    const WarpMesh mesh = make_warp_mesh(*world, request, chosen);
    CHECK(mesh.error_p99 <= 2);
    const std::string text = bourke_mesh(coarse);
    CHECK(text.rfind("2\n65 37\n", 0) == 0);
    CHECK(std::count(text.begin(), text.end(), '\n') == 2 + 65 * 37);
    CHECK(obj_mesh(coarse).find("\nf ") != std::string::npos);
}

TEST_CASE("maps are written as others read them", "[inverse]") {
    FilmMap map;
    map.width = 3, map.height = 2;
    map.source_width = 100, map.source_height = 50;
    map.x = {10.5f, 20, -1, 99.9f, 0.25f, 50};
    map.y = {0.5f, 49.5f, -1, 25, 10, 0.1f};
    map.valid = {1, 1, 0, 1, 1, 1};
    for (auto& values : map.jacobian) values.assign(6, 1);
    const Image stmap = stmap_of(map), up = stmap_of(map, true);
    CHECK(stmap.find("R")->floats()[1] == Approx(0.2));
    CHECK(stmap.find("G")->floats()[1] == Approx(0.99));
    CHECK(up.find("G")->floats()[1] == Approx(0.01));
    CHECK(stmap.find("R")->floats()[2] == -1);
    CHECK(stmap.find("A")->floats()[2] == 0);

    const auto pgm = pgm_of(map, MapAxis::kX);
    const std::string head = "P5\n3 2\n65535\n";
    REQUIRE(pgm.size() == head.size() + 12);
    CHECK(std::memcmp(pgm.data(), head.data(), head.size()) == 0);
    const auto value = [&](std::size_t i) {
        return pgm[head.size() + 2 * i] << 8 | pgm[head.size() + 2 * i + 1];
    };
    CHECK(value(0) == 10);
    CHECK(value(2) == 65535);
    CHECK(value(3) == 99);
    CHECK(pgm_name("a/b.c/map.pgm", MapAxis::kY) == "a/b.c/map_y.pgm");
    const auto npz = npz_of(map);
    CHECK(std::memcmp(npz.data(), "PK\3\4", 4) == 0);
}

TEST_CASE("maps that lead nowhere are refused", "[inverse][bad-input]") {
    const auto world = world_of(dome_json());
    FilmMapRequest plane = dome_request();
    plane.target = {TargetKind::kPlane, 10, 10};
    CHECK_THROWS_AS(make_warp_mesh(*world, plane, {}), UsageError);
    CHECK_THROWS_AS(make_warp_mesh(*world, dome_request(), {1, 1, 1}), UsageError);
    FilmMapRequest optic = dome_request();
    optic.optic = 4;
    CHECK_THROWS_AS(make_film_map(*world, optic), UsageError);
    for (const double tolerance : {0.0, -1.0, std::nan("")}) {
        FilmMapRequest coarse = dome_request();
        coarse.tolerance = tolerance;
        CHECK_THROWS_AS(make_film_map(*world, coarse), UsageError);
    }
    FilmMapRequest glass = dome_request();
    glass.way = MapWay::kView;
    glass.word = EventWord("TT");
    CHECK_THROWS_AS(make_film_map(*world, glass), InputError);
    FilmMapRequest square = dome_request();
    square.target.height = 20;
    CHECK_THROWS_AS(make_film_map(*world, square), UsageError);
}
