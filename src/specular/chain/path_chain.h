// Chains of reflections and refractions by Fermat's principle: Newton's method, and the implicit function
// theorem for how they move.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/raymesh/surface.h"
#include "base/util/few.h"

namespace trilens {

/// Paths over so many surfaces need no memory of their own.
inline constexpr std::size_t kFewEvents = 6;
/// Something of each event of a chain.
template <typename T>
using PerEvent = Few<T, kFewEvents>;
/// Something of each stretch, one more than events.
template <typename T>
using PerStretch = Few<T, kFewEvents + 1>;
/// A matrix of two rows and columns per event, row by row.
using ChainMatrix = Few<double, 4 * kFewEvents * kFewEvents>;

/// An end of a light path, world frame: a point, or one at infinity.
struct ChainEnd {
    Vec3 place{0};  // the point; at infinity: the unit direction of the stretch that touches it, from the eye
                    // to the point
    bool is_direction = false;
};

/// One meeting with a surface; a mirror has the same index on both sides.
struct ChainEvent {
    const Surface* surface = nullptr;
    double index_before = 1, index_after = 1;  // refractive, on the eye's side of the path and on the point's
    bool reflects = true;                      // else it is refracted
};

/// A path from the eye over surfaces to a point.
struct PathChain {
    ChainEnd eye, point;
    PerEvent<ChainEvent> events;  // at least one
};

/// A path's shape: where it meets each surface.
struct ChainShape {
    PerEvent<SurfaceParameter> at;
    PerEvent<SurfacePoint> points;  // there
};

/// What the optical path's first derivatives are made of. With P_0 the eye, P_1 .. P_k the events and
/// P_(k+1) the point, e_i the unit direction from P_i to P_(i+1) and n_i the index along it, the bend at an
/// event is g_i = n_(i-1) e_(i-1) - n_i e_i; the path is one of light (Fermat) where g_i is along the normal:
/// g_i . du = g_i . dv = 0.
struct ChainBend {
    PerStretch<Vec3> way;       // e_0 .. e_k
    PerStretch<double> length;  // of each stretch, scene units; infinite at an end at infinity
    PerEvent<Vec3> bend;        // g_1 .. g_k
};

ChainBend chain_bend(const PathChain& chain, std::span<const SurfacePoint> points);

/// F: (g_i . du, g_i . dv) of every event.
PerEvent<Vec2> chain_law(const ChainBend& bend, std::span<const SurfacePoint> points);

/// The largest part of a bend that lies along its surface: 0 for light; in 0 .. n_before + n_after.
double chain_residual(const ChainBend& bend, std::span<const SurfacePoint> points);

/// The second derivatives of the optical path in the events' parameters, two per event: a full matrix, row by
/// row, symmetric and block tridiagonal.
ChainMatrix chain_second_derivatives(const PathChain& chain, const ChainBend& bend,
                                     std::span<const SurfacePoint> points);

/// chain_second_derivatives(), factored.
/// Solves A x = b by Gaussian elimination with partial pivoting inside the band.
class ChainHessian {
  public:
    ChainHessian(const PathChain& chain, const ChainBend& bend, std::span<const SurfacePoint> points);

    /// False at a caustic, where the path is no function of what it depends on.
    bool is_regular() const { return is_regular_; }
    /// `right`: two numbers per event.
    PerEvent<Vec2> solve(std::span<const Vec2> right) const;

  private:
    double& at(std::size_t row, std::size_t column) { return matrix_[row * size_ + column]; }
    double at(std::size_t row, std::size_t column) const { return matrix_[row * size_ + column]; }
    void factor();

    std::size_t size_ = 0;
    ChainMatrix matrix_;
    Few<std::size_t, 2 * kFewEvents> pivot_;
    bool is_regular_ = true;
};

/// How the image over a path of light moves: the implicit function theorem on the law F(u, theta) = 0, where
/// u are the places on the surfaces and theta is what moves: du / dtheta = -A^-1 dF / dtheta. Only the first
/// event's place moves the image, so two solutions with A, which is symmetric, serve everything that moves
/// (the adjoint method): they say how the image follows each part of the path while the others hold, and what
/// moves several parts moves it by the sum.
class PathSensitivity {
  public:
    /// `slope`: how the image's pixel moves with the first event's position, rows x and y.
    PathSensitivity(const PathChain& chain, std::span<const SurfacePoint> points,
                    const std::array<Vec3, 2>& slope);

    /// Whether the law holds at the points, to rounding.
    bool is_light() const { return is_light_; }
    /// False at a caustic, where the image moves infinitely fast; nothing of what follows may be asked then.
    bool is_regular() const { return is_regular_; }
    /// Pixels per scene unit of the chain's point; of a direction per radian across it. Rows x and y.
    const std::array<Vec3, 2>& by_point() const { return by_point_; }
    /// Pixels as the eye moves, or the direction that it sees along turns; not what the film itself does
    /// then.
    Vec2 by_eye(const Vec3& change) const { return {dot(by_eye_[0], change), dot(by_eye_[1], change)}; }
    /// Pixels as the surface of an event moves from `before` to `after`, both at the event's (u, v): their
    /// positions, du and dv count.
    Vec2 by_surface(std::size_t event, const SurfacePoint& before, const SurfacePoint& after) const;
    /// Pixels as the index along a stretch changes; stretch 0 starts at the eye.
    Vec2 by_index(std::size_t stretch, double change) const { return change * by_index_[stretch]; }

  private:
    void follow(std::size_t axis, const PathChain& chain, const ChainBend& bend,
                std::span<const Vec3> yields);

    /// Of an event's position and tangents: rows x and y.
    struct BySurface {
        std::array<Vec3, 2> position, du, dv;
    };

    bool is_light_ = false, is_regular_ = false;
    PerEvent<BySurface> by_surface_;
    PerStretch<Vec2> by_index_;
    std::array<Vec3, 2> by_eye_{}, by_point_{};
};

/// A step that leaves its face at `border` for a point of space; `from` sees that from where light comes.
struct LeavingStep {
    std::size_t event = 0;
    SurfaceParameter border;
    Vec3 from{0}, towards{0};
};
/// The parameter of the surface near a step's end; none where there is none.
using FindParameter = std::function<std::optional<SurfaceParameter>(const LeavingStep&)>;

/// The path of light near `start`, to rounding, by Newton's method whose steps are shortened until the law's
/// residual falls. None where it finds none: no solution nearby, one beyond a face that `find` does not carry
/// it over, or a path of another kind (reflected through a surface, refracted back from it).
std::optional<ChainShape> solve_chain(const PathChain& chain, std::span<const SurfaceParameter> start,
                                      const FindParameter& find = {});

/// Whether each event leaves light on the side of the surface that its kind says.
bool chain_sides_fit(const PathChain& chain, const ChainBend& bend, std::span<const SurfacePoint> points);

// A proof that there is one path of light near another: Krawczyk's operator on all parameters of a chain
// (Neumaier, Interval Methods for Systems of Equations, chapter 5).

/// For each event of a chain a box of its surface's parameters, and what that does over it.
struct ChainBox {
    std::vector<SurfaceBounds> bounds;
    std::vector<Vec2> half;  // of the boxes' sides, > 0
};

/// How much each entry of chain_second_derivatives() changes over the boxes at most, from their middles: a
/// full matrix, row by row; empty where a stretch of the path may have no length.
std::vector<double> second_derivative_radii(const PathChain& chain, const ChainBox& box);

/// Whether it is proven that exactly one path of light between the chain's ends meets its surfaces within
/// these boxes, with each event on the sides that its kind says. False says nothing. Sound for surfaces whose
/// normals are their own, up to the bounds of these; rounding is allowed for.
bool holds_one_path(const PathChain& chain, const ChainBox& box);

}  // namespace trilens
