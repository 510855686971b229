// Which boxes segments may meet: Embree's packets, with what is inside the boxes left to the caller.
#include <limits>

#include "intersect/box_tree_data.h"
#include "intersect/local_segments.h"

namespace trilens {
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

    bool asks(std::size_t segment, Id primitive) {
        if (!callback(state, segment, box[primitive])) return false;
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
        if (query.asks(RTCRayN_id(arguments->ray, count, i), arguments->primID))
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
