#include "paths/facets/one_history.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "intersect/patch_tree.h"
#include "paths/probe/path_probe.h"
#include "reflect/reflection.h"

namespace trilens {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();
/// How far the weight of a path may lie from what its corners' are blended to.
constexpr double kWeightError = 1.0 / 32;
/// Of an optic's size: what touches.
constexpr double kTouch = 1e-8;

double largest_of(const Vec3& v) {
    return std::max({v.x, v.y, v.z});
}

/// The segment of history h at a point of the part; null where it is not seen.
const PathSegment* segment_at(const PathProbe* probe, const std::vector<std::size_t>& match, std::size_t h) {
    return probe && h < match.size() ? &probe->segments[match[h]] : nullptr;
}

/// One history's last stretch at all points of a part.
struct Stretch {
    std::array<const PathSegment*, 3> corner{}, middle{};
    const PathSegment* centre = nullptr;

    /// A quantity of all of them; `turned(k)` of a corner that is turned away.
    template <typename T, typename Value, typename Turned>
    PartSamples<T> each(const Value& value, const Turned& turned) const {
        PartSamples<T> samples;
        for (std::size_t k = 0; k < 3; ++k) samples.corner[k] = corner[k] ? value(*corner[k]) : turned(k);
        if (middle[0] && middle[1] && middle[2])
            samples.middle = std::array<T, 3>{value(*middle[0]), value(*middle[1]), value(*middle[2])};
        if (centre) samples.centre = value(*centre);
        return samples;
    }
    template <typename Act>
    void for_all(const Act& act) const {
        for (const PathSegment* one :
             {corner[0], corner[1], corner[2], middle[0], middle[1], middle[2], centre})
            if (one) act(*one);
    }
};

Stretch stretch_of(const FacetPart& part, std::size_t h) {
    Stretch stretch;
    for (std::size_t k = 0; k < 3; ++k)
        stretch.corner[k] = segment_at(part.corners[k].probe, part.segment[k], h);
    for (std::size_t i = 0; i < part.inside.size(); ++i)
        (i < 3 ? stretch.middle[i] : stretch.centre) =
            segment_at(part.inside[i].at.probe, part.inside[i].segment, h);
    return stretch;
}

/// Whether all rays come to where an optic lies on an object: that is what they see, whatever follows.
bool rests(const Stretch& stretch) {
    bool all = true;
    stretch.for_all([&](const PathSegment& one) { all = all && std::isfinite(one.rest); });
    return all;
}

/// What a beam comes from and goes to.
struct Flight {
    const Beam& beam;
    Id from = kNone;             // the optic where it starts; kNone: the camera
    double leaves = 1;           // sign of direction . normal there
    Id history = kNone;          // that it is the last stretch of; kNone: the camera's
    bool arrives = false;        // its history goes on at an optic
    bool rests = false;          // or ends there, on an object
    Id to = kNone;               // which one; kNone: not known
    Beam::Plane start{}, end{};  // `end` where it arrives
    double far = kEndless;       // along the axis: the farthest place where it arrives
};

/// Whether direction . normal has one sign for all rays of the beam on the patch: 1, -1, or 0 where it has
/// not.
int side_of(const Beam& beam, const SurfacePatch& patch) {
    const double middle = dot(beam.axis(), patch.normal);
    const double room = beam.turn() + patch.normal_radius + beam.turn() * patch.normal_radius;
    return middle > room ? 1 : middle < -room ? -1 : 0;
}

/// Lowest and highest of a piece over a plane.
Interval heights(const Beam::Plane& plane, const Beam::Piece& piece) {
    Interval found{kEndless, -kEndless};
    const double room = piece.stray * length(plane.slope);
    for (const Vec3& corner : piece.corner) {
        const double height = plane.height(corner);
        found.low = std::min(found.low, height - room);
        found.high = std::max(found.high, height + room);
    }
    return found;
}

class Prover {
  public:
    explicit Prover(const HistoryProof& proof) : proof_(proof), world_(*proof.context.world) {}
    bool prove();

  private:
    bool has_one_refraction(const Stretch& stretch) const;
    bool has_one_weight(const Stretch& stretch) const;
    Id next_optic_of(std::size_t h) const;
    bool is_clear(std::size_t h, const Stretch& stretch) const;
    int side_at(Id history, Id optic) const;
    bool camera_arrives() const;
    bool misses_all(const Flight& flight, bool first) const;
    bool misses(const Flight& flight, Id optic, int& arriving) const;
    bool passes(const Flight& flight, Id optic, const SurfacePatch& patch, int& arriving) const;

    const HistoryProof& proof_;
    const PathWorld& world_;
};

/// No colour passes the critical angle: the squared sine of its angle of refraction stays on one side of 1.
bool Prover::has_one_refraction(const Stretch& stretch) const {
    for (int colour = 0; colour < 3; ++colour) {
        const auto sine2 = [&](const PathSegment& segment) { return segment.refraction[colour]; };
        const Interval hull = hull_of(stretch.each<double>(sine2, [](std::size_t) { return 0.0; }));
        if (hull.low < 1 && hull.high >= 1) return false;
    }
    return true;
}

bool Prover::has_one_weight(const Stretch& stretch) const {
    if (!stretch.corner[0] || !stretch.corner[1] || !stretch.corner[2]) return true;
    const auto is_off = [&](const PathSegment* inside, const Vec3& blended) {
        return inside && largest_of(glm::abs(inside->weight - blended)) > kWeightError;
    };
    const Vec3 &a = stretch.corner[0]->weight, &b = stretch.corner[1]->weight, &c = stretch.corner[2]->weight;
    return !is_off(stretch.middle[0], 0.5 * (b + c)) && !is_off(stretch.middle[1], 0.5 * (c + a)) &&
           !is_off(stretch.middle[2], 0.5 * (a + b)) && !is_off(stretch.centre, (a + b + c) / 3.0);
}

/// The side of another optic, one that parts space, on which the beam of a history runs: 1 outside, -1
/// inside, 0 where that is not known.
int Prover::side_at(Id history, Id optic) const {
    const FacetPart& part = proof_.part;
    for (Id s = history; s != kNone; s = part.histories[s].parent) {
        const PathSegment& one = part.histories[s];
        if (one.step.optic != optic) continue;
        const bool is_through = one.step.event != Event::kReflect;
        return one.front == is_through ? -1 : 1;
    }
    const PathOptic& asked = world_.optics[optic];
    if (!asked.mirror) {
        const auto holds = [&](const PartCorner& corner) { return corner.probe->around.holds(optic); };
        const auto inside = std::count_if(part.corners.begin(), part.corners.end(), holds);
        return inside == 0 ? 1 : inside == 3 ? -1 : 0;
    }
    // Nothing goes through a mirror: it is as for the camera's rays.
    const Box box = asked.patches().bounds();
    for (const PartCorner& corner : part.corners)
        if (box.holds(corner.probe->place.point - corner.probe->incident)) return 0;
    return 1;
}

/// A patch that the beam may touch: whether it changes no ray's history. `arriving`: the side on which the
/// beam arrives, once it is known.
bool Prover::passes(const Flight& flight, Id optic, const SurfacePatch& patch, int& arriving) const {
    const Beam::Piece piece{patch.corner, patch.stray};
    const double touch = kTouch * world_.optics[optic].patches().size();
    const int side = side_of(flight.beam, patch);
    if (flight.arrives) {
        const Interval end = heights(flight.end, piece);
        if (end.low > flight.end.room + touch) return true;  // hidden by where the beam arrives
        const bool is_own = optic == flight.from && side != 0 && side == flight.leaves;
        if ((flight.to == kNone || optic == flight.to) && end.high >= -flight.end.room - touch && !is_own) {
            if (flight.rests) return true;
            if (side == 0 || (arriving != 0 && side != arriving)) return false;
            arriving = side;
            return true;
        }
    }
    if (flight.from == kNone) return optic != flight.to;
    const Interval start = heights(flight.start, piece);
    if (start.high < -flight.start.room - touch) return true;  // behind where the beam starts

    // From the side that the beam is on it cannot be met: the side that it left by, or on which it runs. That
    // holds for surfaces that part space, else where the beam starts.
    const PatchTree& tree = world_.optics[optic].patches();
    const bool is_own = optic == flight.from;
    const double unmet = is_own ? flight.leaves : side_at(flight.history, optic);
    if (unmet == 0) return false;
    if (side == unmet && (tree.is_closed() || (is_own && tree.is_height_field()))) return true;
    if (!is_own) return side == unmet && start.low <= flight.start.room + touch;
    return start.low <= flight.start.room + patch.size &&
           (side == unmet || (unmet > 0 ? patch.bends_back : patch.bends_front));
}

/// Whether one optic leaves the flight's history as it is.
bool Prover::misses(const Flight& flight, Id optic, int& arriving) const {
    const PathOptic& asked = world_.optics[optic];
    if (!asked.patches || (asked.convex && optic == flight.from && flight.leaves > 0)) return true;
    const PatchTree& tree = asked.patches();
    return tree.all_of([&](const Box& box) { return flight.beam.may_touch(box, flight.far); },
                       [&](const PatchTree::Item& item) {
                           if (item.patch != kNone) {
                               const SurfacePatch& patch = tree.patches()[item.patch];
                               return !flight.beam.may_touch(Beam::Piece{patch.corner, patch.stray},
                                                             flight.far) ||
                                      passes(flight, optic, patch, arriving);
                           }
                           // A border or a crease counts where the beam arrives; elsewhere the patches beside
                           // it do.
                           if (!flight.arrives || flight.rests || optic != flight.to) return true;
                           const SurfaceRim& rim = tree.rims()[item.rim];
                           const Beam::Piece piece{{rim.end[0], rim.end[1], rim.end[1]}, rim.stray};
                           return !flight.beam.may_touch(piece, flight.far) ||
                                  heights(flight.end, piece).low > flight.end.room ||
                                  heights(flight.end, piece).high < -flight.end.room;
                       });
}

bool Prover::misses_all(const Flight& flight, bool first) const {
    int arriving = 0;
    for (Id optic = 0; optic < world_.optics.size(); ++optic) {
        if (misses(flight, optic, arriving)) continue;
        if (!(first && optic != flight.from && proof_.drawn_over && proof_.drawn_over(optic))) return false;
    }
    return !flight.arrives || flight.to == kNone || !world_.optics[flight.to].patches || arriving != 0;
}

/// The optic that a history goes on to; kNone where nothing of it is followed.
Id Prover::next_optic_of(std::size_t h) const {
    for (const PathSegment& one : proof_.part.histories)
        if (one.parent == h) return one.step.optic;
    return kNone;
}

/// Whether what the history meets after its last event is the same for all rays.
bool Prover::is_clear(std::size_t h, const Stretch& stretch) const {
    const PathSegment& history = proof_.part.histories[h];
    const auto turned = [&](std::size_t k) {
        const PathProbe& probe = *proof_.part.corners[k].probe;
        return Ray{probe.place.point, normalize_or_zero(mirrored(probe.incident, probe.place.normal))};
    };
    const auto rays = stretch.each<Ray>([](const PathSegment& one) { return one.ray; }, turned);
    const std::optional<Beam> beam = Beam::around(rays);
    const bool reflects = history.step.event == Event::kReflect;
    if (!beam) return false;
    Flight flight{*beam, history.step.optic, reflects == history.front ? 1.0 : -1.0, static_cast<Id>(h)};
    const auto origin = [](const PathSegment& one) { return one.ray.origin; };
    flight.start =
        beam->plane_through(stretch.each<Vec3>(origin, [&](std::size_t k) { return turned(k).origin; }));
    flight.rests = rests(stretch);
    if (!history.ends || flight.rests) {
        flight.arrives = true;
        if (!flight.rests) flight.to = next_optic_of(h);
        const auto far = [&](const PathSegment& one) { return flight.rests ? one.rest : one.next; };
        const auto hit = [&](const PathSegment& one) {
            return one.ray.origin + far(one) * one.ray.direction;
        };
        const auto none = [&](std::size_t k) { return turned(k).origin; };
        const auto hits = stretch.each<Vec3>(hit, none);
        flight.end = beam->plane_through(hits);
        const auto along = [&](const PathSegment& one) { return beam->along(hit(one)); };
        flight.far =
            hull_of(stretch.each<double>(along, [](std::size_t) { return 0.0; })).high + flight.end.room;
    }
    return misses_all(flight, history.parent == kNone);
}

/// The camera's rays to the optic itself.
bool Prover::camera_arrives() const {
    PartSamples<Ray> rays;
    PartSamples<Vec3> hits;
    const auto ray_to = [](const PathProbe& probe) {
        return Ray{probe.place.point - probe.incident, probe.incident};
    };
    const FacetPart& part = proof_.part;
    for (std::size_t k = 0; k < 3; ++k) {
        const PathProbe& probe = *part.corners[k].probe;
        if (probe.state != ProbeState::kSeen) return false;
        rays.corner[k] = ray_to(probe);
        hits.corner[k] = probe.place.point;
    }
    if (part.inside.size() == 4) {
        rays.middle.emplace(), hits.middle.emplace();
        for (std::size_t i = 0; i < 4; ++i) {
            const PathProbe& probe = *part.inside[i].at.probe;
            if (probe.state != ProbeState::kSeen) return false;
            (i < 3 ? (*rays.middle)[i] : rays.centre.emplace()) = ray_to(probe);
            (i < 3 ? (*hits.middle)[i] : hits.centre.emplace()) = probe.place.point;
        }
    }
    const std::optional<Beam> beam = Beam::around(rays);
    if (!beam) return false;
    Flight flight{*beam};
    flight.arrives = true;
    flight.to = proof_.context.optic;
    flight.end = beam->plane_through(hits);
    int arriving = 0;
    return misses(flight, flight.to, arriving) && (arriving != 0 || !world_.optics[flight.to].patches);
}

bool Prover::prove() {
    const FacetPart& part = proof_.part;
    if (proof_.from_camera && !camera_arrives()) return false;
    std::vector<char> hidden(part.histories.size(), 0);  // all that follows is
    for (std::size_t h = 0; h < part.histories.size(); ++h) {
        const PathSegment& history = part.histories[h];
        const bool is_hidden = history.parent != kNone && hidden[history.parent];
        const Stretch stretch = stretch_of(part, h);
        hidden[h] = is_hidden || rests(stretch);
        if (is_hidden) continue;
        double light = 0;
        stretch.for_all([&](const PathSegment& one) { light = std::max(light, largest_of(one.weight)); });
        if (!history.principal && light <= kMuchLight * kLeastWeight) continue;
        if (!has_one_refraction(stretch) || !has_one_weight(stretch)) return false;
        if (history.depth < world_.max_depth && !is_clear(h, stretch)) return false;
    }
    return true;
}

}  // namespace

bool rests_on_object(const FacetPart& part, std::size_t h) {
    const Stretch stretch = stretch_of(part, h);
    return stretch.centre && rests(stretch);
}

bool has_one_history(const HistoryProof& proof) {
    return Prover(proof).prove();
}

}  // namespace trilens
