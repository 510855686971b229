// Laws of the search: its lists are the closed forms' lists, and where it cannot know it says so.
#include "specular/specular_search.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/util/parallel.h"
#include "camera/linear/linear_cameras.h"
#include "support/closed_forms.h"
#include "support/draw.h"
#include "support/test.h"
#include "support/test_surfaces.h"

using namespace trilens_test;

namespace {

SpecularSearch search_once(const Surface& surface, const SpecularQuery& query,
                           const SearchLimits& limits = {}) {
    return SpecularSearcher(surface).find(query, limits);
}

/// A place on the unit circle of the plane through the sphere's centre, the eye and the point.
struct Section {
    Vec3 axis, side;
    Vec3 at(double angle) const { return std::cos(angle) * axis + std::sin(angle) * side; }
};

/// Where a unit sphere around the origin refracts light from x to e, by Snell's law in the plane of symmetry:
/// sign changes over many angles, then bisection. Index 1 outside, `inside` inside, the eye on either side.
std::vector<Vec3> refraction_by_angles(const Vec3& e, const Vec3& x, double inside) {
    const Vec3 axis = normalize(e);
    const Section section{axis, normalize(x - dot(x, axis) * axis)};
    const auto sines = [&](double angle) {
        const Vec3 p = section.at(angle);
        const Vec3 from_eye = normalize(p - e), from_point = normalize(p - x);
        const bool front = dot(from_eye, p) < 0;
        const Vec3 along = section.at(angle + 1.5707963267948966);
        const double law =
            (front ? 1 : inside) * dot(from_eye, along) + (front ? inside : 1) * dot(from_point, along);
        return std::pair(law, dot(from_eye, p) * dot(from_point, p) < 0);
    };
    constexpr int kAngles = 20000;
    constexpr double kStep = 6.283185307179586 / kAngles;
    std::vector<Vec3> found;
    for (int k = 0; k < kAngles; ++k) {
        double low = k * kStep, high = low + kStep;
        const double first = sines(low).first;
        if ((first < 0) == (sines(high).first < 0)) continue;
        for (int step = 0; step < 60; ++step) {
            const double middle = 0.5 * (low + high);
            ((sines(middle).first < 0) == (first < 0) ? low : high) = middle;
        }
        // The law jumps where the viewed side changes.
        if (std::fabs(sines(low).first) < 1e-9 && sines(low).second) found.push_back(section.at(low));
    }
    return found;
}

struct SearchTally {
    int images = 0, missing = 0, extra = 0, incomplete = 0;

    void add(const SpecularSearch& search, const std::vector<Vec3>& expected, double size) {
        if (!search.complete) {
            ++incomplete;
            return;
        }
        images += static_cast<int>(expected.size());
        for (const Vec3& p : expected) {
            missing += std::none_of(search.images.begin(), search.images.end(), [&](const SpecularPoint& i) {
                return length(i.position - p) < 1e-6 * size;
            });
        }
        extra += static_cast<int>(search.images.size()) - static_cast<int>(expected.size());
    }
};

}  // namespace

TEST_CASE("the search lists exactly the solutions of Alhazen's problem", "[specular][oracle]") {
    Draw draw(31);
    SearchTally tally;
    std::array<int, 5> by_count{};
    for (int round = 0; round < 400; ++round) {
        const double size = draw.log_uniform(1e-4, 1e4);
        const CubeSphere sphere(size * draw.in_cube(1), size);
        const bool room = round % 2 == 0;
        const double nearest = room ? (round % 4 == 0 ? 0.7 : 0.05) : 1.02, farthest = room ? 0.98 : 20;
        const Vec3 eye = sphere.center + size * draw.away(nearest, farthest);
        SpecularQuery query;
        query.point = sphere.center + size * draw.away(nearest, farthest);
        const std::vector<Vec3> all = alhazen(sphere, eye, query.point);
        ++by_count[std::min<std::size_t>(all.size(), 4)];

        // Cameras back to back see everything around them.
        const Vec3 look = normalize(room ? draw.unit() : sphere.center - eye);
        for (const double sign : {1, -1}) {
            query.camera = camera_at(eye, eye + sign * size * look);
            std::vector<Vec3> expected;
            for (const Vec3& p : all)
                if (screen_from_world(query.camera, p).z > 0) expected.push_back(p);
            tally.add(search_once(sphere, query), expected, size);
        }
    }
    CHECK(tally.missing == 0);
    CHECK(tally.extra == 0);
    CHECK(tally.incomplete == 0);
    CHECK(tally.images > 500);
    CHECK(by_count[2] > 50);
    CHECK(by_count[3] + by_count[4] > 20);
}

TEST_CASE("the search lists exactly the refractions that a scan of all angles finds in a glass sphere",
          "[specular][oracle]") {
    Draw draw(32);
    const CubeSphere sphere(Vec3(0), 1);
    const SpecularSearcher searcher(sphere);
    SearchTally tally;
    int backs = 0, several = 0;
    for (int round = 0; round < 600; ++round) {
        const bool eye_inside = round % 3 == 0;
        const Vec3 eye = eye_inside ? draw.away(0.05, 0.97) : draw.away(1.03, 8);
        SpecularQuery query;
        query.point = round % 2 == 0 ? draw.away(0.6, 0.97) : draw.away(1.03, 8);
        query.event = SpecularEvent::kRefract;
        query.point_index = draw.uniform(1.1, 2.4);
        const std::vector<Vec3> all = refraction_by_angles(eye, query.point, query.point_index);
        several += all.size() > 1;
        const Vec3 look = eye_inside ? draw.unit() : -normalize(eye);
        for (const double sign : {1, -1}) {
            query.camera = camera_at(eye, eye + sign * look);
            std::vector<Vec3> expected;
            for (const Vec3& p : all)
                if (screen_from_world(query.camera, p).z > 0) expected.push_back(p);
            const SpecularSearch search = searcher.find_in_body(query);
            tally.add(search, expected, 1);
            for (const SpecularPoint& image : search.images) backs += !image.front;
        }
    }
    CHECK(tally.missing == 0);
    CHECK(tally.extra == 0);
    CHECK(tally.incomplete == 0);
    CHECK(tally.images > 200);
    CHECK(backs > 50);
    CHECK(several > 10);
}

TEST_CASE("the search finds the one image in a flat mirror and the one through flat water", "[specular]") {
    Draw draw(33);
    SearchTally mirror_tally, water_tally;
    for (int round = 0; round < 300; ++round) {
        const double size = draw.log_uniform(1e-4, 1e4);
        const Patch plane(size * draw.in_cube(1), size, 0);
        const Vec3 eye = plane.center + size * draw.above(2, 0.01, 5);
        const Vec3 x = plane.center + size * draw.above(2, 0.01, 5);
        SpecularQuery query;
        query.camera = camera_at(eye, plane.center);
        query.point = x;
        const double high = eye.z - plane.center.z, low = x.z - plane.center.z;
        const Vec3 hit = eye + (Vec3(x.x, x.y, plane.center.z - low) - eye) * (high / (high + low));
        std::vector<Vec3> expected;
        const Vec3 local = (hit - plane.center) / size;
        if (std::fmax(std::fabs(local.x), std::fabs(local.y)) < 1 &&
            screen_from_world(query.camera, hit).z > 0)
            expected.push_back(hit);
        mirror_tally.add(search_once(plane, query), expected, size);

        // Straight down, light is not bent: the image lies above the point, and there is one.
        query.event = SpecularEvent::kRefract;
        query.point_index = draw.uniform(1.1, 2);
        query.point = Vec3(eye.x, eye.y, plane.center.z - low);
        query.camera = camera_at(eye, plane.center);
        const Vec3 above(eye.x, eye.y, plane.center.z);
        const Vec3 inside = (above - plane.center) / size;
        expected.clear();
        if (std::fmax(std::fabs(inside.x), std::fabs(inside.y)) < 1 &&
            screen_from_world(query.camera, above).z > 0)
            expected.push_back(above);
        water_tally.add(search_once(plane, query), expected, size);
    }
    for (const SearchTally& tally : {mirror_tally, water_tally}) {
        CHECK(tally.missing == 0);
        CHECK(tally.extra == 0);
        CHECK(tally.incomplete == 0);
        CHECK(tally.images > 60);
    }
}

TEST_CASE("the search says that it cannot know: at a focus, on the surface, at an eye on the surface",
          "[specular]") {
    const double bend = 0.4;
    const Patch bowl(Vec3(0), 1, bend);
    SearchLimits limits;
    limits.most_cells = 20'000;
    SpecularQuery query;
    query.camera = make_orthographic({{{0, 0, 9}, {0, 0, 0}, {0, 1, 0}}, 4, 400, 400});
    query.point = Vec3(0, 0, 1 / (4 * bend));
    const SpecularSearch focus = search_once(bowl, query, limits);
    CHECK(!focus.complete);
    CHECK(focus.undecided > 100);
    CHECK(!focus.images.empty());

    query.camera = camera_at({0.3, 0.2, 3}, Vec3(0));
    query.point = Vec3(0.25, 0.5, bend * 0.3125);
    const SpecularSearch touching = search_once(bowl, query);
    CHECK(!touching.complete);
    CHECK(touching.cells < limits.most_cells);

    query.camera = camera_at({0.25, 0.5, bend * 0.3125}, Vec3(0, 0, 2));
    query.point = Vec3(0.1, 0.2, 2);
    CHECK(!search_once(bowl, query).complete);
}

TEST_CASE("near a caustic the search lists both images or says that it cannot know", "[specular]") {
    // Along the axis of a mirror sphere the images away from the axis meet those on it at the caustic's cusp.
    const CubeSphere sphere(Vec3(0), 1);
    const SpecularSearcher searcher(sphere);
    SpecularQuery query;
    const Vec3 eye(0.1, 0.2, 0.55);
    query.camera = camera_at(eye, {0.3, -0.1, -1});
    int complete = 0, kinds = 0;
    std::size_t last = 99;
    for (int k = 0; k <= 500; ++k) {
        query.point = Vec3(-0.7 + 0.0028 * k, 0.31, -0.2);
        const SpecularSearch search = searcher.find(query);
        std::size_t expected = 0;
        for (const Vec3& p : alhazen(sphere, eye, query.point))
            expected += screen_from_world(query.camera, p).z > 0;
        kinds += expected != last;
        last = expected;
        if (!search.complete) continue;
        ++complete;
        CHECK(search.images.size() == expected);
    }
    CHECK(complete > 480);
    CHECK(kinds > 1);
}

TEST_CASE("without bounds, or with borrowed normals, a list is never called complete", "[specular][law]") {
    struct NoBounds : CubeSphere {
        NoBounds() : CubeSphere(Vec3(0), 1) {}
        std::unique_ptr<const SurfaceBounder> make_bounder() const override { return nullptr; }
    };
    SpecularQuery query;
    query.camera = camera_at({0, 0.5, 4}, Vec3(0));
    query.point = Vec3(2, 1, 3);
    const SpecularSearch search = search_once(NoBounds(), query);
    CHECK(!search.complete);
    CHECK(search.images.size() == 2);
    query.own_normals = false;
    const SpecularSearch borrowed = search_once(CubeSphere(Vec3(0), 1), query);
    CHECK(!borrowed.complete);
    CHECK(borrowed.images.size() == 2);
    query.own_normals = true;
    const SpecularSearch known = search_once(CubeSphere(Vec3(0), 1), query);
    CHECK(known.complete);
    REQUIRE(known.images.size() == 2);
    CHECK(known.images[0].front);
    query.viewed = ViewedSide::kBack;
    const SpecularSearch back = search_once(CubeSphere(Vec3(0), 1), query);
    REQUIRE(back.images.size() == 1);
    CHECK(!back.images[0].front);
}

TEST_CASE("searches from many threads give the same lists", "[specular][law]") {
    Draw draw(35);
    const CubeSphere sphere(Vec3(0), 1);
    const SpecularSearcher searcher(sphere);
    std::vector<SpecularQuery> queries(200);
    for (SpecularQuery& query : queries) {
        query.camera = camera_at(draw.away(1.2, 6), Vec3(0));
        query.point = draw.away(1.1, 6);
    }
    std::vector<SpecularSearch> together(queries.size());
    parallel_for(queries.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) together[k] = searcher.find(queries[k]);
    });
    for (std::size_t k = 0; k < queries.size(); ++k) {
        const SpecularSearch alone = searcher.find(queries[k]);
        REQUIRE(alone.images.size() == together[k].images.size());
        CHECK(alone.cells == together[k].cells);
        for (std::size_t i = 0; i < alone.images.size(); ++i)
            CHECK(alone.images[i].pixel == together[k].images[i].pixel);
    }
}
