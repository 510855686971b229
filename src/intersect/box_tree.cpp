// THE door to Embree for truth: boxes as user geometry, robust traversal.
#include "intersect/box_tree.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <limits>
#include <map>
#include <vector>

#include "base/util/check.h"
#include "intersect/box_tree_data.h"

namespace trilens {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// A ray as Embree gets it: local frame, unit direction, started where it reaches the scene.
struct LocalRay {
    Vec3 origin{0}, direction{0};
    double t_start = 0;       // world t of local s = 0
    double local_from_t = 0;  // s = local_from_t * (t - t_start)
    double s_max = 0;
    bool meets_scene = false;
};

/// What travels through Embree to on_box and back.
struct Query : EmbreeContext {
    double (*callback)(void* state, Id box) = nullptr;
    void* state = nullptr;
    const Id* box = nullptr;  // of each of Embree's primitives
    double t_start = 0, local_from_t = 0;
    double t_far = 0;           // the smallest that the callback gave
    std::exception_ptr thrown;  // by the callback: Embree lets nothing pass

    double ask(Id primitive) noexcept {
        try {
            return callback(state, box[primitive]);
        } catch (...) {
            thrown = std::current_exception();
            return -kNever;
        }
    }
};

/// The element in the middle by size; `values` is not empty.
double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// The boxes of each tree, those near the middle first.
std::vector<std::vector<Id>> group_by_distance(std::span<const Box> boxes) {
    Vec3 middle;
    std::vector<double> values(boxes.size());
    for (int k = 0; k < 3; ++k) {
        for (std::size_t i = 0; i < boxes.size(); ++i)
            values[i] = 0.5 * boxes[i].low[k] + 0.5 * boxes[i].high[k];
        middle[k] = median(values);
    }
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const Vec3 reach = glm::max(middle - boxes[i].low, boxes[i].high - middle);
        values[i] = std::max({reach.x, reach.y, reach.z});
    }
    const double near = kGroupSpan * median(values);
    std::map<int, std::vector<Id>> groups;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const bool is_far = near > 0 && values[i] > near;
        const double factors = is_far ? (std::log2(values[i]) - std::log2(near)) / std::log2(kGroupSpan) : -1;
        groups[static_cast<int>(std::floor(factors))].push_back(static_cast<Id>(i));
    }
    std::vector<std::vector<Id>> result;
    for (auto& [factor, group] : groups) result.push_back(std::move(group));
    return result;
}

LocalFrame make_frame(std::span<const Box> boxes, const std::vector<Id>& group) {
    Vec3 low(kNever), high(-kNever);
    for (const Id i : group) low = glm::min(low, boxes[i].low), high = glm::max(high, boxes[i].high);
    // Halves first: the sum of two large corners may overflow.
    const Vec3 half = 0.5 * high - 0.5 * low;
    const double radius = length(half);
    return {low + half, radius > 0 && std::isfinite(radius) ? 1 / radius : 1.0};
}

LocalRay make_local(const LocalFrame& frame, const Ray& ray, double t_min, double t_max) {
    LocalRay local;
    // Lengths that squares cannot hold take the slow way.
    const double squared = dot(ray.direction, ray.direction);
    const bool usual = squared > 1e-280 && squared < 1e280;
    local.direction = usual ? ray.direction * (1 / std::sqrt(squared)) : normalize_or_zero(ray.direction);
    const double speed = dot(local.direction, ray.direction) * frame.scale;
    const Vec3 origin = frame.from_world(ray.origin);
    if (!(speed > 0) || !std::isfinite(speed) || !std::isfinite(dot(origin, origin))) return local;

    // The stretch of the ray inside the scene's ball, with room for rounding of far origins.
    const double far = std::fabs(origin.x) + std::fabs(origin.y) + std::fabs(origin.z);
    const double radius = 1 + 8 * kBoxMargin + 1e-14 * far;
    const double s_nearest = -dot(origin, local.direction);
    const Vec3 nearest = origin + s_nearest * local.direction;
    const double half_chord_2 = radius * radius - dot(nearest, nearest);
    if (!(half_chord_2 > 0)) return local;
    const double half_chord = std::sqrt(half_chord_2);
    const double s_enter = std::max(s_nearest - half_chord, t_min * speed);
    const double s_leave = std::min(s_nearest + half_chord, t_max * speed);
    if (!(s_enter <= s_leave)) return local;

    local.origin = nearest + (s_enter - s_nearest) * local.direction;
    local.local_from_t = speed;
    local.t_start = s_enter / speed;
    local.s_max = s_leave - s_enter;
    local.meets_scene = true;
    return local;
}

/// A float that is not below `s` plus the margin of the boxes.
float rounded_up(double s) {
    return std::nextafter(static_cast<float>(s + 4 * kBoxMargin), std::numeric_limits<float>::infinity());
}

void on_bounds(const RTCBoundsFunctionArguments* arguments) {
    *arguments->bounds_o = static_cast<const RTCBounds*>(arguments->geometryUserPtr)[arguments->primID];
}

// Embree offers a box: ask the visitor, and shorten the ray to what still matters.
void on_box(const RTCIntersectFunctionNArguments* arguments) noexcept {
    if (!arguments->valid[0]) return;
    Query& query = *static_cast<Query*>(arguments->context);
    RTCRayHit& hit = *reinterpret_cast<RTCRayHit*>(arguments->rayhit);
    const double t_far = query.ask(arguments->primID);
    query.t_far = std::min(query.t_far, t_far);
    const double s_far = (t_far - query.t_start) * query.local_from_t;
    if (!(s_far < hit.ray.tfar)) return;
    const float tfar =
        s_far < 0 && std::isinf(s_far) ? -std::numeric_limits<float>::infinity() : rounded_up(s_far);
    if (tfar >= hit.ray.tfar) return;
    hit.ray.tfar = tfar;
    hit.hit.primID = arguments->primID;
    hit.hit.geomID = arguments->geomID;
}

RTCBounds local_bounds(const LocalFrame& frame, const Box& box) {
    const Vec3 low = frame.from_world(box.low) - kBoxMargin, high = frame.from_world(box.high) + kBoxMargin;
    RTCBounds bounds{};
    bounds.lower_x = static_cast<float>(low.x), bounds.upper_x = static_cast<float>(high.x);
    bounds.lower_y = static_cast<float>(low.y), bounds.upper_y = static_cast<float>(high.y);
    bounds.lower_z = static_cast<float>(low.z), bounds.upper_z = static_cast<float>(high.z);
    return bounds;
}

}  // namespace

void BoxTree::Data::build(std::span<const Box> boxes, Group& group) {
    group.frame = make_frame(boxes, group.box);
    std::vector<RTCBounds> bounds;
    bounds.reserve(group.box.size());
    for (const Id i : group.box) bounds.push_back(local_bounds(group.frame, boxes[i]));

    RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(bounds.size()));
    rtcSetGeometryUserData(geometry, bounds.data());
    rtcSetGeometryBoundsFunction(geometry, &on_bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, &on_box);
    rtcSetGeometryOccludedFunction(geometry, &on_box_of_segments);
    rtcCommitGeometry(geometry);
    group.scene = rtcNewScene(device.get());
    rtcSetSceneFlags(group.scene, RTC_SCENE_FLAG_ROBUST);
    rtcAttachGeometry(group.scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(group.scene);
    device.check("building the tree");
}

BoxTree::BoxTree(std::span<const Box> boxes, const std::string& isa) : data_(std::make_unique<Data>(isa)) {
    if (boxes.empty()) return;
    TRILENS_CHECK(boxes.size() < kNone, "boxes are numbered with 32 bits");
    for (std::vector<Id>& group : group_by_distance(boxes)) {
        data_->groups.emplace_back().box = std::move(group);
        data_->build(boxes, data_->groups.back());
    }
}

BoxTree::~BoxTree() = default;
BoxTree::BoxTree(BoxTree&&) noexcept = default;
BoxTree& BoxTree::operator=(BoxTree&&) noexcept = default;

void BoxTree::visit_with(const Ray& ray, const Interval& interval, Callback callback, void* state) const {
    double t_max = interval.t_max;
    for (const Data::Group& group : data_->groups) {
        const LocalRay local = make_local(group.frame, ray, interval.t_min, t_max);
        if (!local.meets_scene) continue;

        Query query;
        init_context(&query);
        query.callback = callback;
        query.state = state;
        query.box = group.box.data();
        query.t_start = local.t_start;
        query.local_from_t = local.local_from_t;
        query.t_far = t_max;

        RTCRayHit embree{};
        embree.ray.org_x = static_cast<float>(local.origin.x),
        embree.ray.dir_x = static_cast<float>(local.direction.x);
        embree.ray.org_y = static_cast<float>(local.origin.y),
        embree.ray.dir_y = static_cast<float>(local.direction.y);
        embree.ray.org_z = static_cast<float>(local.origin.z),
        embree.ray.dir_z = static_cast<float>(local.direction.z);
        embree.ray.tfar = rounded_up(local.s_max);
        embree.ray.mask = ~0u;
        embree.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        intersect_one(group.scene, &query, &embree);
        if (query.thrown) std::rethrow_exception(query.thrown);
        t_max = query.t_far;
    }
}

// Which boxes segments may meet: Embree's packets, with what is inside the boxes left to the caller.

namespace {

/// The segments from `first` on as Embree wants them; those not asked are rays without a length. False where
/// none is asked.
template <typename Rays, std::size_t kWidth>
bool set_packet(const LocalSegments& local, std::size_t first, Segments::Bits asked, Rays& rays,
                int (&valid)[kWidth]) {
    bool any = false;
    for (std::size_t i = 0; i < kWidth; ++i) {
        const std::size_t s = first + i;
        const bool is_asked = asked >> s & 1;
        const auto value = [&](const float* of_all, float otherwise) {
            return is_asked ? of_all[s] : otherwise;
        };
        rays.org_x[i] = value(local.origin[0], 0), rays.dir_x[i] = value(local.direction[0], 1);
        rays.org_y[i] = value(local.origin[1], 0), rays.dir_y[i] = value(local.direction[1], 1);
        rays.org_z[i] = value(local.origin[2], 0), rays.dir_z[i] = value(local.direction[2], 1);
        rays.tnear[i] = rays.time[i] = 0;
        rays.tfar[i] = value(local.length, -1);
        rays.mask[i] = ~0u;
        rays.flags[i] = 0;
        rays.id[i] = static_cast<unsigned>(s);
        valid[i] = is_asked ? -1 : 0;
        any = any || is_asked;
    }
    return any;
}

/// What travels through Embree to on_box_of_segments and back.
struct SegmentQuery : EmbreeContext {
    bool (*callback)(void* state, std::size_t segment, Id box) = nullptr;
    void* state = nullptr;
    const Id* box = nullptr;  // of each of Embree's primitives
    Segments::Bits found = 0;
    std::exception_ptr thrown;  // by the callback; then no segment asks any more

    /// Whether the segment has found what it looked for.
    bool ends(std::size_t segment, Id primitive) noexcept {
        if (thrown) return true;
        try {
            if (!callback(state, segment, box[primitive])) return false;
        } catch (...) {
            thrown = std::current_exception();
            return true;
        }
        found |= Segments::bit(segment);
        return true;
    }
};

}  // namespace

// Segments that are found here travel no further.
void BoxTree::Data::on_box_of_segments(const RTCOccludedFunctionNArguments* arguments) noexcept {
    SegmentQuery& query = *static_cast<SegmentQuery*>(arguments->context);
    const unsigned count = arguments->N;
    for (unsigned i = 0; i < count; ++i) {
        if (!arguments->valid[i]) continue;
        if (query.ends(RTCRayN_id(arguments->ray, count, i), arguments->primID))
            RTCRayN_tfar(arguments->ray, count, i) = -std::numeric_limits<float>::infinity();
    }
}

Segments::Bits BoxTree::find_with(const Segments& segments, SegmentCallback callback, void* state) const {
    Segments::Bits found = 0, unusual = 0;
    for (const Data::Group& group : data_->groups) {
        const LocalSegments local = make_local_segments(segments, group.frame.centre, group.frame.scale);
        unusual |= local.unusual;
        SegmentQuery query;
        init_context(&query);
        query.callback = callback;
        query.state = state;
        query.box = group.box.data();
        const auto ask = [&]<typename Rays, std::size_t kWidth>() {
            static_assert(Segments::kMost % kWidth == 0);
            for (std::size_t first = 0; first < segments.count; first += kWidth) {
                Rays rays;
                alignas(64) int valid[kWidth];
                if (set_packet(local, first, local.meets & ~found, rays, valid))
                    occluded_coherent(valid, group.scene, &query, &rays);
            }
        };
        if (data_->packet_width == 16)
            ask.operator()<RTCRay16, 16>();
        else if (data_->packet_width == 8)
            ask.operator()<RTCRay8, 8>();
        else
            ask.operator()<RTCRay4, 4>();
        if (query.thrown) std::rethrow_exception(query.thrown);
        found |= query.found;
    }
    for_each_of(unusual, [&](std::size_t i) {
        visit(segments.ray(i), 0, 1, [&](Id box) {
            if (!callback(state, i, box)) return 1.0;
            found |= Segments::bit(i);
            return -std::numeric_limits<double>::infinity();
        });
    });
    return found;
}

}  // namespace trilens
