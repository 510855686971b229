// Where all of a light's beams end: by rays, and where none of a beam's tells of an object, by the area
// that its triangles cut out of the beam.
#include "caustics/flux_ends.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "base/util/parallel.h"
#include "caustics/beam_light.h"
#include "shade/shade.h"

namespace trilens {
namespace {

/// Halvings of a beam's sides.
constexpr int kMostEndHalvings = 6;
/// A part that brings less than this share of what comes to the optics is shared out by its corners.
constexpr double kFaintEnd = 1e-6;

enum class EndKind { kObject, kAway, kOptic };

EndKind kind_of(const BeamEnd& end) {
    if (std::isfinite(end.object)) return EndKind::kObject;
    return std::isfinite(end.optic) ? EndKind::kOptic : EndKind::kAway;
}

void add_to(FluxEnds& sum, EndKind kind, const Vec3& flux) {
    if (kind == EndKind::kObject) sum.on_objects += flux;
    if (kind == EndKind::kAway) sum.away += flux;
}

/// One beam's.
class BeamDivider {
  public:
    BeamDivider(const FluxQuery& query, Id beam, double faint)
        : refined_(query.refined), beams_(query.beams), optics_(query.optics), beam_(beam), faint_(faint) {}

    FluxEnds sum() {
        const LightBeam& beam = beams_.beams[beam_];
        const BeamEnds end = corners_of(beams_, beam).end;
        const bool is_in_air = beams_.histories[beam.history].medium == kNone;
        const EndKind kind = kind_of(*end[0]);
        bool are_alike = true;
        for (std::size_t k = 0; k < 3; ++k) {
            are_alike = are_alike && kind_of(*end[k]) == kind;
            if (!is_in_air || !are_alike) continue;
            BeamEnd middle = *refined_.side_middles(beam_)[k];
            refined_.look_ahead(beam_, middle);
            are_alike = kind_of(middle) == kind;
        }
        if (are_alike) {
            // Exact for quadratic light: at a rim, where Fresnel's weights are steep, corners say too much.
            Vec3 left(0);
            for (const BeamEnd* one : end) left += left_of(*one) / 3.0;
            for (const BeamEnd* middle : refined_.side_middles(beam_))
                add_to(sum_, kind, beam.measure / 3 * left * middle->light);
        } else {
            add(end, is_in_air ? 0 : kMostEndHalvings);
        }
        return sum_;
    }

  private:
    using Side = std::pair<Vec2, Vec2>;
    struct Before {
        bool operator()(const Vec2& a, const Vec2& b) const { return a.x != b.x ? a.x < b.x : a.y < b.y; }
        bool operator()(const Side& a, const Side& b) const {
            return a.first != b.first ? (*this)(a.first, b.first) : (*this)(a.second, b.second);
        }
    };

    const BeamEnd* middle(const BeamEnd& a, const BeamEnd& b) {
        const auto [low, high] = std::minmax(a.place, b.place, Before{});
        const auto [known, is_new] = middles_.try_emplace({low, high});
        if (is_new) {
            known->second = refined_.middle(beam_, a, b);
            refined_.look_ahead(beam_, known->second);
        }
        return &known->second;
    }

    /// What the glass that the end lies in leaves on the way to an object in it.
    Vec3 left_of(const BeamEnd& end) const {
        const Id medium = beams_.histories[beams_.beams[beam_].history].medium;
        if (kind_of(end) != EndKind::kObject) return Vec3(1);
        return body_transmittance(optics_, medium, end.object * length(end.direction));
    }

    void add(const BeamEnds& end, int level) {
        const double measure = refined_.corners(beam_, end).measure;
        Vec3 light(0);
        for (const BeamEnd* one : end) light += measure / 3 * one->light;
        const EndKind kind = kind_of(*end[0]);
        if (kind_of(*end[1]) == kind && kind_of(*end[2]) == kind) return add_to(sum_, kind, light);
        if (level == kMostEndHalvings || light.x + light.y + light.z < faint_) {
            for (const BeamEnd* one : end)
                add_to(sum_, kind_of(*one), measure / 3 * left_of(*one) * one->light);
            return;
        }
        const BeamEnds middles{middle(*end[1], *end[2]), middle(*end[2], *end[0]), middle(*end[0], *end[1])};
        for (const BeamEnds& part : quarters(end, middles)) add(part, level + 1);
    }

    const RefinedBeams& refined_;
    const Beams& beams_;
    const PathWorld& optics_;
    const Id beam_;
    const double faint_;
    FluxEnds sum_;
    std::map<Side, BeamEnd, Before> middles_;  // neighbouring parts share them
};

}  // namespace

std::vector<FluxEnds> flux_ends_by_rays(const FluxQuery& query) {
    const Beams& beams = query.beams;
    const Vec3 arriving = beams.flux_arriving();
    const double faint = kFaintEnd * (arriving.x + arriving.y + arriving.z);
    std::vector<FluxEnds> of_beam(beams.beams.size());
    parallel_for(of_beam.size(), 64, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i)
            of_beam[i] = BeamDivider(query, static_cast<Id>(i), faint).sum();
    });
    return of_beam;
}

namespace {

constexpr std::size_t kTrianglesAtOnce = 64;

using BeamFlux = std::pair<Id, Vec3>;

/// A triangle as the receiving half of a parallelogram, on one of its sides; without area where it has none.
Receiver side_of_triangle(const TriangleScene& scene, std::size_t t, bool is_back, double offset) {
    static constexpr std::array<Vec2, 3> kHalf{Vec2(-0.5, -0.5), Vec2(0.5, -0.5), Vec2(-0.5, 0.5)};
    const IdTriple& corner = scene.triangles[t];
    const Vec3 &a = scene.points[corner[0]], &b = scene.points[corner[1]], &c = scene.points[corner[2]];
    Receiver receiver;
    receiver.sides = {b - a, c - a};
    receiver.point = 0.5 * (b + c);
    receiver.normal = (is_back ? -1.0 : 1.0) * normalize_or_zero(cross(b - a, c - a));
    receiver.shading_normal = receiver.normal;
    receiver.lifted = receiver.point + offset * receiver.normal;
    receiver.outline = kHalf;
    receiver.keeps_sides = true;
    return receiver;
}

}  // namespace

FluxEnds BeamLight::flux_ends(const TriangleScene& objects) const {
    const std::vector<FluxEnds> of_beam = flux_ends_by_rays({*refined_, beams_, *space_.optics});
    std::vector<char> asks_area(of_beam.size());
    for (std::size_t i = 0; i < of_beam.size(); ++i) asks_area[i] = of_beam[i].on_objects == Vec3(0);

    const std::size_t blocks = (objects.size() + kTrianglesAtOnce - 1) / kTrianglesAtOnce;
    std::vector<std::vector<BeamFlux>> found(blocks);
    const double offset = kShadowOffset * space_.size;
    parallel_for(blocks, 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t t = from * kTrianglesAtOnce; t < std::min(to * kTrianglesAtOnce, objects.size());
             ++t)
            for (const bool is_back : {false, true})
                for_each_flux(
                    side_of_triangle(objects, t, is_back, offset), asks_area,
                    [&](Id beam, const Vec3& flux) { found[t / kTrianglesAtOnce].emplace_back(beam, flux); });
    });
    std::vector<Vec3> by_area(of_beam.size(), Vec3(0));
    for (const auto& block : found)
        for (const auto& [beam, flux] : block) by_area[beam] += flux;

    FluxEnds all;
    for (std::size_t i = 0; i < of_beam.size(); ++i) {
        const FluxEnds& by_rays = of_beam[i];
        const Vec3 on_objects =
            asks_area[i] ? glm::min(by_area[i], beams_.beams[i].flux) : by_rays.on_objects;
        all.on_objects += on_objects;
        all.away += glm::max(Vec3(0), by_rays.away + by_rays.on_objects - on_objects);
    }
    return all;
}

}  // namespace trilens
