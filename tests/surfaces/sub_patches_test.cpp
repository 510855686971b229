// Sub-patches found by asking for the points at places, against a division that is known.
#include "surfaces/polynomial/sub_patches.h"

#include <cmath>
#include <random>
#include <vector>

#include "support/test.h"

using namespace trilens;

namespace {

constexpr int kDeepest = 6;

/// A face divided towards its corners (0, 0) and, for squares, (1, 1): a number per part.
int part_at(FaceDomain domain, Vec2 uv) {
    const bool is_square = domain == FaceDomain::kSquare;
    const bool is_far = is_square && uv.x + uv.y > 1;
    if (is_far) uv = Vec2(1) - uv;
    for (int level = 1; level <= kDeepest; ++level) {
        const double half = std::ldexp(1.0, -level);
        const bool right = is_far ? uv.x > half : uv.x >= half, upper = is_far ? uv.y > half : uv.y >= half;
        if (!is_square && !right && !upper && uv.x + uv.y >= half) return 10 * level + 3;
        if (right || upper) {
            // Of a square the quarters beside the diagonal are parts of either corner.
            const bool is_shared = is_square && level == 1;
            const int quarter = is_far && is_shared ? (right ? 2 : 1) : (right ? 1 : 0) + (upper ? 2 : 0);
            return 10 * level + quarter + (is_far && !is_shared ? 100 : 0);
        }
    }
    return is_far ? 201 : 200;
}

}  // namespace

TEST_CASE("The points at a place are those of the sub-patch that holds it", "[surfaces][law]") {
    for (const FaceDomain domain : {FaceDomain::kSquare, FaceDomain::kTriangle}) {
        int asked = 0;
        const SubPatches parts(domain, 10, [&](const Vec2& uv) {
            ++asked;
            return std::vector<int>{part_at(domain, uv), 1000};
        });
        CHECK(asked < 300);
        CHECK(parts.bytes() > 0);
        std::mt19937 engine(5);
        std::uniform_real_distribution<double> any(0, 1);
        for (int k = 0; k < 20000; ++k) {
            const double shrink = std::exp2(-10 * any(engine));
            Vec2 uv = shrink * Vec2(any(engine), any(engine));
            if (domain == FaceDomain::kTriangle && uv.x + uv.y > 1) uv = Vec2(1) - uv;
            if (domain == FaceDomain::kSquare && k % 2 == 1) uv = Vec2(1) - uv;
            CAPTURE(uv.x, uv.y);
            const auto points = parts.points_at(uv);
            REQUIRE(points.size() == 2);
            REQUIRE(points[0] == part_at(domain, uv));
        }
        CHECK(parts.points_at(Vec2(0))[0] == 200);
    }
}

TEST_CASE("Where a face is divided more finely than it was looked for there are no points",
          "[surfaces][bad-input]") {
    const SubPatches parts(FaceDomain::kSquare, 3,
                           [](const Vec2& uv) { return std::vector<int>{part_at(FaceDomain::kSquare, uv)}; });
    CHECK(parts.points_at(Vec2(0.01)).empty());
    CHECK(parts.points_at(Vec2(0.6, 0.2)).size() == 1);
}
