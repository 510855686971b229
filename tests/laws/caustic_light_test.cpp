// Light over optics: closed forms, energy, completeness against project, and a light tracer.
#include <algorithm>
#include <cmath>
#include <random>

#include "base/util/parallel.h"
#include "caustics/flux_ends.h"
#include "inverse/maps/caustic_map.h"
#include "render/project/project.h"
#include "render/shoot/shoot.h"
#include "render/world/world.h"
#include "shade/shade.h"
#include "study/scenes.h"
#include "support/lit_world.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

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

TEST_CASE("a wide mirror's light is that of the light's image, from end to end of every beam",
          "[laws][law][caustics]") {
    // Seen from the lamp the mirror is so wide that a beam's film is unlike over its part of the window.
    const LitWorld lit(lit_world(R"({"name": "mirror", "role": "optic", "material": "mirror", "resolution": 4,
        "points": [[-2,0.2,4],[-2,0.2,-4],[-2,3,-4],[-2,3,4]], "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3],
        "subdivisionScheme": "bilinear"})",
                                 kLamp));
    const auto expected_at = [](const Vec3& point) {
        const Vec3 way = Vec3(-4, 4, 3) - point;
        return 10 * way.y / std::pow(length(way), 3);
    };
    constexpr double kWide = 0.1;
    std::mt19937 random(11);
    std::uniform_real_distribution<double> place(-1, 1);
    double square = 0, square_at_points = 0;
    constexpr int kCount = 200;
    for (int i = 0; i < kCount; ++i) {
        Receiver there = on_floor(0.1 + 0.5 * place(random), -1 + 0.5 * place(random));
        CHECK(lit.light().exact_irradiance(there).y == Approx(expected_at(there.point)).epsilon(1e-7));
        const double off_at_point = lit.light().irradiance(there).y / expected_at(there.point) - 1;
        CHECK(std::fabs(off_at_point) < 0.008);
        square_at_points += off_at_point * off_at_point;
        there.sides = {Vec3(kWide, 0, 0), Vec3(0, 0, -kWide)};
        double expected = 0;  // over the footprint, by Simpson's rule
        for (const int u : {-1, 0, 1})
            for (const int v : {-1, 0, 1})
                expected += (u == 0 ? 4 : 1) * (v == 0 ? 4 : 1) / 36.0 *
                            expected_at(there.point + 0.5 * kWide * Vec3(u, 0, v));
        const double off = lit.light().irradiance(there).y / expected - 1;
        CAPTURE(there.point.x, there.point.z, expected);
        CHECK(std::fabs(off) < 0.008);
        square += off * off;
    }
    CAPTURE(std::sqrt(square / kCount), std::sqrt(square_at_points / kCount));
    CHECK(std::sqrt(square / kCount) < 0.0025);
    CHECK(std::sqrt(square_at_points / kCount) < 0.0025);
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
    const FluxEnds ends = lit.light().flux_ends(lit.world->objects);
    const double out = ends.on_objects.y + ends.away.y;
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

TEST_CASE("light through a flat slab has the density of Snell's law", "[laws][law][caustics]") {
    constexpr double kTop = 1.5, kBottom = 1, kLampHeight = 4, kIndex = 1.5;
    const LitWorld lit(
        lit_world(R"({"name": "slab", "role": "optic", "material": "glass", "resolution": 4,
        "subdivisionScheme": "bilinear",
        "points": [[-4,1,-4],[4,1,-4],[4,1,4],[-4,1,4],[-4,1.5,-4],[4,1.5,-4],[4,1.5,4],[-4,1.5,4]],
        "faceVertexCounts": [4,4,4,4,4,4],
        "faceVertexIndices": [0,1,2,3, 4,7,6,5, 0,4,5,1, 1,5,6,2, 2,6,7,3, 3,7,4,0]})",
                  R"({"type": "point", "position": [0, 4, 0], "intensity": 10, "caustics": true})"),
        {.first_cells = 12});
    std::size_t compared = 0;
    for (const double angle : {0.1, 0.2, 0.3, 0.45, 0.6}) {
        const double inner = std::asin(std::sin(angle) / kIndex), air = kLampHeight - (kTop - kBottom);
        const double radius = air * std::tan(angle) + (kTop - kBottom) * std::tan(inner);
        const double inner_by_angle = std::cos(angle) / (kIndex * std::cos(inner));
        const double radius_by_angle = air / std::pow(std::cos(angle), 2) +
                                       (kTop - kBottom) * inner_by_angle / std::pow(std::cos(inner), 2);
        for (const ExactArrival& arrival :
             lit.light().exact_arrivals(on_floor(radius * std::cos(1.0), radius * std::sin(1.0)))) {
            if (arrival.single.path.steps.size() != 2) continue;
            ++compared;
            CHECK(arrival.density == Approx(std::sin(angle) / (radius * radius_by_angle)).epsilon(1e-6));
        }
    }
    CHECK(compared == 5);
}

TEST_CASE("a mirror ball's light is at Alhazen's point", "[laws][law][caustics]") {
    // The lamp stands above the ball's middle, so that all is in one plane: the point of reflection at angle
    // a from the top has the normal between both ways.
    const LitWorld lit(lit_world(R"({"name": "ball", "role": "optic", "material": "mirror", "resolution": 8,
        "primitive": {"type": "sphere", "center": [0, 1, 0], "radius": 0.8}})",
                                 R"({"type": "point", "position": [0, 4, 0], "intensity": 10})"));
    const auto landing = [](double a) {
        const Vec2 at(0.8 * std::sin(a), 1 + 0.8 * std::cos(a)), normal(std::sin(a), std::cos(a));
        const Vec2 in = glm::normalize(at - Vec2(0, 4));
        const Vec2 out = in - 2 * glm::dot(in, normal) * normal;
        return at.x - at.y / out.y * out.x;
    };
    const auto angle_at_lamp = [](double a) { return std::atan2(0.8 * std::sin(a), 3 - 0.8 * std::cos(a)); };
    for (const double a : {1.0, 1.1, 1.2, 1.25}) {
        constexpr double kStep = 1e-5;
        const double radius = landing(a);
        if (!(radius > 0 && radius < 5.5)) continue;
        const double by_a = (landing(a + kStep) - landing(a - kStep)) / (2 * kStep),
                     lamp_by_a = (angle_at_lamp(a + kStep) - angle_at_lamp(a - kStep)) / (2 * kStep);
        const double expected = std::sin(angle_at_lamp(a)) * lamp_by_a / (radius * std::fabs(by_a));
        const auto arrivals =
            lit.light().exact_arrivals(on_floor(radius * std::cos(0.7), radius * std::sin(0.7)));
        CAPTURE(a, radius);
        REQUIRE(arrivals.size() == 1);
        CHECK(arrivals[0].density == Approx(expected).epsilon(1e-5));
        CHECK(length(arrivals[0].single.path.ray.origin - Vec3(0, 1, 0)) == Approx(0.8).epsilon(1e-9));
        CHECK(arrivals[0].single.path.ray.origin.y == Approx(1 + 0.8 * std::cos(a)).epsilon(1e-6));
    }
}

TEST_CASE("sphere lights and backgrounds send their light to optics", "[laws][law][caustics]") {
    const std::string ball = R"({"name": "ball", "role": "optic", "material": "mirror", "resolution": 8,
        "primitive": {"type": "sphere", "center": [0, 1, 0], "radius": 0.8}})";
    const auto arriving = [&](const std::string& light) {
        const LitWorld lit(lit_world(ball, light), {.first_cells = 12});
        Vec3 sum(0);
        for (const auto& one : lit.lights) sum += one->beams().flux_arriving();
        return sum.y;
    };
    constexpr double kPi = 3.14159265358979;
    const double sine2 = 0.8 * 0.8 / 18, solid_angle = 2 * kPi * (1 - std::sqrt(1 - sine2));
    CHECK(
        arriving(R"({"type": "sphere", "position": [0, 4, 3], "radius": 0.01, "intensity": 100, "samples": 48,
        "visible": false})") == Approx(100 * kPi * 1e-4 * solid_angle).epsilon(0.02));
    // A white sky lights a floor as Lambert has it, and its other half shines from below.
    Light sky;
    sky.intensity = 2;
    sky.kind = EnvironmentLight{.samples = 32};
    double from_above = 0, from_below = 0;
    Background white;
    white.color = Vec3(1);
    for (const BeamSource& source : beam_sources(sky, white, 1)) {
        CHECK(source.is_parallel);
        const double light = source.strength(source.direction).y * source.direction.y;
        (light < 0 ? from_above : from_below) += std::fabs(light);
    }
    CHECK(from_above == Approx(2 * kPi).epsilon(0.01));
    CHECK(from_below == Approx(2 * kPi).epsilon(0.01));
}

TEST_CASE("a traced picture's light is that of exact paths, found without its beams' pieces",
          "[laws][law][caustics]") {
    for (const bool is_glass : {true, false}) {
        const LitWorld lit(lit_world(std::string(R"({"name": "ball", "role": "optic", "material": ")") +
                                         (is_glass ? "glass" : "mirror") + R"(", "resolution": 8,
            "primitive": {"type": "sphere", "center": [0, 1, 0], "radius": 0.8}})",
                                     kLamp));
        std::mt19937 random(5);
        std::uniform_real_distribution<double> place(-3, 3);
        std::size_t lit_points = 0, near = 0;
        double worst_beams = 0;
        for (int i = 0; i < 600; ++i) {
            Receiver there = on_floor(place(random), place(random));
            const double truth = lit.light().exact_irradiance(there).y;
            if (truth < 0.01) continue;
            ++lit_points;
            there.sides = {Vec3(1e-3, 0, 0), Vec3(0, 0, 1e-3)};
            const double by_beams = lit.light().irradiance(there).y;
            there.exact = true;
            const double by_pieces = lit.light().irradiance(there).y;
            CAPTURE(is_glass, there.point.x, there.point.z, truth, by_beams, by_pieces);
            near += std::fabs(by_pieces - truth) < 5e-3 * truth;
            worst_beams = std::max(worst_beams, std::fabs(by_beams - truth) / truth);
        }
        CAPTURE(is_glass, lit_points, near, worst_beams);
        CHECK(lit_points > 40);
        CHECK(near + lit_points / 25 >= lit_points);  // a border of the light may run through a footprint
        CHECK(worst_beams > 5e-3);                    // two answers, not one
    }
}
