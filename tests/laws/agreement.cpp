#include "laws/agreement.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "render/engines/engine.h"

using namespace trilens;

namespace trilens_test {
namespace {

void unheard(const std::string&) {}

/// What a pixel shows, in ids.
struct Seen {
    Id direct, optic, facet, reflect, refract;
    std::vector<Id> ends;  // of all its paths
    bool operator==(const Seen&) const = default;
};

Seen seen(const SampleViews& views, std::size_t sample) {
    const SampleView& view = views.samples[sample];
    std::vector<Id> ends;
    for (const PathEnd& end : views.ends_of(view)) ends.push_back(end.hit.triangle);
    return {view.hit.triangle,
            view.optic,
            view.facet,
            views.hit(view, Path::kReflect).triangle,
            views.hit(view, Path::kRefract).triangle,
            std::move(ends)};
}

bool covers_same(const Seen& a, const Seen& b) {
    const auto same = [](Id x, Id y) { return (x == kNone) == (y == kNone); };
    return same(a.direct, b.direct) && same(a.optic, b.optic) && same(a.reflect, b.reflect) &&
           same(a.refract, b.refract);
}

CameraRays shifted(CameraRays camera, const Vec2& by) {
    if (camera.linear) {
        camera.linear->screen_x += by.x * camera.linear->screen_w;
        camera.linear->screen_y += by.y * camera.linear->screen_w;
    }
    for (Vec3& s : camera.mesh.screen) s += Vec3(by.x * s.z, by.y * s.z, 0);
    return camera;
}

double relative_t(const Hit& a, const Hit& b) {
    if (!a.seen() || !b.seen()) return 0;
    return std::fabs(a.t - b.t) / std::max({std::fabs(a.t), std::fabs(b.t), 1e-300});
}

struct Differing {
    int x, y;
    Seen projected, traced;
};

/// Leaves those of `open` for which no shifted view shows the other engine's answer.
void close_edge_ties(const World& world, std::vector<Differing>& open) {
    const double d = kEdgeDistance, c = kEdgeDistance * 0.70710678;
    for (const Vec2& by : {Vec2(d, 0), Vec2(-d, 0), Vec2(0, d), Vec2(0, -d), Vec2(c, c), Vec2(-c, c),
                           Vec2(c, -c), Vec2(-c, -c)}) {
        if (open.empty()) return;
        const CameraRays camera = shifted(make_camera_rays(world.scene, 0), by);
        const Frame frame = make_frame(world, camera, FrameParams{}, unheard);
        const std::unique_ptr<Viewer> project = make_facet_viewer(world, frame, Engine::kExact);
        const std::unique_ptr<Viewer> trace = make_facet_viewer(world, frame, Engine::kFacetsTruth);
        std::erase_if(open, [&](const Differing& pixel) {
            SampleViews a, b;
            project->view({pixel.x, pixel.y, pixel.x + 1, pixel.y + 1, 1}, a);
            trace->view({pixel.x, pixel.y, pixel.x + 1, pixel.y + 1, 1}, b);
            return seen(a, 0) == pixel.traced || seen(b, 0) == pixel.projected;
        });
    }
}

}  // namespace

Agreement compare_engines(const World& world) {
    const Film& film = world.scene.film;
    const SampleGrid grid{0, 0, film.width, film.height, 1};
    SampleViews projected, traced;
    make_viewer(world, {}, Engine::kExact, unheard)->view(grid, projected);
    make_viewer(world, {}, Engine::kFacetsTruth, unheard)->view(grid, traced);

    Agreement result;
    result.pixels = grid.size();
    std::vector<Differing> open;
    for (std::size_t p = 0; p < grid.size(); ++p) {
        const Seen a = seen(projected, p), b = seen(traced, p);
        result.optic_pixels += a.optic != kNone;
        if (a == b) {
            const SampleView &x = projected.samples[p], &y = traced.samples[p];
            result.worst_t = std::max(result.worst_t, relative_t(x.hit, y.hit));
            for (const Path path : {Path::kReflect, Path::kRefract})
                result.worst_t =
                    std::max(result.worst_t, relative_t(projected.hit(x, path), traced.hit(y, path)));
            continue;
        }
        ++(covers_same(a, b) ? result.seen : result.coverage);
        open.push_back({static_cast<int>(p) % film.width, static_cast<int>(p) / film.width, a, b});
    }
    close_edge_ties(world, open);
    result.off_edge = open.size();
    if (!open.empty()) {
        const Differing& d = open.front();
        const auto text = [](const Seen& s) {
            return std::to_string(s.direct) + "/" + std::to_string(s.optic) + "/" + std::to_string(s.facet) +
                   "/" + std::to_string(s.reflect) + "/" + std::to_string(s.refract);
        };
        result.first_off_edge = "pixel " + std::to_string(d.x) + "," + std::to_string(d.y) + ": projector " +
                                text(d.projected) + ", Embree " + text(d.traced);
    }
    return result;
}

}  // namespace trilens_test
