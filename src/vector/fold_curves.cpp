// Marching squares over samples, each crossing refined on the facets' own rays.
#include "vector/caustic.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "base/raymesh/sample_grid.h"
#include "base/util/error.h"
#include "base/util/parallel.h"

namespace trilens {
namespace {

constexpr double kRounding = 1e-10;  // of the product of the vectors' lengths, a determinant has no sign
constexpr double kFound = 1e-6;      // pixels: how near a crossing is found
constexpr double kJump = 1e-3;       // of the ray's length: what is seen on the two sides of a fold is nearer

/// What a facet shows at a place of the film.
struct Shown {
    int side = 0;       // the orientation; 0: none is known
    Id object = kNone;  // kNone: the environment
    Vec3 point{0};      // in the environment the unit direction
    double way = 1;     // from the ray's origin
};

/// The sign of the determinant of the film's map to the points at t, or for no t to the directions.
int orientation(const Vec3& direction, const RaySlope& slope, std::optional<double> t) {
    const Vec3 x = t ? slope.origin_x + *t * slope.direction_x : slope.direction_x;
    const Vec3 y = t ? slope.origin_y + *t * slope.direction_y : slope.direction_y;
    const double size = length(direction), longest = std::max(length(x), length(y));
    const double area = triple(direction, x, y);
    if (!(std::fabs(area) > kRounding * size * longest * longest)) return 0;
    if (!t && longest <= kRounding * size) return 0;  // directions that are alike but for rounding
    return area > 0 ? 1 : -1;
}

using Crossing = std::pair<std::size_t, int>;  // a sample, and 0: the edge to its right, 1: below

class FoldFinder {
  public:
    explicit FoldFinder(const FoldView& view)
        : view_(view), lattice_{view.grid}, slope_(corner_slopes(view.mesh)) {}

    std::vector<FoldCurve> find();

  private:
    struct Found {
        Id object = kNone;
        Vec2 at{0};
        Vec3 place{0};  // what is seen there
    };

    Shown shown(Id facet, const Vec2& at) const;
    Shown shown_near(const std::array<Id, 2>& facets, const Vec2& at) const;
    std::optional<Found> cross(std::size_t from, std::size_t to) const;
    void look_at_samples();
    void find_crossings();
    void join_crossings();
    std::vector<FoldCurve> walk();

    const FoldView& view_;
    SampleLattice lattice_;
    std::vector<RaySlope> slope_;  // per corner of the mesh
    std::vector<Shown> at_sample_;
    std::map<Crossing, Found> crossings_;
    std::map<Crossing, std::vector<Crossing>> joined_;
};

Shown FoldFinder::shown(Id facet, const Vec2& at) const {
    const FacetWeights weights = facet_weights(view_.mesh, facet);
    Shown what;
    if (weights.edge_on) return what;
    const Vec3 e = weights.unnormalised(at.x, at.y), share = e / (e.x + e.y + e.z);
    const Ray ray = interpolated_ray(view_.mesh, facet, share);
    const Hit hit = view_.first_hit(ray);
    std::optional<double> t;
    if (hit.seen()) {
        t = hit.t;
        what.object = view_.object_of(hit.triangle);
        what.point = ray.origin + hit.t * ray.direction;
        what.way = hit.t * length(ray.direction);
    } else {
        what.point = normalize_or_zero(ray.direction);
    }
    RaySlope slope;
    for (int k = 0; k < 3; ++k)
        slope.add(slope_[view_.mesh.facets[facet][static_cast<std::size_t>(k)]], share[k]);
    what.side = orientation(ray.direction, slope, t);
    return what;
}

/// By the one of two facets in which the place lies, or by the nearer one.
Shown FoldFinder::shown_near(const std::array<Id, 2>& facets, const Vec2& at) const {
    if (facets[0] == facets[1]) return shown(facets[0], at);
    std::array<double, 2> least{};
    for (std::size_t i = 0; i < 2; ++i) {
        const Vec3 e = facet_weights(view_.mesh, facets[i]).unnormalised(at.x, at.y);
        least[i] = std::min({e.x, e.y, e.z}) / (e.x + e.y + e.z);
    }
    return shown(facets[least[1] > least[0] ? 1 : 0], at);
}

/// The change of orientation between two samples; none where there is none.
std::optional<FoldFinder::Found> FoldFinder::cross(std::size_t from, std::size_t to) const {
    Shown near = at_sample_[from], far = at_sample_[to];
    if (near.side * far.side >= 0 || near.object != far.object) return std::nullopt;
    const std::array<Id, 2> facets{view_.facet[from], view_.facet[to]};
    Vec2 a = view_.grid.position(from), b = view_.grid.position(to);
    while (length(b - a) > kFound) {
        const Vec2 middle = 0.5 * (a + b);
        const Shown there = shown_near(facets, middle);
        if (there.side == 0) {
            if (there.object != near.object) return std::nullopt;
            a = b = middle, near = far = there;
        } else if (there.side == near.side) {
            a = middle, near = there;
        } else {
            b = middle, far = there;
        }
    }
    const bool jumps = length(near.point - far.point) > kJump * std::max(near.way, far.way);
    if (near.object != far.object || jumps) return std::nullopt;
    return Found{near.object, 0.5 * (a + b), near.point};
}

void FoldFinder::look_at_samples() {
    at_sample_.resize(view_.grid.size());
    parallel_for(at_sample_.size(), 256, [&](std::size_t from, std::size_t to) {
        for (std::size_t s = from; s < to; ++s)
            if (view_.facet[s] != kNone && view_.mesh.has_rays(view_.facet[s]))
                at_sample_[s] = shown(view_.facet[s], view_.grid.position(s));
    });
}

void FoldFinder::find_crossings() {
    for (int row = 0; row < lattice_.rows(); ++row)
        for (int column = 0; column < lattice_.columns(); ++column)
            for (int down = 0; down < 2; ++down) {
                if (!lattice_.holds(column + 1 - down, row + down)) continue;
                const std::size_t from = lattice_.sample(column, row),
                                  to = lattice_.sample(column + 1 - down, row + down);
                if (const auto found = cross(from, to)) crossings_[{from, down}] = *found;
            }
}

/// The crossings on the border of each square of four samples, in pairs.
void FoldFinder::join_crossings() {
    for (int row = 0; row + 1 < lattice_.rows(); ++row)
        for (int column = 0; column + 1 < lattice_.columns(); ++column) {
            const std::size_t here = lattice_.sample(column, row);
            // In turn: above, right, below, left.
            const std::array<Crossing, 4> border{
                Crossing{here, 0}, Crossing{lattice_.sample(column + 1, row), 1},
                Crossing{lattice_.sample(column, row + 1), 0}, Crossing{here, 1}};
            std::vector<Crossing> found;
            for (const Crossing& one : border)
                if (crossings_.count(one)) found.push_back(one);
            // Four: two curves pass; neighbours on the border are joined round two opposite samples.
            for (std::size_t i = 0; i + 1 < found.size(); i += 2) {
                joined_[found[i]].push_back(found[i + 1]);
                joined_[found[i + 1]].push_back(found[i]);
            }
        }
}

/// Open curves first, then closed ones, each from its first crossing in order.
std::vector<FoldCurve> FoldFinder::walk() {
    std::vector<FoldCurve> curves;
    const auto follow = [&](Crossing at) {
        const Found& start = crossings_.at(at);
        FoldCurve curve{start.object, {start.at}, {start.place}};
        while (!joined_[at].empty()) {
            const Crossing next = joined_[at].front();
            joined_[at].erase(joined_[at].begin());
            std::vector<Crossing>& back = joined_[next];
            back.erase(std::find(back.begin(), back.end(), at));
            const Found& here = crossings_.at(next);
            curve.points.push_back(here.at);
            // Where it passes on to another object, each part keeps to its own.
            if (here.object == curve.object) curve.places.push_back(here.place);
            if (here.object != curve.object) {
                curve.places.push_back(curve.places.back());
                curves.push_back(std::move(curve));
                curve = {here.object, {here.at}, {here.place}};
            }
            at = next;
        }
        if (curve.points.size() > 1) curves.push_back(std::move(curve));
    };
    for (const auto& [at, next] : crossings_)
        if (joined_[at].size() == 1) follow(at);
    for (const auto& [at, next] : crossings_)
        if (!joined_[at].empty()) follow(at);
    return curves;
}

std::vector<FoldCurve> FoldFinder::find() {
    look_at_samples();
    find_crossings();
    join_crossings();
    return walk();
}

}  // namespace

std::vector<FoldCurve> fold_curves(const FoldView& view) {
    check_sample_grid(view.grid);
    check_facet_corners(view.mesh);
    if (view.facet.size() != view.grid.size())
        throw InputError("", "facet", "has not one entry per sample of the grid");
    for (const Id facet : view.facet)
        if (facet != kNone && facet >= view.mesh.facets.size())
            throw InputError("", "facet", "names a facet that the mesh does not have");
    if (!view.first_hit || !view.object_of) throw UsageError("fold curves need to see what rays hit");
    return FoldFinder(view).find();
}

}  // namespace trilens
