// Where all of a light's beams end: by rays, and where no ray tells of an object, by the area that its
// triangles cut out of a beam.
#include <algorithm>
#include <utility>
#include <vector>

#include "base/util/parallel.h"
#include "caustics/beam_light.h"
#include "caustics/flux_ends.h"
#include "shade/shade.h"

namespace trilens {
namespace {

constexpr std::size_t kTrianglesAtOnce = 64;

using BeamFlux = std::pair<Id, Vec3>;

/// A triangle as the receiving half of a parallelogram, on one of its sides; without area where it has none.
Receiver side_of_triangle(const TriangleScene& scene, std::size_t t, bool is_back, double offset) {
    static constexpr std::array<Vec2, 3> kHalf{Vec2(-0.5, -0.5), Vec2(0.5, -0.5), Vec2(-0.5, 0.5)};
    const IdTriple& corner = scene.triangles[t];
    const Vec3 &a = scene.points[corner[0]], &b = scene.points[corner[1]], &c = scene.points[corner[2]];
    Receiver receiver;
    receiver.sides = {b - a, c - a};
    receiver.point = 0.5 * (b + c);
    receiver.normal = (is_back ? -1.0 : 1.0) * normalize_or_zero(cross(b - a, c - a));
    receiver.shading_normal = receiver.normal;
    receiver.lifted = receiver.point + offset * receiver.normal;
    receiver.outline = kHalf;
    receiver.keeps_sides = true;
    return receiver;
}

}  // namespace

FluxEnds BeamLight::flux_ends(const TriangleScene& objects) const {
    std::vector<BeamFluxEnds> of_beam = flux_ends_by_rays({*refined_, beams_, *space_.optics});
    std::vector<char> is_unsure(of_beam.size());
    for (std::size_t i = 0; i < of_beam.size(); ++i) is_unsure[i] = !of_beam[i].is_sure;

    const std::size_t blocks = (objects.size() + kTrianglesAtOnce - 1) / kTrianglesAtOnce;
    std::vector<std::vector<BeamFlux>> found(blocks);
    const double offset = kShadowOffset * space_.size;
    parallel_for(blocks, 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t t = from * kTrianglesAtOnce; t < std::min(to * kTrianglesAtOnce, objects.size());
             ++t)
            for (const bool is_back : {false, true})
                for_each_flux(
                    side_of_triangle(objects, t, is_back, offset), is_unsure,
                    [&](Id beam, const Vec3& flux) { found[t / kTrianglesAtOnce].emplace_back(beam, flux); });
    });
    std::vector<Vec3> by_area(of_beam.size(), Vec3(0));
    for (const auto& block : found)
        for (const auto& [beam, flux] : block) by_area[beam] += flux;

    FluxEnds all;
    for (std::size_t i = 0; i < of_beam.size(); ++i) {
        const FluxEnds& by_rays = of_beam[i];
        const Vec3 on_objects =
            is_unsure[i] ? glm::min(by_area[i], beams_.beams[i].flux) : by_rays.on_objects;
        all.on_objects += on_objects;
        all.away += glm::max(Vec3(0), by_rays.away + by_rays.on_objects - on_objects);
    }
    return all;
}

}  // namespace trilens
