// Laws of bounds: nothing of the surface lies outside of them, and they shrink with the box.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "support/test.h"
#include "surfaces/polynomial/polynomial_bounds.h"
#include "surfaces/surfaces.h"
#include "test_cages.h"

using namespace trilens;
using namespace trilens_test;

namespace {

class Boxes {
  public:
    explicit Boxes(unsigned seed) : engine_(seed) {}

    double uniform(double low, double high) {
        return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0);
    }
    Id face(const Surface& surface) { return static_cast<Id>(engine_() % surface.face_count()); }

    /// Some dyadic, as a search has them, some not, some elongated, some beyond a triangle's long side.
    std::array<Vec2, 2> box(FaceDomain domain) {
        for (;;) {
            Vec2 low, high;
            for (int axis = 0; axis < 2; ++axis) {
                const int level = static_cast<int>(engine_() % 13);
                const double size = std::ldexp(1, -level);
                const double start = std::floor(uniform(0, 1) / size) * size;
                const bool dyadic = engine_() % 3 != 0;
                low[axis] = dyadic ? start : uniform(0, 1 - size);
                high[axis] = std::min(1.0, low[axis] + size);
            }
            // Every fourth box lies at a corner of the domain, where extraordinary vertices are.
            if (engine_() % 4 == 0) high -= low, low = Vec2(0);
            if (domain == FaceDomain::kSquare || low.x + low.y < 1) return {low, high};
        }
    }
    Vec2 inside(const std::array<Vec2, 2>& box, FaceDomain domain) {
        for (;;) {
            Vec2 t(uniform(0, 1), uniform(0, 1));
            for (int axis = 0; axis < 2; ++axis)
                if (engine_() % 4 == 0) t[axis] = std::round(t[axis]);
            const Vec2 uv = glm::mix(box[0], box[1], t);
            if (domain == FaceDomain::kSquare || uv.x + uv.y <= 1) return uv;
        }
    }

  private:
    std::mt19937 engine_;
};

struct Outside {
    int points = 0, outside = 0;
    double worst = 0;
};

/// Random boxes, random points in each.
Outside points_outside(const Surface& surface, unsigned seed, int box_count) {
    const auto bounder = surface.make_bounder();
    REQUIRE(bounder);
    Boxes boxes(seed);
    Outside result;
    for (int k = 0; k < box_count; ++k) {
        const Id face = boxes.face(surface);
        const auto box = boxes.box(surface.domain(face));
        const SurfaceBounds b = bounder->bounds(face, box[0], box[1]);
        const Box around = bounder->box(face, box[0], box[1]);
        for (int n = 0; n < 12; ++n) {
            const SurfacePoint p = surface.eval(face, boxes.inside(box, surface.domain(face)));
            if (!around.holds(p.position))
                ++result.outside, UNSCOPED_INFO("face " << face << ": out of its box");
            const std::array<std::array<double, 2>, 7> pairs = {
                {{length(p.position - b.middle.position), b.position_radius},
                 {length(p.du - b.middle.du), b.du_radius},
                 {length(p.dv - b.middle.dv), b.dv_radius},
                 {length(p.duu - b.middle.duu), b.duu_radius},
                 {length(p.duv - b.middle.duv), b.duv_radius},
                 {length(p.dvv - b.middle.dvv), b.dvv_radius},
                 {length(p.normal - b.middle.normal), b.normal_radius}}};
            for (std::size_t q = 0; q < pairs.size(); ++q) {
                ++result.points;
                if (pairs[q][0] <= pairs[q][1]) continue;
                ++result.outside;
                result.worst = std::max(result.worst, pairs[q][0] - pairs[q][1]);
                UNSCOPED_INFO("quantity " << q << " face " << face << " box " << box[0].x << " " << box[0].y
                                          << " " << box[1].x << " " << box[1].y << ": " << pairs[q][0]
                                          << " > " << pairs[q][1]);
            }
        }
    }
    return result;
}

Primitive primitive_of(const PrimitiveKind& kind) {
    return {.center = {3, -2, 0.5}, .axis = {0.3, 0.8, -0.4}, .kind = kind};
}

/// An even asphere, and a sphere with departures along its normals, with a hole.
const LensPrimitive kHoled{0.9, {0.5, 0, {0.02, -0.01}, 1.2}, {-0.4, 0, {}, 0.9, {0.02, 0.01, -0.005}}, 0.35};
/// A hyperboloid before an even asphere.
const LensPrimitive kLens{0.9,
                          {.curvature = 0.4, .conic = -2.2, .aperture = 1.3},
                          {.curvature = -0.3, .conic = 0.6, .coefficients = {0.01, -0.02, 0.004}}};

/// A biconic saddle before an aspheric toric side, and two cylinders that cross, with a hole.
const LensPrimitive kAnamorphic{1,
                                {0.4, -0.5, {}, 1.2, {}, SideForm::kBiconic, -0.2, 1.5},
                                {-0.3, 0.4, {0.01, -0.02}, 0.9, {}, SideForm::kToricX, -0.5}};
const LensPrimitive kCylinders{
    0.9, {0.5, 0, {}, 1.1, {}, SideForm::kToricY}, {-0.5, 0, {}, 1.1, {}, SideForm::kToricX}, 0.3};

const std::array<PrimitiveKind, 9> kBoundedKinds = {SpherePrimitive{1.7},
                                                    ParaboloidPrimitive{1.7, 0.6},
                                                    CylinderPrimitive{1.7, 4},
                                                    ConePrimitive{1.7, 1.1},
                                                    PlanePrimitive{{3, 0.7}},
                                                    kLens,
                                                    kHoled,
                                                    kAnamorphic,
                                                    kCylinders};

/// Patches of several degrees and weights; the k-th of the first four has its k-th side in one point.
std::vector<RationalPatch> rational_patches() {
    Boxes draw(41);
    std::vector<RationalPatch> patches;
    const std::array<std::array<int, 2>, 7> degrees = {
        {{3, 3}, {2, 3}, {3, 2}, {4, 4}, {1, 2}, {5, 1}, {3, 3}}};
    for (std::size_t k = 0; k < degrees.size(); ++k) {
        const auto [p, q] = degrees[k];
        RationalPatch patch{p, q, Vec3(2, -3, 10) * (k == 6 ? 1e3 : 1.0), {}};
        for (int j = 0; j <= q; ++j)
            for (int i = 0; i <= p; ++i) {
                Vec3 at(static_cast<double>(i) / p, static_cast<double>(j) / q, draw.uniform(-0.2, 0.2));
                const std::array<double, 4> distance = {at.y, 1 - at.x, 1 - at.y, at.x};
                if (k < 4 && distance[k] == 0)
                    at = Vec3(k == 1 ? 1 : k == 3 ? 0 : 0.5, k == 0 ? 0 : k == 2 ? 1 : 0.5, 0.1);
                const double w = draw.uniform(0.5, 2);
                patch.points.emplace_back(w * at, w);
            }
        patches.push_back(patch);
    }
    return patches;
}

/// An octahedron as a Loop cage: all its vertices have four faces, so none is regular.
Cage octahedron() {
    Cage cage =
        make_cage({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1.3}},
                  {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}});
    cage.scheme = SubdivisionScheme::kLoop;
    return cage;
}

}  // namespace

TEST_CASE("no point of a primitive lies outside its bounds", "[surfaces][law]") {
    for (const PrimitiveKind& kind : kBoundedKinds) {
        const auto surface = make_primitive_surface(primitive_of(kind));
        const Outside outside = points_outside(*surface, 1 + static_cast<unsigned>(kind.index()), 4000);
        CAPTURE(kind.index(), outside.worst);
        CHECK(outside.outside == 0);
        CHECK(outside.points > 300000);
    }
}

TEST_CASE("no point of a rational patch lies outside its bounds, nor beside a side that is one point",
          "[surfaces][law]") {
    const auto surface = make_patch_surface(rational_patches(), "patches");
    const Outside outside = points_outside(*surface, 31, 6000);
    CAPTURE(outside.worst);
    CHECK(outside.outside == 0);
    CHECK(outside.points > 400000);
    // Up to a pole normals keep within what they turn by.
    const auto bounder = surface->make_bounder();
    for (Id face = 0; face < 4; ++face)
        for (const double size : {0x1p-4, 0x1p-10, 0x1p-20}) {
            const Vec2 low[] = {{0.3, 0}, {1 - size, 0.3}, {0.3, 1 - size}, {0, 0.3}};
            const SurfaceBounds bounds = bounder->bounds(face, low[face], low[face] + size);
            CAPTURE(face, size);
            CHECK(bounds.normal_radius < 60 * size + 1e-8);
        }
}

TEST_CASE("no point of a limit surface lies outside its bounds", "[surfaces][law]") {
    unsigned seed = 10;
    auto cages = small_cages();
    cages.emplace_back("octahedron", octahedron());
    for (const auto& [name, cage] : cages) {
        const auto surface = make_limit_surface(cage, name, {});
        const Outside outside = points_outside(*surface, ++seed, 500);
        CAPTURE(name, outside.worst);
        CHECK(outside.outside == 0);
    }
}

TEST_CASE("no point of the outside data's cages lies outside its bounds", "[surfaces][law]") {
    TRILENS_NEEDS_DATA("cages");
    unsigned seed = 100;
    for (const std::string& name : cage_files()) {
        const auto surface = make_limit_surface(read_cage(name), name, {});
        const Outside outside = points_outside(*surface, ++seed, 300);
        CAPTURE(name, outside.worst);
        CHECK(outside.outside == 0);
    }
}

TEST_CASE("bounds shrink at least in proportion to the box", "[surfaces][law]") {
    auto cages = small_cages();
    cages.emplace_back("octahedron", octahedron());
    std::vector<std::pair<std::string, std::unique_ptr<Surface>>> surfaces;
    for (const auto& [name, cage] : cages) {
        if (name == "sheet" || name == "cube" || name == "prism 5" || name == "octahedron")
            surfaces.emplace_back(name, make_limit_surface(cage, name, {}));
    }
    for (const PrimitiveKind& kind : kBoundedKinds)
        surfaces.emplace_back("primitive", make_primitive_surface(primitive_of(kind)));
    surfaces.emplace_back("patches", make_patch_surface(rational_patches(), "patches"));
    REQUIRE(surfaces.size() == 14);

    Boxes boxes(77);
    for (const auto& [name, surface] : surfaces) {
        const auto bounder = surface->make_bounder();
        for (int k = 0; k < 200; ++k) {
            // Away from corners, where extraordinary vertices lie.
            const Vec2 middle(boxes.uniform(0.15, 0.4), boxes.uniform(0.15, 0.4));
            const Id face = boxes.face(*surface);
            const auto around = [&](double half) {
                return bounder->bounds(face, middle - half, middle + half);
            };
            const SurfaceBounds wide = around(0x1p-4), narrow = around(0x1p-9);
            CAPTURE(name, face, middle.x, middle.y);
            CHECK(narrow.position_radius <= wide.position_radius / 16 + 1e-9);
            CHECK(narrow.du_radius <= wide.du_radius / 16 + 1e-9);
            CHECK(narrow.dv_radius <= wide.dv_radius / 16 + 1e-9);
            CHECK(narrow.normal_radius <= wide.normal_radius / 16 + 1e-9);
            // Nor are they much too wide: of the first order, a ball around a parallelogram.
            const double reach = (length(narrow.middle.du) + length(narrow.middle.dv)) * 0x1p-9;
            CHECK(narrow.position_radius <= 4 * reach + 1e-9);
        }
    }
}

TEST_CASE("second derivatives of limit surfaces are the first ones' derivatives, in turned triangles too",
          "[surfaces]") {
    Boxes boxes(78);
    for (const auto& cage : {octahedron(), cube()}) {
        const auto surface = make_limit_surface(cage, "cage", {});
        for (int k = 0; k < 1000; ++k) {
            const Id face = boxes.face(*surface);
            const Vec2 uv(boxes.uniform(0.03, 0.48), boxes.uniform(0.03, 0.48));
            constexpr double kStep = 1e-6;
            const auto change = [&](const Vec2& step, Vec3 SurfacePoint::*first) {
                return (surface->eval(face, uv + step).*first - surface->eval(face, uv - step).*first) /
                       (2 * kStep);
            };
            const SurfacePoint point = surface->eval(face, uv);
            // Third derivatives jump between patches, so a step across shows in second order at most.
            CHECK(length(change({kStep, 0}, &SurfacePoint::du) - point.duu) < 1e-3);
            CHECK(length(change({0, kStep}, &SurfacePoint::du) - point.duv) < 1e-3);
            CHECK(length(change({0, kStep}, &SurfacePoint::dv) - point.dvv) < 1e-3);
        }
    }
}
