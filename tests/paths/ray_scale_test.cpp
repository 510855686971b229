// The ray scale at a probe: known wherever the surface has two directions, unknown where it has none.
#include <array>
#include <vector>

#include "paths/bodies.h"
#include "paths/probe/path_probe.h"
#include "paths/stage.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

TEST_CASE("a ray scale is known in every corner of a triangle; where a face is drawn to a point it is not",
          "[paths]") {
    const Vec3 apex(0, 1, 0), eye(0.3, 0.4, 5);
    PathCamera pinhole;
    pinhole.screen = [=](const Vec3& p) {
        const double w = eye.z - p.z;
        return Vec3(p.x - eye.x, eye.y - p.y, w);
    };
    pinhole.point = [=](const Vec3& s) { return eye + Vec3(s.x, -s.y, -s.z); };
    pinhole.ray = [=](const Vec3&, const Vec3& chord) { return Ray{eye, chord - eye}; };
    const std::array<Vec3, 4> base{Vec3(1, 0, 1), Vec3(1, 0, -1), Vec3(-1, 0, -1), Vec3(-1, 0, 1)};
    std::size_t first = 0;
    for (const bool drawn : {false, true}) {
        std::vector<std::array<Vec3, 4>> sides{{base[0], base[3], base[2], base[1]}};
        for (std::size_t k = 0; k < 4; ++k)
            sides.push_back({base[k], base[(k + 1) % 4], apex, drawn ? apex + Vec3(1e-300) : apex});
        Stage stage;
        stage.add_body(FlatBody(std::move(sides)), glass_of(1.5));
        const ProbeContext context{&stage.world, 0, &stage.surface(0), pinhole};
        std::vector<Vec2> corners{{0, 0}, {1, 0}, {0, 1}};
        if (drawn) corners = {{0.5, 1}};
        for (const Vec2& uv : corners) {
            const SurfacePoint at = stage.surface(0).eval(4, uv), side = stage.surface(0).eval(4, {0.3, 0.3});
            PathProbe probe = probe_point(context, {4, uv, at.position, side.normal}, {});
            REQUIRE(probe.state == ProbeState::kSeen);
            REQUIRE(!probe.segments.empty());
            set_ray_scale(context, probe);
            REQUIRE(probe.ray_scale.size() == probe.segments.size());
            INFO("at " << uv.x << ", " << uv.y);
            for (std::size_t s = 0; s < probe.segments.size(); ++s) {
                if (drawn) CHECK(probe.ray_scale[s] == 0);
                if (probe.segments[s].parent != kNone) continue;
                // A flat mirror's is 1; glass draws the bundle together.
                const bool is_mirrored = probe.segments[s].step.event == Event::kReflect;
                if (!drawn && is_mirrored) CHECK(probe.ray_scale[s] == Approx(1).margin(1e-3));
                if (!drawn && !is_mirrored) CHECK(probe.ray_scale[s] == Approx(1.4).margin(0.1));
                ++first;
            }
        }
    }
    CHECK(first == 8);  // reflected and refracted, at three corners and one point
}
