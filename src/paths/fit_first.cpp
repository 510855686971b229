#include "paths/fit_first.h"

#include <cmath>
#include <optional>
#include <vector>

#include "base/parallel.h"
#include "paths/fit_linear.h"
#include "reflect/mirror.h"
#include "refract/snell.h"

namespace trilens {
namespace {

constexpr std::size_t kFacetsPerTask = 256;
constexpr std::size_t kPlaces = 3;
constexpr double kOutside = 1e-9;  // weights this far below 0 are rounding

/// One facet for whose inside exact rays are wanted.
struct FacetFit {
    const FirstOptic& optic;
    const PathMesh& path;
    std::size_t facet = 0;
    double side = 1;  // of the normal: 1 where the front is seen

    Vec3 incident(const Vec3& point) const { return incident_direction(optic.camera, point); }

    bool is_turned(const Vec3& point, const Vec3& normal) const {
        return side * dot(incident(point), normal) >= 0;
    }

    /// Nothing on total reflection.
    std::optional<Vec3> direction(const SurfacePoint& at) const {
        if (path.path == Path::kReflect) return mirrored(incident(at.position), at.normal);
        return refracted(incident(at.position), side * at.normal, side > 0 ? 1 / optic.ior : optic.ior);
    }

    std::optional<FitSample> sample(const FacetWeights& weights, std::size_t place) const {
        Vec2 uv(0);
        for (std::size_t k = 0; k < 3; ++k)
            uv += (k == place ? 2.0 / 3 : 1.0 / 6) * optic.grid.facet_uv[facet][k];
        const SurfacePoint at = optic.surface.eval_first_order(optic.grid.facet_face[facet], uv);
        if (at.normal == Vec3(0) || is_turned(at.position, at.normal)) return std::nullopt;
        const Vec3 screen = screen_from_world(optic.camera, at.position);
        if (!(screen.z > 0)) return std::nullopt;
        Vec3 e = weights.unnormalised(screen.x / screen.z, screen.y / screen.z);
        e /= e.x + e.y + e.z;
        if (!(e.x > -kOutside && e.y > -kOutside && e.z > -kOutside)) return std::nullopt;
        const std::optional<Vec3> leaves = direction(at);
        if (!leaves) return std::nullopt;

        FitSample sample;
        sample.corners = path.mesh.facets[facet];
        sample.weights = glm::max(e, Vec3(0));
        sample.weights /= sample.weights.x + sample.weights.y + sample.weights.z;
        std::array<Vec3, 3> corner;
        double w = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            corner[k] = path.mesh.screen[sample.corners[k]];
            w += sample.weights[static_cast<int>(k)] * corner[k].z;
        }
        sample.measure = std::fabs(triple(corner[0], corner[1], corner[2])) / (w * w * w);
        sample.value = {at.position.x, at.position.y, at.position.z, leaves->x, leaves->y, leaves->z, 0};
        return sample;
    }

    /// Whether all corners are before the eye and face it.
    bool takes_part() const {
        for (const Id corner : optic.grid.facets[facet]) {
            const Vec3& point = optic.grid.points[optic.grid.corner_point[corner]];
            if (!(screen_from_world(optic.camera, point).z > 0)) return false;
            if (is_turned(point, optic.grid.corner_normal[corner])) return false;
        }
        return true;
    }
};

}  // namespace

void fit_first_rays(const FirstOptic& optic, PathMesh& path) {
    const std::size_t facets = optic.grid.facets.size();
    std::vector<std::optional<FitSample>> found(kPlaces * facets);
    parallel_for(facets, kFacetsPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t f = from; f < to; ++f) {
            if (!path.mesh.has_rays(f)) continue;
            const FacetWeights weights = facet_weights(path.mesh, f);
            if (weights.edge_on) continue;
            FacetFit fit{optic, path, f};
            const Id first = optic.grid.corner_point[optic.grid.facets[f][0]];
            if (!faces_front(optic.grid, optic.grid.facets[f], fit.incident(optic.grid.points[first])))
                fit.side = -1;
            if (!fit.takes_part()) continue;
            for (std::size_t i = 0; i < kPlaces; ++i) found[kPlaces * f + i] = fit.sample(weights, i);
        }
    });
    std::vector<FitSample> samples;
    for (const std::optional<FitSample>& one : found)
        if (one) samples.push_back(*one);

    std::vector<FitValue> values;
    for (const Ray& ray : path.mesh.rays) {
        const Vec3 &o = ray.origin, &d = ray.direction;
        values.push_back({o.x, o.y, o.z, d.x, d.y, d.z, 0});
    }
    even_out(samples, values);
    fit_linear(samples, values);
    for (std::size_t c = 0; c < values.size(); ++c)
        path.mesh.rays[c] = {{values[c][0], values[c][1], values[c][2]},
                             {values[c][3], values[c][4], values[c][5]}};
}

}  // namespace trilens
