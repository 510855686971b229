// Chains of reflections and refractions: solutions obey the laws, and move as differences say.
#include "specular/path_chain.h"

#include <cmath>
#include <random>

#include "support/test.h"

using namespace trilens;

namespace {

/// z = a x^2 + b x y + c y^2 + d x^3 over the unit square of (u, v) = (x, y) + 1/2, placed in the world.
class Cubic final : public Surface {
  public:
    Cubic(const Vec3& middle, const Mat3& frame, const Vec4& bend)
        : middle_(middle), frame_(frame), bend_(bend) {}
    std::size_t face_count() const override { return 1; }
    FaceDomain domain(Id) const override { return FaceDomain::kSquare; }
    SurfacePoint eval(Id, const Vec2& uv) const override {
        const double x = uv.x - 0.5, y = uv.y - 0.5;
        SurfacePoint p;
        p.position =
            middle_ +
            frame_ * Vec3(x, y, bend_.x * x * x + bend_.y * x * y + bend_.z * y * y + bend_.w * x * x * x);
        p.du = frame_ * Vec3(1, 0, 2 * bend_.x * x + bend_.y * y + 3 * bend_.w * x * x);
        p.dv = frame_ * Vec3(0, 1, bend_.y * x + 2 * bend_.z * y);
        p.duu = frame_ * Vec3(0, 0, 2 * bend_.x + 6 * bend_.w * x);
        p.duv = frame_ * Vec3(0, 0, bend_.y);
        p.dvv = frame_ * Vec3(0, 0, 2 * bend_.z);
        p.normal = normalize(cross(p.du, p.dv));
        return p;
    }

  private:
    Vec3 middle_;
    Mat3 frame_;
    Vec4 bend_;
};

Mat3 frame_towards(const Vec3& z) {
    const Vec3 n = normalize(z), side = normalize(cross(Vec3(0.3, 0.9, 0.2), n));
    return Mat3(side, cross(n, side), n);
}

struct Example {
    std::vector<Cubic> surfaces;
    PathChain chain;
    std::vector<SurfaceParameter> start;
};

/// `count` surfaces in a row along z; `mirrors`: they reflect to and fro instead.
Example example_of(std::size_t count, bool mirrors, unsigned seed) {
    std::mt19937 random(seed);
    // To and fro between mirrors tilts add up.
    const double reach = mirrors ? 0.01 : 0.1;
    std::uniform_real_distribution<double> draw(-reach, reach);
    Example example;
    double index = 1;
    for (std::size_t i = 0; i < count; ++i) {
        const double z = mirrors ? (i % 2 == 0 ? 2 : -2) : static_cast<double>(i) + 1;
        const Vec3 out(draw(random), draw(random), mirrors && i % 2 == 0 ? -1 : 1);
        example.surfaces.emplace_back(Vec3(draw(random), draw(random), z), frame_towards(out),
                                      Vec4(draw(random), draw(random), draw(random), draw(random)));
    }
    for (std::size_t i = 0; i < count; ++i) {
        const double next = mirrors ? index : (i % 2 == 0 ? 1.5 : 1.1);
        example.chain.events.push_back({&example.surfaces[i], index, next, mirrors});
        index = next;
        example.start.push_back({0, Vec2(0.5)});
    }
    example.chain.eye.place = {draw(random), draw(random), mirrors ? 0.0 : -1.5};
    example.chain.point.place = {draw(random), draw(random), mirrors ? 0.4 : static_cast<double>(count) + 2};
    return example;
}

}  // namespace

TEST_CASE("chains of one to six surfaces obey the laws of reflection and refraction at each",
          "[specular][law]") {
    int solved = 0;
    for (const bool mirrors : {false, true})
        for (std::size_t count = 1; count <= 6; ++count)
            for (unsigned seed = 0; seed < 6; ++seed) {
                Example example = example_of(count, mirrors, 10 * static_cast<unsigned>(count) + seed);
                const auto shape = solve_chain(example.chain, example.start);
                if (!shape) continue;
                ++solved;
                CAPTURE(mirrors, count, seed);
                Vec3 from = example.chain.eye.place;
                for (std::size_t i = 0; i < count; ++i) {
                    const Vec3 at = shape->points[i].position, n = shape->points[i].normal;
                    const Vec3 to = i + 1 < count ? shape->points[i + 1].position : example.chain.point.place;
                    const Vec3 in = normalize(at - from), out = normalize(to - at);
                    const ChainEvent& event = example.chain.events[i];
                    // Snell: n1 sin = n2 sin in one plane; of mirrors both indices are one.
                    CHECK(length(event.index_before * cross(n, in) - event.index_after * cross(n, out)) <
                          1e-12);
                    CHECK((dot(in, n) * dot(out, n) < 0) == event.reflects);
                    from = at;
                }
            }
    CHECK(solved == 72);  // all
}

TEST_CASE("a chain moves with its point as its Hessian says", "[specular][law]") {
    for (const bool mirrors : {false, true})
        for (std::size_t count = 1; count <= 5; ++count) {
            Example example = example_of(count, mirrors, 70 + static_cast<unsigned>(count));
            const auto shape = solve_chain(example.chain, example.start);
            if (!shape) continue;
            CAPTURE(mirrors, count);
            const ChainHessian hessian(example.chain, chain_bend(example.chain, shape->points),
                                       shape->points);
            REQUIRE(hessian.is_regular());
            constexpr double kStep = 1e-5;
            const Vec3 by(0.3, -0.8, 0.5);
            std::vector<std::vector<Vec2>> law, place;
            for (const double sign : {1.0, -1.0}) {
                PathChain moved = example.chain;
                moved.point.place += sign * kStep * by;
                law.push_back(chain_law(chain_bend(moved, shape->points), shape->points));
                const auto there = solve_chain(moved, shape->at);
                REQUIRE(there);
                std::vector<Vec2> uv;
                for (const SurfaceParameter& at : there->at) uv.push_back(at.uv);
                place.push_back(uv);
            }
            std::vector<Vec2> right;
            for (std::size_t i = 0; i < count; ++i) right.push_back((law[1][i] - law[0][i]) / (2 * kStep));
            const std::vector<Vec2> expected = hessian.solve(right);
            for (std::size_t i = 0; i < count; ++i) {
                const Vec2 found = (place[0][i] - place[1][i]) / (2 * kStep);
                CHECK(length(found - expected[i]) < 1e-6 * (1 + length(expected[i])));
            }
        }
}
