// The zeros that a sphere is said to have, against the solutions of Alhazen's problem.
#include "specular/sphere_images.h"

#include <algorithm>
#include <cmath>

#include "specular/specular_point.h"
#include "support/closed_forms.h"
#include "support/draw.h"
#include "support/test.h"
#include "support/test_surfaces.h"

using namespace trilens_test;

namespace {

struct SphereTally {
    int lit = 0, shaded = 0, silent = 0, wrong = 0, elsewhere = 0, inside = 0;
};

/// Whether there are two roots, seen from the sides that are said.
bool are_as_said(const CubeSphere& sphere, const SpecularQuery& query, const std::vector<Vec3>& zeros,
                 bool lit) {
    const auto outside = std::count_if(zeros.begin(), zeros.end(), [&](const Vec3& zero) {
        return dot(specular_path(query, zero).bend, zero - sphere.center) < 0;
    });
    return zeros.size() == 2 && outside == (lit ? 1 : 0);
}

bool is_near_any(const std::vector<Vec3>& zeros, const Vec3& place, double reach) {
    return std::any_of(zeros.begin(), zeros.end(),
                       [&](const Vec3& zero) { return length(zero - place) < reach; });
}

void compare(Draw& draw, double nearest, double furthest, SphereTally& tally) {
    const CubeSphere sphere(draw.in_cube(1), draw.log_uniform(0.3, 3));
    const auto somewhere = [&] {
        const Vec3 direction = draw.unit();
        return sphere.center + sphere.radius * draw.log_uniform(nearest, furthest) * direction;
    };
    SpecularQuery query;
    query.camera = camera_at(somewhere(), sphere.center + Vec3(0.1, 0, 0.2) * sphere.radius);
    PointLanes points;
    for (std::size_t i = 0; i < kPointLanes; ++i) points.set(i, somewhere());
    SphereZeros zeros;
    find_zeros({sphere.center, sphere.radius}, query.camera.eye, points, zeros);
    CHECK((zeros.lit & zeros.shaded) == 0);
    for (std::size_t i = 0; i < kPointLanes; ++i) {
        const bool lit = zeros.lit >> i & 1, shaded = zeros.shaded >> i & 1;
        query.point = points.at(i);
        tally.lit += lit;
        tally.shaded += shaded;
        tally.silent += !lit && !shaded;
        if (!lit && !shaded) continue;
        const std::vector<Vec3> roots = alhazen(sphere, query.camera.eye, query.point);
        tally.wrong += !are_as_said(sphere, query, roots, lit);
        for (const Vec3& said : {zeros.first.at(i), zeros.second.at(i)})
            tally.elsewhere +=
                !is_near_any(roots, sphere.center + sphere.radius * said, 1e-6 * sphere.radius);
        tally.inside += length(query.point - sphere.center) < sphere.radius;
    }
}

}  // namespace

TEST_CASE("the zeros that are said of a sphere are those of Alhazen's problem", "[specular][oracle]") {
    Draw draw(87);
    SphereTally near, wide, inside;
    for (int round = 0; round < 300; ++round) compare(draw, 1.001, 6, near);
    for (int round = 0; round < 300; ++round) compare(draw, 1.001, 60, wide);
    for (int round = 0; round < 100; ++round) compare(draw, 0.1, 1.2, inside);
    for (const SphereTally& tally : {near, wide, inside}) {
        CAPTURE(tally.lit, tally.shaded, tally.silent, tally.elsewhere);
        CHECK(tally.wrong == 0);
        CHECK(tally.elsewhere <= (tally.lit + tally.shaded) / 200);
        CHECK(tally.inside == 0);
    }
    CHECK(near.lit > 2000);
    CHECK(near.shaded > 500);
    CHECK(near.silent < 1500);
    CHECK(wide.shaded > 200);
}

TEST_CASE("what an eye outside sees in a sphere's front is what Alhazen's problem has there",
          "[specular][oracle]") {
    Draw draw(88);
    int one = 0, none = 0, silent = 0, wrong = 0, elsewhere = 0, far = 0;
    for (int round = 0; round < 400; ++round) {
        const CubeSphere sphere(draw.in_cube(1), draw.log_uniform(0.3, 3));
        const auto somewhere = [&](double nearest, double furthest) {
            const Vec3 direction = draw.unit();
            return sphere.center + sphere.radius * draw.log_uniform(nearest, furthest) * direction;
        };
        const Vec3 eye = somewhere(1.01, 20);
        // Half of the points lie where the way passes close by the sphere's edge; in every other round
        // half of either lie up to as far away as points at infinity do.
        const Vec3 out = normalize(eye - sphere.center);
        PointLanes points;
        for (std::size_t i = 0; i < kPointLanes; ++i) {
            const Vec3 aside = normalize(cross(out, draw.unit()));
            const double distance = length(eye - sphere.center) / sphere.radius;
            const double sine = (1 + draw.uniform(-0.02, 0.02)) / distance;
            const Vec3 along = sine * aside - std::sqrt(std::max(0.0, 1 - sine * sine)) * out;
            const bool is_far = round % 2 == 0 && i % 4 > 1;
            points.set(i, i % 2 == 0
                              ? (is_far ? somewhere(20, 1e6) : somewhere(0.3, 20))
                              : eye + sphere.radius * distance *
                                          (is_far ? draw.log_uniform(3, 1e5) : draw.uniform(0.5, 3)) * along);
        }
        FrontZeros zeros;
        find_front_zeros({sphere.center, sphere.radius}, eye, points, zeros);
        CHECK((zeros.one & zeros.none) == 0);
        for (std::size_t i = 0; i < kPointLanes; ++i) {
            const bool is_one = zeros.one >> i & 1, is_none = zeros.none >> i & 1;
            one += is_one;
            none += is_none;
            silent += !is_one && !is_none;
            if (!is_one && !is_none) continue;
            far += length(points.at(i) - sphere.center) > 1e3 * sphere.radius;
            std::vector<Vec3> front = alhazen(sphere, eye, points.at(i));
            std::erase_if(front, [&](const Vec3& root) {
                const Vec3 normal = root - sphere.center;
                return dot(eye - root, normal) <= 0 || dot(points.at(i) - root, normal) <= 0;
            });
            wrong += front.size() != (is_one ? 1 : 0);
            elsewhere += is_one && !is_near_any(front, sphere.center + sphere.radius * zeros.at.at(i),
                                                1e-6 * sphere.radius);
        }
    }
    CAPTURE(one, none, silent, elsewhere, far);
    CHECK(wrong == 0);
    CHECK(far > 800);
    CHECK(elsewhere <= one / 200);
    CHECK(one > 2000);
    CHECK(none > 1000);
    CHECK(silent < 500);
}

TEST_CASE("of a sphere nothing is said where the way to the point grazes it or ends on it", "[specular]") {
    const Vec3 eye(0, 0, 4);
    PointLanes points;
    const double edge = 1 / std::sqrt(1 - 1.0 / 16);  // where the ray that touches the sphere meets z = 0
    const std::array<Vec3, 7> silent = {
        Vec3(0, edge, 0), Vec3(0, edge * (1 + 1e-3), 0), Vec3(0, 0, -3),   eye,
        Vec3(0, 1, 0),    Vec3(0.2, 0.1, 0.3),           Vec3(0, 0, 1.001)};
    for (std::size_t i = 0; i < kPointLanes; ++i) points.set(i, silent[std::min<std::size_t>(i, 6)]);
    points.set(15, {0, std::nan(""), 1e300});
    SphereZeros zeros;
    find_zeros({Vec3(0), 1}, eye, points, zeros);
    CHECK(zeros.lit == 0);
    CHECK(zeros.shaded == 0);
}
