// What a closed surface hides of itself, against rays and against the search without it.
#include "specular/self_occlusion.h"

#include <algorithm>
#include <memory>
#include <vector>

#include "base/raymesh/face_neighbours.h"
#include "intersect/limit_tracer.h"
#include "laws/worlds.h"
#include "specular/specular_search.h"
#include "support/closed_forms.h"
#include "support/draw.h"
#include "support/test.h"
#include "surfaces/surfaces.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// A shipped scene's first optic, and its rays.
struct Body {
    std::unique_ptr<World> world;
    const Surface& surface;

    explicit Body(const std::string& scene)
        : world(shipped_world(scene, 4, 64, 64)), surface(*world->optics[0].surface) {}
    Occluder rays() const {
        return [this](const Ray& ray, double t_min) { return limit_tracer(*world, 0).first_hit(ray, t_min); };
    }
    bool hides(const Vec3& eye, const Vec3& place) const {
        return limit_tracer(*world, 0).meets({eye, place - eye}, 0, 1 - 1e-7);
    }
};

struct Looks {
    int hidden = 0, back = 0;  // of cells, and of those turned away whose normals turn by little
    int wrong = 0;             // places of hidden cells that are seen
};

/// Cells of all sizes, and places in each.
Looks look_around(const Body& body, const Vec3& eye, Draw& draw, int count) {
    const CellBvh cells(body.surface, body.rays());
    const SelfOcclusion occlusion(body.surface, cells);
    Looks looks;
    for (int k = 0; k < count; ++k) {
        const SurfaceCell* cell = &cells.faces()[static_cast<std::size_t>(
            draw.uniform(0, static_cast<double>(cells.faces().size())))];
        for (int depth = k % 12; depth > 0; --depth)
            cell = &(*cells.halves(*cell))[draw.uniform(0, 1) < 0.5 ? 0 : 1];
        const InSight sight = occlusion.look(eye, cell->box, cell->bounds);
        const SurfacePoint& middle = cell->bounds.middle;
        const bool is_back = dot(normalize(middle.position - eye), middle.normal) > 0.4;
        const bool is_small = cell->bounds.normal_radius < 0.1;
        looks.back += is_back && is_small;
        looks.hidden += is_back && is_small && sight == InSight::kHidden;
        if (sight != InSight::kHidden) continue;
        for (int place = 0; place < 20; ++place) {
            const Vec2 share(draw.uniform(0, 1), draw.uniform(0, 1));
            const Vec2 uv = cell->box.low + share * (cell->box.high - cell->box.low);
            looks.wrong += !body.hides(eye, body.surface.eval(cell->box.face, uv).position);
        }
    }
    return looks;
}

}  // namespace

TEST_CASE("places that a closed surface is said to hide are met by no ray from the eye first", "[law]") {
    Draw draw(311);
    for (const char* scene : {"sphere", "torus", "closed"}) {
        CAPTURE(scene);
        const Body body(scene);
        REQUIRE(is_closed(body.surface));
        for (int eyes = 0; eyes < 3; ++eyes) {
            const Looks looks = look_around(body, draw.away(4, 9), draw, 600);
            CAPTURE(looks.hidden, looks.back);
            CHECK(looks.wrong == 0);
            CHECK(looks.back > 50);
            CHECK(looks.hidden > 0.9 * looks.back);
        }
    }
}

TEST_CASE("surfaces with a border are not closed, and hide nothing", "[law]") {
    for (const char* scene : {"saddle", "flat"}) {
        const Body body(scene);
        CHECK_FALSE(is_closed(body.surface));
        CHECK_FALSE(CellBvh(body.surface, body.rays()).occluder());
    }
}

TEST_CASE("an eye within a closed surface sees its back", "[law]") {
    const Body body("sphere");
    const CellBvh cells(body.surface, body.rays());
    const SelfOcclusion occlusion(body.surface, cells);
    const Vec3 middle = body.surface.eval(0, Vec2(0.5)).position -
                        body.surface.eval(0, Vec2(0.5)).normal * 0.5 / body.surface.sphere_curvature();
    for (const SurfaceCell& face : cells.faces())
        CHECK(occlusion.look(middle, face.box, face.bounds) != InSight::kHidden);
}

TEST_CASE("what is hidden is all that a search leaves out where a closed surface hides parts of itself",
          "[law]") {
    Draw draw(312);
    for (const char* scene : {"sphere", "torus", "closed"}) {
        CAPTURE(scene);
        const Body body(scene);
        const SpecularSearcher all(body.surface), seen(body.surface, body.rays());
        SpecularQuery query;
        query.camera = camera_at(draw.away(4, 9), Vec3(0));
        std::vector<Vec3> points;
        for (int p = 0; p < 150; ++p) points.push_back(draw.away(2, 6));
        const auto of_all = all.find_each(query, points), of_seen = seen.find_each(query, points);
        int listed = 0, left_out = 0;
        for (std::size_t p = 0; p < points.size(); ++p) {
            CHECK((of_seen[p].complete || !of_all[p].complete));
            std::vector<SpecularPoint> shown = of_all[p].images, still = of_seen[p].images;
            const auto is_hidden = [&](const SpecularPoint& image) {
                return body.hides(query.camera.eye, image.position);
            };
            left_out += static_cast<int>(shown.size() - still.size());
            std::erase_if(shown, is_hidden);
            std::erase_if(still, is_hidden);
            listed += static_cast<int>(shown.size());
            CHECK(std::equal(shown.begin(), shown.end(), still.begin(), still.end(),
                             [](const SpecularPoint& a, const SpecularPoint& b) {
                                 return a.at.face == b.at.face && length(a.at.uv - b.at.uv) < 1e-12;
                             }));
        }
        CHECK(listed > 50);
        CHECK(left_out > 50);
    }
}
