#include "camera/chain_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "base/check.h"
#include "camera/chain_newton.h"

namespace trilens {
namespace {

/// Cells with a shorter side, in parameters, are halved no more.
constexpr double kSmallestCell = 0x1p-20;
/// Larger cells are not asked Krawczyk's operator: it knows nothing there.
constexpr double kFlatEnough = 0.6;

using Nodes = std::array<TreeNode*, kMostEvents>;

/// The least cosine with the normal that a refracted ray has on the denser side; 0 where there is no limit.
double critical_cosine(double thin, double dense) {
    return thin < dense ? std::sqrt(1 - thin / dense * (thin / dense)) : 0;
}

/// How large the angle between a sight and a piece's normals is: |cosine| is from low to high.
struct Cosines {
    double middle = 0, radius = 2;

    double least() const { return std::max(0.0, std::fabs(middle) - radius); }
    double most() const { return std::fabs(middle) + radius; }
    bool is_positive() const { return middle > radius; }
    bool is_negative() const { return middle < -radius; }
};

class ChainWalk {
  public:
    ChainWalk(std::span<ChainSurface> surfaces, const LinearCamera& camera,
              std::span<const ChainEvent> events, const Vec3& point)
        : surfaces_(surfaces), camera_(camera), events_(events), point_(point) {}

    ChainPaths run(std::size_t most_boxes);

  private:
    /// What is known of one box.
    struct Box {
        Nodes nodes{};
        std::array<Sight, kMostEvents + 1> sights{};   // the one that arrives at event i: [i]
        std::array<bool, kMostEvents + 1> is_known{};  // its ends lie apart
    };

    TreeNode& node(const Box& box, std::size_t i) const { return *box.nodes[i]; }
    Cosines cosines(const Box& box, std::size_t sight, std::size_t event) const;
    void set_sights(Box& box) const;
    bool is_empty(const Box& box) const;
    bool breaks_sides(const Box& box, std::size_t i) const;
    bool breaks_law(const Box& box, std::size_t i) const;
    bool breaks_chord(const Box& box, std::size_t i) const;
    bool settle(const Box& box);
    std::optional<std::size_t> widest(const Box& box) const;
    void halve(const Box& box, std::size_t i);

    std::span<ChainSurface> surfaces_;
    const LinearCamera& camera_;
    std::span<const ChainEvent> events_;
    const Vec3& point_;
    std::vector<Nodes> waiting_;
    ChainPaths found_;
};

void ChainWalk::set_sights(Box& box) const {
    const std::size_t count = events_.size();
    box.sights[0] = node(box, 0).view.sight;
    box.is_known[0] = node(box, 0).view.is_apart;
    for (std::size_t i = 0; i < count; ++i) {
        const PlaceBounds& from = node(box, i).place;
        const bool is_last = i + 1 == count;
        const Vec3& to = is_last ? point_ : node(box, i + 1).place.position;
        const double radius = from.position_radius + (is_last ? 0 : node(box, i + 1).place.position_radius);
        box.is_known[i + 1] = sight_from(from.position, radius, to, box.sights[i + 1]);
    }
}

Cosines ChainWalk::cosines(const Box& box, std::size_t sight, std::size_t event) const {
    const PlaceBounds& place = node(box, event).place;
    if (!box.is_known[sight] || place.normal_radius >= 1) return {};
    return {dot(box.sights[sight].direction, place.normal), box.sights[sight].turn + place.normal_radius};
}

/// Light arrives and goes on by the sides that the event asks for, and not beyond the critical angle.
bool ChainWalk::breaks_sides(const Box& box, std::size_t i) const {
    const ChainEvent& event = events_[i];
    const Cosines in = cosines(box, i, i), out = cosines(box, i + 1, i);
    if (!event.either_side) {
        if (event.front ? in.is_positive() : in.is_negative()) return true;
        const bool goes_outward = event.front == event.reflects;
        if (goes_outward ? out.is_negative() : out.is_positive()) return true;
    }
    const bool known = (in.is_positive() || in.is_negative()) && (out.is_positive() || out.is_negative());
    if (known && (in.middle * out.middle > 0) == event.reflects) return true;
    return !event.reflects && (out.most() < critical_cosine(event.before, event.after) ||
                               in.most() < critical_cosine(event.after, event.before));
}

/// Where the bend g = n e - n' e' is parallel to a normal N, |g x n| is at most what g and n change.
bool ChainWalk::breaks_law(const Box& box, std::size_t i) const {
    const PlaceBounds& place = node(box, i).place;
    if (!box.is_known[i] || !box.is_known[i + 1] || place.normal_radius >= 1) return false;
    const double before = events_[i].before, after = events_[i].after;
    const Vec3 bend = before * box.sights[i].direction - after * box.sights[i + 1].direction;
    const double turn = before * box.sights[i].turn + after * box.sights[i + 1].turn;
    const Vec3 across = bend - dot(bend, place.normal) * place.normal;
    const double most = turn + (length(bend) + turn) * place.normal_radius;
    return dot(across, across) > most * most;
}

/// A chord of a convex body runs into it where it begins and out of it where it ends: there its cosines have
/// other signs, so neither is more than the normals differ.
bool ChainWalk::breaks_chord(const Box& box, std::size_t i) const {
    if (i + 1 == events_.size() || events_[i].tree != events_[i + 1].tree || !events_[i].convex) return false;
    const PlaceBounds &from = node(box, i).place, &to = node(box, i + 1).place;
    if (from.normal_radius >= 1 || to.normal_radius >= 1) return false;
    const double most = length(from.normal - to.normal) + from.normal_radius + to.normal_radius;
    const auto breaks = [&](const ChainEvent& event, double critical, const Cosines& other) {
        return event.reflects ? other.least() > most : most < critical;
    };
    const ChainEvent &begin = events_[i], &end = events_[i + 1];
    return breaks(begin, critical_cosine(begin.before, begin.after), cosines(box, i, i)) ||
           breaks(end, critical_cosine(end.after, end.before), cosines(box, i + 2, i + 1));
}

bool ChainWalk::is_empty(const Box& box) const {
    if (node(box, 0).view.is_behind) return true;
    for (std::size_t i = 0; i < events_.size(); ++i)
        if (breaks_sides(box, i) || breaks_law(box, i) || breaks_chord(box, i)) return true;
    return false;
}

/// Whether the box is done: it has no zero, or one that was found.
bool ChainWalk::settle(const Box& box) {
    ChainCells cells;
    for (std::size_t i = 0; i < events_.size(); ++i) {
        const TreeNode& one = node(box, i);
        if (!one.bounds || !box.is_known[i + 1] || one.place.normal_radius > kFlatEnough) return false;
        cells.push_back(
            {surfaces_[events_[i].tree].surface, one.box, one.bounds, events_[i].before, events_[i].after});
    }
    if (!box.is_known[0]) return false;
    const ChainKrawczyk krawczyk(cells, std::span(box.sights).first(events_.size() + 1));
    switch (krawczyk.verdict()) {
        case ChainVerdict::kEmpty:
            return true;
        case ChainVerdict::kUnknown:
            return false;
        case ChainVerdict::kOneAtMost:
            break;
    }
    const std::optional<ChainZero> zero = krawczyk.find_zero(camera_, point_);
    if (!zero) return false;
    if (!zero->is_in_domain) return true;
    const Vec3 screen = screen_from_world(camera_, zero->positions.front());
    if (!(screen.z > 0)) return true;
    found_.paths.push_back({Vec2(screen) / screen.z, zero->positions});
    return true;
}

/// The cell from which most of what is not known comes; none where all are of the smallest size.
std::optional<std::size_t> ChainWalk::widest(const Box& box) const {
    constexpr double kMeet = 4;  // as if the places were so many radii apart
    std::optional<std::size_t> widest;
    double most = -1;
    for (std::size_t i = 0; i < events_.size(); ++i) {
        const TreeNode& one = node(box, i);
        const Vec2 side = one.box.high - one.box.low;
        if (one.bounds && (one.bounds->is_finest || std::min(side.x, side.y) < kSmallestCell)) continue;
        double width = std::min(one.place.normal_radius, 2.0);
        for (const std::size_t sight : {i, i + 1})
            width += box.is_known[sight]
                         ? box.sights[sight].by_distance * one.place.position_radius
                         : kMeet * one.place.position_radius /
                               std::max(one.place.position_radius +
                                            node(box, sight == i ? std::max(i, std::size_t{1}) - 1
                                                                 : std::min(i + 1, events_.size() - 1))
                                                .place.position_radius,
                                        1e-300);
        if (!(width > most)) continue;
        most = width;
        widest = i;
    }
    return widest;
}

void ChainWalk::halve(const Box& box, std::size_t i) {
    TreeNode& one = node(box, i);
    surfaces_[events_[i].tree].tree->halve(one);
    for (TreeNode* half : {one.halves[1], one.halves[0]}) {
        if (!half) continue;
        waiting_.push_back(box.nodes);
        waiting_.back()[i] = half;
    }
}

ChainPaths ChainWalk::run(std::size_t most_boxes) {
    found_.complete = true;
    Nodes whole{};
    for (std::size_t i = 0; i < events_.size(); ++i) {
        whole[i] = surfaces_[events_[i].tree].tree->root();
        if (!whole[i]) return {};
    }
    waiting_.assign(1, whole);
    while (!waiting_.empty()) {
        if (++found_.boxes > most_boxes) {
            found_.complete = false;
            break;
        }
        Box box;
        box.nodes = waiting_.back();
        waiting_.pop_back();
        set_sights(box);
        if (is_empty(box) || settle(box)) continue;
        if (const std::optional<std::size_t> one = widest(box))
            halve(box, *one);
        else
            found_.complete = false;
    }
    return std::move(found_);
}

}  // namespace

ChainPaths find_chain_paths(std::span<ChainSurface> surfaces, const LinearCamera& camera,
                            std::span<const ChainEvent> events, const Vec3& point, std::size_t most_boxes) {
    TRILENS_CHECK(!events.empty() && events.size() <= kMostEvents, "a chain has one to kMostEvents events");
    return ChainWalk(surfaces, camera, events, point).run(most_boxes);
}

}  // namespace trilens
