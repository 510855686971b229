// Volumes directly, in mirrors and through glass: by projection against rays, against small steps along
// closed forms, and in a furnace.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/raymesh/rasterize.h"
#include "base/util/parallel.h"
#include "laws/worlds.h"
#include "render/engines/engine.h"
#include "render/picture/sample_colour.h"
#include "render/volumes/volume_rays.h"
#include "render/world/volume_geometry.h"
#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr int kVolumeWidth = 60, kVolumeHeight = 45;

/// A mirror ball, a glass ball, a floor, a wall that stands in the volume, and what `volumes` has.
std::string volume_room(const std::string& volumes, const std::string& more = "") {
    return R"({"version": 1, "film": {"width": 60, "height": 45},
        "cameras": [{"name": "main", "yfov": 45, "lookAt": {"eye": [0.1, 0.7, 5], "at": [0, 0, 0]}}],
        "background": {"color": [0.3, 0.4, 0.6]},
        "materials": [{"name": "chrome", "metallicFactor": 1, "roughnessFactor": 0},
                      {"name": "glass", "transmissionFactor": 1, "ior": 1.5},
                      {"name": "red", "baseColorFactor": [0.8, 0.1, 0.1], "unlit": true}],
        "meshes": [
            {"name": "mirror", "role": "optic", "material": "chrome", "resolution": 12,
             "primitive": {"type": "sphere", "center": [1.6, 0, -0.4], "radius": 0.9}},
            {"name": "lens", "role": "optic", "material": "glass", "resolution": 16,
             "primitive": {"type": "sphere", "center": [-0.9, -0.1, 1.9], "radius": 0.6}},
            {"name": "wall", "role": "object", "material": "red", "points": [[-0.4, -0.3, 0], [0.1, -0.3, 0], [0.1, 0.2, 0.2], [-0.4, 0.2, 0.2]],
             "faceVertexCounts": [4], "faceVertexIndices": [0, 1, 2, 3]},
            {"name": "floor", "role": "object", "material": "red", "points": [[-9, -1.2, 9], [9, -1.2, 9], [9, -1.2, -9], [-9, -1.2, -9]],
             "faceVertexCounts": [4], "faceVertexIndices": [0, 1, 2, 3]})" +
           more + R"(],
        "volumes": )" +
           volumes + "}";
}

/// A grid of n^3 points over a cube of that side, each scalar by `value`.
template <typename Value>
std::string cube_volume(int n, double side, const std::string& transfer, const Value& value) {
    std::string scalars;
    const double step = side / (n - 1);
    for (int z = 0; z < n; ++z)
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x)
                scalars += (scalars.empty() ? "" : ",") +
                           std::to_string(value(Vec3(x, y, z) * step - Vec3(0.5 * side)));
    const std::string size = std::to_string(n), at = std::to_string(-0.5 * side), s = std::to_string(step);
    return R"({"grid": {"size": [)" + size + "," + size + "," + size + R"(], "origin": [)" + at + "," + at +
           "," + at + R"(], "spacing": [)" + s + "," + s + "," + s + R"(], "scalars": [)" + scalars +
           R"(]}, "transferFunction": )" + transfer + "}";
}

constexpr const char* kTransfer =
    R"({"points": [{"value": 0, "color": [0.1, 0.4, 0.9], "extinction": 0.1},
                   {"value": 0.4, "color": [0.9, 0.8, 0.1], "extinction": 1.5},
                   {"value": 0.6, "color": [0.2, 0.2, 0.2], "extinction": 0},
                   {"value": 1, "color": [1, 0.1, 0.1], "extinction": 5}]})";

std::string random_cube(std::uint64_t seed) {
    Draw draw(seed);
    return cube_volume(7, 1.5, kTransfer, [&](const Vec3&) { return draw.uniform(0, 1); });
}

SampleViews views_of(const World& world, Engine engine, const SampleGrid& grid) {
    const auto viewer = make_viewer(world, {}, engine, [](const std::string&) {});
    SampleViews views;
    viewer->view(grid, views);
    return views;
}

const SampleGrid kFilm{0, 0, kVolumeWidth, kVolumeHeight, 1};

bool shows_same(const SampleViews& a, const SampleViews& b, std::size_t s) {
    const SampleView &x = a.samples[s], &y = b.samples[s];
    if (x.hit.triangle != y.hit.triangle || x.optic != y.optic || x.facet != y.facet) return false;
    const auto p = a.ends_of(x), q = b.ends_of(y);
    if (p.size() != q.size()) return false;
    for (std::size_t i = 0; i < p.size(); ++i)
        if (p[i].hit.triangle != q[i].hit.triangle) return false;
    return true;
}

double difference(const Vec3& a, const Vec3& b) {
    const Vec3 d = glm::abs(a - b);
    return std::max({d.x, d.y, d.z});
}

}  // namespace

TEST_CASE("volumes by projection are those that Embree finds along the same rays", "[volumes][law]") {
    const auto world = world_from("volumes", volume_room("[" + random_cube(1) + "]"), 14);
    const SampleViews projected = views_of(*world, Engine::kExact, kFilm),
                      traced = views_of(*world, Engine::kFacetsTruth, kFilm);
    std::size_t compared = 0, in_mirror = 0, in_glass = 0, dimmed = 0;
    double worst = 0;
    for (std::size_t s = 0; s < projected.samples.size(); ++s) {
        if (!shows_same(projected, traced, s)) continue;
        ++compared;
        const SampleVolumes &a = projected.volumes[s], &b = traced.volumes[s];
        worst = std::max({worst, std::fabs(a.first.transmittance - b.first.transmittance),
                          difference(a.first.emission, b.first.emission), difference(a.reflect, b.reflect),
                          difference(a.refract, b.refract)});
        const auto p = projected.ends_of(projected.samples[s]), q = traced.ends_of(traced.samples[s]);
        for (std::size_t i = 0; i < p.size(); ++i)
            worst = std::max(worst, difference(p[i].weight, q[i].weight));
        dimmed += a.first.transmittance < 0.9;
        in_mirror += a.reflect != Vec3(0) && !projected.samples[s].traced;
        in_glass += a.refract != Vec3(0) && !projected.samples[s].traced;
    }
    CHECK(worst < 1e-4);
    CHECK(compared > kFilm.size() * 97 / 100);
    CHECK(dimmed > 150);
    CHECK(in_mirror > 30);
    CHECK(in_glass >= 30);
    CAPTURE(worst, compared, dimmed, in_mirror, in_glass);
    CHECK(worst < 1e-8);  // the same integral of the same cells
}

TEST_CASE("cells by projection are cells by rays, in order, also where rays start inside", "[volumes][law]") {
    const std::string room = volume_room("[" + random_cube(2) + "]");
    for (const bool inside : {false, true}) {
        const char* const eye = inside ? "[0.03, 0.1, 0.2]" : "[0.1, 0.7, 5]";
        const auto world =
            world_from("cells", std::string(room).replace(room.find("[0.1, 0.7, 5]"), 13, eye), 14);
        const VolumeGeometry& volume = *world->volumes[0];
        const CameraRays camera = make_camera_rays(world->scene, 0);
        const FacetSamples owned = rasterize_facets(camera.mesh, kFilm);
        for (const double until : {std::numeric_limits<double>::infinity(), 4.6, 0.3}) {
            const std::vector<double> reach(kFilm.size(), until);
            std::vector<std::vector<CellStretch>> found(kFilm.size()), expected(kFilm.size());
            project_cells(volume, {camera.mesh, owned, kFilm, reach},
                          [&](Id s, const Ray& ray, const std::vector<CellStretch>& cells) {
                              found[s] = cells;
                              expected[s] = trace_cells(volume, ray, until);
                          });
            std::size_t cells = 0, differing = 0;
            for (std::size_t s = 0; s < found.size(); ++s) {
                bool same = found[s].size() == expected[s].size();
                for (std::size_t c = 0; same && c < found[s].size(); ++c) {
                    same = found[s][c].cell == expected[s][c].cell;
                    CHECK(found[s][c].t_in == Approx(expected[s][c].t_in).epsilon(1e-9).margin(1e-12));
                }
                cells += found[s].size();
                differing += !same;
            }
            CHECK(differing == 0);
            CHECK((cells > 1000) == (inside || until > 1));
        }
    }
}

TEST_CASE("rays that run along faces of cells see what rays beside them see", "[volumes][law]") {
    // A cube before a camera on its axis: rays of both diagonals of the film run in planes that cut its
    // boxes.
    const std::string transfer = R"({"map": "viridis", "extinction": 3})";
    const std::string cube =
        cube_volume(17, 2, transfer, [](const Vec3& p) { return std::max(0.0, 1 - length(p)); });
    std::string room = volume_room("[" + cube + "]");
    room.replace(room.find("[0.1, 0.7, 5]"), 13, "[0, 0, 4]");
    const auto world = world_from("along", room, 14);
    const VolumeGeometry& volume = *world->volumes[0];
    const CameraRays camera = make_camera_rays(world->scene, 0);
    for (const int side : {1, 2, 3}) {
        const SampleGrid film{0, 0, kVolumeWidth, kVolumeHeight, side};
        const FacetSamples owned = rasterize_facets(camera.mesh, film);
        const std::vector<double> until(film.size(), std::numeric_limits<double>::infinity());
        std::vector<double> lost(film.size(), 0.0);
        project_cells(volume, {camera.mesh, owned, film, until},
                      [&](Id s, const Ray& ray, const std::vector<CellStretch>& cells) {
                          const std::vector<CellStretch> traced = trace_cells(volume, ray, until[s]);
                          Ray beside = ray;
                          beside.direction += Vec3(3e-7, -1e-7, 0);
                          double projected_way = 0, traced_way = 0, beside_way = 0;
                          for (const CellStretch& one : cells) projected_way += one.t_out - one.t_in;
                          for (const CellStretch& one : traced) traced_way += one.t_out - one.t_in;
                          for (const CellStretch& one : trace_cells(volume, beside, until[s]))
                              beside_way += one.t_out - one.t_in;
                          lost[s] = std::max(std::fabs(projected_way - beside_way),
                                             std::fabs(traced_way - beside_way));
                      });
        CHECK(*std::max_element(lost.begin(), lost.end()) < 1e-4);
    }
}

TEST_CASE("a volume in the truth is what small steps along closed forms see, directly and in a ball",
          "[volumes][law]") {
    // A linear scalar is the same in every cell: the field is known without cells.
    const Vec3 slope(0.3, 0.5, -0.2);
    const auto scalar = [&](const Vec3& p) { return 0.5 + dot(slope, p); };
    const auto world =
        world_from("steps", volume_room("[" + cube_volume(3, 1.5, kTransfer, scalar) + "]"), 14);
    const TransferFunction& transfer = world->scene.volumes[0].transfer;
    const SampleViews views = views_of(*world, Engine::kLimitTruth, kFilm);
    const auto by_steps = [&](const Ray& ray, double until) {
        constexpr int kSteps = 20'000;
        constexpr double kFar = 12;
        const Vec3 direction = normalize(ray.direction);
        const double end = std::min(kFar, until * length(ray.direction)), step = end / kSteps;
        VolumeLight light;
        for (int i = 0; i < kSteps; ++i) {
            const Vec3 p = ray.origin + (i + 0.5) * step * direction;
            if (std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}) > 0.75) continue;
            const TransferPoint at = transfer.at(scalar(p));
            const double through = std::exp(-at.extinction * step);
            light.put_behind({(1 - through) * at.color, through});
        }
        return light;
    };
    std::size_t direct = 0, mirrored = 0;
    for (std::size_t s = 0; s < kFilm.size(); s += 3) {
        const SampleView& view = views.samples[s];
        const bool closed = view.hit.seen() || view.optic != kNone;
        const VolumeLight expected =
            by_steps(view.ray, closed ? view.depth : std::numeric_limits<double>::infinity());
        const VolumeLight& found = views.volumes[s].first;
        CHECK(std::fabs(found.transmittance - expected.transmittance) < 2e-3);  // a step is 6e-4 long
        CHECK(difference(found.emission, expected.emission) < 2e-3);
        direct += expected.transmittance < 0.99;
        if (view.optic != 0) continue;
        // Of the ball: one reflection, by the law itself.
        const Vec3 d = normalize(view.ray.direction), p = view.ray.origin + view.depth * view.ray.direction;
        const Vec3 n = normalize(p - Vec3(1.6, 0, -0.4));
        const std::span<const PathEnd> ends = views.ends_of(view);
        if (ends.size() != 1 || ends[0].step_count != 1) continue;
        const Ray mirror{p, d - 2 * dot(d, n) * n};
        const double until = ends[0].hit.seen() ? ends[0].hit.t * length(ends[0].ray.direction)
                                                : std::numeric_limits<double>::infinity();
        const VolumeLight behind = by_steps(mirror, until);
        CHECK(difference(views.volumes[s].reflect, behind.emission) < 2e-3);
        CHECK(std::fabs(ends[0].weight.x - behind.transmittance) < 2e-3);
        mirrored += behind.transmittance < 0.99;
    }
    CHECK(direct > 40);
    CHECK(mirrored > 10);
}

TEST_CASE("in a furnace a volume as bright as all else is not seen", "[volumes][law]") {
    const std::string transfer =
        R"({"points": [{"value": 0, "color": [1, 1, 1], "extinction": 0}, {"value": 1, "color": [1, 1, 1], "extinction": 9}]})";
    Draw draw(4);
    const std::string cube = cube_volume(5, 1.5, transfer, [&](const Vec3&) { return draw.uniform(0, 1); });
    std::string room = volume_room("[" + cube + "," + cube + "]");
    room.replace(room.find("[0.3, 0.4, 0.6]"), 15, "[1, 1, 1]");
    room.replace(room.find("[0.8, 0.1, 0.1]"), 15, "[1, 1, 1]");
    const auto world = world_from("furnace", room, 14);
    for (const Engine engine : {Engine::kExact, Engine::kLimitTruth}) {
        const SampleViews views = views_of(*world, engine, kFilm);
        for (std::size_t s = 0; s < kFilm.size(); ++s) {
            const SampleView& view = views.samples[s];
            const SampleColour colour = sample_colour(*world, views, view);
            const Vec3 light = colour.direct + colour.reflect + colour.refract;
            CHECK(light.x <= 1 + 1e-9);
            // Of glass, paths that are too faint or too deep are cut.
            const auto in_glass = [&](const PathEnd& end) {
                return end.step_count > 1 || !world->optics[view.optic].mirror;
            };
            const auto ends = views.ends_of(view);
            const bool loses = std::any_of(ends.begin(), ends.end(), in_glass);
            CHECK(light.x >= (loses ? 0.97 : 1 - 1e-9));
        }
    }
}

TEST_CASE("pictures of volumes are the same for any number of threads", "[volumes][law]") {
    const auto world = world_from("threads", volume_room("[" + random_cube(3) + "]"), 14);
    const auto colours = [&] {
        const SampleViews views = views_of(*world, Engine::kExact, kFilm);
        std::vector<SampleColour> all(kFilm.size());
        sample_colours(*world, views, 0, all);
        return all;
    };
    set_thread_count(1);
    const auto one = colours();
    set_thread_count(8);
    const auto eight = colours();
    set_thread_count(0);
    for (std::size_t s = 0; s < one.size(); ++s) {
        CHECK(one[s].direct == eight[s].direct);
        CHECK(one[s].reflect == eight[s].reflect);
        CHECK(one[s].refract == eight[s].refract);
    }
}

TEST_CASE("a changed scene keeps the volumes whose cells stay", "[volumes]") {
    const auto world = world_from("kept", volume_room("[" + random_cube(3) + "]"), 14);
    const auto* before = world->volumes[0].get();
    Scene scene = world->scene;
    scene.volumes[0].transfer.points[0].extinction = 7;
    change_scene(*world, scene, [](const std::string&) {});
    CHECK(world->volumes[0].get() == before);
    auto moved = std::make_shared<TetMesh>(*scene.volumes[0].cells);
    moved->points[0].x += 0.1;
    scene.volumes[0].cells = moved;
    change_scene(*world, scene, [](const std::string&) {});
    CHECK(world->volumes[0].get() != before);
}
