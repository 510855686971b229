// What is proven to have one history has it: random rays between those that were looked at, followed exactly.
#include <cmath>

#include "intersect/random_scene.h"
#include "paths/facets/divide_facet.h"
#include "paths/probe/path_probe.h"
#include "paths/stage.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// A pinhole at `eye` that looks along -z, with 400 pixels per unit of z.
PathCamera pinhole(const Vec3& eye) {
    PathCamera camera;
    camera.film = Vec2(1e5);
    camera.screen = [=](const Vec3& p) {
        const double w = eye.z - p.z;
        return Vec3(400 * (p.x - eye.x) + 5000 * w, 400 * (eye.y - p.y) + 5000 * w, w);
    };
    camera.ray = [=](const Vec3&, const Vec3& chord) { return Ray{eye, chord - eye}; };
    return camera;
}

struct Counts {
    std::size_t rays = 0, other = 0, projected = 0, traced = 0;
};

PathProbe look_between(const ProbeContext& context, const FacetPart& part, const Vec3& weights) {
    Chord chord{Vec3(0), Vec3(0), part.reach};
    for (std::size_t k = 0; k < 3; ++k) {
        chord.screen += weights[static_cast<int>(k)] * part.corners[k].probe->screen;
        chord.point += weights[static_cast<int>(k)] * part.corners[k].chord;
    }
    return probe_chord(context, chord, {.side = part.side, .least_weight = kPrincipalOnly});
}

/// Divides the facets of optic 0 that face the eye, and follows random rays within those that are drawn
/// whole.
void hold(const Stage& stage, const Vec3& eye, int n, Random& random, Counts& counts) {
    const ProbeContext context{&stage.world, 0, &stage.surface(0), pinhole(eye)};
    const SurfaceGrid grid = make_grid(stage.surface(0), n);
    DivideParams params;
    params.least_area = 4;
    params.most_levels = 4;
    for (std::size_t f = 0; f < grid.facets.size(); ++f) {
        std::array<PathProbe, 3> probes;
        FacetToDivide facet;
        bool is_seen = true;
        for (std::size_t k = 0; k < 3; ++k) {
            const Id corner = grid.facets[f][k];
            const Vec3 point = grid.points[grid.corner_point[corner]];
            const Place place{grid.facet_face[f], grid.facet_uv[f][k], point, grid.corner_normal[corner]};
            probes[k] = probe_point(context, place, {.least_weight = kFainter * kLeastWeight});
            facet.corners[k] = {corner, &probes[k], point};
            is_seen = is_seen && probes[k].state == ProbeState::kSeen;
        }
        if (!is_seen) continue;
        const DividedFacet divided = divide_facet(context, facet, params);
        for (const FacetPart& part : divided.parts) {
            (part.method == LeafMethod::kProjected ? counts.projected : counts.traced) += 1;
            if (part.method != LeafMethod::kProjected || part.histories.empty()) continue;
            const PathProbe centre = look_between(context, part, Vec3(1.0 / 3));
            for (int i = 0; i < 6; ++i) {
                const double a = std::sqrt(random.uniform(0, 1)), b = random.uniform(0, 1);
                const PathProbe probe = look_between(context, part, {1 - a, a * (1 - b), a * b});
                ++counts.rays;
                counts.other += probe.state != ProbeState::kSeen || probe.front != centre.front ||
                                !same_principal(probe.segments, centre.segments);
            }
        }
    }
}

void check(const Counts& counts, double least_share) {
    INFO(counts.rays << " rays, " << counts.other << " with another history; " << counts.projected
                     << " parts projected, " << counts.traced << " traced");
    CHECK(counts.other == 0);
    CHECK(static_cast<double>(counts.projected) >
          least_share * static_cast<double>(counts.projected + counts.traced));
}

}  // namespace

TEST_CASE("One history is proven where nothing is near", "[paths][law]") {
    Random random(5);
    for (const bool is_glass : {false, true}) {
        Stage stage;
        stage.add_ball({0, 0, 0}, 1, is_glass ? glass_of(1.5) : mirror_of());
        Counts counts;
        hold(stage, {0.2, 0.1, 5}, 8, random, counts);
        check(counts, is_glass ? 0.5 : 0.9);
    }
}

TEST_CASE("What is proven holds beside small optics anywhere", "[paths][law]") {
    Random random(7);
    Counts counts;
    for (int scene = 0; scene < 24; ++scene) {
        Stage stage;
        stage.world.max_depth = 4;
        stage.add_ball({0, 0, 0}, 1, scene % 2 ? glass_of(1.5) : mirror_of());
        for (int i = 0; i < 3; ++i) {
            const double radius = random.log_uniform(0.01, 0.3);
            const Vec3 at = random.uniform(1.05 + radius, 3) * random.direction();
            stage.add_ball(at, radius, i % 2 ? glass_of(1.3) : mirror_of());
        }
        hold(stage, {0.2, 0.1, 5}, 3, random, counts);
    }
    check(counts, 0.2);
    CHECK(counts.rays > 5000);
}

TEST_CASE("What is proven holds where bodies of glass overlap, whichever has priority", "[paths][law]") {
    Random random(9);
    Counts counts;
    for (int scene = 0; scene < 24; ++scene) {
        Stage stage;
        stage.world.max_depth = 5;
        stage.add_ball({0, 0, 0}, 1, glass_of(1.5), scene % 3);
        const Vec3 towards = random.direction();
        const double radius = random.uniform(0.2, 0.9);
        stage.add_ball(random.uniform(0.3, 1 + radius) * towards, radius, glass_of(1.2), 1);
        if (scene % 4 == 0) stage.add_ball(-0.5 * towards, 0.2, mirror_of());
        hold(stage, {0.2, 0.1, 5}, 3, random, counts);
    }
    check(counts, 0.1);
    CHECK(counts.rays > 3000);
}

TEST_CASE("What is proven holds inside of a mirror, around other optics", "[paths][law]") {
    Random random(11);
    Counts counts;
    for (int scene = 0; scene < 12; ++scene) {
        Stage stage;
        stage.world.max_depth = 3;
        stage.add_ball({0, 0, 0}, 0.5, scene % 2 ? glass_of(1.5) : mirror_of());
        stage.add_ball({0, 0, 2}, 6, mirror_of());  // the room
        stage.add_ball(random.uniform(1.5, 3) * random.direction(), random.log_uniform(0.05, 0.4),
                       mirror_of());
        hold(stage, {0.2, 0.1, 4}, 3, random, counts);
    }
    check(counts, 0.05);
    CHECK(counts.rays > 500);
}
