// What a tree over boxes holds: Embree's scenes, and the frames in which they stand. Internal to this room.
#pragma once

#include <vector>

#include "intersect/box_tree.h"
#include "intersect/embree_device.h"

namespace trilens {

/// The way from the world to Embree's frame: centre at the origin, half diagonal 1.
struct LocalFrame {
    Vec3 centre{0};
    double scale = 1;  // local length = scale * world length

    Vec3 from_world(const Vec3& point) const { return (point - centre) * scale; }
};

struct BoxTree::Data {
    /// Boxes that share an Embree scene and its frame.
    struct Group {
        std::vector<Id> box;
        LocalFrame frame;
        RTCScene scene = nullptr;
    };

    explicit Data(const std::string& isa) : device(isa), packet_width(native_packet_width(device)) {}
    ~Data() {
        for (const Group& group : groups)
            if (group.scene) rtcReleaseScene(group.scene);
    }
    Data(const Data&) = delete;
    Data& operator=(const Data&) = delete;

    /// Embree offers a box to some of a packet's rays.
    static void on_box_of_segments(const RTCOccludedFunctionNArguments* arguments) noexcept;
    void build(std::span<const Box> boxes, Group& group);

    EmbreeDevice device;
    int packet_width = 4;  // rays that Embree takes at once
    std::vector<Group> groups;
};

}  // namespace trilens
