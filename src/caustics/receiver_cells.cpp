#include "caustics/receiver_cells.h"

#include <cmath>
#include <optional>

namespace trilens {
namespace {

constexpr int kCells = 4;          // along each side
constexpr double kInside = 0.998;  // of a footprint's half side: where its corners are asked
constexpr double kEdgeOn = 1e-3;   // cosine of a triangle that is seen edge-on

/// One receiver on what lies under it.
class FootprintOnSurface {
  public:
    FootprintOnSurface(const Receiver& receiver, const ReceivingSurfaces& under)
        : receiver_(receiver),
          under_(under),
          along_(normalize_or_zero(receiver.seen_along)),
          reach_(0.5 * (length(receiver.sides[0]) + length(receiver.sides[1]))) {}

    bool lies_on_one_face() const {
        const Id face = under_.faces.face_of(receiver_.triangle);
        if (face == kNone) return true;
        bool is_held = true, is_one = true;
        for (const double s : {-0.5, 0.5})
            for (const double t : {-0.5, 0.5}) is_held = is_held && under_.faces.holds(face, place(s, t));
        if (is_held) return true;
        for (const double s : {-0.5 * kInside, 0.5 * kInside})
            for (const double t : {-0.5 * kInside, 0.5 * kInside}) {
                const Hit hit = seen_at(s, t);
                is_one = is_one && (!hit.seen() || under_.faces.face_of(hit.triangle) == face);
            }
        return is_one;
    }

    std::optional<Receiver> cell(int column, int row) const {
        const double s = (column + 0.5) / kCells - 0.5, t = (row + 0.5) / kCells - 0.5;
        const Hit hit = seen_at(s, t);
        if (!hit.seen()) return std::nullopt;
        const IdTriple& corner = under_.triangles.triangles[hit.triangle];
        const Vec3& first = under_.triangles.points[corner[0]];
        Vec3 normal = normalize_or_zero(cross(under_.triangles.points[corner[1]] - first,
                                              under_.triangles.points[corner[2]] - first));
        if (dot(normal, along_) > 0) normal = -normal;
        if (!(dot(normal, along_) < -kEdgeOn)) return std::nullopt;
        Receiver cell = receiver_;
        cell.point = position(under_.triangles, hit);
        cell.lifted = cell.point + length(receiver_.lifted - receiver_.point) * normal;
        if (receiver_.shading_normal == receiver_.normal) cell.shading_normal = normal;
        cell.normal = normal;
        cell.triangle = hit.triangle;
        for (Vec3& side : cell.sides) {
            side /= kCells;
            side -= dot(normal, side) / dot(normal, along_) * along_;
        }
        cell.slack = 0.5 * (length(cell.sides[0]) + length(cell.sides[1]));
        return cell;
    }

  private:
    Vec3 place(double s, double t) const {
        return receiver_.point + s * receiver_.sides[0] + t * receiver_.sides[1];
    }

    /// Of the receiver's object, no farther from the footprint than that is wide.
    Hit seen_at(double s, double t) const {
        const Hit hit = under_.tracer.first_hit({place(s, t) - reach_ * along_, along_});
        const std::vector<Id>& object = under_.triangles.object;
        const bool is_own =
            hit.seen() && hit.t <= 2 * reach_ && object[hit.triangle] == object[receiver_.triangle];
        return is_own ? hit : Hit();
    }

    const Receiver& receiver_;
    const ReceivingSurfaces& under_;
    Vec3 along_;
    double reach_ = 0;
};

}  // namespace

std::vector<Receiver> receiver_cells(const Receiver& receiver, const ReceivingSurfaces& under) {
    const bool is_told = receiver.triangle < under.triangles.size() && receiver.seen_along != Vec3(0);
    const double area = length(cross(receiver.sides[0], receiver.sides[1]));
    if (!is_told || !(area > 0) || !std::isfinite(area)) return {};
    const FootprintOnSurface footprint(receiver, under);
    if (footprint.lies_on_one_face()) return {};
    std::vector<Receiver> cells;
    for (int row = 0; row < kCells; ++row)
        for (int column = 0; column < kCells; ++column)
            if (const auto cell = footprint.cell(column, row)) cells.push_back(*cell);
    return cells;
}

}  // namespace trilens
