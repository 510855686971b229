// A light tracer with Embree: random rays of a light over facets of the optics
// (Arvo, Backward Ray Tracing, 1986).
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <random>
#include <utility>
#include <vector>

#include "base/util/parallel.h"
#include "inverse/maps/target.h"
#include "render/world/world.h"
#include "surfaces/surfaces.h"

namespace trilens {

inline double luminance(const Vec3& light) {
    return (light.x + light.y + light.z) / 3;
}

inline constexpr std::size_t kChunk = 50'000;          // rays with a seed of their own
inline constexpr std::size_t kTracedFacets = 300'000;  // of each optic, about

/// Objects and facets of optics in one tree.
struct FacetWorld {
    const World& world;
    PathWorld optics;  // what happens at a meeting
    std::vector<SurfaceGrid> grids;
    std::vector<Id> optic_of;  // by object id
    Id first_facet = 0;
    std::vector<std::pair<Id, Id>> facet;  // optic and facet of each triangle from there on
    std::unique_ptr<Tracer> tracer;

    explicit FacetWorld(const World& of) : world(of), optics(optics_for_lights(of)) {
        TriangleScene scene = world.objects;
        first_facet = static_cast<Id>(scene.size());
        for (Id i = 0; i < world.optics.size(); ++i) {
            const Surface& surface = *world.optics[i].surface;
            const double per_face =
                static_cast<double>(kTracedFacets) / (2.0 * static_cast<double>(surface.face_count()));
            grids.push_back(make_grid(surface, std::clamp(static_cast<int>(std::sqrt(per_face)), 2, 400)));
            append_facets(grids.back(), world.optics[i].mesh, scene);
            for (Id f = 0; f < grids.back().facets.size(); ++f) facet.emplace_back(i, f);
        }
        tracer = std::make_unique<Tracer>(std::move(scene));
    }

    std::optional<Meeting> meeting(const Hit& hit, const Ray& ray) const {
        if (hit.triangle < first_facet) return std::nullopt;
        const auto [optic, f] = facet[hit.triangle - first_facet];
        const SurfaceGrid& grid = grids[optic];
        const IdTriple& corner = grid.facets[f];
        const Vec3 weights(1 - hit.barycentric.x - hit.barycentric.y, hit.barycentric.x, hit.barycentric.y);
        Meeting at;
        at.optic = optic;
        at.incoming = normalize(ray.direction);
        at.point = ray.origin + hit.t * ray.direction;
        at.normal = Vec3(0);
        for (std::size_t k = 0; k < 3; ++k)
            at.normal += weights[static_cast<int>(k)] * grid.corner_normal[corner[k]];
        at.normal = normalize(at.normal);
        at.front = faces_front(grid, corner, ray.direction);
        return at;
    }
};

/// Where paths end on a rectangle, as counts of light.
struct Histogram {
    const FlatRectangle& rectangle;
    int width = 0, height = 0;
    std::vector<double> sum, squares;
    std::vector<std::uint32_t> count;
    double all = 0;  // of the light that comes to the object, by any cell

    Histogram(const FlatRectangle& of, int w, int h) : rectangle(of), width(w), height(h) {
        const auto cells = static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
        sum.resize(cells), squares.resize(cells), count.resize(cells);
    }
    void add(const Vec3& point, double light) {
        const Vec3 way = point - rectangle.origin;
        const double u = dot(way, rectangle.u) / dot(rectangle.u, rectangle.u),
                     v = dot(way, rectangle.v) / dot(rectangle.v, rectangle.v);
        const int x = static_cast<int>(std::floor(u * width)),
                  y = height - 1 - static_cast<int>(std::floor(v * height));
        if (x < 0 || y < 0 || x >= width || y >= height) return;
        const auto cell = static_cast<std::size_t>(y * width + x);
        sum[cell] += light, squares[cell] += light * light, ++count[cell], all += light;
    }
    void add(const Histogram& other) {
        for (std::size_t i = 0; i < sum.size(); ++i)
            sum[i] += other.sum[i], squares[i] += other.squares[i], count[i] += other.count[i];
        all += other.all;
    }
};

struct LightTracer {
    const FacetWorld& scene;
    const BeamSource& source;
    std::vector<LightWindow> windows;
    Id object;  // where light is counted
    Media around;

    /// One ray, by one way at each meeting, chosen by what it carries.
    void shoot(std::mt19937_64& random, double share, Histogram& to) const {
        std::uniform_real_distribution<double> unit(0, 1);
        const LightWindow& window =
            windows[static_cast<std::size_t>(unit(random) * static_cast<double>(windows.size()))];
        const Vec2 place(2 * unit(random) - 1, 2 * unit(random) - 1);
        Ray ray = window.ray(place);
        Vec3 light = share * 4 * static_cast<double>(windows.size()) * window.density(place) *
                     source.strength(ray.direction);
        Media media = around;
        Colours colours = kAllColours;
        double t_min = 0;
        for (int depth = 0; depth <= scene.optics.max_depth + 1; ++depth) {
            const Hit hit = scene.tracer->first_hit(ray, t_min);
            if (!hit.seen()) return;
            light *= body_transmittance(scene.optics, active_medium(scene.optics, media), hit.t);
            const std::optional<Meeting> at = scene.meeting(hit, ray);
            if (!at) {
                if (depth > 0 && scene.world.objects.object[hit.triangle] == object)
                    to.add(ray.origin + hit.t * ray.direction, luminance(light));
                return;
            }
            if (depth > scene.optics.max_depth) return;
            const Branches ways = branches(scene.optics, *at, media, colours);
            double all = 0;
            for (const Branch& way : ways) all += luminance(way.weight * light);
            if (!(all > 0)) return;
            double chosen = unit(random) * all;
            const Branch* taken = &ways.back();
            for (const Branch& way : ways) {
                const double one = luminance(way.weight * light);
                if (chosen < one) {
                    taken = &way;
                    break;
                }
                chosen -= one;
            }
            const double chance = luminance(taken->weight * light) / all;
            light *= taken->weight / chance;
            media = taken->media, colours = taken->colours;
            ray = {at->point, taken->direction};
            t_min = 1e-7 * scene.world.shading.size;
        }
    }

    Histogram trace(std::size_t rays, const FlatRectangle& rectangle, int width, int height) const {
        Histogram total(rectangle, width, height);
        const std::size_t chunks = (rays + kChunk - 1) / kChunk;
        std::mutex mutex;
        parallel_for(chunks, 1, [&](std::size_t first, std::size_t last) {
            Histogram part(rectangle, width, height);
            for (std::size_t c = first; c < last; ++c) {
                std::mt19937_64 random(c);
                for (std::size_t i = 0; i < kChunk; ++i)
                    shoot(random, 1 / static_cast<double>(chunks * kChunk), part);
            }
            const std::lock_guard lock(mutex);
            total.add(part);
        });
        return total;
    }
};

}  // namespace trilens
