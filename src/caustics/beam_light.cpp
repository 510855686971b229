#include "caustics/beam_light.h"

#include <algorithm>
#include <cmath>

#include "caustics/flux_ends.h"
#include "caustics/footprint.h"
#include "caustics/plane_beams.h"
#include "caustics/refined_beams.h"

namespace trilens {
namespace {

/// Footprints are no wider than this share of the scene.
constexpr double kWidestFootprint = 0.25;
/// A smooth surface's normal makes light at grazing no brighter than so.
constexpr double kMostTurned = 10;

/// Rays of a beam may fall this many tolerances beside its triangle.
constexpr double kMostBent = 2;

/// A receiver's slack is no more than this share of the way to the last optic.
constexpr double kMostSlack = 0.5;

/// What falls on faces smaller than this share of the scene is looked up beam by beam.
constexpr double kSmallFace = 0.004;

/// Irradiance, the sum of its colours, that a source brings to a place where nothing stands in its way.
double straight_light(const BeamSource& source, const Vec3& place, const Vec3& normal) {
    const Vec3 way = source.is_parallel ? source.direction : place - source.position;
    const double far = length(way), cosine = -dot(way, normal) / far;
    if (!(cosine > 0)) return 0;
    return strength_of(source.strength(way / far)) * cosine / (source.is_parallel ? 1 : far * far);
}

/// Of the making of beams: until windows are divided, and until their borders are found.
constexpr double kDividingShare = 0.2, kBorderShare = 0.6;

}  // namespace

BeamLight::BeamLight(const LightSpace& space, const BeamSource& source, const BeamGridParams& params,
                     const std::vector<std::vector<Vec3>>& outlines, const Progress& progress)
    : space_(space), source_(source), tolerance_(params.tolerance) {
    beams_.divides = space.optics->fresnel;
    std::vector<std::pair<Id, LightWindow>> windows;
    for (std::size_t i = 0; i < outlines.size(); ++i)
        if (!outlines[i].empty())
            for (const LightWindow& window : windows_on(source, outlines[i], space.reach))
                windows.emplace_back(static_cast<Id>(i), window);
    const double share = 1.0 / static_cast<double>(windows.size());
    for (std::size_t w = 0; w < windows.size(); ++w) {
        const double from = (kDividingShare + kBorderShare) * share * static_cast<double>(w);
        BeamGrid grid(space, source, windows[w].second, windows[w].first);
        grid.divide(params, progress.part(from, kDividingShare * share));
        losses_.coarse += grid.coarse_count();
        for (Id corner = 0; corner < grid.corner_count(); ++corner)
            losses_.most = most_cut(losses_.most, grid.cut(corner));
        add_beams(grid, beams_, progress.part(from + kDividingShare * share, kBorderShare * share));
    }
    const double made = kDividingShare + kBorderShare;
    refined_ = std::make_unique<RefinedBeams>(space_, source_, beams_, progress.part(made, 1 - made));
    tree_ = BeamTree(beams_, [&](Id beam) { return refined_->side_middles(beam); });
}

BeamLight::~BeamLight() = default;

void BeamLight::receive_on(std::shared_ptr<const ReceiverFaces> faces) {
    faces_ = std::move(faces);
    on_face_ = std::make_unique<Lazy<PlaneBeams>[]>(2 * faces_->faces().size());
}

/// Whether it is a face that is worth it.
bool BeamLight::gathers_on(const ReceiverSide& on) const {
    return faces_ && on.face != kNone && faces_->faces()[on.face].radius >= kSmallFace * space_.size;
}

double BeamLight::reach_beyond_faces() const {
    return kMostBent * tolerance_ * space_.size;
}

/// None: it lies on no face that is worth it.
const PlaneBeams* BeamLight::plane_beams(const Receiver& receiver) const {
    if (!faces_) return nullptr;
    return plane_beams(faces_->side_of(receiver.triangle, receiver.normal), {{}, receiver.cancel});
}

const PlaneBeams* BeamLight::plane_beams(const ReceiverSide& on, const Progress& progress) const {
    if (!gathers_on(on)) return nullptr;
    const ReceiverFace& face = faces_->faces()[on.face];
    return &on_face_[2 * on.face + on.is_back].get([&] {
        PlaneBeamsParams params;
        params.tolerance = tolerance_ * space_.size;
        params.reach = reach_beyond_faces();
        for (const BeamEnd& end : beams_.ends)
            params.brightest = std::max(params.brightest, strength_of(end.light));
        params.faint_light = kFaintShare * refined_->mean_light();
        params.same_place = kSamePlace * space_.size;
        const Vec3 normal = on.is_back ? -face.normal : face.normal;
        params.is_alone = straight_light(source_, face.center, normal) < refined_->mean_light();
        return std::make_unique<PlaneBeams>(PlaneBeams::Source{beams_, tree_, *refined_}, face, normal,
                                            params, progress);
    });
}

std::size_t BeamLight::count_near(const ReceiverSide& on) const {
    if (is_gathered(on)) return 0;
    const ReceiverFace& face = faces_->faces()[on.face];
    std::size_t count = 0;
    tree_.for_each_near(face.center, face.radius + reach_beyond_faces(), [&](Id) { ++count; });
    return count;
}

void BeamLight::gather(const ReceiverSide& on, const Progress& progress) const {
    plane_beams(on, progress);
}

bool BeamLight::is_gathered(const ReceiverSide& on) const {
    return !gathers_on(on) || on_face_[2 * on.face + on.is_back].find();
}

/// A triangle that falls on a receiver's plane.
struct BeamLight::Piece {
    const LightBeam& beam;
    const BeamCorners& corners;
    const FallenBeam& fallen;
    const ReceiverPlane& plane;
    Way way;  // of the whole beam
};

/// What glass and blended surfaces leave of light on the way from the last optic.
Vec3 BeamLight::left_of(const LightHistory& history, const Vec3& origin, const Receiver& receiver) const {
    const Vec3 left = body_transmittance(*space_.optics, history.medium, length(origin - receiver.point));
    if (!space_.veil) return left;
    const Vec3 way = origin - receiver.lifted;
    const double inset = history.has_start ? 0 : 2 * same_place(origin) / length(way);
    return space_.veil({receiver.lifted, (1 - inset) * way}).through * left;
}

/// Irradiance on the receiver's plane times the cosine that counts; none where nothing comes.
std::optional<Vec3> BeamLight::light_of(const Piece& piece, const FootprintPart& here,
                                        const Receiver& receiver) const {
    Vec3 light(0), weights(0);
    for (int k = 0; k < 3; ++k) {
        const auto c = static_cast<std::size_t>(k);
        light += here.weights[k] * piece.fallen.share[c] * piece.fallen.light[c];
        weights += here.weights[k] * piece.fallen.weights[c];
    }
    const double density = here.density / piece.plane.mean_area;
    if (is_plain(piece, receiver)) return density * light;
    Vec3 origin(0), direction(0);
    for (int k = 0; k < 3; ++k) {
        const BeamEnd& end = *piece.corners.end[static_cast<std::size_t>(k)];
        origin += weights[k] * end.origin, direction += weights[k] * end.direction;
    }
    const double cosine = -dot(receiver.shading_normal, direction);
    if (!(cosine > 0)) return std::nullopt;
    const double geometric = -dot(piece.plane.normal, direction);
    if (piece.way == Way::kUnknown) {
        const double t = dot(origin - piece.plane.point, piece.plane.normal) / geometric;
        const Vec3 there = here.middle ? piece.plane.place(*here.middle) : origin + t * direction;
        const Vec3 lifted = there + (receiver.lifted - receiver.point), way = origin - lifted;
        const double past = std::min(receiver.slack / length(way), kMostSlack);
        if (is_hidden(piece, lifted + past * way, origin)) return std::nullopt;
    }
    light *= left_of(beams_.histories[piece.beam.history], origin, receiver);
    return density * std::min(cosine / geometric, kMostTurned) * light;
}

/// Whether all of its light comes, and counts as it falls on the plane, wherever it comes from.
bool BeamLight::is_plain(const Piece& piece, const Receiver& receiver) const {
    return piece.way == Way::kFree && is_plain(piece.plane, receiver) &&
           beams_.histories[piece.beam.history].medium == kNone;
}

/// Whether that may be so at the receiver.
bool BeamLight::is_plain(const ReceiverPlane& plane, const Receiver& receiver) const {
    return !space_.veil && receiver.shading_normal == plane.normal;
}

/// Calls use(light) for the light of a part of a beam, where that comes.
template <typename Use>
auto BeamLight::part_user(const ReceiverPlane& plane, const Receiver& receiver, const Use& use) const {
    return [&, this](Id index, Way way, const BeamCorners& corners, const FallenBeam& fallen,
                     const FootprintPart& part) {
        if (const auto light = light_of({beams_.beams[index], corners, fallen, plane, way}, part, receiver))
            use(*light);
    };
}

/// Calls use(light) for what arrives by each beam, or each of its exact pieces, or by all of several beams.
template <typename Use>
void BeamLight::for_each_arrival(const Receiver& receiver, const Use& use) const {
    const ReceiverPlane plane(receiver, kWidestFootprint * space_.size);
    if (const PlaneBeams* on_plane = receiver.exact ? nullptr : plane_beams(receiver)) {
        const auto use_part = part_user(plane, receiver, use);
        if (!plane.has_footprint)
            return on_plane->for_each_piece(
                plane, [&](Id index, Way way, const BeamCorners& corners, const FallenBeam& fallen) {
                    if (const auto part = part_at_footprint(fallen, plane))
                        use_part(index, way, corners, fallen, *part);
                });
        return on_plane->for_each_part(
            plane, is_plain(plane, receiver), [&](const Vec3& light) { use(light / plane.unit_area); },
            use_part);
    }
    tree_.for_each_near(receiver.point, plane.reach + (receiver.exact ? reach_beyond_faces() : 0),
                        [&](Id index) { for_each_arrival_of(index, plane, receiver, use); });
}

/// Those of one beam.
template <typename Use>
void BeamLight::for_each_arrival_of(Id index, const ReceiverPlane& plane, const Receiver& receiver,
                                    const Use& use) const {
    Way way = way_to(corners_of(beams_, beams_.beams[index]).end, plane, kSamePlace * space_.size);
    if (way == Way::kStopped) return;
    if (receiver.exact) way = Way::kUnknown;
    const auto use_part = part_user(plane, receiver, use);
    const auto use_one = [&](const BeamCorners& corners, const FallenBeam& fallen) {
        if (const auto part = part_at_footprint(fallen, plane)) use_part(index, way, corners, fallen, *part);
    };
    if (!receiver.exact) return refined_->for_each_curved_piece(index, plane, use_one);
    const double guess = reach_beyond_faces() * std::max(length(plane.dual_s), length(plane.dual_t));
    refined_->for_each_piece(index, plane, guess, use_one);
}

void BeamLight::for_each_flux(const Receiver& receiver, const std::vector<char>& wanted,
                              const std::function<void(Id beam, const Vec3& flux)>& use) const {
    const ReceiverPlane plane(receiver, kWidestFootprint * space_.size);
    if (!plane.has_footprint) return;
    tree_.for_each_near(receiver.point, plane.reach, [&](Id index) {
        if (!wanted[index]) return;
        for_each_arrival_of(index, plane, receiver,
                            [&](const Vec3& light) { use(index, plane.mean_area * light); });
    });
}

/// Whether anything lies between where a piece falls and where it leaves the last optic. That optic itself is
/// not asked so near to it as the piece is wide: its origin may lie a little inside of it. Others are asked
/// up to where the way comes into it there, since they may lie on it, or just inside.
bool BeamLight::is_hidden(const Piece& piece, const Vec3& from, const Vec3& origin) const {
    const Vec3 toward = origin - from;
    Segments way;
    way.add(from, (1 - kSamePlace) * toward);
    if (space_.objects->occluded(way)) return true;
    const Id last = beams_.histories[piece.beam.history].steps.back().optic;
    const double far = length(toward), wide = width_of(piece.corners);
    const LimitTracer& tracer = *space_.optics->optics[last].tracer;
    if (wide < far) {
        Segments before;
        before.add(from, (1 - std::max(wide / far, kSamePlace)) * toward);
        if (tracer.occluded(before, before.all())) return true;
    }
    for (Id i = 0; i < space_.optics->optics.size(); ++i) {
        if (i == last || !space_.optics->optics[i].tracer->occluded(way, way.all())) continue;
        const auto into = tracer.first_hit({from, toward});
        if (!into || into->t >= 1 - kSamePlace) return true;
        Segments outside;
        outside.add(from, (into->t - kSamePlace) * toward);
        if (space_.optics->optics[i].tracer->occluded(outside, outside.all())) return true;
    }
    int met = 0;
    for (const Id e : piece.beam.end) met += beams_.ends[e].optic < (1 - kSamePlace) * far;
    return met == 3;
}

Vec3 BeamLight::irradiance(const Receiver& receiver) const {
    if (receiver.cancel && receiver.cancel->load(std::memory_order_relaxed)) throw Interrupted();
    Vec3 sum(0);
    for_each_arrival(receiver, [&](const Vec3& light) { sum += light; });
    return sum;
}

namespace {

/// Exact arrivals that leave the last optic so near to each other, as a share of the scene's size, are one,
/// whichever window they come through: from there the way back to the light is one.
constexpr double kSameArrival = 1e-7;
/// How near an exact path comes to its point, as a share of the scene's size.
constexpr double kExact = 1e-11;

bool is_known(const std::vector<ExactArrival>& known, const ExactArrival& one, double size) {
    const auto is_same = [&](const ExactArrival& other) {
        return other.single.path.history() == one.single.path.history() &&
               length(other.single.path.ray.origin - one.single.path.ray.origin) < kSameArrival * size;
    };
    return std::any_of(known.begin(), known.end(), is_same);
}

}  // namespace

/// Whether nothing stands in its way.
bool BeamLight::comes(const ExactArrival& arrival, const Receiver& receiver) const {
    const SinglePath& single = arrival.single;
    const double far = length(receiver.point - single.path.ray.origin);
    Segments way;
    way.add(receiver.lifted, (1 - kSamePlace) * (single.path.ray.origin - receiver.lifted));
    if (space_.objects->occluded(way)) return false;
    const auto next =
        next_optic(*space_.optics, {single.path.ray, single.path.steps.back().optic, single.media});
    if (next && next->distance < (1 - kSamePlace) * far) return false;
    return is_free(space_, arrival.from, single);
}

std::vector<ExactArrival> BeamLight::exact_arrivals(const Receiver& receiver) const {
    std::vector<ExactArrival> arrivals;
    Receiver point = receiver;
    point.sides = {};
    ReceiverPlane plane(point, space_.size);
    tree_.for_each_near(receiver.point, kMostBent * tolerance_ * space_.size, [&](Id index) {
        const LightBeam& beam = beams_.beams[index];
        const FallenBeams fallen = fall(corners_of(beams_, beam), plane, INFINITY);
        std::array<Vec2, 3> places;
        for (std::size_t k = 0; k < 3; ++k) places[k] = beams_.ends[beam.end[k]].place;
        const ExactMap map{space_, source_, beams_.windows[beam.window], beams_.histories[beam.history]};
        for (std::size_t i = 0; i < fallen.count; ++i) {
            std::array<Vec2, 3> corners;
            for (std::size_t k = 0; k < 3; ++k)
                corners[k] = fallen.part[i].weights[k].x * places[0] +
                             fallen.part[i].weights[k].y * places[1] +
                             fallen.part[i].weights[k].z * places[2];
            const auto arrival = map.arrive(corners, fallen.part[i], plane, kExact * space_.size);
            if (arrival && !is_known(arrivals, *arrival, space_.size) && comes(*arrival, receiver))
                arrivals.push_back(*arrival);
        }
    });
    return arrivals;
}

Vec3 BeamLight::exact_irradiance(const Receiver& receiver) const {
    Vec3 sum(0);
    for (const ExactArrival& arrival : exact_arrivals(receiver)) {
        const double cosine = -dot(receiver.shading_normal, arrival.single.path.ray.direction),
                     geometric = -dot(receiver.normal, arrival.single.path.ray.direction);
        if (!(cosine > 0)) continue;
        sum += arrival.density * std::min(cosine / geometric, kMostTurned) *
               left_of(arrival.single.path, arrival.single.path.ray.origin, receiver) *
               arrival.single.path.light;
    }
    return sum;
}

std::size_t BeamLight::path_count(const Receiver& receiver) const {
    std::size_t count = 0;
    for_each_arrival(receiver, [&](const Vec3&) { ++count; });
    return count;
}

}  // namespace trilens
