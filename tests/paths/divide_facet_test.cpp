// A facet's parts: which paths are followed while it is divided, held against all of them.
#include "paths/facets/divide_facet.h"

#include <algorithm>
#include <optional>

#include "intersect/random_scene.h"
#include "paths/probe/path_probe.h"
#include "paths/stage.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

PathCamera eye_at(const Vec3& eye) {
    PathCamera camera;
    camera.film = Vec2(10000);
    camera.screen = [=](const Vec3& p) {
        const double w = eye.z - p.z;
        return Vec3(400 * (p.x - eye.x) + 5000 * w, 400 * (eye.y - p.y) + 5000 * w, w);
    };
    camera.ray = [=](const Vec3&, const Vec3& chord) { return Ray{eye, chord - eye}; };
    return camera;
}

/// A ball of glass, with another one and a mirror behind it.
void put_up_stage(Stage& stage) {
    stage.add_ball({0, 0, 0}, 1, glass_of(1.5));
    stage.add_ball({0.9, 0.3, -2}, 0.8, glass_of(1.3));
    stage.add_ball({-1.2, -0.4, -2.5}, 0.9, mirror_of());
    stage.world.max_depth = 6;
}

void check_same(const std::vector<PathSegment>& a, const std::vector<PathSegment>& b) {
    REQUIRE(a.size() == b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        CHECK(a[i].parent == b[i].parent);
        CHECK(a[i].step == b[i].step);
        CHECK(a[i].ends == b[i].ends);
        CHECK(a[i].ray.origin == b[i].ray.origin);
        CHECK(a[i].ray.direction == b[i].ray.direction);
        CHECK(a[i].weight == b[i].weight);
    }
}

bool all_agree(const PathProbe& centre, const std::vector<PathProbe>& others) {
    if (centre.state != ProbeState::kSeen) return false;
    for (const PathProbe& probe : others) {
        if (probe.state != ProbeState::kSeen || probe.front != centre.front) return false;
        const auto match = matched(centre.segments, probe.segments);
        if (match.size() != centre.segments.size() || !covers(match, probe.segments)) return false;
    }
    return true;
}

/// What a part's corners, the middles of its edges and its centre see, all paths followed.
struct FullProbes {
    std::vector<PathProbe> corners, middles;
    PathProbe centre;
};
FullProbes full_probes(const ProbeContext& context, const FacetPart& part) {
    const auto between = [&](std::initializer_list<std::size_t> corners, double least_weight) {
        Chord chord{Vec3(0), Vec3(0), part.reach};
        const double share = 1.0 / static_cast<double>(corners.size());
        for (const std::size_t k : corners) {
            chord.screen += share * part.corners[k].probe->screen;
            chord.point += share * part.corners[k].chord;
        }
        return probe_chord(context, chord, {.side = part.side, .least_weight = least_weight});
    };
    const double fainter = kFainter * kLeastWeight;
    FullProbes full;
    for (const PartCorner& corner : part.corners) {
        PathProbe& probe = full.corners.emplace_back(*corner.probe);
        follow_all(context, probe, fainter);
    }
    full.middles = {between({1, 2}, fainter), between({2, 0}, fainter), between({0, 1}, fainter)};
    full.centre = between({0, 1, 2}, kLeastWeight);
    return full;
}

}  // namespace

TEST_CASE("a probe's principal paths are the same whether others are followed or not", "[paths]") {
    Stage stage;
    put_up_stage(stage);
    const ProbeContext context{&stage.world, 0, &stage.surface(0), eye_at({0.1, 0.2, 6})};
    Random random(71);
    std::size_t seen = 0, fainter = 0, refused = 0;
    std::optional<PathProbe> last;
    for (int i = 0; i < 400; ++i) {
        const Vec3 point(random.uniform(-1, 1), random.uniform(-1, 1), 0.2);
        const Chord chord{context.camera.screen(point), point, 1.5};
        const PathProbe all = probe_chord(context, chord, {.least_weight = kFainter * kLeastWeight});
        PathProbe one = probe_chord(context, chord, {.least_weight = kPrincipalOnly});
        REQUIRE(all.state == one.state);
        if (all.state != ProbeState::kSeen) continue;
        ++seen;
        CHECK(one.principal_only);
        CHECK(std::all_of(one.segments.begin(), one.segments.end(),
                          [](const PathSegment& s) { return s.principal; }));
        CHECK(same_principal(one.segments, all.segments));
        fainter += all.segments.size() > one.segments.size();
        if (last) {
            const auto match = matched(all.segments, last->segments);
            const bool agree = match.size() == all.segments.size() && covers(match, last->segments);
            const bool may = same_principal(all.segments, last->segments);
            CHECK((may || !agree));
            refused += !may;
        }
        follow_all(context, one, kFainter * kLeastWeight);
        CHECK(!one.principal_only);
        check_same(one.segments, all.segments);
        last = all;
    }
    CHECK(seen > 200);
    CHECK(fainter > 100);
    CHECK(refused > 50);
}

TEST_CASE("parts are projected where all paths agree, and traced only where they do not", "[paths][oracle]") {
    Stage stage;
    put_up_stage(stage);
    const ProbeContext context{&stage.world, 0, &stage.surface(0), eye_at({0.1, 0.2, 6})};
    const SurfaceGrid grid = make_grid(stage.surface(0), 4);
    DivideParams params;
    params.least_area = 8;
    params.most_levels = 5;
    std::size_t projected = 0, traced = 0, unproven = 0;
    for (const IdTriple& corners : grid.facets) {
        std::array<PathProbe, 3> probes;
        FacetToDivide facet;
        bool faces_eye = true;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 point = grid.points[grid.corner_point[corners[k]]];
            const Place place{0, Vec2(0), point, normalize(point)};
            probes[k] = probe_point(context, place, {.least_weight = kFainter * kLeastWeight});
            facet.corners[k] = {corners[k], &probes[k], point};
            faces_eye = faces_eye && probes[k].state == ProbeState::kSeen;
        }
        if (!faces_eye) continue;
        const DividedFacet divided = divide_facet(context, facet, params);
        for (const FacetPart& part : divided.parts) {
            const FullProbes full = full_probes(context, part);
            std::vector<PathProbe> others = full.corners;
            others.insert(others.end(), full.middles.begin(), full.middles.end());
            const bool agree = all_agree(full.centre, others);
            CHECK((agree || part.method == LeafMethod::kTraced));
            if (part.method == LeafMethod::kTraced) {
                ++traced;
                unproven += agree;
                continue;
            }
            ++projected;
            check_same(part.histories, full.centre.segments);
            for (std::size_t k = 0; k < 3; ++k) {
                check_same(part.corners[k].probe->segments, full.corners[k].segments);
                check_same(part.inside[k].at.probe->segments, full.middles[k].segments);
            }
        }
    }
    CHECK(projected > 100);
    CHECK(traced > 100);
    // Parts that agree where they were looked at and are not proven to agree between: near outlines, few.
    CHECK(unproven > 0);
    CHECK(unproven < traced / 2);
}
