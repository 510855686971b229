// A light's beams where they fall on one plane.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "caustics/beam_tree.h"
#include "caustics/plane_tree.h"
#include "caustics/receiver_faces.h"
#include "caustics/refined_beams.h"

namespace trilens {

/// What the rays at a beam's ends say about the way to a plane.
enum class Way { kFree, kStopped, kUnknown };
/// `same_place`: world units.
Way way_to(const BeamEnds& end, const ReceiverPlane& plane, double same_place);

/// How far light may fall from its place.
struct PlaneBeamsParams {
    double tolerance = 0;    // world units
    double reach = 0;        // beyond the face, world units
    double brightest = 0;    // path of the light: the sum of its colours
    double faint_light = 0;  // irradiance, the sum of its colours, that is not looked at closely
    double same_place = 0;   // world units
    // No light of the source comes straight to the face, which would drown what is faint there: it is looked
    // at as closely as it is bright beside what else comes to the face over optics.
    bool is_alone = false;
};

/// The beams that come to one side of a face, as curved beams in the plane's own coordinates: divided by
/// exact rays where those between their six lie beside the quadratic, as at silhouettes. Thread-safe to read.
class PlaneBeams {
  public:
    /// The beams and what belongs to them must live longer.
    struct Source {
        const Beams& beams;
        const BeamTree& tree;
        const RefinedBeams& refined;
    };
    /// `normal`: of the side that receives. Throws Interrupted soon after `progress` says so.
    PlaneBeams(const Source& source, const ReceiverFace& face, const Vec3& normal,
               const PlaneBeamsParams& params, const Progress& progress = {});

    /// Calls use(beam, way, corners, fallen) for every piece that may come to the point, which is a
    /// receiver's without a footprint; of beams that are stopped on their way for none.
    template <typename Use>
    void for_each_piece(const ReceiverPlane& point, const Use& use) const;

    /// The same of a footprint, in sums: calls use_light(light) with the light, times its part of the film,
    /// of all that comes there without being asked for its way, and use(beam, way, corners, fallen, part) for
    /// every other piece. `sums`: whether there are receivers that need not ask (see is_plain).
    template <typename UseLight, typename Use>
    void for_each_part(const ReceiverPlane& footprint, bool sums, const UseLight& use_light,
                       const Use& use) const;

  private:
    struct Curved {
        BeamCorners corners;
        FallenCurve curve;
        Id index = kNone;
        Way way = Way::kUnknown;
        int sides = 4;          // of its pieces
        bool is_plain = false;  // all of it comes, through air
        Vec3 mean_light{0};
        // Of at most four pieces: each one's share of the film over the mean share, as their areas are, and
        // the light that they have then, at the ends and middles. Of 16 pieces all are alike, and so is the
        // curve's.
        std::array<double, 4> part{1, 1, 1, 1};
        std::array<Vec3, 6> spread{};
        double part_of(std::size_t piece) const { return sides < PieceGrid::kMostSides ? part[piece] : 1; }
    };
    struct Flat {  // what the plane cuts, or lies askew to
        BeamCorners corners;
        FallenBeam fallen;
        Id index = kNone;
        Way way = Way::kUnknown;
    };
    /// What becomes of one beam, and the ends of that which are no beam's.
    struct Parts {
        std::vector<Curved> curved;
        std::vector<Flat> flat;
        std::vector<std::unique_ptr<const BeamEnd>> ends;
    };
    struct Target {
        const Source& source;
        const ReceiverPlane& plane;
        const PlaneBeamsParams& params;
        Vec2 half;  // of the rectangle around the face
        const Progress& progress;
    };
    struct PartsMaker;
    static Parts parts_of(const Target& target, Id beam);
    /// From the plane's coordinates to the footprint's.
    struct Map {
        Vec2 origin{0};
        Mat2 turn{1};
        Vec2 operator()(const Vec2& at) const { return origin + turn * at; }
    };
    static std::array<Vec2, 6> fallen_on(const Curved& one, const Map& map);
    // Of where a curved beam falls, in a footprint's coordinates.
    static bool is_inside(const std::array<Vec2, 6>& at);
    static Vec3 light_of(const Curved& one, const std::array<Vec2, 6>& at);
    template <typename Use>
    static void use_parts(const Curved& one, const std::array<Vec2, 6>& at, const Use& use);
    template <typename Use>
    static void use_flat(const Flat& one, const Map& map, double half, const Use& use);
    Map map_to(const ReceiverPlane& footprint) const;
    static PlaneParallelogram parallelogram_of(const ReceiverPlane& footprint, const Map& map);

    ReceiverPlane plane_;
    std::vector<std::unique_ptr<const BeamEnd>> ends_;  // of parts, that are no beams'
    std::vector<Curved> curved_;
    std::vector<Flat> flat_;
    PlaneTree tree_;  // over the curved, and after them the flat
};

template <typename Use>
void PlaneBeams::for_each_piece(const ReceiverPlane& point, const Use& use) const {
    const Map map = map_to(point);
    tree_.for_each_near(parallelogram_of(point, map), [&](std::uint32_t entry) {
        if (entry >= curved_.size()) return use_flat(flat_[entry - curved_.size()], map, 0, use);
        const Curved& one = curved_[entry];
        CurvedBeam{one.corners, {}}.for_each_piece({fallen_on(one, map), one.curve.light}, 0, one.sides,
                                                   [&](const BeamCorners& corners, const FallenBeam& fallen) {
                                                       use(one.index, one.way, corners, fallen);
                                                   });
    });
}

template <typename UseLight, typename Use>
void PlaneBeams::for_each_part(const ReceiverPlane& footprint, bool sums, const UseLight& use_light,
                               const Use& use) const {
    const Map map = map_to(footprint);
    tree_.for_each_near(parallelogram_of(footprint, map), [&](std::uint32_t entry) {
        if (entry >= curved_.size()) {
            use_flat(flat_[entry - curved_.size()], map, 0.5,
                     [&](Id index, Way way, const BeamCorners& corners, const FallenBeam& fallen) {
                         if (const auto part = part_at_footprint(fallen, footprint))
                             use(index, way, corners, fallen, *part);
                     });
            return;
        }
        const Curved& one = curved_[entry];
        const std::array<Vec2, 6> at = fallen_on(one, map);
        if (sums && one.is_plain) {
            const Vec3 light = light_of(one, at);
            if (light != Vec3(0)) use_light(light);
        } else {
            use_parts(one, at, use);
        }
    });
}

template <typename Use>
void PlaneBeams::use_parts(const Curved& one, const std::array<Vec2, 6>& at, const Use& use) {
    FallenBeam fallen;
    if (is_inside(at)) {
        for (std::size_t k = 0; k < 3; ++k) fallen.light[k] = one.mean_light;
        return use(one.index, one.way, one.corners, fallen,
                   FootprintPart{one.corners.measure, Vec3(1.0 / 3)});
    }
    const PieceGrid& grid = PieceGrid::of(one.sides);
    CutPieces cut;
    cut_pieces(at, one.sides, cut);
    const double measure = one.corners.measure / static_cast<double>(grid.pieces);
    for (std::size_t p = 0; p < grid.pieces; ++p) {
        if (!(cut.share[p] > 0)) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t n = grid.piece[p][k];
            fallen.weights[k] = grid.weights[n];
            fallen.light[k] = Vec3(0);
            for (std::size_t c = 0; c < 6; ++c) fallen.light[k] += grid.quadratic[n][c] * one.spread[c];
        }
        use(one.index, one.way, one.corners, fallen,
            FootprintPart{cut.share[p] * one.part_of(p) * measure,
                          Vec3(cut.weight[0][p], cut.weight[1][p], cut.weight[2][p])});
    }
}

template <typename Use>
void PlaneBeams::use_flat(const Flat& one, const Map& map, double half, const Use& use) {
    FallenBeam fallen = one.fallen;
    for (Vec2& at : fallen.at) at = map(at);
    if (!is_beyond(fallen.at, half, 0)) use(one.index, one.way, one.corners, fallen);
}

}  // namespace trilens
