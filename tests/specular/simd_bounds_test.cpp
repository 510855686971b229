// What is said about points side by side is what is said about each alone.
#include "specular/simd_bounds.h"

#include <algorithm>
#include <cmath>

#include "specular/cell_bvh.h"
#include "support/closed_forms.h"
#include "support/draw.h"
#include "support/test.h"
#include "support/test_surfaces.h"

using namespace trilens_test;

namespace {

/// By how much of the bound a decision may turn on the order in which numbers are added.
constexpr double kRounding = 1e-9;

/// Where light goes that comes along the unit vector `in`; straight on where it is reflected in total.
Vec3 goes_on(const SpecularQuery& query, const Vec3& in, const Vec3& normal) {
    const double cosine = dot(in, normal);
    if (query.event == SpecularEvent::kReflect) return in - 2 * cosine * normal;
    const Vec3 along = query.eye_index / query.point_index * (in - cosine * normal);
    const double rest = 1 - dot(along, along);
    return rest > 0 ? along + std::copysign(std::sqrt(rest), cosine) * normal : in;
}

struct LanesTally {
    int places = 0, empty = 0, leaving = 0, contracting = 0, open = 0, narrow = 0, different = 0,
        not_asked = 0;
};

bool has(LaneBits bits, std::size_t lane) {
    return bits >> lane & 1;
}

/// Whether both sides of the Newton operator's questions are told apart by more than rounding.
bool is_clear(const NewtonBounds& newton, const Vec2& half) {
    for (int axis = 0; axis < 2; ++axis) {
        const double step = std::fabs(newton.step[axis]), wide = newton.spread[axis], side = half[axis];
        for (const double gap :
             {step - (side + wide + newton.rounding[axis] + kCellBorder), wide - 0.5 * side, step - side})
            if (!(std::fabs(gap) > kRounding * (step + wide + side))) return false;
    }
    return true;
}

void compare_newton(const LaneQuestion& question, const CellTerms& terms, const Vec2& half,
                    LanesTally& tally) {
    const NewtonLanes lanes = newton_lanes(question, terms, half);
    tally.not_asked += ((lanes.leaves | lanes.contracts | lanes.open | lanes.narrow) & ~question.asked) != 0;
    for (std::size_t i = 0; i < kPointLanes; ++i) {
        if (!has(question.asked, i)) continue;
        const Vec3 point(question.points.x[i], question.points.y[i], question.points.z[i]);
        const NewtonBounds alone = newton_bounds(terms, point, half);
        const bool leaves = alone.known && leaves_cell(alone, half);
        const bool contracts = alone.known && !leaves && alone.spread.x <= 0.5 * half.x &&
                               alone.spread.y <= 0.5 * half.y && std::fabs(alone.step.x) <= half.x &&
                               std::fabs(alone.step.y) <= half.y;
        // What is open stays so however it rounds.
        const Vec2 share = alone.spread / half;
        tally.different +=
            has(lanes.open, i) && (!alone.known || leaves || std::max(share.x, share.y) <= kAloneShare);
        tally.open += has(lanes.open, i);
        tally.different += has(lanes.narrow, i) &&
                           (!alone.known || leaves || contracts || std::max(share.x, share.y) > kAloneShare);
        tally.narrow += has(lanes.narrow, i);
        if (alone.known && !is_clear(alone, half)) continue;
        tally.different += has(lanes.leaves, i) != leaves || has(lanes.contracts, i) != contracts;
        tally.leaving += leaves;
        tally.contracting += contracts;
    }
}

LanesTally compare(Draw& draw, const Surface& surface, SpecularQuery query, int rounds) {
    const auto bounder = surface.make_bounder();
    LanesTally tally;
    for (int round = 0; round < rounds; ++round) {
        CellBox box{
            static_cast<Id>(draw.uniform(0, 0.999) * static_cast<double>(surface.face_count())), {}, {}};
        const double size = draw.log_uniform(1e-3, 1);
        box.low = {draw.uniform(0, 1 - size), draw.uniform(0, 1 - size)};
        box.high = glm::min(box.low + size, Vec2(1));
        const SurfaceBounds bounds = bounder->bounds(box.face, box.low, box.high);
        const PlaceBounds place = place_of(bounds);
        const EyeView view = eye_view(query, place);

        PointLanes points;
        // Around a point that the eye sees in the cell's middle, or anywhere.
        const SurfacePoint& at = bounds.middle;
        const Vec3 in = normalize(incident_direction(query.camera, at.position));
        const double distance = draw.uniform(0.3, 4);
        const Vec3 seen = at.position + distance * goes_on(query, in, at.normal);
        const Vec3 middle = round % 3 == 0 ? seen : draw.away(0.5, 4);
        for (std::size_t i = 0; i < kPointLanes; ++i)
            points.set(i, middle + draw.in_cube(round % 2 ? 2 : size * distance));
        const LaneBits asked = static_cast<LaneBits>(draw.uniform(0, 1 << kPointLanes));
        const LaneQuestion question{query.event == SpecularEvent::kReflect, path_indices(query), points,
                                    asked};
        const LaneBits empty = empty_lanes(question, place, view);
        tally.not_asked += (empty & ~asked) != 0;
        for (std::size_t i = 0; i < kPointLanes; ++i) {
            if (!has(asked, i)) continue;
            query.point = {points.x[i], points.y[i], points.z[i]};
            const bool alone = test_place(query, place, view, 0).empty;
            tally.different += has(empty, i) != alone;
            tally.empty += alone;
            ++tally.places;
        }
        compare_newton(question, cell_terms(query, bounds, view), box.half(), tally);
    }
    return tally;
}

void check(const LanesTally& tally) {
    CHECK(tally.different == 0);
    CHECK(tally.not_asked == 0);
    CHECK(tally.empty > tally.places / 20);
    CHECK(tally.empty < tally.places);
    CHECK(tally.leaving > tally.places / 50);
    CHECK(tally.contracting > 0);
    CHECK(tally.open > tally.places / 50);
    CHECK(tally.narrow > 0);
}

}  // namespace

TEST_CASE("points side by side are excluded from the cells that exclude each alone", "[specular][law]") {
    Draw draw(85);
    SpecularQuery mirror;
    mirror.camera = camera_at({0.4, 2.5, 1.5}, Vec3(0));
    check(compare(draw, CubeSphere(Vec3(0), 1), mirror, 3000));
    check(compare(draw, Patch(Vec3(0), 1, 0.3), mirror, 3000));

    SpecularQuery glass = mirror;
    glass.event = SpecularEvent::kRefract;
    glass.point_index = 1.5;
    check(compare(draw, CubeSphere(Vec3(0), 1), glass, 3000));

    SpecularQuery oblique = mirror;
    oblique.camera.parallel = true;
    oblique.camera.view_direction = {0.3, -2, -1.1};
    oblique.camera.screen_w = {0, 0, 0, 1};
    check(compare(draw, CubeSphere(Vec3(0), 1), oblique, 3000));
}

TEST_CASE("a zero that is known to be alone on a part of a sphere is alone there", "[specular][many]") {
    Draw draw(86);
    int alone = 0, alone_and_there = 0, others = 0, at_front = 0;
    for (int round = 0; round < 20000; ++round) {
        const CubeSphere sphere(draw.in_cube(1), draw.log_uniform(0.3, 3));
        const bool inside = round % 4 == 0;
        const auto somewhere = [&] {
            return sphere.center + sphere.radius * (inside ? draw.away(0, 0.99) : draw.away(1.01, 5));
        };
        SpecularQuery query;
        query.camera = camera_at(somewhere(), sphere.center + draw.in_cube(0.3));
        query.point = somewhere();
        const std::vector<Vec3> zeros = alhazen(sphere, query.camera.eye, query.point);
        if (zeros.empty()) continue;

        CellBox box{static_cast<Id>(round % 6), {}, {}};
        const double size = draw.log_uniform(0.01, 0.3);
        box.low = {draw.uniform(0, 1 - size), draw.uniform(0, 1 - size)};
        box.high = box.low + size;
        const PlaceBounds place = place_of(sphere.make_bounder()->bounds(box.face, box.low, box.high));
        const EyeView view = eye_view(query, place);
        PointLanes points;
        for (std::size_t i = 0; i < kPointLanes; ++i) points.set(i, query.point);
        ZeroLanes known;
        known.known = (LaneBits{1} << zeros.size()) - 1;
        for (std::size_t i = 0; i < zeros.size(); ++i) {
            known.at.set(i, zeros[i]);
            known.along[i] =
                dot(specular_path(query, zeros[i]).bend, (zeros[i] - sphere.center) / sphere.radius);
        }
        const LaneBits said = alone_lanes({true, path_indices(query), points, 0xffff}, place, view, known,
                                          sphere.sphere_curvature());
        CHECK((said & ~known.known) == 0);
        const auto may_lie_there = [&](const Vec3& zero) {
            return length(zero - place.position) <= place.position_radius &&
                   length((zero - sphere.center) / sphere.radius - place.normal) <= place.normal_radius;
        };
        for (std::size_t i = 0; i < zeros.size(); ++i) {
            if (!has(said, i)) continue;
            ++alone;
            at_front += known.along[i] < 0;
            alone_and_there += may_lie_there(zeros[i]);
            for (std::size_t k = 0; k < zeros.size(); ++k) others += k != i && may_lie_there(zeros[k]);
        }
    }
    CHECK(others == 0);
    CHECK(alone_and_there > 50);
    CHECK(at_front > 1000);
    CHECK(alone - at_front > 1000);
}
