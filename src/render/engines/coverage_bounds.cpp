#include "render/engines/coverage_bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "base/util/parallel.h"

namespace trilens {
namespace {

constexpr int kLevels = 5;  // of a pixel's division: 32 x 32 cells
constexpr int kCellsAcross = 1 << kLevels;

/// Pixels along a block's edge, a power of two: what all of them see is found for the block, then for its
/// quarters.
constexpr double kBlock = 16;

/// Stands for any of several optics.
constexpr Id kSomeOptic = kNone - 1;

/// Whether the pixel from this place on is in the window.
bool holds_pixel(const SampleGrid& window, const Vec2& at) {
    return at.x >= window.x0 && at.x < window.x1 && at.y >= window.y0 && at.y < window.y1;
}

/// Whether a pixel of the block is in the window; and all of them.
bool touches_block(const SampleGrid& window, const Vec2& at, double size) {
    return at.x + size > window.x0 && at.x < window.x1 && at.y + size > window.y0 && at.y < window.y1;
}
bool holds_block(const SampleGrid& window, const Vec2& at, double size) {
    return holds_pixel(window, at) && holds_pixel(window, at + Vec2(size - 1));
}

/// How a square lies to a facet on the screen.
struct OnFacet {
    bool touches = false, lies_in = false;
    std::uint8_t open = 0;  // bit k: the line of the edge opposite corner k passes the square
};

OnFacet square_on_facet(const FacetWeights& weights, const Vec2& low, const Vec2& high) {
    constexpr double kSlack = 1e-11;
    OnFacet on{true, true, 0};
    for (int k = 0; k < 3; ++k) {
        double least = 0, most = 0, size = 0;
        for (int corner = 0; corner < 4; ++corner) {
            const Vec2 at(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y);
            const double e = weights.unnormalised(at.x, at.y)[k];
            least = corner ? std::min(least, e) : e;
            most = corner ? std::max(most, e) : e;
            size = std::max(size, std::fabs(weights.weights_from_screen[0][k] * at.x) +
                                      std::fabs(weights.weights_from_screen[1][k] * at.y) +
                                      std::fabs(weights.weights_from_screen[2][k]));
        }
        if (most < -kSlack * size) on.touches = false;
        if (least > kSlack * size) continue;
        on.lies_in = false;
        on.open |= static_cast<std::uint8_t>(1u << k);
    }
    on.lies_in = on.lies_in && on.touches;
    return on;
}

/// The facet's corners and their box; where some lie behind the camera, the whole plane.
void place_on_screen(const RayMesh& mesh, std::size_t facet, std::array<Vec3, 3>& corner, Vec2& low,
                     Vec2& high) {
    constexpr double kEverywhere = 1e30;
    bool in_front = true;
    low = Vec2(kEverywhere);
    high = Vec2(-kEverywhere);
    for (std::size_t k = 0; k < 3; ++k) {
        corner[k] = mesh.screen[mesh.facets[facet][k]];
        in_front = in_front && corner[k].z > 0;
        const Vec2 at = Vec2(corner[k].x, corner[k].y) / corner[k].z;
        low = glm::min(low, at);
        high = glm::max(high, at);
    }
    if (!in_front) {
        low = Vec2(-kEverywhere);
        high = Vec2(kEverywhere);
    }
}

/// Whether a place of the square lies in the facet, away from its edges.
bool holds_place(const FacetWeights& weights, const Vec2& low, const Vec2& high) {
    // Not the middle: diagonals of cells pass through it.
    const Vec2 at = low + (high - low) * Vec2(0.37, 0.61);
    const Vec3 e = weights.unnormalised(at.x, at.y);
    const double least = 1e-9 * (e.x + e.y + e.z);
    return e.x > least && e.y > least && e.z > least;
}

}  // namespace

Id shown_mesh(const World& world, const SampleView& view) {
    if (view.optic != kNone) return world.optics[view.optic].mesh;
    return view.hit.seen() ? world.objects.object[view.hit.triangle] : kNone;
}

CoverageBounder::CoverageBounder(const World& world, const Frame& frame,
                                 const std::vector<SampleGrid>& windows)
    : world_(world),
      frame_(frame),
      windows_(windows),
      reach_(frame.camera.far_depth - frame.camera.near_depth) {
    const RayMesh& mesh = frame.camera.mesh;
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        if (!mesh.has_rays(f)) continue;
        const FacetWeights weights = facet_weights(mesh, f);
        if (weights.edge_on) continue;
        CameraFacet facet{make_facet_rays({mesh, f, weights}), weights};
        place_on_screen(mesh, f, facet.corner, facet.low, facet.high);
        facet.turned = dot(facet.corner[0], cross(facet.corner[1], facet.corner[2])) < 0;
        facets_.push_back(facet);
    }
}

/// Where a square's rays are asked for what they may meet.
struct CoverageBounder::Place {
    const Vec3& centre;         // the facet's
    Vec2 pixel{0};              // whose optics are meant
    bool mixes_optics = false;  // as one
};

std::vector<SquareTriangle> CoverageBounder::triangles_before(const SquareRays& rays,
                                                              const Place& place) const {
    std::vector<SquareTriangle> triangles;
    collect_triangles(
        prepared_objects(world_), place.centre, rays,
        [&](Id triangle) { return world_.objects.object[triangle]; }, triangles);
    for (std::size_t i = 0; i < windows_.size(); ++i) {
        if (!holds_pixel(windows_[i], place.pixel)) continue;
        const Id mesh = place.mixes_optics ? kSomeOptic : world_.optics[i].mesh;
        collect_triangles(
            frame_.optics[i].facets->prepared(), place.centre, rays, [&](Id) { return mesh; }, triangles);
    }
    return triangles;
}

/// What rays of a block of pixels may see, all of one facet.
struct CoverageBounder::BlockSight {
    const CameraFacet* facet = nullptr;
    std::vector<SquareTriangle> triangles;
};

/// The pixels that are asked about, and the answers.
struct CoverageBounder::Wanted {
    const SampleGrid& grid;
    std::span<const Id> shown;
    std::span<CoverageBounds> bounds;
    std::span<const Id> facets;  // of the block

    std::size_t index(double x, double y) const {
        return static_cast<std::size_t>(y - grid.y0) * static_cast<std::size_t>(grid.width()) +
               static_cast<std::size_t>(x - grid.x0);
    }
    /// All of a block's pixels see one surface.
    void fill(const Vec2& at, double size, Id surface) const {
        for (double y = std::max<double>(at.y, grid.y0); y < std::min<double>(at.y + size, grid.y1); ++y)
            for (double x = std::max<double>(at.x, grid.x0); x < std::min<double>(at.x + size, grid.x1);
                 ++x) {
                const std::size_t i = index(x, y);
                const float share = shown[i] == surface ? 1.0f : 0.0f;
                bounds[i] = {share, share};
            }
    }
};

/// One pixel: the camera's facets that it touches, with what their rays may meet there.
class CoverageBounder::Pixel {
  public:
    Pixel(const CoverageBounder& of, const Vec2& at, Id shown);

    void add_facet(const CameraFacet& facet);
    /// Instead: the facet that the pixel lies in, with what the block around it may see.
    void take(const BlockSight& around) {
        parts_.push_back({around.facet, std::vector<Triangles>(kLevels + 2)});
        parts_.back().triangles[0] = around.triangles;
    }
    CoverageBounds bounds() {
        divide(at_, 0);
        constexpr float kCells = kCellsAcross * kCellsAcross;
        CoverageBounds result{static_cast<float>(sure_) / kCells, static_cast<float>(possible_) / kCells};
        if (is_optic_ && mixes_optics_) result.low = 0;
        return result;
    }

  private:
    using Triangles = std::vector<SquareTriangle>;
    struct Part {
        const CameraFacet* facet = nullptr;
        std::vector<Triangles> triangles;  // by level
    };

    void divide(const Vec2& low, int level);
    /// What a cell shows: sure that it shows the mesh, may show it.
    std::pair<bool, bool> see(const Vec2& low, int level);

    const CoverageBounder& of_;
    const Vec2 at_;
    Id shown_;
    bool is_optic_ = false, mixes_optics_ = false;
    std::vector<Part> parts_;
    int sure_ = 0, possible_ = 0;  // cells
};

CoverageBounder::Pixel::Pixel(const CoverageBounder& of, const Vec2& at, Id shown)
    : of_(of), at_(at), shown_(shown) {
    mixes_optics_ = std::count_if(of.windows_.begin(), of.windows_.end(),
                                  [&](const SampleGrid& window) { return holds_pixel(window, at); }) > 1;
    for (std::size_t i = 0; i < of.windows_.size(); ++i)
        is_optic_ = is_optic_ || of.world_.optics[i].mesh == shown;
    if (is_optic_ && mixes_optics_) shown_ = kSomeOptic;
}

void CoverageBounder::Pixel::add_facet(const CameraFacet& facet) {
    const Vec2 high = at_ + Vec2(1);
    // A linear camera's facets all have the same rays.
    if (of_.frame_.camera.linear ? !parts_.empty() : !square_on_facet(facet.weights, at_, high).touches)
        return;
    Part part{&facet, std::vector<Triangles>(kLevels + 2)};
    const SquareRays rays(facet.rays, at_, high);
    if (rays.has_rays())
        part.triangles[0] = of_.triangles_before(rays, {facet.rays.centre, at_, mixes_optics_});
    parts_.push_back(std::move(part));
}

std::pair<bool, bool> CoverageBounder::Pixel::see(const Vec2& low, int level) {
    const Vec2 high = low + Vec2(std::ldexp(1.0, -level));
    bool sure = true, possible = false, in_one = false, any = false, is_held = false;
    std::vector<OpenEdge> open;
    for (Part& part : parts_) {
        Triangles& kept = part.triangles[static_cast<std::size_t>(level) + 1];
        kept.clear();
        if (in_one) continue;
        const OnFacet on = of_.frame_.camera.linear ? OnFacet{true, true, 0}
                                                    : square_on_facet(part.facet->weights, low, high);
        if (!on.touches) continue;
        const SquareRays rays(part.facet->rays, low, high);
        const Triangles& before = part.triangles[static_cast<std::size_t>(level)];
        any = true;
        if (!rays.has_rays()) {
            kept = before;
            sure = false;
            possible = true;
            continue;
        }
        const SquareSight sight = see_first(rays, of_.reach_, before, kept);
        const bool may_see =
            shown_ == kNone ? !sight.is_closed
                            : std::any_of(kept.begin(), kept.end(),
                                          [&](const SquareTriangle& one) { return one.surface == shown_; });
        sure = sure && sight.is_sure && sight.surface == shown_;
        possible = possible || may_see;
        in_one = on.lies_in;
        is_held = is_held || holds_place(part.facet->weights, low, high);
        const std::array<Vec3, 3>& corner = part.facet->corner;
        for (std::size_t k = 0; k < 3; ++k) {
            if (!(on.open >> k & 1)) continue;
            const Vec3 &from = corner[(k + 1) % 3], &to = corner[(k + 2) % 3];
            open.push_back(part.facet->turned ? OpenEdge{to, from} : OpenEdge{from, to});
        }
    }
    if (!any) return {shown_ == kNone, shown_ == kNone};
    // Between facets there may be places without a ray.
    if (!in_one && shown_ == kNone)
        possible = true;
    else if (!in_one)
        sure = sure && is_held && are_paired(open);
    return {sure, possible};
}

void CoverageBounder::Pixel::divide(const Vec2& low, int level) {
    const auto [sure, possible] = see(low, level);
    const int cells = 1 << 2 * (kLevels - level);
    if (sure) sure_ += cells;
    if (sure || !possible || level == kLevels) {
        possible_ += possible || sure ? cells : 0;
        return;
    }
    const double half = std::ldexp(1.0, -level - 1);
    for (int quarter = 0; quarter < 4; ++quarter)
        divide(low + half * Vec2(quarter & 1, quarter >> 1), level + 1);
}

CoverageBounds CoverageBounder::bound_pixel(const Vec2& at, Id shown, std::span<const Id> facets,
                                            const BlockSight* around) const {
    Pixel pixel(*this, at, shown);
    if (around) {
        pixel.take(*around);
        return pixel.bounds();
    }
    for (const Id f : facets) {
        const CameraFacet& facet = facets_[f];
        if (frame_.camera.linear || facet.touches(at, at + Vec2(1))) pixel.add_facet(facet);
    }
    return pixel.bounds();
}

/// The facet that a square lies in; null: several, or none.
const CoverageBounder::CameraFacet* CoverageBounder::facet_around(const Vec2& low, const Vec2& high,
                                                                  std::span<const Id> facets) const {
    for (const Id f : facets) {
        const CameraFacet& facet = facets_[f];
        if (frame_.camera.linear) return &facet;
        if (facet.low.x <= low.x && facet.high.x >= high.x && facet.low.y <= low.y &&
            facet.high.y >= high.y && square_on_facet(facet.weights, low, high).lies_in)
            return &facet;
    }
    return nullptr;
}

/// What a block's rays may meet, where they are of one facet and its pixels are in the window of one optic,
/// or in none's.
std::optional<CoverageBounder::BlockSight> CoverageBounder::meet_block(const Vec2& at, double size,
                                                                       std::span<const Id> facets) const {
    bool is_in_one = false;
    for (const SampleGrid& window : windows_) {
        if (!touches_block(window, at, size)) continue;
        if (is_in_one || !holds_block(window, at, size)) return std::nullopt;
        is_in_one = true;
    }
    BlockSight met{facet_around(at, at + Vec2(size), facets), {}};
    if (!met.facet) return std::nullopt;
    const SquareRays rays(met.facet->rays, at, at + Vec2(size));
    if (!rays.has_rays()) return std::nullopt;
    met.triangles = triangles_before(rays, {met.facet->rays.centre, at, false});
    return met;
}

/// `around`: what the block's rays may see; null: not known.
void CoverageBounder::bound_block(const Vec2& at, double size, const BlockSight* around,
                                  const Wanted& wanted) const {
    const SampleGrid& grid = wanted.grid;
    if (!touches_block(grid, at, size)) return;
    std::optional<BlockSight> met;
    if (!around && size > 1) met = meet_block(at, size, wanted.facets);
    if (met) around = &*met;
    if (size == 1) {
        const std::size_t i = wanted.index(at.x, at.y);
        wanted.bounds[i] = bound_pixel(at, wanted.shown[i], wanted.facets, around);
        return;
    }

    BlockSight kept;
    const BlockSight* within = nullptr;
    if (around) {
        const SquareRays rays(around->facet->rays, at, at + Vec2(size));
        if (rays.has_rays()) {
            const SquareSight sight = see_first(rays, reach_, around->triangles, kept.triangles);
            if (sight.is_sure) {
                wanted.fill(at, size, sight.surface);
                return;
            }
            kept.facet = around->facet;
            within = &kept;
        }
    }
    const double half = size / 2;
    for (int quarter = 0; quarter < 4; ++quarter)
        bound_block(at + half * Vec2(quarter & 1, quarter >> 1), half, within, wanted);
}

void CoverageBounder::bound(const SampleGrid& grid, std::span<const Id> shown,
                            std::span<CoverageBounds> bounds) const {
    const auto first_block = [](int from) { return std::floor(from / kBlock) * kBlock; };
    const auto blocks = [&](int from, int to) {
        return static_cast<std::size_t>(std::ceil((to - first_block(from)) / kBlock));
    };
    const std::size_t columns = blocks(grid.x0, grid.x1), rows = blocks(grid.y0, grid.y1);
    parallel_for(columns * rows, 4, [&](std::size_t first, std::size_t last) {
        std::vector<Id> facets;
        for (std::size_t block = first; block < last; ++block) {
            const Vec2 at(first_block(grid.x0) + kBlock * static_cast<double>(block % columns),
                          first_block(grid.y0) + kBlock * static_cast<double>(block / columns));
            facets.clear();
            for (std::size_t f = 0; f < facets_.size(); ++f)
                if (frame_.camera.linear || facets_[f].touches(at, at + Vec2(kBlock)))
                    facets.push_back(static_cast<Id>(f));
            bound_block(at, kBlock, nullptr, {grid, shown, bounds, facets});
        }
    });
}

}  // namespace trilens
