// Histories at the corners, the middles of the edges and the centre, compared.
#include "paths/facets/divide_facet.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "paths/facets/one_history.h"
#include "paths/probe/path_probe.h"

namespace trilens {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class Divider {
  public:
    struct Probed {
        ProbeSide side;
        double reach;
        const ProbePlan& plan;
    };
    Divider(const ProbeContext& context, const Probed& probed, const DivideParams& params)
        : context_(context),
          side_(probed.side),
          params_(params),
          plan_(probed.plan),
          reach_(probed.reach),
          probes_(context, {probed.side, probed.reach, !params.estimates}) {
        mirror_ = context.world->optics[context.optic].mirror;
    }
    DividedFacet divide(const std::array<PartCorner, 3>& from);
    DividedFacet divide_on(const FacetPart& part);

  private:
    using Triangle = std::array<FacetPoint, 3>;

    using Inside = std::array<FacetPoint, 4>;  // the edges' middles, opposite to the corners, and the centre

    static FacetPoint point_of(const PartCorner& corner) {
        return {corner.probe, corner.probe->screen, corner.chord, corner.shared};
    }
    void divide(Id cell, const Triangle& corners, int level);
    void split(Id cell, const Triangle& corners, const Inside& inside, int level);
    bool is_least(const Triangle& corners, int level, bool probed) const;
    bool has_break(const Triangle& corners) const;
    bool project(const Triangle& corners, std::span<const FacetPoint> inside, int level);
    bool is_proven(const Triangle& corners) const;
    bool mirror_alone(const Triangle& corners, std::span<const FacetPoint> inside) const;
    bool layered(const Triangle& corners, std::span<const FacetPoint> inside, int level);
    bool divide_plain(Id cell, const Triangle& corners);
    void trace(Id cell, const Triangle& corners, int level);
    bool probe_inside(const Triangle& corners, Inside& inside, int level);
    /// False where no fainter paths at these points could make project() true. A mirror's are all principal.
    bool may_project(std::span<const FacetPoint> points) const { return mirror_ || may_agree(points); }
    DividedFacet take();
    void project_mirror(const Triangle& corners);
    void end(Id cell, FacetPart part);
    FacetPart part_of(const Triangle& corners, int level) const;

    const ProbeContext& context_;
    ProbeSide side_ = ProbeSide::kFront;
    const DivideParams& params_;
    const ProbePlan& plan_;
    double reach_ = 0;
    bool mirror_ = true;
    ProbeCache probes_;
    DividedFacet divided_;
    FacetPart projected_;  // what `project` found
};

FacetPart Divider::part_of(const Triangle& corners, int level) const {
    FacetPart part;
    part.level = static_cast<std::uint8_t>(level);
    part.reach = reach_;
    part.side = side_;
    for (std::size_t k = 0; k < 3; ++k)
        part.corners[k] = {corners[k].shared, corners[k].probe, corners[k].chord};
    return part;
}

/// A mirror that shows no other optic there has rays beyond its silhouette too: the mirror law goes on.
bool Divider::mirror_alone(const Triangle& corners, std::span<const FacetPoint> inside) const {
    if (!mirror_) return false;
    const auto alone = [](const PathProbe& probe) {
        return probe.state != ProbeState::kSeen || (probe.segments.size() == 1 && probe.segments[0].ends);
    };
    return std::all_of(corners.begin(), corners.end(),
                       [&](const FacetPoint& corner) {
                           return corner.probe->state != ProbeState::kMissed && alone(*corner.probe);
                       }) &&
           std::all_of(inside.begin(), inside.end(),
                       [&](const FacetPoint& point) { return alone(*point.probe); });
}

/// The optic that the path over a mirror goes on to; kNone: to none.
Id next_of(const PathProbe& probe) {
    for (const PathSegment& segment : probe.segments)
        if (segment.parent == 0) return segment.step.optic;
    return kNone;
}

/// The first reflection alone, in projected_.
void Divider::project_mirror(const Triangle& corners) {
    PathSegment segment;
    segment.step = {context_.optic, Event::kReflect};
    segment.medium = active_medium(*context_.world, context_.camera.media(corners[0].screen));
    projected_.histories = {segment};
    for (std::size_t k = 0; k < 3; ++k)
        if (corners[k].probe->state == ProbeState::kSeen) projected_.segment[k] = {0};
    for (PartInside& point : projected_.inside)
        if (point.at.probe->state == ProbeState::kSeen) point.segment = {0};
}

/// Whether the nested optics over this mirror show what the exact paths meet next, wherever they were probed
/// at.
bool Divider::layered(const Triangle& corners, std::span<const FacetPoint> inside, int level) {
    if (!params_.nested_agree || level > 0 || !mirror_) return false;
    const auto agrees = [&](const FacetPoint& point) {
        const PathProbe& probe = *point.probe;
        if (probe.state != ProbeState::kSeen) return true;
        return !probe.segments.empty() && probe.screen.z > 0 &&
               params_.nested_agree(Vec2(probe.screen) / probe.screen.z, next_of(probe));
    };
    if (!std::all_of(corners.begin(), corners.end(), agrees) ||
        !std::all_of(inside.begin(), inside.end(), agrees))
        return false;
    projected_ = part_of(corners, level);
    projected_.layered = true;
    for (const FacetPoint& point : inside)
        projected_.inside.push_back({{kNone, point.probe, point.chord}, {}});
    project_mirror(corners);
    return is_proven(corners);
}

/// Whether projected_ has one history all over, as far as nested optics do not draw the others.
bool Divider::is_proven(const Triangle& corners) const {
    HistoryProof proof{context_, projected_, {}, side_ == ProbeSide::kNearest};
    if (projected_.layered && params_.nested_covers) {
        // Half its size farther than the part reaches, and a pixel.
        Vec2 low(kInfinity), high(-kInfinity);
        for (const FacetPoint& corner : corners) {
            if (!(corner.screen.z > 0)) return false;
            low = glm::min(low, Vec2(corner.screen) / corner.screen.z);
            high = glm::max(high, Vec2(corner.screen) / corner.screen.z);
        }
        const Vec2 room = 0.5 * (high - low) + 1.0;
        proof.drawn_over = [this, low = low - room, high = high + room](Id optic) {
            return params_.nested_covers(optic, low, high);
        };
    }
    return has_one_history(proof);
}

/// Whether the camera's rays jump within the part.
bool Divider::has_break(const Triangle& corners) const {
    for (int axis = 0; axis < 2; ++axis)
        for (const double at : context_.camera.breaks[static_cast<std::size_t>(axis)]) {
            int before = 0, behind = 0;
            for (const FacetPoint& corner : corners) {
                before += corner.screen[axis] < at * corner.screen.z;
                behind += corner.screen[axis] > at * corner.screen.z;
            }
            if (before > 0 && behind > 0) return true;
        }
    return false;
}

bool Divider::project(const Triangle& corners, std::span<const FacetPoint> inside, int level) {
    if (has_break(corners)) return false;
    projected_ = part_of(corners, level);
    for (const FacetPoint& point : inside)
        projected_.inside.push_back({{kNone, point.probe, point.chord}, {}});
    if (!context_.world->reflect && mirror_) return true;
    if (mirror_alone(corners, inside)) {
        project_mirror(corners);
        return is_proven(corners);
    }
    const PathProbe& centre = inside.empty() ? *corners[0].probe : *inside.back().probe;
    if (centre.state != ProbeState::kSeen) return false;
    const auto agrees = [&](const PathProbe& probe, std::vector<std::size_t>& match) {
        if (probe.state != ProbeState::kSeen || probe.front != centre.front) return false;
        match = matched(centre.segments, probe.segments);
        return match.size() == centre.segments.size() && covers(match, probe.segments);
    };
    for (PartInside& point : projected_.inside)
        if (!agrees(*point.at.probe, point.segment)) return false;
    for (std::size_t k = 0; k < 3; ++k)
        if (!agrees(*corners[k].probe, projected_.segment[k])) return false;
    projected_.histories = centre.segments;
    return is_proven(corners);
}

void Divider::end(Id cell, FacetPart part) {
    divided_.cells[cell].part = static_cast<Id>(divided_.parts.size());
    divided_.parts.push_back(std::move(part));
}

std::array<Vec3, 3> on_screen(const std::array<FacetPoint, 3>& corners) {
    return {corners[0].screen, corners[1].screen, corners[2].screen};
}

/// Whether a part is not to be divided. `probed`: it was.
bool Divider::is_least(const Triangle& corners, int level, bool probed) const {
    const double area = screen_area(on_screen(corners));
    if (level >= params_.most_levels) return true;
    if (plan_.decides()) return !plan_.is_worth_dividing(level, plan_.samples_in(area), probed);
    return area < params_.least_area;
}

/// Whether projected_ stands for the part. Sets the centre, and has all paths followed, where the principal
/// ones leave that open.
bool Divider::probe_inside(const Triangle& corners, Inside& inside, int level) {
    const auto& [a, b, c, centre] = inside;
    if (!may_project(std::array{corners[0], corners[1], corners[2], a, b, c})) return false;
    inside[3] = probes_.between({&corners[0], &corners[1], &corners[2]});
    if (!may_project(std::array{corners[0], centre})) return false;
    for (const FacetPoint& point : {corners[0], corners[1], corners[2], a, b, c})
        probes_.follow_all_at(point, kFainter * kLeastWeight);
    probes_.follow_all_at(centre, kLeastWeight);
    return layered(corners, inside, level) || project(corners, inside, level);
}

void Divider::divide(Id cell, const Triangle& corners, int level) {
    // Nobody sees what is off the film.
    if (level > 0 && !may_reach_film(on_screen(corners), context_.camera.film))
        return trace(cell, corners, level);
    // A part is not probed that would be traced anyway, or for more than tracing it takes.
    const bool agree = may_project(corners);
    ProbeTally::Level& tally = divided_.tally.at(level);
    ++tally.parts;
    tally.agree += agree;
    if (!agree && is_least(corners, level, false)) return trace(cell, corners, level);
    if (agree && plan_.decides() &&
        !plan_.is_worth_inside(level, plan_.samples_in(screen_area(on_screen(corners)))))
        return trace(cell, corners, level);
    tally.probed += agree;
    Inside inside{probes_.middle_of(corners[1], corners[2]), probes_.middle_of(corners[2], corners[0]),
                  probes_.middle_of(corners[0], corners[1])};
    if (probe_inside(corners, inside, level)) {
        ++tally.projected;
        return end(cell, std::move(projected_));
    }
    split(cell, corners, inside, level);
}

void Divider::trace(Id cell, const Triangle& corners, int level) {
    FacetPart part = part_of(corners, level);
    part.method = LeafMethod::kTraced;
    part.centre = (corners[0].screen + corners[1].screen + corners[2].screen) / 3.0;
    end(cell, std::move(part));
}

/// A facet so small that what lies between its corners is less than a pixel away from them; false where it is
/// none.
bool Divider::divide_plain(Id cell, const Triangle& corners) {
    if (!(screen_area(on_screen(corners)) < params_.plain_area)) return false;
    if (layered(corners, {}, 0) || project(corners, {}, 0))
        end(cell, std::move(projected_));
    else
        trace(cell, corners, 0);
    return true;
}

void Divider::split(Id cell, const Triangle& corners, const Inside& inside, int level) {
    if (is_least(corners, level, true)) return trace(cell, corners, level);
    const Id first = static_cast<Id>(divided_.cells.size());
    divided_.cells[cell].children = first;
    divided_.cells.resize(divided_.cells.size() + 4);
    divide(first, {corners[0], inside[2], inside[1]}, level + 1);
    divide(first + 1, {inside[2], corners[1], inside[0]}, level + 1);
    divide(first + 2, {inside[1], inside[0], corners[2]}, level + 1);
    divide(first + 3, {inside[0], inside[1], inside[2]}, level + 1);
}

DividedFacet Divider::take() {
    divided_.probes = std::move(probes_.probes());
    divided_.cut = probes_.cut();
    return std::move(divided_);
}

DividedFacet Divider::divide(const std::array<PartCorner, 3>& from) {
    Triangle corners;
    bool has_normals = true;
    for (std::size_t k = 0; k < 3; ++k) {
        corners[k] = point_of(from[k]);
        const bool missed = from[k].probe->state == ProbeState::kMissed;
        has_normals = has_normals && (missed || from[k].probe->place.normal != Vec3(0));
        probes_.note(from[k].probe->cut);
    }
    divided_.cells.resize(1);
    if (!has_normals)
        end(0, part_of(corners, 0));
    else if (!divide_plain(0, corners))
        divide(0, corners, 0);
    return take();
}

DividedFacet Divider::divide_on(const FacetPart& part) {
    Triangle corners;
    Inside inside;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = point_of(part.corners[k]);
    for (std::size_t k = 0; k < 4; ++k) inside[k] = point_of(part.inside[k].at);
    divided_.cells.resize(1);
    split(0, corners, inside, part.level);
    return take();
}

}  // namespace

bool may_reach_film(const std::array<Vec3, 3>& screen, const Vec2& film) {
    constexpr double kMargin = 1;
    bool left = true, right = true, below = true, above = true, behind = true;
    for (const Vec3& s : screen) {
        left = left && s.x <= -kMargin * s.z;
        right = right && s.x >= (film.x + kMargin) * s.z;
        below = below && s.y <= -kMargin * s.z;
        above = above && s.y >= (film.y + kMargin) * s.z;
        behind = behind && !(s.z > 0);
    }
    return !(left || right || below || above || behind);
}

double screen_area(const std::array<Vec3, 3>& screen) {
    const auto behind = [](const Vec3& s) { return !(s.z > 0); };
    if (std::all_of(screen.begin(), screen.end(), behind)) return 0;
    if (std::any_of(screen.begin(), screen.end(), behind)) return std::numeric_limits<double>::infinity();
    const auto pixel = [&](std::size_t k) { return Vec2(screen[k]) / screen[k].z; };
    const Vec2 b = pixel(1) - pixel(0), c = pixel(2) - pixel(0);
    return 0.5 * std::fabs(cross(b, c));
}

DividedFacet divide_facet(const ProbeContext& context, const FacetToDivide& facet, const DivideParams& params,
                          const ProbePlan& plan) {
    double reach = facet.reach;
    for (std::size_t k = 0; k < 3 && facet.reach == 0; ++k)
        reach = std::max(reach, length(facet.corners[k].chord - facet.corners[(k + 1) % 3].chord));
    return Divider(context, {facet.side, reach, plan}, params).divide(facet.corners);
}

DividedFacet traced_facet(const std::array<Vec3, 3>& screen) {
    DividedFacet divided;
    divided.cells.push_back({kNone, 0});
    FacetPart& part = divided.parts.emplace_back();
    part.method = LeafMethod::kTraced;
    part.centre = (screen[0] + screen[1] + screen[2]) / 3.0;
    return divided;
}

DividedFacet divide_part(const ProbeContext& context, const FacetPart& part, const DivideParams& params,
                         const ProbePlan& plan) {
    return Divider(context, {part.side, part.reach, plan}, params).divide_on(part);
}

}  // namespace trilens
