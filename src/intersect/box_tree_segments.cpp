// Which boxes segments may meet: Embree's packets, with what is inside the boxes left to the caller.
#include <cstring>
#include <limits>

#include "intersect/box_tree_data.h"
#include "intersect/local_segments.h"

namespace trilens {
namespace {

constexpr std::size_t kPacket = 16;
static_assert(Segments::kMost % kPacket == 0);

/// The segments from `first` on as Embree wants them; false where none of them is asked.
bool set_packet(const LocalSegments& local, std::size_t first, Segments::Bits asked, RTCRay16& rays,
                int (&valid)[kPacket]) {
    constexpr std::size_t kBytes = kPacket * sizeof(float);
    std::memcpy(rays.org_x, local.origin[0] + first, kBytes);
    std::memcpy(rays.org_y, local.origin[1] + first, kBytes);
    std::memcpy(rays.org_z, local.origin[2] + first, kBytes);
    std::memcpy(rays.dir_x, local.direction[0] + first, kBytes);
    std::memcpy(rays.dir_y, local.direction[1] + first, kBytes);
    std::memcpy(rays.dir_z, local.direction[2] + first, kBytes);
    std::memcpy(rays.tfar, local.length + first, kBytes);
    bool any = false;
    for (std::size_t i = 0; i < kPacket; ++i) {
        rays.tnear[i] = rays.time[i] = 0;
        rays.mask[i] = ~0u;
        rays.flags[i] = 0;
        rays.id[i] = static_cast<unsigned>(first + i);
        valid[i] = asked >> (first + i) & 1 ? -1 : 0;
        any = any || valid[i];
    }
    return any;
}

}  // namespace

/// What travels through Embree to on_box_of_segments and back.
struct BoxTree::SegmentQuery : EmbreeContext {
    SegmentCallback callback = nullptr;
    void* state = nullptr;
    const Id* box = nullptr;  // of each of Embree's primitives
    Segments::Bits found = 0;

    bool asks(std::size_t segment, Id primitive) {
        if (!callback(state, segment, box[primitive])) return false;
        found |= Segments::bit(segment);
        return true;
    }
};

// Embree offers a box to some of a packet's rays; those that are found here travel no further.
void BoxTree::on_box_of_segments(const void* from_embree) noexcept {
    const auto* arguments = static_cast<const RTCOccludedFunctionNArguments*>(from_embree);
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
        for (std::size_t first = 0; first < segments.count; first += kPacket) {
            RTCRay16 rays;
            alignas(64) int valid[kPacket];
            if (set_packet(local, first, local.meets & ~found, rays, valid))
                occluded_coherent(valid, group.scene, &query, &rays);
        }
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
