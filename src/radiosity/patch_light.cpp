#include "radiosity/patch_light.h"

#include <algorithm>

#include "base/util/parallel.h"
#include "radiosity/form_factors.h"

namespace trilens {
namespace {

/// A point of a surface as a ray sees it that comes down on it.
struct SeenPoint {
    Hit hit;
    Ray ray;

    SeenPoint(const TriangleScene& scene, const ShadedPoint& point)
        : hit{point.triangle, 1, point.barycentric} {
        const IdTriple& corner = scene.triangles[point.triangle];
        const Vec3& a = scene.points[corner[0]];
        const Vec3 up = normalize_or_zero(cross(scene.points[corner[1]] - a, scene.points[corner[2]] - a));
        ray.direction = point.is_back ? up : -up;
        ray.origin = position(scene, hit) - ray.direction;
    }
};

PatchSide side_of_patch(const World& world, const DirectLight& direct, const RadiosityElement& patch,
                        bool is_back) {
    std::vector<ShadedPoint> points;
    for (const Vec3& w : middles_of_parts(kPartsPerEdge))
        points.push_back(
            {patch.parent,
             w.x * patch.barycentrics[0] + w.y * patch.barycentrics[1] + w.z * patch.barycentrics[2],
             is_back});
    PatchSide side;
    for (const Vec3& light : direct.at(points)) side.direct += light;
    for (const ShadedPoint& point : points) {
        const SeenPoint seen(world.objects, point);
        const SurfaceLook look =
            look_at(world.shading, seen.hit, texels_at(world.shading, {&seen.hit, &seen.ray}));
        side.reflectance += glm::max(outgoing_radiance(look, {.matt = Vec3(1)}) - look.emissive, Vec3(0));
        side.emission += look.emissive;
    }
    for (Vec3* mean : {&side.direct, &side.reflectance, &side.emission})
        *mean /= static_cast<double>(points.size());
    return side;
}

}  // namespace

DirectLight::DirectLight(const World& world, const Progress& progress)
    : world_(world), white_(world.shading), cancel_(progress.cancel) {
    prepare_shadows(world, false, progress);
    for (Material& material : white_.materials) {
        material = Material{};
        material.brdf = Brdf::kLambert;
    }
    white_.mips.clear();
    white_.colors.clear();
    white_.baked.clear();
}

std::vector<Vec3> DirectLight::at(std::span<const ShadedPoint> points) const {
    std::vector<SeenPoint> seen;
    std::vector<SeenAlong> along;
    for (const ShadedPoint& point : points) seen.emplace_back(world_.objects, point);
    for (const SeenPoint& one : seen) {
        along.push_back({&one.hit, &one.ray});
        along.back().cancel = cancel_;
    }
    std::vector<Vec3> light(points.size());
    shade_rays(white_, along, light);
    return light;
}

PatchLight patch_light(const World& world, const DirectLight& direct, const ElementMesh& mesh,
                       const Progress& progress) {
    PatchLight light;
    LoopProgress done(progress, static_cast<double>(mesh.elements().size()));
    light.sides.resize(2 * mesh.elements().size());
    parallel_for(mesh.elements().size(), 16, [&](std::size_t from, std::size_t to) {
        for (std::size_t e = from; e < to; ++e) {
            done.stop_if_cancelled();
            for (const bool is_back : {false, true})
                light.sides[side_of(static_cast<Id>(e), is_back)] =
                    side_of_patch(world, direct, mesh.elements()[e], is_back);
            done.add(1);
        }
    });
    for (std::size_t e = 0; e < mesh.elements().size(); ++e) {
        bool is_too_white = false;
        for (const bool is_back : {false, true}) {
            Vec3& reflectance = light.sides[side_of(static_cast<Id>(e), is_back)].reflectance;
            for (int k = 0; k < 3; ++k) is_too_white = is_too_white || reflectance[k] > kMostReflectance;
            reflectance = glm::min(reflectance, Vec3(kMostReflectance));
        }
        light.too_white += is_too_white;
        const Id material = world.shading.material[mesh.elements()[e].parent];
        light.glossy += !world.shading.materials[material].is_matt();
    }
    return light;
}

}  // namespace trilens
