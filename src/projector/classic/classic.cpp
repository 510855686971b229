#include "projector/classic/classic.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "base/util/check.h"
#include "base/util/parallel.h"
#include "projector/scene/bvh.h"
#include "trilinear/outline.h"

namespace trilens {

// The classic engine: every facet projects the triangles it may image, and fills their outlines into its own
// samples.

namespace {

/// Outlines reach this far, in weights, over the facet's border, so that no sample on it is lost to rounding.
/// It is harmless: the facet draws into its own samples only.
constexpr double kOverhang = 1e-8;

/// Arcs are never drawn finer than this, in weights.
constexpr double kFinestTolerance = 1e-9;

/// A triangle at a sample.
struct Candidate {
    std::size_t place = 0;
    LineHit hit;
    Id index = 0;  // into PreparedScene::Data
};

/// The smallest singular value of the weights' derivative by the screen's x and y: how little they change per
/// pixel.
double least_change(const FacetWeights& weights, const Vec3& e) {
    const double sum = e.x + e.y + e.z;
    const auto derivative = [&](const Vec3& column) {
        return (column - (column.x + column.y + column.z) / sum * e) / sum;
    };
    const Vec3 by_x = derivative(weights.weights_from_screen[0]);
    const Vec3 by_y = derivative(weights.weights_from_screen[1]);
    const double xx = dot(by_x, by_x), yy = dot(by_y, by_y), xy = dot(by_x, by_y);
    return std::sqrt(std::max(0.0, (xx + yy - std::hypot(xx - yy, 2 * xy)) / 2));
}

/// The ray's hit of the triangle's plane. Beside the triangle, where coarse outlines reach, or behind
/// the ray's origin: the triangle's point with the nearest barycentrics, at the depth of its foot on the ray.
LineHit hit_on_triangle(const TrilinearFacet& facet, const SceneTriangle& triangle, const Vec3& weights) {
    const std::optional<ImageVertex> hit = plane_hit(facet, triangle, weights);
    const bool beside =
        !hit || !(std::min({hit->barycentric.x, hit->barycentric.y, hit->barycentric.z}) >= 0);
    if (!beside && hit->t >= 0) return {hit->t, {hit->barycentric.y, hit->barycentric.z}};
    Vec3 share = hit ? glm::max(hit->barycentric, Vec3(0)) : Vec3(1);
    share /= share.x + share.y + share.z;
    if (!std::isfinite(share.x + share.y + share.z)) share = Vec3(1.0 / 3);
    const Vec3 direction = facet.direction(weights);
    const double t =
        dot(triangle.point(share) - facet.origin(weights), direction) / dot(direction, direction);
    return {t > 0 ? t : 0, {share.y, share.z}};
}

/// A border vertex, moved a little out of the facet.
Vec3 with_overhang(Vec3 weights) {
    for (int k = 0; k < 3; ++k) {
        if (weights[k] == 0) weights[k] = -kOverhang;
    }
    return weights / (weights.x + weights.y + weights.z);
}

class FacetDrawing {
  public:
    FacetDrawing(const PreparedScene::Data& scene, const RayMesh& mesh, std::size_t facet,
                 const SampleRows& rows, const ClassicParams& params);

    void draw();
    /// The first triangle at each place.
    std::vector<Hit> hits() const;

  private:
    static double least_depth(const std::vector<Vec3>& weights, const std::array<Vec3, 3>& screen);
    void draw_triangle(Id index);
    void keep_inside(const SceneTriangle& triangle, Id index);

    const PreparedScene::Data& scene_;
    const SampleRows& rows_;
    TrilinearFacet facet_;
    std::array<Vec3, 3> screen_{};
    std::vector<Vec3> weights_;  // of each place
    ShapeParams shape_;
    std::optional<PolygonFiller> filler_;
    std::vector<Candidate> candidate_;
};

FacetDrawing::FacetDrawing(const PreparedScene::Data& scene, const RayMesh& mesh, std::size_t facet,
                           const SampleRows& rows, const ClassicParams& params)
    : scene_(scene), rows_(rows), facet_(trilinear_facet(mesh, facet)) {
    for (std::size_t k = 0; k < 3; ++k) screen_[k] = mesh.screen[mesh.facets[facet][k]];

    // Weights of the samples; how far a pixel is in weights where that is least.
    const FacetWeights on_screen = facet_weights(mesh, facet);
    double change = std::numeric_limits<double>::infinity();
    weights_.reserve(rows.size());
    for (const SampleRows::Row& row : rows.row) {
        for (std::size_t place = row.first; place < row.end; ++place) {
            const Vec3 e = on_screen.unnormalised(rows.x[place], row.y);
            weights_.push_back(e / (e.x + e.y + e.z));
            change = std::min(change, least_change(on_screen, e));
        }
    }
    shape_ = {params.curves, params.clip, params.pieces,
              std::max(kFinestTolerance, params.tolerance * change)};
    filler_.emplace(rows, least_depth(weights_, screen_));
}

/// Half the smallest depth at a sample in front of the camera.
double FacetDrawing::least_depth(const std::vector<Vec3>& weights, const std::array<Vec3, 3>& screen) {
    double least = std::numeric_limits<double>::infinity();
    for (const Vec3& w : weights) {
        const double depth = w.x * screen[0].z + w.y * screen[1].z + w.z * screen[2].z;
        if (depth > 0) least = std::min(least, depth);
    }
    return least / 2;
}

void FacetDrawing::draw() {
    if (shape_.clip == Clip::kUnclipped) {
        for (std::size_t i = 0; i < scene_.size(); ++i) draw_triangle(static_cast<Id>(i));
        return;
    }
    const FacetFrustum frustum(facet_);
    std::vector<Id> waiting;
    const Bvh& bvh = scene_.bvh();
    if (!bvh.nodes.empty()) waiting.push_back(0);
    while (!waiting.empty()) {
        const BvhNode& node = bvh.nodes[waiting.back()];
        waiting.pop_back();
        if (frustum.misses({node.box.low - frustum.centre(), node.box.high - frustum.centre()})) continue;
        for (Id i = node.first; i < node.first + node.count; ++i) draw_triangle(bvh.order[i]);
        if (node.count == 0) waiting.insert(waiting.end(), {node.first, node.first + 1});
    }
}

void FacetDrawing::draw_triangle(Id index) {
    SceneTriangle triangle;
    for (std::size_t k = 0; k < 3; ++k) triangle.corner[k] = scene_.corner(k, index, Vec3(0));
    ScreenPolygon polygon;
    for (const Outline& outline : project_triangle(facet_, triangle, shape_)) {
        polygon.clear();
        for (const ImageVertex& vertex : outline.vertex) {
            const Vec3 w = shape_.clip == Clip::kUnclipped ? vertex.weights : with_overhang(vertex.weights);
            polygon.push_back(w.x * screen_[0] + w.y * screen_[1] + w.z * screen_[2]);
        }
        filler_->add(polygon);
        // The pieces of a tessellated triangle may overlap once their sides are straight.
        if (shape_.curves == Curves::kTessellate) keep_inside(triangle, index);
    }
    keep_inside(triangle, index);
}

void FacetDrawing::keep_inside(const SceneTriangle& triangle, Id index) {
    filler_->fill([&](std::size_t first, std::size_t end) {
        for (std::size_t place = first; place < end; ++place)
            candidate_.push_back({place, hit_on_triangle(facet_, triangle, weights_[place]), index});
    });
}

std::vector<Hit> FacetDrawing::hits() const {
    std::vector<double> nearest(rows_.size(), std::numeric_limits<double>::infinity());
    for (const Candidate& c : candidate_) nearest[c.place] = std::min(nearest[c.place], c.hit.t);
    std::vector<const Candidate*> first(rows_.size(), nullptr);
    for (const Candidate& c : candidate_) {
        if (!(c.hit.t <= nearest[c.place] * (1 + kDepthTie))) continue;
        const Candidate*& best = first[c.place];
        if (!best || scene_.rank(c.index) < scene_.rank(best->index)) best = &c;
    }
    std::vector<Hit> hits(rows_.size());
    for (std::size_t place = 0; place < hits.size(); ++place) {
        if (first[place]) hits[place] = scene_hit(scene_, first[place]->index, first[place]->hit);
    }
    return hits;
}

}  // namespace

void draw_classic(const PreparedScene& scene, const RayMesh& mesh, const FacetSamples& owned,
                  const SampleGrid& grid, std::span<Hit> hits, const ClassicParams& params) {
    TRILENS_CHECK(hits.size() == grid.size(), "one hit per sample of the grid");
    TRILENS_CHECK(owned.first.size() == mesh.facets.size() + 1,
                  "the samples must be grouped by the mesh's facets");
    TRILENS_CHECK(params.pieces >= 1 && params.tolerance > 0, "outlines need a piece and a tolerance");
    parallel_for(mesh.facets.size(), 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t f = from; f < to; ++f) {
            if (!mesh.has_rays(f) || owned.of(f).empty() || facet_weights(mesh, f).edge_on) continue;
            const SampleRows rows = make_sample_rows(owned.of(f), grid);
            FacetDrawing drawing(scene.data(), mesh, f, rows, params);
            drawing.draw();
            const std::vector<Hit> found = drawing.hits();
            for (std::size_t place = 0; place < rows.size(); ++place) hits[rows.sample[place]] = found[place];
        }
    });
}

// Fills polygons row by row: every side notes where it crosses the rows of samples, and pairs of crossings
// are runs.

namespace {

/// The point at `depth` between a nearer and a farther vertex.
Vec3 at_depth(const Vec3& nearer, const Vec3& farther, double depth) {
    return farther + (farther.z - depth) / (farther.z - nearer.z) * (nearer - farther);
}

}  // namespace

SampleRows make_sample_rows(std::span<const Id> samples, const SampleGrid& grid) {
    std::vector<Vec2> position(samples.size());
    for (std::size_t s = 0; s < samples.size(); ++s) position[s] = grid.position(samples[s]);
    std::vector<std::size_t> order(samples.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    if (grid.side > 1) {
        std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
            return std::pair(position[a].y, position[a].x) < std::pair(position[b].y, position[b].x);
        });
    }
    SampleRows rows;
    for (const std::size_t s : order) {
        if (rows.row.empty() || rows.row.back().y != position[s].y)
            rows.row.push_back({position[s].y, rows.size(), rows.size()});
        rows.sample.push_back(samples[s]);
        rows.x.push_back(position[s].x);
        rows.row.back().end = rows.size();
    }
    return rows;
}

void PolygonFiller::add_side(const Vec2& a, const Vec2& b) {
    const bool down = std::pair(a.y, a.x) < std::pair(b.y, b.x);
    const Vec2 &top = down ? a : b, &bottom = down ? b : a;
    const auto before = [](const SampleRows::Row& row, double y) { return row.y < y; };
    auto row = std::lower_bound(rows_.row.begin(), rows_.row.end(), top.y, before);
    for (; row != rows_.row.end() && row->y < bottom.y; ++row) {
        const double share = (row->y - top.y) / (bottom.y - top.y);
        crossing_.push_back(
            {static_cast<std::size_t>(row - rows_.row.begin()), top.x + share * (bottom.x - top.x)});
    }
}

void PolygonFiller::add(const ScreenPolygon& polygon) {
    flat_.clear();
    const auto push = [&](const Vec3& v) { flat_.push_back({v.x / v.z, v.y / v.z}); };
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3 &v = polygon[i], &next = polygon[(i + 1) % polygon.size()];
        const bool in = v.z >= least_depth_, next_in = next.z >= least_depth_;
        if (in) push(v);
        if (in != next_in) push(in ? at_depth(next, v, least_depth_) : at_depth(v, next, least_depth_));
    }
    for (std::size_t i = 0; i < flat_.size(); ++i) add_side(flat_[i], flat_[(i + 1) % flat_.size()]);
}

void PolygonFiller::fill(const std::function<void(std::size_t first, std::size_t end)>& body) {
    std::sort(crossing_.begin(), crossing_.end(), [](const Crossing& a, const Crossing& b) {
        return a.row != b.row ? a.row < b.row : a.x < b.x;
    });
    // Closed polygons cross every row an even number of times.
    for (std::size_t i = 0; i + 1 < crossing_.size(); i += 2) {
        const SampleRows::Row& row = rows_.row[crossing_[i].row];
        const auto place = [&](double x) {
            const auto begin = rows_.x.begin() + static_cast<std::ptrdiff_t>(row.first),
                       end = rows_.x.begin() + static_cast<std::ptrdiff_t>(row.end);
            return static_cast<std::size_t>(std::lower_bound(begin, end, x) - rows_.x.begin());
        };
        const std::size_t first = place(crossing_[i].x), end = place(crossing_[i + 1].x);
        if (first < end) body(first, end);
    }
    crossing_.clear();
}

namespace {

// A plane is trusted only beyond this share of the coordinates involved. Rounding in the planes, the boxes
// and the decision who is hit stays below 64 units in the last place of them (1.4e-14).
constexpr double kSlack = 1e-13;
// Rounding of the dot product of two unit vectors.
constexpr double kRounding = 8 * std::numeric_limits<double>::epsilon();
// A normal further off than this is not the plane of a side.
constexpr double kLargestTurn = 1e-9;

double size_of(const Vec3& v) {
    return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z);
}

double reach(const Box& box) {
    return size_of(glm::max(glm::abs(box.low), glm::abs(box.high)));
}

/// The largest normal . x over the box; at least the computed normal . x of each of its points.
double highest(const Box& box, const Vec3& normal) {
    return std::max(normal.x * box.low.x, normal.x * box.high.x) +
           std::max(normal.y * box.low.y, normal.y * box.high.y) +
           std::max(normal.z * box.low.z, normal.z * box.high.z);
}

}  // namespace

FacetFrustum::FacetFrustum(const TrilinearFacet& facet) : centre_(facet.corner[0].origin) {
    const std::array<Ray, 3>& c = facet.corner;
    const Vec3 o1 = (c[1].origin - centre_) * 0.5, o2 = (c[2].origin - centre_) * 0.5;
    const Vec3 d1 = (c[1].direction - c[0].direction) * 0.5, d2 = (c[2].direction - c[0].direction) * 0.5;
    constexpr std::array<Vec2, 4> kCorners{Vec2{-1, -1}, Vec2{1, -1}, Vec2{1, 1}, Vec2{-1, 1}};
    for (std::size_t k = 0; k < 4; ++k) {
        const double u = kCorners[k].x, v = kCorners[k].y;
        origin_[k] = (o1 + o2) + u * o1 + v * o2;
        direction_[k] = (c[0].direction + d1 + d2) + u * d1 + v * d2;
        unit_direction_[k] = normalize_or_zero(direction_[k]);
        origin_size_ = std::max(origin_size_, size_of(origin_[k]));
    }
    add_axis();

    // The sides: through adjacent directions where the frustum opens or closes, else along the axis.
    for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t next = (k + 1) % 4;
        const Vec3 across = cross(direction_[k], direction_[next]);
        add_plane(across);
        add_plane(-across);
        const Vec3 along = cross(origin_[next] - origin_[k], axis_);
        add_plane(along);
        add_plane(-along);
    }
}

void FacetFrustum::add_axis() {
    for (const Vec3& d : unit_direction_) axis_ += d;
    axis_ = normalize_or_zero(axis_);
    least_cosine_ = 1;
    for (const Vec3& d : unit_direction_) least_cosine_ = std::min(least_cosine_, dot(axis_, d));
    // The axis means something unless a ray goes nearly across it.
    constexpr double kSteep = 0.01;
    if (!(least_cosine_ > kSteep)) least_cosine_ = 0;
    add_plane(axis_);
}

void FacetFrustum::add_plane(const Vec3& normal) {
    Vec3 unit = normalize_or_zero(normal);
    if (unit == Vec3(0)) return;

    // A normal that should be square to two directions misses by rounding; turn it towards the axis by as
    // much.
    double least = 1;
    for (const Vec3& d : unit_direction_) least = std::min(least, dot(unit, d));
    if (least < kRounding) {
        if (!(least > -kLargestTurn && least_cosine_ > 0)) return;
        unit += (kRounding - least) / least_cosine_ * axis_;
    }
    double offset = std::numeric_limits<double>::infinity();
    for (const Vec3& o : origin_) offset = std::min(offset, dot(unit, o));
    plane_[planes_++] = {unit, offset - kSlack * origin_size_};
}

bool FacetFrustum::misses(const Box& box) const {
    const double slack = kSlack * reach(box);
    for (std::size_t k = 0; k < planes_; ++k) {
        if (highest(box, plane_[k].normal) + slack < plane_[k].offset) return true;
    }
    return false;
}

}  // namespace trilens
