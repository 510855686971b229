#include "surfaces/polynomial/face_parts.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "base/util/parallel.h"

namespace trilens {
namespace {

/// A kind costs about as much as so many faces.
constexpr std::size_t kManyFaces = 16;
/// Where a part that its kind says is a polynomial is held against the face itself.
constexpr Vec2 kCheckedPlace{0.31, 0.27};

std::array<PartShape, 4> quarters(const PartShape& shape, FaceDomain domain) {
    const double half = shape.size / 2;
    const PartShape last = domain == FaceDomain::kSquare ? PartShape{shape.corner + half, half}
                                                         : PartShape{shape.corner + half, -half};
    return {{{shape.corner, half},
             {shape.corner + Vec2(half, 0), half},
             {shape.corner + Vec2(0, half), half},
             last}};
}

/// Halves a face until `keep` takes each part, and takes the last ones whatever they are.
std::vector<PartBranch> branches_of(FaceDomain domain,
                                    const std::function<bool(const PartShape&, bool is_last)>& keep) {
    const double finest = std::ldexp(1, -kFinestPart);
    std::vector<PartBranch> branches(1);
    std::size_t parts = 0;
    for (std::size_t b = 0; b < branches.size(); ++b) {
        const PartShape shape = branches[b].shape;
        branches[b].is_part = keep(shape, std::fabs(shape.size) <= finest);
        branches[b].first = branches[b].is_part ? parts++ : branches.size();
        if (branches[b].is_part) continue;
        for (const PartShape& quarter : quarters(shape, domain)) branches.push_back({quarter});
    }
    return branches;
}

/// The weights of control points 3 f, 3 f + 1 and 3 f + 2 of one face as a surface's face f.
class WeightSurface final : public Surface {
  public:
    WeightSurface(const Surface& of, const HasStencils& stencils, Id face)
        : domain_(of.domain(face)),
          stencils_(stencils),
          face_(face),
          count_(stencils.controls(face).offsets.size()) {}

    std::size_t face_count() const override { return (count_ + 2) / 3; }
    FaceDomain domain(Id) const override { return domain_; }
    SurfacePoint eval(Id group, const Vec2& uv) const override {
        const FaceStencils weights = stencils_.stencils(face_, uv);
        SurfacePoint point;
        for (std::size_t q = 0; q < kQuantities; ++q)
            for (std::size_t k = 0; k < std::min<std::size_t>(3, count_ - 3 * group); ++k)
                (point.*kQuantity[q])[static_cast<int>(k)] = weights[q][3 * group + k];
        return point;
    }

  private:
    FaceDomain domain_;
    const HasStencils& stencils_;
    Id face_;
    std::size_t count_;
};

/// Groups of three control points: the weights' coordinates to the world's, and how much they enlarge.
struct Group {
    Mat3 offsets{0};
    double size = 0;
};

std::vector<Group> groups_of(const std::vector<Vec3>& offsets) {
    std::vector<Group> groups((offsets.size() + 2) / 3);
    for (std::size_t k = 0; k < offsets.size(); ++k)
        groups[k / 3].offsets[static_cast<int>(k % 3)] = offsets[k];
    for (Group& group : groups) {
        for (int k = 0; k < 3; ++k) group.size += dot(group.offsets[k], group.offsets[k]);
        group.size = std::sqrt(group.size);
    }
    return groups;
}

/// The part of a face with these control points.
FacePart summed_part(const std::vector<FacePart>& of_group, const std::vector<Group>& groups,
                     const Vec3& origin) {
    FacePart part;
    part.is_polynomial = true;
    part.shape = of_group.front().shape;
    part.net = of_group.front().net;
    part.net.point.fill(Vec3(0));
    for (std::size_t g = 0; g < groups.size(); ++g) {
        part.origin += groups[g].offsets * of_group[g].origin;
        for (std::size_t k = 0; k < part.net.points().size(); ++k)
            part.net.point[k] += groups[g].offsets * of_group[g].net.point[k];
        for (std::size_t q = 0; q < kQuantities; ++q) part.slack[q] += groups[g].size * of_group[g].slack[q];
    }
    part.origin += origin;
    add_rounding(part);
    return part;
}

}  // namespace

TakenFace take_apart(const Surface& surface, Id face) {
    TakenFace taken;
    taken.branches = branches_of(surface.domain(face), [&](const PartShape& shape, bool is_last) {
        const std::optional<FacePart> part = polynomial_part(surface, face, shape);
        if (part || is_last) taken.parts.push_back(part ? *part : sampled_part(surface, face, shape));
        return part || is_last;
    });
    return taken;
}

FaceTaker::FaceTaker(const Surface& surface)
    : surface_(surface), stencils_(dynamic_cast<const HasStencils*>(&surface)) {
    if (!stencils_) return;
    kind_of_.resize(surface.face_count());
    parallel_for(kind_of_.size(), 16, [&](std::size_t first, std::size_t last) {
        for (std::size_t f = first; f < last; ++f) kind_of_[f] = stencils_->kind(static_cast<Id>(f));
    });
    std::map<std::uint64_t, std::vector<Id>> faces;
    for (std::size_t f = 0; f < kind_of_.size(); ++f)
        if (kind_of_[f]) faces[*kind_of_[f]].push_back(static_cast<Id>(f));
    std::vector<std::pair<Id, Kind*>> wanted;
    for (const auto& [kind, of_kind] : faces)
        if (of_kind.size() >= kManyFaces) wanted.emplace_back(of_kind.front(), &kinds_[kind]);
    parallel_for(wanted.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) *wanted[k].second = take_kind(wanted[k].first);
    });
}

TakenFace FaceTaker::take(Id face) const {
    if (is_of_kind(face))
        if (std::optional<TakenFace> taken = take_by(kinds_.at(*kind_of_[face]), face))
            return std::move(*taken);
    return take_apart(surface_, face);
}

FaceTaker::Kind FaceTaker::take_kind(Id face) const {
    const WeightSurface weights(surface_, *stencils_, face);
    Kind kind;
    kind.branches = branches_of(surface_.domain(face), [&](const PartShape& shape, bool is_last) {
        KindPart made{shape, {}};
        for (Id group = 0; group < weights.face_count(); ++group) {
            std::optional<FacePart> part = polynomial_part(weights, group, shape);
            if (!part) {
                made.of_group.clear();
                break;
            }
            made.of_group.push_back(std::move(*part));
        }
        const bool is_part = !made.of_group.empty() || is_last;
        if (is_part) kind.parts.push_back(std::move(made));
        return is_part;
    });
    return kind;
}

/// None where the face is found to be another than its kind says.
std::optional<TakenFace> FaceTaker::take_by(const Kind& kind, Id face) const {
    const FaceControls controls = stencils_->controls(face);
    const std::vector<Group> groups = groups_of(controls.offsets);
    TakenFace taken;
    taken.by_kind = true;
    taken.branches = kind.branches;
    taken.parts.reserve(kind.parts.size());
    for (const KindPart& known : kind.parts) {
        if (known.of_group.empty()) {
            taken.parts.push_back(sampled_part(surface_, face, known.shape));
            continue;
        }
        if (known.of_group.size() != groups.size()) return std::nullopt;
        taken.parts.push_back(summed_part(known.of_group, groups, controls.origin));
        if (!agrees_at(surface_, face, taken.parts.back(), kCheckedPlace)) return std::nullopt;
    }
    return taken;
}

}  // namespace trilens
