#include "picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/raymesh/rasterize.h"
#include "projector/projector.h"
#include "reflect/reflection.h"

namespace trilens::browser {
namespace {

const Vec3 kBack(0.035, 0.032, 0.03);  // of the mirror
const Vec3 kSilver(0.93, 0.94, 0.95);  // what it gives back

LinearCamera camera_of(const Frame& frame) {
    PerspectiveParams params;
    params.look_at = {frame.eye, frame.at, Vec3(0, 1, 0)};
    params.yfov_degrees = 38;
    params.width = frame.width;
    params.height = frame.height;
    return make_perspective(params);
}

/// Whether an eye sees the facet's mirroring side.
bool shows_front(const SurfaceGrid& grid, std::size_t facet, const Vec3& eye) {
    return faces_front(grid, grid.facets[facet], grid.points[grid.corner_point[grid.facets[facet][0]]] - eye);
}

/// sRGB of linear light, eight bits, by a table.
std::uint8_t shown(double light) {
    static const auto table = [] {
        std::array<std::uint8_t, 4097> made{};
        for (std::size_t i = 0; i < made.size(); ++i) {
            const double x = static_cast<double>(i) / 4096;
            made[i] = static_cast<std::uint8_t>(
                std::lround(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055)));
        }
        return made;
    }();
    return table[static_cast<std::size_t>(4096 * std::clamp(light, 0.0, 1.0))];
}

/// The part of the samples' window in which the mirror may be seen; all of it where one of its points does
/// not lie before the camera.
SampleGrid window_of(const SurfaceGrid& facets, const LinearCamera& camera, const SampleGrid& samples) {
    Vec2 low(samples.x1, samples.y1), high(samples.x0, samples.y0);
    for (const Vec3& point : facets.points) {
        const Vec3 at = screen_from_world(camera, point);
        if (at.z <= 0) return samples;
        low = glm::min(low, Vec2(at.x / at.z, at.y / at.z));
        high = glm::max(high, Vec2(at.x / at.z, at.y / at.z));
    }
    const auto between = [](double at, int first, int last) {
        return static_cast<int>(std::clamp(at, double(first), double(last)));
    };
    SampleGrid part = samples;
    part.x0 = between(std::floor(low.x) - 1, samples.x0, samples.x1);
    part.y0 = between(std::floor(low.y) - 1, samples.y0, samples.y1);
    part.x1 = between(std::ceil(high.x) + 1, part.x0, samples.x1);
    part.y1 = between(std::ceil(high.y) + 1, part.y0, samples.y1);
    return part;
}

/// What the camera sees of the samples: the room, and the mirror's facet wherever it lies before that.
void look(const LittleRoom& room, const Frame& frame, const SurfaceGrid& facets, const SampleGrid& samples,
          FrameBuffers& seen) {
    const LinearCamera camera = camera_of(frame);
    const RayMesh rays = make_camera_mesh(camera, frame.width, frame.height);
    seen.room.assign(samples.size(), Hit());
    seen.mirror.assign(samples.size(), kNone);
    draw(*room.ready, rays, rasterize_facets(rays, samples), samples, seen.room);
    const SampleGrid part = window_of(facets, camera, samples);
    if (part.size() == 0) return;
    TriangleScene mirror;
    append_facets(facets, 0, mirror);
    seen.part.assign(part.size(), Visible());
    find_visible(PreparedScene(mirror), rays, rasterize_facets(rays, part), part, seen.part);
    for (std::size_t i = 0; i < seen.part.size(); ++i) {
        const Visible& facet = seen.part[i];
        const std::size_t s = part.sample_in(samples, i);
        if (facet.seen() && (!seen.room[s].seen() || double{facet.t_high} < seen.room[s].t))
            seen.mirror[s] = facet.triangle;
    }
}

}  // namespace

void draw_frame(const LittleRoom& room, const Frame& frame, FrameBuffers& seen) {
    const LinearCamera camera = camera_of(frame);
    const SurfaceGrid facets = make_grid(frame.mirror, frame.n);
    const SampleGrid samples{0, frame.first_row, frame.width, frame.last_row, frame.side};
    look(room, frame, facets, samples, seen);

    // The samples that see the mirror's front belong to the facets that they see, and the room is projected
    // through these.
    std::vector<char> front(facets.facets.size());
    for (std::size_t f = 0; f < front.size(); ++f) front[f] = shows_front(facets, f, frame.eye);
    seen.owner.resize(samples.size());
    for (std::size_t s = 0; s < seen.owner.size(); ++s)
        seen.owner[s] = seen.mirror[s] != kNone && front[seen.mirror[s]] ? seen.mirror[s] : kNone;
    const RayMesh mirror = make_reflection(facets, camera);
    seen.mirrored.assign(samples.size(), Hit());
    draw(*room.ready, mirror, group_by_facet(seen.owner, facets.facets.size()), samples, seen.mirrored);

    // Rays of samples are asked for only where they see the sky.
    std::vector<FacetWeights> weights(mirror.facets.size());
    for (std::size_t f = 0; f < weights.size(); ++f)
        if (mirror.has_rays(f)) weights[f] = facet_weights(mirror, f);
    const auto light_at = [&](std::size_t s) -> Vec3 {
        if (const Id facet = seen.owner[s]; facet != kNone) {
            if (seen.mirrored[s].seen()) return kSilver * light_of(room, seen.mirrored[s]);
            if (!mirror.has_rays(facet) || weights[facet].edge_on) return kBack;
            return kSilver * sky(sample_ray(mirror, facet, weights[facet], samples.position(s)).direction);
        }
        if (seen.mirror[s] != kNone) return kBack;
        return seen.room[s].seen() ? light_of(room, seen.room[s])
                                   : sky(film_ray(camera, samples.position(s)).direction);
    };

    seen.rgba.assign(4 * samples.pixels(), 255);
    const std::size_t each = static_cast<std::size_t>(samples.samples_per_pixel());
    for (std::size_t p = 0; p < samples.pixels(); ++p) {
        Vec3 light(0);
        for (std::size_t s = p * each; s < (p + 1) * each; ++s) light += light_at(s);
        for (int c = 0; c < 3; ++c)
            seen.rgba[4 * p + static_cast<std::size_t>(c)] = shown(light[c] / static_cast<double>(each));
    }
}

std::vector<float> facets_on_film(const Frame& frame) {
    const LinearCamera camera = camera_of(frame);
    const SurfaceGrid facets = make_grid(frame.mirror, frame.n);
    std::vector<float> corners;
    for (const IdTriple& facet : facets.facets) {
        std::array<Vec3, 3> at;
        for (std::size_t k = 0; k < 3; ++k)
            at[k] = screen_from_world(camera, facets.points[facets.corner_point[facet[k]]]);
        if (std::any_of(at.begin(), at.end(), [](const Vec3& v) { return v.z <= 0; })) continue;
        for (const Vec3& v : at) {
            corners.push_back(static_cast<float>(v.x / v.z));
            corners.push_back(static_cast<float>(v.y / v.z));
        }
    }
    return corners;
}

std::optional<Vec2> mirror_place(const LittleRoom& room, const Frame& frame, const Vec2& at) {
    const SurfaceGrid facets = make_grid(frame.mirror, frame.n);
    const int x = static_cast<int>(at.x), y = static_cast<int>(at.y);
    const SampleGrid sample{x, y, x + 1, y + 1, 1};
    FrameBuffers seen;
    look(room, frame, facets, sample, seen);
    if (seen.mirror[0] == kNone) return std::nullopt;
    TriangleScene mirror;
    append_facets(facets, 0, mirror);
    const RayMesh rays = make_camera_mesh(camera_of(frame), frame.width, frame.height);
    Hit hit;
    draw(PreparedScene(mirror), rays, rasterize_facets(rays, sample), sample, {&hit, 1});
    if (!hit.seen()) return std::nullopt;
    const std::array<Vec2, 3>& uv = facets.facet_uv[hit.triangle];
    return (1 - hit.barycentric.x - hit.barycentric.y) * uv[0] + hit.barycentric.x * uv[1] +
           hit.barycentric.y * uv[2];
}

}  // namespace trilens::browser
