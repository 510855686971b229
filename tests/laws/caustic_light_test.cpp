// Light over optics: closed forms, energy, completeness against project, and a light tracer.
#include <algorithm>
#include <cmath>
#include <random>

#include "base/util/parallel.h"
#include "inverse/maps/caustic_map.h"
#include "render/project/project.h"
#include "render/shoot/shoot.h"
#include "render/world/caustic_lights.h"
#include "render/world/world.h"
#include "shade/shade.h"
#include "study/scenes.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr const char* kFloor =
    R"({"name": "floor", "role": "object", "material": "white", "points": [[-6,0,6],[6,0,6],[6,0,-6],[-6,0,-6]],
        "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3]})";

/// A scene with a floor at y = 0, one optic and one light; the camera stands where the light does.
std::unique_ptr<World> lit_world(const std::string& optic, const std::string& light,
                                 const Vec3& eye = {0, 4, 3}) {
    const std::string text =
        R"({"version": 1, "film": {"width": 64, "height": 64},
            "cameras": [{"yfov": 60, "lookAt": {"eye": [)" +
        std::to_string(eye.x) + "," + std::to_string(eye.y) + "," + std::to_string(eye.z) +
        R"(], "at": [0, 0.5, 0]}}],
            "materials": [{"name": "white"}, {"name": "mirror", "metallicFactor": 1}, {"name": "glass", "transmissionFactor": 1, "ior": 1.5}],
            "meshes": [)" +
        kFloor + ", " + optic + R"(], "lights": [)" + light + R"(], "render": {"maxDepth": 4}})";
    return make_world(parse_scene(text), ignore);
}

const std::string kLamp = R"({"type": "point", "position": [0, 4, 3], "intensity": 10, "caustics": true})";

Receiver on_floor(double x, double z) {
    const Vec3 up(0, 1, 0), point(x, 0, z);
    return {point, up, up, point + 1e-5 * up, {}};
}

struct LitWorld {
    std::unique_ptr<World> world;
    PathWorld optics;
    std::vector<std::unique_ptr<BeamLight>> lights;

    explicit LitWorld(std::unique_ptr<World> made, const BeamGridParams& params = {})
        : world(std::move(made)),
          optics(optics_for_lights(*world)),
          lights(make_beam_lights(*world, optics, 0, params)) {}
    const BeamLight& light() const { return *lights.front(); }
};

Vec3 total(const Beams& beams) {
    Vec3 sum(0);
    for (const Vec3& flux : beams.flux_by_history()) sum += flux;
    return sum;
}

}  // namespace

TEST_CASE("a flat mirror's light is that of the light's image behind it", "[laws][law][caustics]") {
    // The mirror stands in the plane z = -2 and faces +z; the lamp's image is at z = -7.
    const LitWorld lit(lit_world(R"({"name": "mirror", "role": "optic", "material": "mirror", "resolution": 4,
        "points": [[-2,0.2,-2],[2,0.2,-2],[2,3,-2],[-2,3,-2]], "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3],
        "subdivisionScheme": "bilinear"})",
                                 kLamp));
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(-1, 1);
    for (int i = 0; i < 100; ++i) {
        const Receiver there = on_floor(0.4 * place(random), -1 + 0.4 * place(random));
        const Vec3 way = Vec3(0, 4, -7) - there.point;
        const double expected = 10 * way.y / std::pow(length(way), 3);
        CAPTURE(there.point.x, there.point.z, expected);
        CHECK(lit.light().path_count(there) == 1);
        CHECK(lit.light().exact_irradiance(there).y == Approx(expected).epsilon(1e-7));
        CHECK(lit.light().irradiance(there).y == Approx(expected).epsilon(0.02));
    }
    // Beyond the light that the mirror sends there is none.
    CHECK(lit.light().irradiance(on_floor(0, -1.9)) == Vec3(0));
    CHECK(lit.light().irradiance(on_floor(4.5, 0)) == Vec3(0));
}

TEST_CASE("a mirror ball sends light by as many paths as project finds, with its derivative",
          "[laws][law][caustics]") {
    const LitWorld lit(lit_world(R"({"name": "ball", "role": "optic", "material": "mirror", "resolution": 8,
        "primitive": {"type": "sphere", "center": [0, 1, 0], "radius": 0.8}})",
                                 kLamp));
    std::mt19937 random(11);
    std::uniform_real_distribution<double> place(-5, 5);
    std::vector<Vec3> points;
    while (points.size() < 200) points.emplace_back(place(random), 0, place(random));
    ProjectRequest request;
    request.path = EventWord("R");
    request.derivatives = true;
    const std::vector<PointProjection> truth = project_points(*lit.world, request, points);
    std::size_t missed = 0, paths = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto arrivals = lit.light().exact_arrivals(on_floor(points[i].x, points[i].z));
        std::size_t visible = 0;
        for (const WorldImage& image : truth[i].images) visible += image.visible;
        paths += visible;
        missed += visible - std::min(visible, arrivals.size());
        CHECK(arrivals.size() <= visible);
    }
    CHECK(paths > 100);
    CHECK(missed <= paths / 50);
}

TEST_CASE("no light is lost on its way through a glass ball", "[laws][law][caustics]") {
    const LitWorld lit(lit_world(R"({"name": "ball", "role": "optic", "material": "glass", "resolution": 8,
        "primitive": {"type": "sphere", "center": [0, 1, 0], "radius": 0.8}})",
                                 kLamp));
    const Beams& beams = lit.light().beams();
    // The ball is a cone of the light's directions.
    const double sine2 = 0.8 * 0.8 / (3 * 3 + 3 * 3),
                 solid_angle = 2 * 3.14159265358979 * (1 - std::sqrt(1 - sine2));
    CHECK(beams.flux_arriving().y == Approx(10 * solid_angle).epsilon(1e-3));
    const double out = beams.flux_on_objects().y + beams.flux_away().y;
    CHECK(out == Approx(beams.flux_arriving().y).epsilon(0.01));  // paths below a 200th are not followed

    // A map has the same flux at any size: footprints share beams out.
    CausticMapRequest request;
    request.target.kind = TargetKind::kObject;
    request.target.object = 0;
    request.target.width = request.target.height = 40;
    const CausticMap coarse = make_caustic_map(*lit.world, request);
    request.target.width = request.target.height = 96;
    const CausticMap fine = make_caustic_map(*lit.world, request);
    CHECK(fine.flux_received.y == Approx(coarse.flux_received.y).epsilon(1e-9));
    CHECK(total(beams).y > fine.flux_received.y);
}

TEST_CASE("the light behind a glass ball is a light tracer's, within its noise", "[laws][law][caustics]") {
    const auto world = lit_world(R"({"name": "ball", "role": "optic", "material": "glass", "resolution": 8,
        "primitive": {"type": "sphere", "center": [0, 1, 0], "radius": 0.8}})",
                                 kLamp);
    // The words that carry all but a thousandth of the light.
    constexpr int kSide = 24;
    constexpr std::size_t kRays = 200'000;
    std::vector<double> traced(kSide * kSide), squares(kSide * kSide);
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit(0, 1);
    const Vec3 lamp(0, 4, 3), axis = normalize(Vec3(0, 1, 0) - lamp);
    const double cosine = std::sqrt(1 - 0.8 * 0.8 / 18.0), cone = 2 * 3.14159265358979 * (1 - cosine);
    const Vec3 u = normalize(cross(axis, Vec3(1, 0, 0))), v = cross(axis, u);
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < kRays; ++i) {
        const double c = 1 - unit(random) * (1 - cosine), s = std::sqrt(1 - c * c),
                     phi = 6.283185307179586 * unit(random);
        rays.push_back({lamp, c * axis + s * (std::cos(phi) * u + std::sin(phi) * v)});
    }
    const double size = 12.0 / kSide;
    for (const char* word : {"R", "TT", "TRT", "TRRT"}) {
        ShootRequest request;
        request.path = EventWord(word);
        for (const ShotRay& shot : shoot_rays(*world, request, rays).rays) {
            if (shot.state != ShotState::kSeen) continue;
            const int x = static_cast<int>((shot.position.x + 6) / size),
                      z = static_cast<int>((shot.position.z + 6) / size);
            if (x < 0 || z < 0 || x >= kSide || z >= kSide) continue;
            const double light = 10 * cone / kRays * shot.weight.y / (size * size);
            traced[static_cast<std::size_t>(z * kSide + x)] += light;
            squares[static_cast<std::size_t>(z * kSide + x)] += light * light;
        }
    }
    CausticMapRequest request;
    request.target.kind = TargetKind::kObject;
    request.target.object = 0;
    request.target.width = request.target.height = kSide;
    const CausticMap map = make_caustic_map(*world, request);
    const double most = *std::max_element(traced.begin(), traced.end());
    std::size_t compared = 0, beyond = 0;
    for (std::size_t i = 0; i < traced.size(); ++i) {
        const double noise = std::sqrt(squares[i]);
        // Beams' light may fall 1e-3 of the scene's size beside its place: a few thousandths of a
        // neighbour's.
        if (traced[i] < 20 * 10 * cone / kRays / (size * size)) continue;  // too few rays to know their noise
        ++compared;
        CAPTURE(i, traced[i], map.irradiance[i].y, noise);
        beyond += std::fabs(traced[i] - map.irradiance[i].y) > 4 * noise + 0.01 * traced[i] + 3e-3 * most;
    }
    CHECK(compared > 20);
    CHECK(beyond == 0);
}

TEST_CASE("the sun in a mirrored ring draws a nephroid, bright as one over the root of the distance",
          "[laws][law][caustics]") {
    // The sun comes along -x, a little from above; the ring's mirrored inside stands on the floor.
    const LitWorld lit(lit_world(
        R"({"name": "ring", "role": "optic", "material": "mirror", "resolution": 16,
        "primitive": {"type": "cylinder", "center": [0, 0.5, 0], "axis": [0, 1, 0], "radius": 1, "height": 1}})",
        R"({"type": "directional", "direction": [-0.8, -0.6, 0], "intensity": 1, "caustics": true})"));
    // On the axis the cusp lies half of the radius before the wall. A ray that meets the wall at angle a
    // touches the curve at (3 cos a - cos 3a, 3 sin a - sin 3a) / 4: Huygens, Traite de la lumiere, 1690.
    const double angle = 0.5;
    const Vec3 on_curve(-(3 * std::cos(angle) - std::cos(3 * angle)) / 4, 0,
                        (3 * std::sin(angle) - std::sin(3 * angle)) / 4);
    // Across the curve: its tangent turns twice as fast as the ray.
    const Vec3 tangent(-(-3 * std::sin(angle) + 3 * std::sin(3 * angle)), 0,
                       3 * std::cos(angle) - 3 * std::cos(3 * angle));
    const Vec3 across = normalize(Vec3(tangent.z, 0, -tangent.x));
    const double side =
        lit.light().exact_arrivals(on_floor((on_curve + 0.02 * across).x, (on_curve + 0.02 * across).z))
                    .size() >
                lit.light()
                    .exact_arrivals(on_floor((on_curve - 0.02 * across).x, (on_curve - 0.02 * across).z))
                    .size()
            ? 1
            : -1;
    const auto light_at = [&](double distance) {
        const Vec3 there = on_curve + side * distance * across;
        return lit.light().exact_irradiance(on_floor(there.x, there.z)).y;
    };
    const double near = light_at(0.0005), far = light_at(0.002), beyond = light_at(-0.002);
    CAPTURE(near, far, beyond);
    CHECK((near - beyond) / (far - beyond) == Approx(2).epsilon(0.05));
}

TEST_CASE("a caustic has the same bytes for any number of threads", "[laws][law][caustics]") {
    CausticMapRequest request;
    request.target.kind = TargetKind::kObject;
    request.target.object = 0;
    request.target.width = request.target.height = 48;
    std::vector<CausticMap> maps;
    for (const int threads : {1, 4}) {
        set_thread_count(threads);
        maps.push_back(make_caustic_map(
            *lit_world(R"({"name": "ball", "role": "optic", "material": "glass", "resolution": 8,
            "primitive": {"type": "sphere", "center": [0, 1, 0], "radius": 0.8}})",
                       kLamp),
            request));
    }
    set_thread_count(0);
    CHECK(maps[0].irradiance == maps[1].irradiance);
}

TEST_CASE("a moving lamp's light behind a lens neither flickers nor is lost", "[laws][law][caustics]") {
    // Light received over light sent, as the lamp moves by small steps.
    std::vector<double> shares;
    for (int step = 0; step < 5; ++step) {
        const std::string x = std::to_string(0.3 + 0.004 * step);
        const auto world =
            lit_world(R"({"name": "ball", "role": "optic", "material": "glass", "resolution": 8,
            "primitive": {"type": "sphere", "center": [0, 1, 0], "radius": 0.8}})",
                      R"({"type": "point", "position": [)" + x + R"(, 4, 3], "intensity": 10})");
        CausticMapRequest request;
        request.target.kind = TargetKind::kObject;
        request.target.object = 0;
        request.target.width = request.target.height = 16;
        const CausticMap map = make_caustic_map(*world, request);
        CHECK((map.flux_on_objects.y + map.flux_away.y) / map.flux_in.y == Approx(0.997).epsilon(3e-3));
        shares.push_back(map.flux_received.y / map.flux_in.y);
    }
    // What the floor gets changes evenly.
    for (std::size_t i = 2; i < shares.size(); ++i)
        CHECK(std::fabs(shares[i] - 2 * shares[i - 1] + shares[i - 2]) < 2e-3 * shares[i]);
}
