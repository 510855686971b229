// Laws of the bounds over balls of points: no image that exists is ever excluded, no two are called one.
#include "specular/cell_bounds.h"

#include <cmath>
#include <optional>

#include "specular/branch_and_bound.h"
#include "specular/view_tree.h"
#include "support/closed_forms.h"
#include "support/draw.h"
#include "support/test.h"
#include "support/test_surfaces.h"

using namespace trilens_test;

namespace {

/// A point that the eye sees in place `at` of the surface, `distance` behind it: on the reflected ray, or on
/// the refracted one by Snell's law. None where the light is reflected in total.
std::optional<Vec3> point_seen_in(const SurfacePoint& at, const SpecularQuery& query, double distance) {
    const Vec3 in = normalize(incident_direction(query.camera, at.position));
    const double cosine = dot(in, at.normal);
    if (query.event == SpecularEvent::kReflect) return at.position + distance * (in - 2 * cosine * at.normal);
    const double ratio = query.eye_index / query.point_index;
    const Vec3 along = ratio * (in - cosine * at.normal);
    const double rest = 1 - dot(along, along);
    if (!(rest > 0)) return std::nullopt;
    return at.position + distance * (along + std::copysign(std::sqrt(rest), cosine) * at.normal);
}

CellBox random_box(Draw& draw, Id face) {
    CellBox box{face, {}, {}};
    for (int axis = 0; axis < 2; ++axis) {
        const double size = std::min(draw.log_uniform(1e-4, 2), 1.0);
        box.low[axis] = draw.uniform(0, 1 - size);
        box.high[axis] = std::min(box.low[axis] + size, 1.0);
    }
    return box;
}

/// A place in the box, on its border in one of four.
Vec2 place_in(Draw& draw, const CellBox& box) {
    Vec2 uv;
    for (int axis = 0; axis < 2; ++axis) {
        const double share = draw.uniform(-0.15, 1.15);
        uv[axis] = glm::mix(box.low[axis], box.high[axis], std::min(std::max(share, 0.0), 1.0));
    }
    return uv;
}

struct Count {
    int images = 0, excluded = 0, lost = 0, outside = 0, known = 0;
};

/// Cells, and balls of points one of which has its image in the cell.
Count exclude_images(Draw& draw, const Surface& surface, const SpecularQuery& from, int rounds) {
    const auto bounder = surface.make_bounder();
    Count count;
    for (int round = 0; round < rounds; ++round) {
        SpecularQuery query = from;
        const CellBox box = random_box(
            draw, static_cast<Id>(draw.uniform(0, 0.999) * static_cast<double>(surface.face_count())));
        const Vec2 uv = place_in(draw, box);
        const auto point = point_seen_in(surface.eval(box.face, uv), query, draw.log_uniform(1e-3, 20));
        if (!point || !(screen_from_world(query.camera, surface.eval(box.face, uv).position).z > 0)) continue;
        const double radius = round % 3 == 0 ? 0 : draw.log_uniform(1e-6, 3);
        query.point = *point + (round % 2 == 0 ? draw.away(0, radius) : radius * draw.unit());
        const double reach = std::max(radius, length(query.point - *point)) * (1 + 1e-15);

        const SurfaceBounds bounds = bounder->bounds(box.face, box.low, box.high);
        const PlaceBounds place = place_of(bounds);
        const EyeView view = eye_view(query, place);
        ++count.images;
        count.lost += test_place(query, place, view, reach).empty;
        const NewtonBounds newton =
            newton_bounds(cell_terms(query, bounds, view), query.point, box.half(), reach);
        count.known += newton.known;
        count.outside += newton.known && leaves_cell(newton, box.half());

        // The same cell and another point, whose image is elsewhere: most are excluded.
        query.point += draw.away(0, 3);
        count.excluded += test_place(query, place, view, reach).empty;
    }
    return count;
}

void check(const Count& count) {
    CHECK(count.images > 5000);
    CHECK(count.lost == 0);
    CHECK(count.outside == 0);
    CHECK(count.excluded > count.images / 20);
    CHECK(count.known > count.images / 20);
}

/// Pairs of images of one point in a room's mirror sphere, and cells that hold both.
void check_alone(std::uint64_t seed, int rounds) {
    Draw draw(seed);
    const CubeSphere sphere(Vec3(0), 1);
    const auto bounder = sphere.make_bounder();
    const SpecularSearcher searcher(sphere);
    SpecularQuery query;
    query.camera = camera_at({0.3, -0.2, 0.6}, {0.1, 0.1, -1});
    int pairs = 0, alone = 0, shrunk = 0;
    for (int round = 0; round < rounds; ++round) {
        query.point = draw.away(0.1, 0.95);
        const SpecularSearch search = searcher.find(query);
        for (std::size_t i = 0; i < search.images.size(); ++i) {
            const SurfaceParameter& a = search.images[i].at;
            for (std::size_t k = i + 1; k < search.images.size(); ++k) {
                const SurfaceParameter& b = search.images[k].at;
                if (a.face != b.face) continue;
                ++pairs;
                const SurfaceBounds bounds = bounder->bounds(a.face, min(a.uv, b.uv), max(a.uv, b.uv));
                const Vec2 half = 0.5 * (max(a.uv, b.uv) - min(a.uv, b.uv));
                const NewtonBounds newton = newton_bounds(
                    cell_terms(query, bounds, eye_view(query, place_of(bounds))), query.point, half);
                alone += newton.known && newton.spread.x < half.x && newton.spread.y < half.y;
            }
            const CellBox small{a.face, max(a.uv - 1e-3, Vec2(0)), min(a.uv + 1e-3, Vec2(1))};
            const SurfaceBounds bounds = bounder->bounds(a.face, small.low, small.high);
            const NewtonBounds newton = newton_bounds(
                cell_terms(query, bounds, eye_view(query, place_of(bounds))), query.point, small.half());
            shrunk += newton.known && newton.spread.x < small.half().x && newton.spread.y < small.half().y;
        }
    }
    CHECK(pairs > 100);
    CHECK(alone == 0);
    CHECK(shrunk > 1000);
}

}  // namespace

TEST_CASE("a ball of points is excluded from no cell in which one of them has its image", "[specular][law]") {
    Draw draw(71);
    SpecularQuery mirror;
    mirror.camera = camera_at({0.4, 2.5, 1.5}, Vec3(0));
    check(exclude_images(draw, CubeSphere(Vec3(0), 1), mirror, 20000));
    check(exclude_images(draw, Patch(Vec3(0), 1, 0.3), mirror, 20000));
    check(exclude_images(draw, Patch(Vec3(0), 1, 0), mirror, 20000));

    SpecularQuery glass = mirror;
    glass.event = SpecularEvent::kRefract;
    glass.point_index = 1.5;
    check(exclude_images(draw, CubeSphere(Vec3(0), 1), glass, 20000));

    // Parallel rays, of an oblique camera: their direction is no unit vector.
    SpecularQuery oblique = mirror;
    oblique.camera.parallel = true;
    oblique.camera.view_direction = {0.3, -2, -1.1};
    oblique.camera.screen_w = {0, 0, 0, 1};
    check(exclude_images(draw, CubeSphere(Vec3(0), 1), oblique, 20000));

    // From inside, where one sphere has several images of a point.
    SpecularQuery room = mirror;
    room.camera = camera_at({0.3, -0.2, 0.6}, {0.1, 0.1, -1});
    check(exclude_images(draw, CubeSphere(Vec3(0), 1), room, 20000));
}

TEST_CASE("a ball that may touch the piece, or holds the eye's place, excludes nothing", "[specular][law]") {
    SpecularQuery query;
    query.camera = camera_at({0, 0, 4}, Vec3(0));
    query.point = {0, 0, 1.5};
    const PlaceBounds place{{0, 0, 1}, 0.1, {0, 0, 1}, 0.1};
    CHECK(!test_place(query, place, eye_view(query, place), 0.45).empty);
    CHECK(!test_place(query, place, eye_view(query, place), HUGE_VAL).empty);
    const PlaceBounds around{{0, 0, 4}, 0.1, {0, 0, 1}, 0.1};
    CHECK(!eye_view(query, around).is_apart);
    CHECK(!test_place(query, around, eye_view(query, around), 0.1).empty);
}

TEST_CASE("where the Newton operator shrinks a cell there is one zero of the law at most",
          "[specular][oracle][law][many]") {
    check_alone(72, 4000);
}

TEST_CASE("where the Newton operator shrinks a cell there is one zero at most, at many points",
          "[.long][specular][oracle][law]") {
    check_alone(72, 20000);
}
