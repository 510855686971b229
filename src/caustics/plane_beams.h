// Bounding-volume hierarchy, in two dimensions, over where a light's beams fall on one plane.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "caustics/beam_tree.h"
#include "caustics/receiver_faces.h"
#include "caustics/refined_beams.h"

namespace trilens {

/// What the rays at a beam's ends say about the way to a plane.
enum class Way { kFree, kStopped, kUnknown };
/// `same_place`: world units.
Way way_to(const Beams& beams, const LightBeam& beam, const ReceiverPlane& plane, double same_place);

/// How far light may fall from its place.
struct PlaneBeamsParams {
    double tolerance = 0;    // world units
    double reach = 0;        // beyond the face, world units
    double brightest = 0;    // path of the light: the sum of its colours
    double faint_light = 0;  // irradiance, the sum of its colours, that is not looked at closely
    double same_place = 0;   // world units
};

/// The beams that come to one side of a face, as curved beams in the plane's own coordinates: divided by
/// exact rays where those between their six lie beside the quadratic, as at silhouettes. Thread-safe to read.
class PlaneBeams {
  public:
    /// `normal`: of the side that receives. The beams and what belongs to them must live longer.
    struct Source {
        const Beams& beams;
        const BeamTree& tree;
        const RefinedBeams& refined;
    };
    PlaneBeams(const Source& source, const ReceiverFace& face, const Vec3& normal,
               const PlaneBeamsParams& params);

    /// Calls use(beam, way, corners, fallen) for every piece that may come to the footprint; of beams that
    /// are stopped on their way for none.
    template <typename Use>
    void for_each_piece(const ReceiverPlane& footprint, const Use& use) const;

  private:
    struct Curved {
        CurvedBeam beam;
        FallenCurve curve;
        Id index = kNone;
        Way way = Way::kUnknown;
        int sides = 4;  // of its pieces
        Vec3 mean_light{0};
    };
    struct Flat {  // what the plane cuts, or lies askew to
        BeamCorners corners;
        FallenBeam fallen;
        Id index = kNone;
        Way way = Way::kUnknown;
    };
    struct Box2 {
        Vec2 low{INFINITY}, high{-INFINITY};
        void include(const Vec2& at) { low = glm::min(low, at), high = glm::max(high, at); }
        bool meets(const Box2& other) const {
            return low.x <= other.high.x && other.low.x <= high.x && low.y <= other.high.y &&
                   other.low.y <= high.y;
        }
    };
    struct Node {
        Box2 box;
        std::uint32_t skip = 0;            // the node after this one's subtree
        std::uint32_t first = 0, end = 0;  // a leaf's entries in order_
    };
    struct Maker;
    /// From the plane's coordinates to the footprint's.
    struct Map {
        Vec2 origin{0};
        Mat2 turn{1};
        Vec2 operator()(const Vec2& at) const { return origin + turn * at; }
    };
    template <typename Use>
    static void use_curved(const Curved& one, const Map& map, double half, const Use& use);
    template <typename Use>
    static void use_flat(const Flat& one, const Map& map, double half, const Use& use);
    /// Around the Bezier points of a quadratic triangle.
    static Box2 hull_box(const std::array<Vec2, 6>& at);
    Map map_to(const ReceiverPlane& footprint) const;
    Box2 box_of(const ReceiverPlane& footprint, const Map& map) const;
    Box2 box_of(std::uint32_t entry) const;
    void build(std::uint32_t first, std::uint32_t end);

    ReceiverPlane plane_;
    std::vector<Curved> curved_;
    std::vector<Flat> flat_;
    std::vector<Box2> boxes_;           // of all of them
    std::vector<Node> nodes_;           // depth first
    std::vector<std::uint32_t> order_;  // of the curved, and after them of the flat
};

template <typename Use>
void PlaneBeams::for_each_piece(const ReceiverPlane& footprint, const Use& use) const {
    const Map map = map_to(footprint);
    const Box2 asked = box_of(footprint, map);
    const double half = footprint.has_footprint ? 0.5 : 0;
    for (std::size_t n = 0; n < nodes_.size();) {
        const Node& node = nodes_[n];
        if (!node.box.meets(asked)) {
            n = node.skip;
            continue;
        }
        for (std::uint32_t i = node.first; i < node.end; ++i) {
            const std::uint32_t entry = order_[i];
            if (!boxes_[entry].meets(asked)) continue;
            if (entry < curved_.size())
                use_curved(curved_[entry], map, half, use);
            else
                use_flat(flat_[entry - curved_.size()], map, half, use);
        }
        ++n;
    }
}

template <typename Use>
void PlaneBeams::use_curved(const Curved& one, const Map& map, double half, const Use& use) {
    FallenCurve curve = one.curve;
    for (Vec2& at : curve.at) at = map(at);
    const Box2 box = hull_box(curve.at);
    const bool is_inside = std::max({-box.low.x, -box.low.y, box.high.x, box.high.y}) <= half;
    if (!is_inside) {
        one.beam.for_each_piece(curve, half, one.sides,
                                [&](const BeamCorners& corners, const FallenBeam& fallen) {
                                    use(one.index, one.way, corners, fallen);
                                });
        return;
    }
    FallenBeam whole;
    whole.measure = one.beam.corners.measure;
    for (std::size_t k = 0; k < 3; ++k) whole.at[k] = curve.at[k], whole.light[k] = one.mean_light;
    use(one.index, one.way, one.beam.corners, whole);
}

template <typename Use>
void PlaneBeams::use_flat(const Flat& one, const Map& map, double half, const Use& use) {
    FallenBeam fallen = one.fallen;
    for (Vec2& at : fallen.at) at = map(at);
    if (!is_beyond(fallen.at, half, 0)) use(one.index, one.way, one.corners, fallen);
}

}  // namespace trilens
