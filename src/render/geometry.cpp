#include "render/geometry.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/facet_scene.h"
#include "surfaces/surfaces.h"

namespace trilens {
namespace {

/// Facets of the fine grid that finds the face under a ray; Newton then finds the exact point, so this only
/// decides how little of a silhouette is missed.
constexpr std::size_t kFineFacets = 400'000;
constexpr int kMinFine = 4, kMaxFine = 256;

int fine_resolution(const Surface& surface) {
    const double per_face = static_cast<double>(kFineFacets) /
                            (2.0 * static_cast<double>(std::max<std::size_t>(1, surface.face_count())));
    return std::clamp(static_cast<int>(std::sqrt(per_face)), kMinFine, kMaxFine);
}

}  // namespace

/// What is kept of one optic.
struct OpticGeometry {
    Lazy<LimitTracer> limit;
    std::mutex mutex;  // of the two below
    int resolution = 0;
    std::shared_ptr<const OpticFacets> facets;
};

struct WorldGeometry {
    explicit WorldGeometry(std::size_t optics) : optic(optics) {}
    Lazy<PreparedScene> prepared;
    Lazy<Tracer> tracer;
    std::vector<OpticGeometry> optic;
};

World::World() = default;
World::~World() = default;

void prepare_geometry(World& world) {
    world.geometry = std::make_unique<WorldGeometry>(world.optics.size());
}

TriangleScene OpticFacets::scene() const {
    TriangleScene scene;
    append_facets(grid_, object_, scene);
    return scene;
}

const PreparedScene& OpticFacets::prepared() const {
    return prepared_.get([this] { return std::make_unique<PreparedScene>(scene()); });
}

const Tracer& OpticFacets::tracer() const {
    return tracer_.get([this] { return std::make_unique<Tracer>(scene()); });
}

const PreparedScene& prepared_objects(const World& world) {
    return world.geometry->prepared.get([&] { return std::make_unique<PreparedScene>(world.objects); });
}

const Tracer& object_tracer(const World& world) {
    return world.geometry->tracer.get([&] { return std::make_unique<Tracer>(world.objects); });
}

const LimitTracer& limit_tracer(const World& world, std::size_t optic) {
    return world.geometry->optic[optic].limit.get([&] {
        const Surface& surface = *world.optics[optic].surface;
        const SurfaceGrid fine =
            surface.has_closed_form() ? SurfaceGrid{} : make_grid(surface, fine_resolution(surface));
        return std::make_unique<LimitTracer>(surface, fine);
    });
}

std::shared_ptr<const OpticFacets> optic_facets(const World& world, std::size_t optic, int n) {
    OpticGeometry& kept = world.geometry->optic[optic];
    const std::lock_guard lock(kept.mutex);
    if (!kept.facets || kept.resolution != n) {
        kept.facets.reset();  // the old one goes first, unless a picture still uses it
        kept.facets = std::make_shared<OpticFacets>(make_grid(*world.optics[optic].surface, n),
                                                    world.optics[optic].mesh);
        kept.resolution = n;
    }
    return kept.facets;
}

}  // namespace trilens
