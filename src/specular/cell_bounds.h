// Interval tests of a cell: that it holds no image, or at most one (Krawczyk's operator).
#pragma once

#include "base/raymesh/surface.h"
#include "specular/chain/sight.h"
#include "specular/specular_point.h"

namespace trilens {

/// A piece of surface by a ball around its positions and one around its unit normals.
struct PlaceBounds {
    Vec3 position{0};  // world frame
    double position_radius = 0;
    Vec3 normal{0};  // unit
    double normal_radius = 2;
};

PlaceBounds place_of(const SurfaceBounds& bounds);

/// How the query's eye sees a piece: the same for all points.
struct EyeView {
    bool is_behind = false;  // proven: behind the camera, or seen from a side that is not asked for
    bool is_apart = true;    // the eye is not in the piece's ball; else nothing more is known
    bool knows_side = false;
    double cosine = 0;  // of the direction and the normal; its sign is the side
    Sight sight;
};

EyeView eye_view(const SpecularQuery& query, const PlaceBounds& place);

/// What a piece of surface can show of a ball of points.
struct PlaceTest {
    bool empty = false;                  // proven: no point of the ball has an image in the piece
    double by_place = 0, by_points = 0;  // how much of what is not known comes from either one's size
};

/// For the points within `point_radius` >= 0 (world units) of the query's point; `view` is eye_view(query,
/// place). Empty only if everywhere the piece lies behind the camera, or eye and points lie on wrong sides of
/// it, or h = n1 e + n2 x cannot be parallel to the normal.
PlaceTest test_place(const SpecularQuery& query, const PlaceBounds& place, const EyeView& view,
                     double point_radius);

/// The interval Newton operator in Krawczyk's form (Neumaier, Interval Methods for Systems of Equations,
/// chapter 5) on a cell of a face, in parameters from the cell's middle: every zero of (h . du, h . dv) in
/// the cell lies within `spread` + `shift` of `step`. Where the spread is less than half the cell's sides,
/// there is one zero at most.
struct NewtonBounds {
    bool known = false;  // else the bounds say nothing
    Vec2 step{0};        // Newton's step from the middle
    Vec2 spread{0};      // for zeros anywhere in the cell; in proportion to their distance from the start
    Vec2 rounding{0};    // how far rounding moves a zero
    Vec2 shift{0};       // how far `step` may lie from the step of another point of the ball
    Mat2 inverse{0};     // of the Jacobian at the middle
    Vec2 law{0};         // at the middle
};

/// In parameters: zeros this far outside of a cell count as on its border, so that neighbours leave no gap.
inline constexpr double kCellBorder = 1e-12;

/// Whether the Newton operator shows that the cell has no zero: both are of the cell with these half sides.
bool leaves_cell(const NewtonBounds& newton, const Vec2& half);

/// What newton_bounds works with that is the same for all points.
struct CellTerms {
    const SurfaceBounds* bounds = nullptr;  // must live longer
    Reach u, v, uu, uv, vv;
    PathIndices n;
    bool is_apart = true;                       // EyeView's
    Vec3 eye_bend{0};                           // the eye's part of h in the middle,
    double eye_turn = 0;                        // and how much that changes
    double eye_uu = 0, eye_uv = 0, eye_vv = 0;  // the eye's part of the radii of the Hessian's entries
    Vec3 eye_change_u{0}, eye_change_v{0};      // how eye_bend changes along du and dv
    double eye_by_distance = 0;
    double coordinate = 0;  // the largest of eye and middle
};

/// `view` is eye_view of the cell's place.
CellTerms cell_terms(const SpecularQuery& query, const SurfaceBounds& bounds, const EyeView& view);

/// For the points within `point_radius` >= 0 of `point`; `half` is half the cell's sides. For own normals.
NewtonBounds newton_bounds(const CellTerms& terms, const Vec3& point, const Vec2& half,
                           double point_radius = 0);

/// Works out inverse and step once more, with directions normalised to the last bit, where a zero is next
/// looked for.
void step_with_care(const SpecularQuery& query, const SurfacePoint& middle, NewtonBounds& newton);

}  // namespace trilens
