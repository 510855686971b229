// A bounding volume hierarchy over the patches of a surface, with cones of normals (Shirman and Abi-Ezzi, The
// cone of normals technique, Eurographics 1993), for beams of rays.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "base/math/box.h"
#include "base/raymesh/surface.h"

namespace trilens {

/// A facet of a grid with the piece of surface that it stands for; world frame.
struct SurfacePatch {
    std::array<Vec3, 3> corner;
    double stray = 0;          // world units: the surface lies within this distance of the facet
    double size = 0;           // longest edge, world units
    Vec3 normal{0};            // unit, along du x dv turned to the front; zero where there is none
    double normal_radius = 2;  // no normal of the piece lies farther from it: a chord between unit vectors
    bool bends_back = false;   // convex seen from its front, or flat but for a ten-thousandth of its size
    bool bends_front = false;  // convex seen from its back, likewise
};

/// A piece of a border, or of a crease across which normals jump.
struct SurfaceRim {
    std::array<Vec3, 2> end;
    double stray = 0;
};

/// The patches of one surface in a tree of boxes. Bounds come from samples of the surface, with room for what
/// lies between them, as those of LimitTracer do. Deterministic; thread-safe to read.
class PatchTree {
  public:
    /// `grid`: of that surface. Neither is kept.
    PatchTree(const Surface& surface, const SurfaceGrid& grid);

    /// Either a patch or a rim.
    struct Item {
        Box box;
        Id patch = kNone;
        Id rim = kNone;
    };
    struct Node {
        Box box;
        std::size_t first = 0;  // of items
        std::size_t count = 0;  // 0: an inner node
        std::size_t right = 0;  // of nodes; the left child is the next one
    };

    const std::vector<SurfacePatch>& patches() const { return patches_; }
    /// A crease is there twice, once for either side.
    const std::vector<SurfaceRim>& rims() const { return rims_; }
    /// Whether the surface has no border, and one orientation: a ray that does not cross it stays on one side
    /// of it, if the surface does not cross itself.
    bool is_closed() const { return is_closed_; }
    /// Whether it is the graph of a function over a convex region: one sheet, all its normals on one side,
    /// its outline convex seen from there. A ray that leaves it on one side does not meet it from that side
    /// again.
    bool is_height_field() const { return is_height_field_; }
    /// Of all patches with their strays; empty where there are none.
    Box bounds() const { return nodes_.empty() ? Box() : nodes_[0].box; }
    /// Half the diagonal of the box around all.
    double size() const { return size_; }

    /// Calls visit(item) for the items in boxes for which may_touch(box) is true, until it returns false;
    /// whether all of them returned true.
    template <typename MayTouch, typename Visit>
    bool all_of(MayTouch&& may_touch, Visit&& visit) const {
        if (nodes_.empty()) return true;
        std::array<std::size_t, 64> stack;
        std::size_t waiting = 0;
        stack[waiting++] = 0;
        while (waiting > 0) {
            const std::size_t at = stack[--waiting];
            const Node& node = nodes_[at];
            if (!may_touch(node.box)) continue;
            if (node.count == 0) {
                stack[waiting++] = node.right;
                stack[waiting++] = at + 1;
                continue;
            }
            for (std::size_t i = node.first; i < node.first + node.count; ++i)
                if (may_touch(items_[i].box) && !visit(items_[i])) return false;
        }
        return true;
    }

  private:
    void add_rims(const SurfaceGrid& grid);
    void set_shape(const SurfaceGrid& grid);
    void build();
    std::size_t add_node(std::size_t first, std::size_t last, int depth);

    std::vector<SurfacePatch> patches_;
    std::vector<SurfaceRim> rims_;
    std::vector<Item> items_;
    std::vector<Node> nodes_;
    bool is_closed_ = false, is_height_field_ = false;
    double size_ = 0;
};

// Where a ray meets one face of a curved surface: Newton's method on (u, v) in the plane at right angles to
// the ray. Source: Toth, On ray tracing parametric surfaces, SIGGRAPH 1985, with the ray's parameter
// eliminated.

/// A ray with an orthonormal frame about it: z runs along the ray.
struct RayFrame {
    Vec3 origin{0};
    Vec3 x{0}, y{0}, z{0};  // unit
    double speed = 0;       // length of the direction: z = speed * t

    /// A world point, seen along the ray: the ray's line is x = y = 0.
    Vec3 from_world(const Vec3& point) const {
        const Vec3 local = point - origin;
        return {dot(x, local), dot(y, local), dot(z, local)};
    }
};

/// None for a ray that is not finite or has no direction.
std::optional<RayFrame> make_ray_frame(const Ray& ray);

/// Where to look for a hit: a face, a first guess, and how far (in u and v) a step may go at most.
struct SurfaceGuess {
    Id face = kNone;
    Vec2 uv{0};
    double reach = 1;
};

/// The hit that Newton's method reaches from the guess, with any t; none where it reaches none within the
/// face. The hit lies on the ray to kSurfaceResidual times the distances to the world's and the ray's origin;
/// parameters that end up outside of the face by up to kDomainSlack are put on its border. Its point is that
/// of Surface::eval_first_order.
std::optional<SurfaceHit> solve_surface_hit(const Surface& surface, const RayFrame& ray,
                                            const SurfaceGuess& guess);

/// Where a ray that meets the surface at `hit` should meet it a second time close by, if it bends as it does
/// at `hit` (near a silhouette the two are close, and either may be the first): parameters and the step in t.
/// None for flat spots. `hit` with second derivatives.
struct SecondHit {
    Vec2 uv{0};
    double t_step = 0;
};
std::optional<SecondHit> predict_second_hit(const SurfaceHit& hit, const Vec3& direction);

/// Eval rounds at about 1e-16 of the coordinates, several times over; a near miss of more than this is a
/// miss.
inline constexpr double kSurfaceResidual = 1e-13;

}  // namespace trilens
