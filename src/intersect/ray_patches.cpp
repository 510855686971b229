// Facets and their strays, by samples of the surface; a part's at once.
#include "intersect/ray_patches.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "base/util/check.h"

namespace trilens {
namespace {

// How much wider balls around patches are than rounding needs.
constexpr double kBallRoom = 1.000001;

double largest_part(const Vec3& v) {
    return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
}

/// Holds the patch with its stray.
PointBall ball_of(const RayPatch& patch) {
    const Box box = box_of(patch);
    PointBall ball{0.5 * (box.low + box.high)};
    for (const Vec3& corner : patch.corner) ball.radius = std::max(ball.radius, length(corner - ball.middle));
    return {ball.middle, kBallRoom * (ball.radius + patch.stray)};
}

/// The middles of edges, edge k from corner k to the next, and of the facet.
constexpr std::array<Vec3, 4> kStraySamples{Vec3(0.5, 0.5, 0), Vec3(0, 0.5, 0.5), Vec3(0.5, 0, 0.5),
                                            Vec3(1.0 / 3)};

/// How far a place of the surface lies off a facet: to go along the facet, or along the edge that the place
/// belongs to, is not to stray.
class FacetStray {
  public:
    explicit FacetStray(const RayPatch& patch) : patch_(patch), normal_(chord_normal(patch)) {
        for (std::size_t k = 0; k < 3; ++k)
            out_[k] = normalize_or_zero(cross(patch.corner[(k + 1) % 3] - patch.corner[k], normal_));
    }

    /// Takes what stands for that sample; `chord` would, were the patch flat and evenly parameterised.
    void add(std::size_t sample, const Vec3& chord, const Vec3& place) {
        const Vec3 off = place - chord;
        if (normal_ == Vec3(0)) {
            off_plane_ = stray_ = std::max(stray_, length(off));
            return;
        }
        const double off_plane = std::fabs(dot(off, normal_));
        double beyond = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const double over = dot(place - patch_.corner[k], out_[k]);
            beyond = std::max(beyond, k == sample ? std::fabs(over) : over);
        }
        off_plane_ = std::max(off_plane_, off_plane);
        stray_ = std::max(stray_, std::hypot(off_plane, beyond));
    }
    double stray() const { return stray_; }
    double off_plane() const { return off_plane_; }

  private:
    const RayPatch& patch_;
    Vec3 normal_;
    std::array<Vec3, 3> out_;  // of the edges, in the facet's plane
    double stray_ = 0, off_plane_ = 0;
};

/// Where the surface is at the middles of edges, which facets of a grid share.
class EdgeMiddles {
  public:
    template <typename Make>
    const Vec3& of(Id a, Id b, const Make& make) {
        const std::pair<Id, Id> edge = std::minmax(a, b);
        const auto known =
            std::find_if(known_.begin(), known_.end(), [&](const Middle& one) { return one.edge == edge; });
        if (known != known_.end()) return known->place;
        known_.push_back({edge, make()});
        return known_.back().place;
    }

  private:
    struct Middle {
        std::pair<Id, Id> edge;
        Vec3 place;
    };
    std::vector<Middle> known_;  // few
};

RayPatch make_patch_between(const Surface& surface, const SurfaceGrid& grid, std::size_t facet,
                            EdgeMiddles& middles) {
    RayPatch patch;
    patch.face = grid.facet_face[facet];
    patch.uv = grid.facet_uv[facet];
    for (int k = 0; k < 3; ++k) patch.corner[k] = grid.points[grid.corner_point[grid.facets[facet][k]]];

    FacetStray stray(patch);
    for (std::size_t i = 0; i < kStraySamples.size(); ++i) {
        const Vec3& w = kStraySamples[i];
        const Vec3 chord = w.x * patch.corner[0] + w.y * patch.corner[1] + w.z * patch.corner[2];
        const Vec2 uv = w.x * patch.uv[0] + w.y * patch.uv[1] + w.z * patch.uv[2];
        const auto place = [&] { return surface.eval_first_order(patch.face, uv).position; };
        const IdTriple& corners = grid.facets[facet];
        stray.add(i, chord, i < 3 ? middles.of(corners[i], corners[(i + 1) % 3], place) : place());
    }
    for (int k = 0; k < 3; ++k) {
        const Vec2 edge = glm::abs(patch.uv[k] - patch.uv[(k + 1) % 3]);
        patch.size = std::max(patch.size, length(patch.corner[k] - patch.corner[(k + 1) % 3]));
        patch.reach = std::max({patch.reach, edge.x, edge.y});
    }
    if (patch.size > 0) patch.bend = static_cast<float>(kRayStraySafety * stray.off_plane() / patch.size);
    patch.stray = kRayStraySafety * stray.stray() + kSurfaceResidual * largest_part(patch.corner[0]);
    return patch;
}

}  // namespace

RayPatch make_ray_patch(const Surface& surface, const SurfaceGrid& grid, std::size_t facet) {
    EdgeMiddles middles;
    return make_patch_between(surface, grid, facet, middles);
}

Vec3 chord_normal(const RayPatch& patch) {
    return normalize_or_zero(cross(patch.corner[1] - patch.corner[0], patch.corner[2] - patch.corner[0]));
}

Box box_of(const RayPatch& patch) {
    const auto& [a, b, c] = patch.corner;
    return {glm::min(a, glm::min(b, c)) - patch.stray, glm::max(a, glm::max(b, c)) + patch.stray};
}

Box box_of(const Surface& surface) {
    constexpr int kParts = 8;
    const std::unique_ptr<const SurfaceBounder> bounder = surface.make_bounder();
    if (!bounder) return {Vec3(-INFINITY), Vec3(INFINITY)};
    Box box;
    for (Id face = 0; face < surface.face_count(); ++face) {
        for (int i = 0; i < kParts * kParts; ++i) {
            const Vec2 low = Vec2(i % kParts, i / kParts) / double{kParts};
            box.include(bounder->box(face, low, low + 1.0 / kParts));
        }
    }
    return box;
}

// Strays of quads, by those of the facets between their corners.

namespace {

/// A rectangle of parameters, whole and once covered by facets to this share of its area.
constexpr double kWholeRoom = 1e-9;

struct Rectangle {
    Vec2 low{std::numeric_limits<double>::infinity()}, high{-low};

    Vec2 corner(std::size_t k) const {
        return {k == 1 || k == 2 ? high.x : low.x, k == 2 || k == 3 ? high.y : low.y};
    }
    /// Whether the place lies on the side from corner k to the next.
    bool is_on_side(std::size_t k, const Vec2& uv) const {
        const int across = k % 2 == 0 ? 1 : 0;
        return uv[across] == corner(k)[across];
    }
    double area() const { return (high.x - low.x) * (high.y - low.y); }
};

double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
    const Vec3 way = b - a;
    const double squared = dot(way, way);
    const double share = squared > 0 ? std::clamp(dot(p - a, way) / squared, 0.0, 1.0) : 0.0;
    return length(p - (a + share * way));
}

/// Not below the distance to the hull of the corners: that to a point of it, of the bilinear patch between
/// them, near the one whose place in the rectangle is `share`.
double distance_to_hull(const Vec3& p, const std::array<Vec3, PartQuad::kSides>& corner, Vec2 share) {
    const auto along_u = [&](double v) {
        return (1 - v) * (corner[1] - corner[0]) + v * (corner[2] - corner[3]);
    };
    const auto along_v = [&](double u) {
        return (1 - u) * (corner[3] - corner[0]) + u * (corner[2] - corner[1]);
    };
    const auto off_at = [&](const Vec2& at) {
        return p - (corner[0] + at.x * (corner[1] - corner[0]) + at.y * along_v(at.x));
    };
    const Vec3 off = off_at(share), du = along_u(share.y), dv = along_v(share.x);
    const double uu = dot(du, du), uv = dot(du, dv), vv = dot(dv, dv), area = uu * vv - uv * uv;
    const double least = length(off);
    const Vec2 step =
        Vec2(vv * dot(off, du) - uv * dot(off, dv), uu * dot(off, dv) - uv * dot(off, du)) / area;
    if (!std::isfinite(step.x) || !std::isfinite(step.y)) return least;
    return std::min(least, length(off_at(glm::clamp(share + step, 0.0, 1.0))));
}

/// The border from corner c to the next.
void add_side(std::span<const RayPatch> patches, const Rectangle& all, std::size_t c, PartQuad& quad) {
    const Vec3 &first = quad.corner[c], &last = quad.corner[(c + 1) % PartQuad::kSides];
    const int along = c % 2 == 0 ? 0 : 1;
    std::map<double, Vec3> places;
    for (const RayPatch& patch : patches)
        for (std::size_t k = 0; k < 3; ++k) {
            if (!all.is_on_side(c, patch.uv[k])) continue;
            places.emplace(c < 2 ? patch.uv[k][along] : -patch.uv[k][along], patch.corner[k]);
            quad.border =
                std::max(quad.border, patch.stray + distance_to_segment(patch.corner[k], first, last));
            quad.outline_stray = std::max(quad.outline_stray, patch.stray);
        }
    places.erase(std::prev(places.end()));  // the next side's first
    for (const auto& [place, point] : places) quad.outline.push_back(point);
}

}  // namespace

PartQuad make_part_quad(std::span<const RayPatch> patches) {
    Rectangle all;
    double covered = 0;
    for (const RayPatch& patch : patches) {
        for (const Vec2& uv : patch.uv) all.low = glm::min(all.low, uv), all.high = glm::max(all.high, uv);
        covered += 0.5 * std::fabs(cross(patch.uv[1] - patch.uv[0], patch.uv[2] - patch.uv[0]));
    }
    PartQuad quad;
    if (patches.empty() || !(std::fabs(covered - all.area()) <= kWholeRoom * all.area())) return quad;
    for (std::size_t f = 0; f < patches.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k)
            for (std::size_t c = 0; c < PartQuad::kSides; ++c)
                if (patches[f].uv[k] == all.corner(c)) quad.corner[c] = patches[f].corner[k];
    for (std::size_t c = 0; c < PartQuad::kSides; ++c)
        quad.side[c] = length(quad.corner[(c + 1) % PartQuad::kSides] - quad.corner[c]);

    quad.border = quad.stray = 0;
    for (const RayPatch& patch : patches)
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec2 share = (patch.uv[k] - all.low) / (all.high - all.low);
            quad.stray =
                std::max(quad.stray, patch.stray + distance_to_hull(patch.corner[k], quad.corner, share));
        }
    for (std::size_t c = 0; c < PartQuad::kSides; ++c) add_side(patches, all, c, quad);
    return quad;
}

bool surely_meets(const PartQuad& quad, const RayFrame& frame, double from, double to) {
    if (quad.outline.empty()) return false;
    for (const Vec3& corner : quad.corner) {
        const double z = dot(frame.z, corner - frame.origin);
        if (!(z - quad.stray > from && z + quad.stray < to)) return false;
    }
    const auto seen = [&](const Vec3& place) {
        const Vec3 local = place - frame.origin;
        return Vec2(dot(frame.x, local), dot(frame.y, local));
    };
    int turns = 0;
    Vec2 a = seen(quad.outline.back());
    for (const Vec3& place : quad.outline) {
        const Vec2 b = seen(place), way = b - a;
        const double squared = dot(way, way);
        const double share = squared > 0 ? std::clamp(-dot(a, way) / squared, 0.0, 1.0) : 0.0;
        const Vec2 nearest = a + share * way;
        if (!(dot(nearest, nearest) > quad.outline_stray * quad.outline_stray)) return false;
        const bool up = a.y <= 0 && b.y > 0, down = a.y > 0 && b.y <= 0;
        if (up && cross(a, b) > 0) ++turns;
        if (down && cross(a, b) < 0) --turns;
        a = b;
    }
    return turns != 0;
}

const PartPatches::Part& PartPatches::make(Id part) const {
    const SurfaceGrid grid = grid_(part);
    TRILENS_CHECK(grid.facets.size() <= kMostOfPart, "a part has few facets");
    auto made = std::make_unique<Part>();
    const std::size_t count = grid.facets.size();
    made->patches.reserve(count);
    made->balls = PatchBalls(count);
    EdgeMiddles middles;
    for (std::size_t f = 0; f < count; ++f) {
        made->patches.push_back(make_patch_between(surface_, grid, f, middles));
        made->balls.set(f, ball_of(made->patches.back()));
    }
    made->quad = make_part_quad(made->patches);
    // Another thread may have made the same meanwhile.
    const Part* known = nullptr;
    if (parts_[part].compare_exchange_strong(known, made.get())) return *made.release();
    return *known;
}

}  // namespace trilens
