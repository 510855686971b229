// Where do points appear in a mirror? The cubic per facet against a search by tracing rays, as one would do
// it otherwise: the nearest ray of a coarse image, then Newton on the screen with rays traced at each step.
// Both look through the same facets, so that they must find the same images.
#include <cmath>
#include <cstdio>
#include <optional>
#include <span>

#include "base/raymesh/surface.h"
#include "base/util/parallel.h"
#include "camera/linear/linear_cameras.h"
#include "intersect/tracer.h"
#include "reflect/reflection.h"
#include "surfaces/surfaces.h"
#include "trilinear/points/point_images.h"
#include "workloads.h"

namespace {

using namespace trilens;

constexpr int kWidth = 640, kHeight = 480;
constexpr int kResolution = 9;  // 6 x 2 x 81 = 972 facets
constexpr std::size_t kPoints = 100000;
constexpr int kCoarse = 8;       // pixels between the rays of the coarse image
constexpr int kMostSteps = 12;   // of Newton
constexpr double kProbe = 1e-4;  // pixels, for its differences
constexpr double kClose = 1e-9;  // pixels, the last step
constexpr double kSame = 1e-5;   // pixels between two images that are one
constexpr int kRepeats = 5;

/// A mirror of facets that can be asked for the ray at a pixel.
struct FacetMirror {
    LinearCamera camera;
    RayMesh mesh;
    Tracer facets;

    /// None beside the mirror.
    std::optional<Ray> ray_at(const Vec2& pixel) const {
        // The eye's ray through the pixel, from the rows of the camera's map: M (d, 0) = (x, y, 1).
        const glm::dmat3 rows(Vec3(camera.screen_x), Vec3(camera.screen_y), Vec3(camera.screen_w));
        const Vec3 direction = glm::inverse(glm::transpose(rows)) * Vec3(pixel, 1);
        const Hit hit = facets.first_hit({camera.eye, direction});
        if (!hit.seen() || !mesh.has_rays(hit.triangle)) return std::nullopt;
        const Vec3 weights(1 - hit.barycentric.x - hit.barycentric.y, hit.barycentric.x, hit.barycentric.y);
        return interpolated_ray(mesh, hit.triangle, weights);
    }
};

struct CoarseRay {
    Vec2 pixel;
    Vec3 origin, unit;
};

std::vector<CoarseRay> coarse_image(const FacetMirror& mirror) {
    std::vector<CoarseRay> rays;
    for (double y = 0.5 * kCoarse; y < kHeight; y += kCoarse)
        for (double x = 0.5 * kCoarse; x < kWidth; x += kCoarse)
            if (const std::optional<Ray> ray = mirror.ray_at({x, y}))
                rays.push_back({{x, y}, ray->origin, normalize(ray->direction)});
    return rays;
}

/// From the ray to the point, at right angles to the ray.
Vec3 miss(const Ray& ray, const Vec3& point) {
    const Vec3 unit = normalize(ray.direction), way = point - ray.origin;
    return way - dot(way, unit) * unit;
}

std::optional<Vec2> search(const FacetMirror& mirror, std::span<const CoarseRay> coarse, const Vec3& point) {
    double least = INFINITY;
    Vec2 at(0);
    for (const CoarseRay& ray : coarse) {
        const Vec3 way = point - ray.origin;
        const double along = dot(way, ray.unit), distance = dot(way, way) - along * along;
        if (along > 0 && distance < least) least = distance, at = ray.pixel;
    }
    for (int step = 0; step < kMostSteps; ++step) {
        const std::optional<Ray> here = mirror.ray_at(at), right = mirror.ray_at(at + Vec2(kProbe, 0)),
                                 down = mirror.ray_at(at + Vec2(0, kProbe));
        if (!here || !right || !down) return std::nullopt;
        // Least squares: the step that makes the miss vanish.
        const Vec3 residual = miss(*here, point);
        const Vec3 dx = (miss(*right, point) - residual) / kProbe,
                   dy = (miss(*down, point) - residual) / kProbe;
        const double xx = dot(dx, dx), xy = dot(dx, dy), yy = dot(dy, dy), determinant = xx * yy - xy * xy;
        if (!(determinant > 0)) return std::nullopt;
        const Vec2 move = Vec2(xy * dot(dy, residual) - yy * dot(dx, residual),
                               xy * dot(dx, residual) - xx * dot(dy, residual)) /
                          determinant;
        at += move;
        if (length(move) < kClose)
            return dot(point - here->origin, here->direction) > 0 ? std::optional(at) : std::nullopt;
    }
    return std::nullopt;
}

FacetMirror mirror_sphere() {
    PerspectiveParams params;
    params.look_at = {{0.3, 0.4, 4}, {0, 0, 0}, {0, 1, 0}};
    params.width = kWidth;
    params.height = kHeight;
    const Primitive sphere;
    const LinearCamera camera = make_perspective(params);
    const SurfaceGrid grid = make_grid(*make_primitive_surface(sphere), kResolution);
    TriangleScene facets;
    append_facets(grid, 0, facets);
    return {camera, make_reflection(grid, camera), Tracer(facets)};
}

/// The mesh without the facets that face away from the eye: a closed body hides them.
RayMesh without_back(const FacetMirror& mirror) {
    RayMesh mesh = mirror.mesh;
    for (IdTriple& facet : mesh.facets) {
        const auto at = [&](std::size_t k) { return mesh.rays[facet[k]].origin; };
        if (dot(cross(at(1) - at(0), at(2) - at(0)), at(0) - mirror.camera.eye) >= 0)
            facet = {kNone, kNone, kNone};
    }
    return mesh;
}

}  // namespace

int main() {
    const FacetMirror mirror = mirror_sphere();
    std::vector<Vec3> points;
    for (std::uint64_t state = 1; points.size() < kPoints;) {
        const double x = trilens_bench::uniform(state, -5, 5), y = trilens_bench::uniform(state, -5, 5);
        const Vec3 point(x, y, trilens_bench::uniform(state, -5, 5));
        if (length(point) > 1.2) points.push_back(point);
    }

    PointImageLists images;
    const double prepare = trilens_bench::median_ms(kRepeats, [&] { MeshPointImages again(mirror.mesh); });
    const MeshPointImages prepared(mirror.mesh);
    const double cubic = trilens_bench::median_ms(kRepeats, [&] { images = prepared.images(points); });

    const MeshPointImages front_only(without_back(mirror));
    PointImageLists front_images;
    const double front_cubic =
        trilens_bench::median_ms(kRepeats, [&] { front_images = front_only.images(points); });

    std::vector<CoarseRay> coarse;
    const double coarse_ms = trilens_bench::median_ms(kRepeats, [&] { coarse = coarse_image(mirror); });
    std::vector<std::optional<Vec2>> found(points.size());
    const double traced = trilens_bench::median_ms(kRepeats, [&] {
        parallel_for(points.size(), 64, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) found[i] = search(mirror, coarse, points[i]);
        });
    });

    // What the facets show on their back, which the eye cannot see, no search by rays finds.
    std::size_t total = 0, front = 0, both = 0, only_search = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        bool same = false;
        for (const MeshPointImage& image : images.of(i)) {
            ++total;
            const std::optional<Ray> seen = mirror.ray_at(image.screen);
            const Ray own = interpolated_ray(mirror.mesh, image.facet, image.weights);
            front += seen && length(seen->origin - own.origin) < 1e-6;
            same = same || (found[i] && length(*found[i] - image.screen) < kSame);
        }
        both += same;
        only_search += found[i] && !same;
    }
    std::printf("%zu points, %zu facets, %d threads, medians of %d runs\n", points.size(),
                mirror.mesh.facets.size(), thread_count(), kRepeats);
    std::printf(
        "cubic:  prepare %7.2f ms, images %8.1f ms: %zu images, %zu of them on the side that the eye sees\n",
        prepare, cubic, total, front);
    std::printf(
        "front:                     images %8.1f ms: %zu images, through the facets that face the eye\n",
        front_cubic, front_images.image.size());
    std::printf("search: prepare %7.2f ms, images %8.1f ms: %zu of those found, %zu others\n", coarse_ms,
                traced, both, only_search);
    std::printf("search / cubic: %.1f, search / front: %.1f\n", traced / cubic, traced / front_cubic);
    return only_search == 0 && front > 0 ? 0 : 1;
}
