// The beam test never turns away a point that the cubic images, and turns away most of the others.
#include "trilinear/points/point_images.h"

#include <cmath>

#include "random_facets.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

TrilinearFacet moved(const TrilinearFacet& facet, double scale, const Vec3& offset) {
    TrilinearFacet result = facet;
    for (Ray& ray : result.corner) ray.origin = offset + scale * ray.origin, ray.direction *= scale;
    return result;
}

/// A point of the beam: inside, on a border or in a corner; near, at the start, or far.
Vec3 beam_point(Random& random, const TrilinearFacet& facet) {
    Vec3 weights = random.weights();
    const int border = random.below(6);
    if (border < 3) weights[border] = 0;
    if (border == 2) weights[1] = 0;
    weights /= weights.x + weights.y + weights.z;
    const double t = random.below(5) == 0 ? 0 : random.log_uniform(1e-4, 1e4);
    Vec3 point(0);
    for (int k = 0; k < 3; ++k) {
        const Ray& ray = facet.corner[static_cast<std::size_t>(k)];
        point += weights[k] * (ray.origin + t * ray.direction);
    }
    return point;
}

}  // namespace

TEST_CASE("beam: what the cubic images is never turned away, for every kind of facet, size and place",
          "[trilinear][beam][law]") {
    Random random(7);
    int imaged = 0;
    for (int trial = 0; trial < 60000; ++trial) {
        const double scale = random.log_uniform(1e-4, 1e4);
        const Vec3 offset =
            random.below(2) ? Vec3(0) : scale * random.log_uniform(1, 1e4) * random.on_sphere();
        const auto kind = static_cast<FacetKind>(random.below(static_cast<int>(FacetKind::kCount)));
        const TrilinearFacet facet = moved(random_facet(random, kind), scale, offset);
        const Coplanarity coplanarity = make_coplanarity(facet);
        const FacetBeam beam = make_facet_beam(coplanarity);
        for (const Vec3& point : {beam_point(random, facet), offset + scale * random.in_box(4)}) {
            if (point_images(coplanarity, point).count == 0) continue;
            ++imaged;
            CAPTURE(trial, static_cast<int>(kind), scale);
            if (!may_hold(coplanarity, beam, point)) FAIL("turned away");
        }
    }
    CHECK(imaged > 50000);
}

TEST_CASE("beam: of a fine mirror's points without an image nine in ten are turned away",
          "[trilinear][beam]") {
    Random random(8);
    int none = 0, turned_away = 0;
    for (int trial = 0; trial < 2000; ++trial) {
        // A small piece of a facet: corners drawn towards its first.
        TrilinearFacet facet = random_facet(random, FacetKind::kMirror);
        for (const std::size_t k : {std::size_t{1}, std::size_t{2}}) {
            facet.corner[k].origin = glm::mix(facet.corner[0].origin, facet.corner[k].origin, 0.05);
            facet.corner[k].direction = glm::mix(facet.corner[0].direction, facet.corner[k].direction, 0.05);
        }
        const Coplanarity coplanarity = make_coplanarity(facet);
        const FacetBeam beam = make_facet_beam(coplanarity);
        for (int i = 0; i < 20; ++i) {
            // Near the beam, where the tree over facets leaves doubt.
            const Ray& ray = facet.corner[0];
            const Vec3 point = ray.origin + random.uniform(0.2, 4) * ray.direction + 0.5 * random.in_box(1);
            if (point_images(coplanarity, point).count > 0) continue;
            ++none;
            turned_away += !may_hold(coplanarity, beam, point);
        }
    }
    CHECK(none > 20000);
    CHECK(turned_away > 0.9 * none);
}
