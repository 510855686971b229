// Which layer is seen: the nearest over the chain that covers a place; and what is seen in that one.
#include "paths/nested/nested_optics.h"

#include "paths/stage.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// A camera at `eye` that looks to -z; 400 pixels to a unit at distance 1, the axis at (300, 300).
PathCamera layers_camera_at(const Vec3& eye) {
    PathCamera camera;
    camera.film = {600, 600};
    camera.screen = [=](const Vec3& p) {
        const double w = eye.z - p.z;
        return Vec3(400 * (p.x - eye.x) + 300 * w, 400 * (eye.y - p.y) + 300 * w, w);
    };
    camera.point = [=](const Vec3& s) {
        return eye + Vec3((s.x - 300 * s.z) / 400, (300 * s.z - s.y) / 400, -s.z);
    };
    camera.ray = [=](const Vec3&, const Vec3& chord) { return Ray{eye, chord - eye}; };
    return camera;
}

/// A stage with the grids of its optics.
struct Layered {
    Stage stage;
    std::vector<SurfaceGrid> grids;
    NestedStage layers;

    void finish(const Vec3& eye, int n) {
        grids.reserve(stage.world.optics.size());
        layers.world = stage.world;
        for (Id i = 0; i < stage.world.optics.size(); ++i) {
            grids.push_back(make_grid(stage.surface(i), n));
            layers.optics.push_back({&stage.surface(i), &grids.back()});
        }
        layers.eye = eye;
        layers.camera = layers_camera_at(eye);
    }
    NestedOptics seen_in(Id mirror) const {
        std::vector<Vec3> towards;
        for (const Vec3& point : grids[mirror].points) towards.push_back(point - layers.eye);
        return NestedOptics(layers, {mirror}, towards);
    }
    /// The optics of the exact path of a pixel over the mirror alone, that one left out.
    std::optional<std::vector<Id>> exact(Id mirror, const Vec2& pixel) const {
        const Vec3 direction = normalize(layers.camera.point(Vec3(pixel, 1)) - layers.eye);
        const auto first = next_optic(stage.world, {{layers.eye, direction}});
        if (!first || first->meeting.optic != mirror) return std::nullopt;
        std::vector<Id> met;
        for (const PathSegment& segment :
             follow_paths(stage.world, {first->meeting, first->distance}).segments)
            if (segment.parent != kNone) met.push_back(segment.step.optic);
        return met;
    }
};

/// How many pixels show another optic next than the exact path meets, of those that show or meet any.
struct Shown {
    std::size_t any = 0, other = 0, deeper = 0, deeper_other = 0;
};
Shown compare(const Layered& layered, NestedOptics& seen, Id mirror, int step) {
    seen.build();
    for (const auto& layer : seen.all())
        if (layer->deeper()) layer->deeper()->build();
    Shown shown;
    for (int y = 0; y < 600; y += step)
        for (int x = 0; x < 600; x += step) {
            const Vec2 pixel(x + 0.5, y + 0.5);
            const auto exact = layered.exact(mirror, pixel);
            if (!exact) continue;
            const auto there = seen.at(pixel);
            const Id next = exact->empty() ? kNone : exact->front();
            const Id drawn = there ? seen.all()[there->optic]->optic() : kNone;
            shown.any += next != kNone || drawn != kNone;
            shown.other += next != drawn;
            if (next == kNone || next != drawn || !seen.all()[there->optic]->deeper()) continue;
            const NestedOptics& behind = *seen.all()[there->optic]->deeper();
            const auto then = behind.at(pixel);
            const Id after = exact->size() < 2 ? kNone : (*exact)[1];
            const Id drawn_after = then ? behind.all()[then->optic]->optic() : kNone;
            shown.deeper += after != kNone || drawn_after != kNone;
            shown.deeper_other += after != drawn_after;
        }
    return shown;
}

}  // namespace

TEST_CASE("of two balls behind one another a flat mirror shows the nearer, as exact paths do", "[paths]") {
    Layered layered;
    const Primitive plane{{0, 0, -4}, {0, 0, 1}, {1, 0, 0}, PlanePrimitive{{9, 9}}};
    layered.stage.add(make_primitive_surface(plane), mirror_of());
    layered.stage.add_ball({1.8, 0.3, -1.5}, 0.6, mirror_of());
    layered.stage.add_ball({2.2, 0.2, 0.4}, 0.7, mirror_of());
    layered.finish({-1.2, 0.1, 3}, 16);
    NestedOptics seen = layered.seen_in(0);
    const Shown shown = compare(layered, seen, 0, 2);
    REQUIRE(seen.all().size() == 2);
    CHECK(shown.any > 300);
    CHECK(shown.other * 100 <= shown.any * 2);  // outlines of chords

    // In places where both lie over one another the first ball is seen.
    std::size_t both = 0;
    for (int y = 0; y < 600; ++y)
        for (int x = 0; x < 600; ++x) {
            const Vec2 pixel(x + 0.5, y + 0.5);
            if (!seen.all()[0]->cover().at(pixel) || !seen.all()[1]->cover().at(pixel)) continue;
            ++both;
            CHECK(seen.at(pixel)->optic == 0);
        }
    CHECK(both > 20);
}

TEST_CASE("mirror balls show each other, and each other's images, where exact paths do", "[paths]") {
    double before = 1;
    for (const int n : {8, 16, 32}) {
        Layered layered;
        layered.stage.add_ball({-0.75, 0.1, 0}, 0.8, mirror_of());
        layered.stage.add_ball({1, -0.2, 0.3}, 0.65, mirror_of());
        layered.finish({0.35, 0.5, 3}, n);
        NestedOptics seen = layered.seen_in(1);
        const Shown shown = compare(layered, seen, 1, 1);
        REQUIRE(seen.all().size() == 1);
        CHECK(shown.any > 1500);
        const double wrong = static_cast<double>(shown.other) / static_cast<double>(shown.any);
        CHECK(wrong < before / 2);
        before = wrong;
        if (n > 16) continue;  // a grid of more points than pixels is no layer
        CHECK(shown.deeper > 20);
        CHECK(shown.deeper_other * 5 < shown.deeper);
    }
    CHECK(before < 0.005);
}

TEST_CASE("layers and exact paths agree but at outlines, and a way that no layer has is told",
          "[paths][oracle]") {
    Layered layered;
    layered.stage.add_ball({-0.75, 0.1, 0}, 0.8, mirror_of());
    layered.stage.add_ball({1, -0.2, 0.3}, 0.65, mirror_of());
    layered.finish({0.35, 0.5, 3}, 16);
    NestedOptics seen = layered.seen_in(1);
    CHECK(seen.agree({300, 300}, kNone));  // none is worked out yet
    seen.build();
    std::size_t inside = 0, outside = 0;
    for (int y = 0; y < 600; y += 3)
        for (int x = 0; x < 600; x += 3) {
            const Vec2 pixel(x + 0.5, y + 0.5);
            const auto exact = layered.exact(1, pixel);
            if (!exact) continue;
            const bool sees = !exact->empty();
            (sees ? inside : outside) += 1;
            CHECK(seen.agree(pixel, sees ? exact->front() : kNone));
            CHECK(!seen.agree(pixel, 1));  // itself
        }
    CHECK(inside > 100);
    CHECK(outside > 1000);
}

namespace {

/// A ball whose facets are wound the other way, with the ball's own normals: its volume is negative.
SurfaceGrid wound_back(SurfaceGrid grid) {
    for (std::size_t f = 0; f < grid.facets.size(); ++f) {
        std::swap(grid.facets[f][1], grid.facets[f][2]);
        std::swap(grid.facet_uv[f][1], grid.facet_uv[f][2]);
    }
    return grid;
}

}  // namespace

TEST_CASE("which side of a body is outside is its volume's sign; what bounds none has no outside",
          "[paths][law]") {
    Stage stage;
    stage.add_ball({2, 1, -3}, 0.5, mirror_of());
    const SurfaceGrid ball = make_grid(stage.surface(0), 8);
    CHECK(body_orientation(ball) == 1);
    CHECK(body_orientation(wound_back(ball)) == -1);
    SurfaceGrid open = ball;
    open.facets.pop_back();
    CHECK(body_orientation(open) == 0);
    SurfaceGrid turned = ball;
    std::swap(turned.facets[5][1], turned.facets[5][2]);
    CHECK(body_orientation(turned) == 0);
}

TEST_CASE("a body is seen in a mirror from outside, however its facets are wound, with no hole in its image",
          "[paths][law]") {
    std::array<std::size_t, 2> covered{};
    for (const bool back : {false, true}) {
        Layered layered;
        layered.stage.add_ball({-0.75, 0.1, 0}, 0.8, mirror_of());
        layered.stage.add_ball({1, -0.2, 0.3}, 0.65, mirror_of());
        layered.finish({0.35, 0.5, 3}, 16);
        if (back) layered.grids[0] = wound_back(layered.grids[0]);
        NestedOptics seen = layered.seen_in(1);
        const Shown shown = compare(layered, seen, 1, 2);
        REQUIRE(seen.all().size() == 1);
        CHECK(shown.any > 300);
        CHECK(shown.other * 50 <= shown.any);  // outlines of chords
        // What covers a place is the near side: from inside no ray comes to it.
        for (int y = 0; y < 600; y += 2)
            for (int x = 0; x < 600; x += 2) {
                const auto there = seen.at({x + 0.5, y + 0.5});
                if (!there) continue;
                ++covered[back];
                const NestedOptic& one = *seen.all()[there->optic];
                const IdTriple& corner = one.grid().facets[there->facet.facet];
                const auto ray =
                    chain_ray(mirror_chain(layered.layers, one.chain()),
                              layered.layers.camera.point(Vec3(x + 0.5, y + 0.5, 1)) - layered.layers.eye);
                REQUIRE(ray);
                Vec3 out(0);
                for (const Id c : corner) out += one.grid().corner_normal[c];
                CHECK(dot(ray->ray.direction, out) < 0.3 * length(out));
            }
    }
    CHECK(covered[0] > 300);
    CHECK(covered[0] == covered[1]);
}
