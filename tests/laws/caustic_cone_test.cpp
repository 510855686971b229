// Light over optics that has an edge of its own: a spot's cone, against its closed form.
#include <algorithm>
#include <cmath>
#include <string>

#include "shade/shade.h"
#include "support/lit_world.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180;

}  // namespace

TEST_CASE("a spot's cone ends over a mirror where it does, with its inner edge and its outer one",
          "[laws][law][caustics]") {
    // Seen in the mirror in the plane z = -2 the spot stands at z = -7 and shines towards +z.
    const bool is_steep = GENERATE(false, true);
    const double inner = is_steep ? 9.5 : 5, outer = 10;
    CAPTURE(is_steep);
    const LitWorld lit(
        lit_world(R"({"name": "mirror", "role": "optic", "material": "mirror", "resolution": 4,
        "points": [[-2,0.2,-2],[2,0.2,-2],[2,3,-2],[-2,3,-2]], "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3],
        "subdivisionScheme": "bilinear"})",
                  R"({"type": "spot", "position": [0, 4, 3], "direction": [0, -2.4, -5], "intensity": 10,
        "caustics": true, "innerConeAngle": )" +
                      std::to_string(inner) + R"(, "outerConeAngle": )" + std::to_string(outer) + "}"));
    const Vec3 axis = normalize(Vec3(0, -2.4, 5));
    const auto expected_at = [&](const Vec3& point) {
        const Vec3 way = point - Vec3(0, 4, -7);
        const double far = length(way), least = std::cos(outer * kRadiansPerDegree),
                     most = std::cos(inner * kRadiansPerDegree),
                     share = std::clamp((dot(way, axis) / far - least) / (most - least), 0.0, 1.0);
        return 10 * share * share * -way.y / (far * far * far);
    };
    const double brightest = expected_at({0, 0, -7 + 5 * 4 / 2.4});
    double worst = 0;
    for (int i = 0; i <= 200; ++i) {
        const Receiver there = on_floor(-1.7 + 3.4 * i / 200, 1.3);
        const double off = lit.light().irradiance(there).y - expected_at(there.point);
        worst = std::max(worst, std::fabs(off) / brightest);
    }
    CHECK(worst < 0.02);
}
