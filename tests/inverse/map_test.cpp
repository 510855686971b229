// Maps both ways: there and back, against each other, and as other programs read them.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <ctime>
#include <optional>
#include <random>
#include <sstream>

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

/// Where dome_json's projector puts what it draws at (x, y) of its film, y in -1..1, in a fisheye of 1024
/// pixels: its ray, mirrored by the ball, to the dome. None beside the ball.
std::optional<Vec2> dome_pixel(double x, double y, double half_yfov) {
    constexpr double kPi = 3.14159265358979323846;
    const Vec3 eye(0, -0.3, 0.7), ball(0, -0.3, -0.8), ahead = normalize(Vec3(0, -0.15, -0.55) - eye);
    const Vec3 right = normalize(cross(ahead, Vec3(0, 1, 0))), up = cross(right, ahead);
    const double half = std::tan(half_yfov * kPi / 180);
    const Vec3 d = normalize(ahead + half * (x * right + y * up)), from = eye - ball;
    const double b = dot(from, d), square = b * b - dot(from, from) + 0.09;
    if (square < 0) return std::nullopt;
    const Vec3 n = (from + (-b - std::sqrt(square)) * d) / 0.3, m = d - 2 * dot(d, n) * n, p = ball + 0.3 * n;
    const double c = dot(p, m), s = -c + std::sqrt(c * c - dot(p, p) + 9);
    const Vec3 q = normalize(p + s * m);
    const double r = std::atan2(std::hypot(q.x, q.z), q.y) / kPi * 1024;
    return Vec2(512) + r / std::hypot(q.x, q.z) * Vec2(q.x, -q.z);
}

/// Of cells in whose four corners something is drawn: how far their corners' mean is off the closed form in
/// their middle, target pixels. The median: cells at the ball's rim, few, are of order one half.
double median_error(const WarpMesh& mesh) {
    std::vector<double> errors;
    for (int y = 0; y + 1 < mesh.rows; ++y)
        for (int x = 0; x + 1 < mesh.columns; ++x) {
            Vec2 film(0), target(0);
            double least = 1;
            for (int k = 0; k < 4; ++k) {
                const WarpNode& node = mesh.at(x + k % 2, y + k / 2);
                film += node.film / 4.0, target += node.target / 4.0;
                least = std::min(least, node.intensity);
            }
            if (least <= 0) continue;
            const auto exact = dome_pixel((2 * film.x - 640) / 360, 1 - 2 * film.y / 360, 11);
            REQUIRE(exact.has_value());
            errors.push_back(length(*exact - target));
        }
    REQUIRE(errors.size() > 200);
    std::sort(errors.begin(), errors.end());
    return errors[errors.size() / 2];
}

struct DrawnNode {
    Vec2 film{0}, picture{0};  // x and y, u and v
    double i = 0;
};

/// Of a file in Bourke's format: 2, the counts, x y u v i.
std::vector<DrawnNode> read_mesh(const std::string& text, int columns, int rows) {
    std::istringstream file(text);
    int type = 0, wide = 0, high = 0;
    file >> type >> wide >> high;
    REQUIRE((type == 2 && wide == columns && high == rows));
    std::vector<DrawnNode> nodes(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    for (DrawnNode& n : nodes) file >> n.film.x >> n.film.y >> n.picture.x >> n.picture.y >> n.i;
    REQUIRE(file);
    return nodes;
}

/// How far from `film` (dome_pixel's x and y) lies what shows that pixel of the picture, in pixels of 360
/// rows: by the closed form and its differences. None beside the ball.
std::optional<double> film_error(const Vec2& film, const Vec2& pixel) {
    constexpr double kStep = 1e-7;
    const auto here = dome_pixel(film.x, film.y, 11), right = dome_pixel(film.x + kStep, film.y, 11),
               up = dome_pixel(film.x, film.y + kStep, 11);
    if (!here || !right || !up) return std::nullopt;
    const Mat2 jacobian((*right - *here) / kStep, (*up - *here) / kStep);
    return 180 * length(glm::inverse(jacobian) * (pixel - *here));
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
    const double ratio = median_error(coarse) / median_error(fine);
    INFO("halved cells are off by " << ratio << " times less in the median");
    CHECK(ratio > 3.5);
    CHECK(ratio < 4.5);
    CHECK(fine.error.value().mean < coarse.error.value().mean / 2);  // with the rim
    CHECK(coarse.drawn_count() > 300);

    int checked = 0;
    for (const WarpNode& node : coarse.nodes) {
        if (node.intensity <= 0) continue;
        const auto expected = dome_pixel((2 * node.film.x - 640) / 360, 1 - 2 * node.film.y / 360, 11);
        REQUIRE(expected.has_value());
        CHECK(length(node.target - *expected) < 1e-6);
        ++checked;
    }
    CHECK(checked > 300);
    WarpMeshParams chosen;
    chosen.max_error = 2;
    const WarpMesh mesh = make_warp_mesh(*world, request, chosen);
    CHECK(mesh.error.value().p99 <= 2);
    const std::string text = bourke_mesh(coarse);
    CHECK(text.rfind("2\n65 37\n", 0) == 0);
    CHECK(std::count(text.begin(), text.end(), '\n') == 2 + 65 * 37);
    CHECK(obj_mesh(coarse).find("\nf ") != std::string::npos);
}

TEST_CASE("a warp mesh stops when it is asked to, and says how far it is", "[inverse]") {
    const auto world = world_of(dome_json());
    std::atomic<bool> cancel = false;
    std::size_t stop_after = 3;
    std::vector<double> said;
    Progress progress;
    progress.cancel = &cancel;
    progress.report = [&](double done) {
        said.push_back(done);
        cancel = said.size() == stop_after;
    };
    const std::clock_t start = std::clock();
    CHECK_THROWS_AS(make_warp_mesh(*world, dome_request(), {2049, 2049, 1}, progress), Interrupted);
    CHECK(double(std::clock() - start) / CLOCKS_PER_SEC < 3);  // of 20 and more for the whole
    CHECK(said.size() == 3);

    cancel = false;
    stop_after = 0;
    for (const WarpMeshParams& params :
         {WarpMeshParams{129, 73, 1}, WarpMeshParams{129, 65, 1, WarpGrid::kTarget},
          WarpMeshParams{0, 0, 20}}) {
        said.clear();
        make_warp_mesh(*world, dome_request(), params, progress);
        REQUIRE(said.size() > 3);
        CHECK(std::is_sorted(said.begin(), said.end()));
        CHECK(said[1] < 0.9);
        CHECK(said.back() == 1);
    }
}

TEST_CASE("the first and the last ray of a warp mesh in rays and rings are one", "[inverse][law]") {
    const auto world = world_of(dome_json());
    WarpMeshParams params{65, 33, 1, WarpGrid::kTarget};
    FilmMapRequest panorama = dome_request();
    panorama.target = {TargetKind::kEquirect, 1024, 512};
    for (const FilmMapRequest& request : {dome_request(), panorama}) {
        const WarpMesh mesh = make_warp_mesh(*world, request, params);
        int faded = 0, drawn = 0;
        for (int y = 0; y < mesh.rows; ++y) {
            const WarpNode &first = mesh.at(0, y), &last = mesh.at(mesh.columns - 1, y);
            INFO("row " << y);
            CHECK(first.film == last.film);
            CHECK(first.intensity == last.intensity);
            if (first.intensity == 0) ++faded;
            if (first.intensity > 0) ++drawn;
            // The scene is its own mirror image: there the ray is in the middle of the film.
            if (first.intensity >= 0) CHECK(std::abs(first.film.x - 320) < 1e-6);
        }
        CHECK((faded > 0 || request.target.kind == TargetKind::kEquirect));  // which is seen all along there
        CHECK(drawn > 3);
    }
}

TEST_CASE("a mirror dome's warp mesh, read and drawn as others do, is within a hundredth of a pixel",
          "[inverse][law]") {
    const auto world = world_of(dome_json());
    WarpMeshParams params;
    params.max_error = 0.01;
    params.grid = WarpGrid::kTarget;
    const WarpMesh made = make_warp_mesh(*world, dome_request(), params);
    CHECK(made.error.value().p99 <= 0.01);
    CHECK(made.columns < kMostWarpColumns);
    const std::vector<DrawnNode> nodes = read_mesh(bourke_mesh(made), made.columns, made.rows);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> share(0, 1);
    std::vector<double> errors;
    int beside = 0, faded = 0;  // drawn, yet not on the ball; in cells that fade at its rim, or are not drawn
    for (int k = 0; k < 20000; ++k) {
        const double x = share(random) * (made.columns - 1), y = share(random) * (made.rows - 1);
        const int column = static_cast<int>(x), row = static_cast<int>(y);
        const double s = x - column, t = y - row;
        const auto at = [&](int i, int j) {
            return nodes[static_cast<std::size_t>(row + j) * static_cast<std::size_t>(made.columns) +
                         static_cast<std::size_t>(column + i)];
        };
        const DrawnNode a = at(0, 0), b = at(1, 0), c = at(0, 1), d = at(1, 1);
        if (std::min({a.i, b.i, c.i, d.i}) <= 0) {
            ++faded;
            continue;
        }
        const auto drawn = [&](Vec2 DrawnNode::*side) {
            const Vec2 &p = a.*side, &q = b.*side, &r = c.*side, &o = d.*side;
            return std::array<Vec2, 3>{
                (1 - s) * (1 - t) * p + s * (1 - t) * q + (1 - s) * t * r + s * t * o,  // bilinear
                s > t ? p + s * (q - p) + t * (o - q) : p + t * (r - p) + s * (o - r),
                s + t < 1 ? p + s * (q - p) + t * (r - p) : o + (1 - s) * (r - o) + (1 - t) * (q - o)};
        };
        const std::array<Vec2, 3> films = drawn(&DrawnNode::film), pictures = drawn(&DrawnNode::picture);
        for (std::size_t way = 0; way < 3; ++way)
            if (const auto off = film_error(films[way], Vec2(pictures[way].x, 1 - pictures[way].y) * 1024.0))
                errors.push_back(*off);
            else
                ++beside;
    }
    REQUIRE(errors.size() > 30000);
    std::sort(errors.begin(), errors.end());
    INFO(beside << " places beside the ball, " << faded << " of 20000 in cells at its rim; p99 "
                << errors[errors.size() * 99 / 100] << ", max " << errors.back() << " of " << made.columns
                << " x " << made.rows << " nodes, said " << made.error->p99 << ", " << made.error->max);
    CHECK(errors[errors.size() * 99 / 100] < 0.01);
    CHECK(beside == 0);
    CHECK(faded < 200);
    // At the very rim the closed form's derivative is infinite, and tells nothing of pixels.
    CHECK(errors[errors.size() * 999 / 1000] < made.error->max);
}

TEST_CASE("of a mesh without one whole cell no error is said, and no mesh that is chosen is one",
          "[inverse]") {
    std::string json = dome_json();
    json.replace(json.find("\"yfov\": 22"), 10, "\"yfov\": 150");
    const auto world = world_of(json);
    const WarpMesh coarse = make_warp_mesh(*world, dome_request(), {17, 9, 1});
    CHECK(coarse.drawn_count() > 0);
    CHECK_FALSE(coarse.error.has_value());
    WarpMeshParams chosen;
    chosen.max_error = 20;
    const WarpMesh fine = make_warp_mesh(*world, dome_request(), chosen);
    REQUIRE(fine.error.has_value());
    CHECK(fine.error->p99 <= 20);
    CHECK(fine.error->p99 > 0);
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
    WarpMeshParams regular;
    regular.grid = WarpGrid::kTarget;
    FilmMapRequest faces = dome_request();
    faces.target = {TargetKind::kCubemap, 384, 64};
    CHECK_THROWS_AS(make_warp_mesh(*world, faces, regular), UsageError);
    FilmMapRequest word = dome_request();
    word.word = EventWord("R");
    CHECK_THROWS_AS(make_warp_mesh(*world, word, regular), UsageError);
    FilmMapRequest path = dome_request();
    path.path = Path::kReflect;
    CHECK_THROWS_AS(make_warp_mesh(*world, path, {33, 19, 1}), UsageError);
    CHECK(make_warp_mesh(*world, path, {33, 9, 1, WarpGrid::kTarget}).drawn_count() > 50);
    for (const MapWay way : {MapWay::kUnwrap, MapWay::kView}) {
        FilmMapRequest other = way == MapWay::kView ? path : word;
        other.way = way;
        CHECK_THROWS_AS(make_film_map(*world, other), UsageError);
    }
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
