// The limit surface of a cage as patches that OpenSubdiv evaluates; behind this header lies THE door to
// OpenSubdiv.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/math/box.h"
#include "base/raymesh/surface.h"
#include "surfaces/checked_cage.h"
#include "surfaces/polynomial/face_stencils.h"

namespace trilens {

/// Limit patches of the faces of a cage, made when a face is first evaluated, from any thread. A bounded
/// number of them is kept; they are the same bit for bit whenever they are made. Where they are very many, a
/// patch that is of a kind with many others has no patch points of its own: those that matter at a place are
/// made when it is evaluated there, and are the same bit for bit, too.
///
/// Exactness: patches are exact (bicubic, or quartic for Loop) outside a region of 2^-10 of a face around
/// each extraordinary vertex and along creases of a sharpness near 10; inside it OpenSubdiv fits Gregory
/// patches to the limit.
class LimitPatches {
  public:
    /// Throws InputError(name, ...) where OpenSubdiv refuses the topology, and where more than `memory` bytes
    /// are needed.
    LimitPatches(const CheckedCage& cage, const std::string& name, double memory);
    ~LimitPatches();

    /// Whether all of the face has a limit surface: false for holes, and near boundaries that are not
    /// interpolated.
    bool has_limit(int face) const;

    /// A face of the cage, or the sub-face of it from a corner on: see eval().
    struct Face {
        int face = 0, sub_face = -1;
    };
    /// Per face a box that holds its limit surface, without any of its patches.
    std::vector<Box> hulls(std::span<const Face> faces) const;

    /// Position and derivatives, without a normal, and how far the control points around spread (0: they
    /// coincide).
    struct Point {
        SurfacePoint point;
        double extent = 0;
    };
    /// At (u, v) inside the domain. Faces with four corners, and triangles under Loop: sub_face -1, corners
    /// as in FaceBorder. Other faces: sub_face k is the quad from corner k over the middle of edge k and the
    /// centre to the middle of edge k - 1.
    Point eval(int face, int sub_face, const Vec2& uv) const;
    /// The same without second derivatives.
    Point eval_first_order(int face, int sub_face, const Vec2& uv) const;

    /// Faces of one kind are the same sums of their control points; none where the face is several patches, a
    /// regular one, or of a kind of its own.
    std::optional<std::uint64_t> kind(int face, int sub_face) const;
    /// The control points of a face that has a kind, and their weights at (u, v) for position, du, dv, duu,
    /// duv and dvv.
    FaceControls controls(int face, int sub_face) const;
    FaceStencils stencils(int face, int sub_face, const Vec2& uv) const;

    /// What is held now, in bytes; see Surface::bytes_held.
    std::size_t bytes() const;

  private:
    template <bool kSecondOrder>
    Point eval_to_order(int face, int sub_face, const Vec2& uv) const;

    struct Impl;
    std::unique_ptr<Impl> impl_;  // none for a cage without faces
};

}  // namespace trilens
