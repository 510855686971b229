// Many points at once have the lists that each has alone, to the last bit.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "base/math/box.h"
#include "specular/specular_search.h"
#include "support/closed_forms.h"
#include "support/draw.h"
#include "support/test.h"
#include "support/test_surfaces.h"

using namespace trilens_test;

namespace {

bool same_image(const SpecularPoint& a, const SpecularPoint& b) {
    return a.at.face == b.at.face && a.at.uv == b.at.uv && a.position == b.position && a.pixel == b.pixel &&
           a.distance == b.distance && a.t == b.t && a.front == b.front;
}

bool same_list(const SpecularSearch& a, const SpecularSearch& b) {
    return a.complete == b.complete &&
           std::equal(a.images.begin(), a.images.end(), b.images.begin(), b.images.end(), same_image);
}

struct BatchTally {
    int different = 0, images = 0, incomplete = 0;
    std::size_t cells_alone = 0, cells = 0;
};

BatchTally compare(const SpecularSearcher& searcher, const SpecularQuery& query,
                   const std::vector<Vec3>& points, bool body = false) {
    const auto found = body ? searcher.find_each_in_body(query, points) : searcher.find_each(query, points);
    BatchTally tally;
    SpecularQuery one = query;
    for (std::size_t p = 0; p < points.size(); ++p) {
        one.point = points[p];
        const SpecularSearch alone = body ? searcher.find_in_body(one) : searcher.find(one);
        tally.different += !same_list(alone, found[p]);
        tally.images += static_cast<int>(alone.images.size());
        tally.incomplete += !alone.complete;
        tally.cells_alone += alone.cells;
        tally.cells += found[p].cells;
    }
    return tally;
}

std::vector<Vec3> scattered(Draw& draw, int count, double low, double high) {
    std::vector<Vec3> points;
    for (int p = 0; p < count; ++p) points.push_back(draw.away(low, high));
    return points;
}

}  // namespace

TEST_CASE("many points in one search have each the list that it has alone", "[specular][oracle][many][thorough]") {
    Draw draw(81);
    const CubeSphere sphere(Vec3(0), 1);
    const SpecularSearcher searcher(sphere);
    SpecularQuery query;
    query.camera = camera_at({0.4, 2.5, 1.5}, Vec3(0));
    std::vector<Vec3> points = scattered(draw, 3000, 0.02, 4);

    const BatchTally mirror = compare(searcher, query, points);
    CHECK(mirror.different == 0);
    CHECK(mirror.images > 3000);

    query.event = SpecularEvent::kRefract;
    query.point_index = 1.5;
    const BatchTally glass = compare(searcher, query, points, true);
    CHECK(glass.different == 0);
    CHECK(glass.images > 500);

    query = {};
    query.camera = camera_at({0.3, -0.2, 0.6}, {0.1, 0.1, -1});
    const BatchTally room = compare(searcher, query, scattered(draw, 2000, 0, 0.99));
    CHECK(room.different == 0);
    CHECK(room.images > 2000);
}

TEST_CASE("points on caustics, on the surface and on one another have the lists that they have alone",
          "[specular][oracle][many]") {
    const CubeSphere sphere(Vec3(0), 1);
    const SpecularSearcher searcher(sphere);
    SpecularQuery query;
    query.camera = camera_at({0.1, 0.2, 0.55}, {0.3, -0.1, -1});
    std::vector<Vec3> across;
    for (int k = 0; k <= 300; ++k) across.push_back({-0.7 + 0.0046 * k, 0.31, -0.2});
    CHECK(compare(searcher, query, across).different == 0);

    // Symmetric places have their images on the borders of cells and faces.
    query.camera = camera_at({0, 0, 4}, Vec3(0));
    std::vector<Vec3> aligned;
    for (int x = -4; x <= 4; ++x)
        for (int y = -4; y <= 4; ++y)
            for (int z = -4; z <= 4; ++z) aligned.push_back(0.5 * Vec3(x, y, z));
    CHECK(compare(searcher, query, aligned).different == 0);

    const std::vector<Vec3> one(40, Vec3(1.5, 1, 2)), none;
    CHECK(compare(searcher, query, one).different == 0);
    CHECK(searcher.find_each(query, none).empty());

    // The focus of a bowl, from which every place is an image: undecided, and found so.
    const Patch bowl(Vec3(0), 1, 0.5);
    const SpecularSearcher in_bowl(bowl);
    query.camera = camera_at({0, 0, 0.5}, {0, 0.1, 0});
    Draw draw(82);
    std::vector<Vec3> around;
    for (int k = 0; k < 200; ++k) around.push_back(Vec3(0, 0, 1.5) + draw.in_cube(0.7));
    CHECK(compare(in_bowl, query, around).different == 0);
}

TEST_CASE("points side by side have most of the work in common", "[specular]") {
    Draw draw(84);
    const Patch bowl(Vec3(0), 1, 0.5);
    const SpecularSearcher searcher(bowl);
    SpecularQuery query;
    query.camera = camera_at({0.4, 0.3, 0.9}, {0, 0.1, 0});
    std::vector<Vec3> close;
    for (int p = 0; p < 300; ++p) close.push_back(Vec3(0.3, -0.2, 0.8) + draw.in_cube(0.05));
    const BatchTally together = compare(searcher, query, close);
    CHECK(together.different == 0);
    CHECK(together.images == 300);
    CHECK(together.cells_alone > 0);  // a sphere has no cells at all
    CHECK(together.cells < together.cells_alone / 2);
}

TEST_CASE("points that a sphere lights, shades or hides have the lists that they have alone",
          "[specular][oracle][many][thorough]") {
    Draw draw(88);
    const CubeSphere sphere({0.1, -0.2, 0.3}, 0.7);
    const SpecularSearcher searcher(sphere);
    for (int round = 0; round < 12; ++round) {
        SpecularQuery query;
        const double far = draw.log_uniform(0.71, 20);
        query.camera = camera_at(sphere.center + far * draw.unit(), sphere.center + Vec3(0.1, 0, 0.2));
        const Vec3 axis = normalize(sphere.center - query.camera.eye);
        std::vector<Vec3> points = scattered(draw, 60, 0.02, 3);
        // Close behind the sphere, around the cone that touches it, and along the axis.
        const double tangent = 0.7 / std::sqrt(far * far - 0.49);
        for (int p = 0; p < 180; ++p) {
            const Vec3 way = draw.unit(), across = normalize(way - dot(way, axis) * axis);
            const double depth = draw.log_uniform(0.8, 30);
            const double wide = draw.uniform(-0.1, 0.1);
            const double share = p % 3 == 0 ? 1 + wide : p % 3 == 1 ? 1 + 1e-3 * wide : wide;
            points.push_back(query.camera.eye + (far + depth) * (axis + share * tangent * across));
        }
        CHECK(compare(searcher, query, points).different == 0);
    }
}

TEST_CASE("the order of the points changes no list", "[specular][law]") {
    Draw draw(83);
    const CubeSphere sphere(Vec3(0), 1);
    const SpecularSearcher searcher(sphere);
    SpecularQuery query;
    query.camera = camera_at({0.4, 2.5, 1.5}, Vec3(0));
    const std::vector<Vec3> points = scattered(draw, 500, 0.02, 4);
    const std::vector<Vec3> reversed(points.rbegin(), points.rend());
    const auto there = searcher.find_each(query, points), back = searcher.find_each(query, reversed);
    for (std::size_t p = 0; p < points.size(); ++p) CHECK(same_list(there[p], back[points.size() - 1 - p]));
}

TEST_CASE("points are halved by their coordinates alone, and their ball holds them", "[specular]") {
    Draw draw(84);
    for (int round = 0; round < 300; ++round) {
        const int count = 2 + round % 40, kinds = 1 + round % 5;
        const double size = draw.log_uniform(1e-12, 1e12);
        const Vec3 at = draw.in_cube(size);
        std::vector<Vec3> points;
        for (int p = 0; p < count; ++p) {
            // Many equal coordinates, and equal points.
            const Vec3 v = draw.in_cube(static_cast<double>(kinds));
            points.push_back(at + size * Vec3(std::round(v.x), std::round(v.y), round % 2 ? 0 : v.z));
        }
        std::vector<std::size_t> some(points.size()), other(points.size());
        std::iota(some.begin(), some.end(), std::size_t{0});
        std::iota(other.rbegin(), other.rend(), std::size_t{0});
        const PointBall ball = ball_around(points, some);
        for (const Vec3& p : points) CHECK(length(p - ball.middle) <= ball.radius);

        const std::size_t half = spatial_split(points, some);
        CHECK(half == points.size() / 2);
        CHECK(spatial_split(points, other) == half);
        const std::size_t unit = 1 + static_cast<std::size_t>(round) % (points.size() - 1);
        std::vector<std::size_t> in_units(some);
        const std::size_t of_units = spatial_split(points, in_units, unit);
        CHECK(of_units % unit == 0);
        CHECK(of_units > 0);
        CHECK(of_units < points.size());
        CHECK((of_units == unit || of_units <= points.size() / 2));
        const auto sorted = [&](std::vector<std::size_t>& order) {
            std::vector<std::array<double, 3>> first;
            for (std::size_t k = 0; k < half; ++k) {
                const Vec3& p = points[order[k]];
                first.push_back({p.x, p.y, p.z});
            }
            std::sort(first.begin(), first.end());
            return first;
        };
        CHECK(sorted(some) == sorted(other));
    }
}
