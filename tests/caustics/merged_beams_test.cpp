// One beam for many: only where a quadratic has all of their rays.
#include "caustics/beams/merged_beams.h"

#include <array>
#include <vector>

#include "caustics/beams/quadratic.h"
#include "support/test.h"

using namespace trilens;

namespace {

/// Rays straight down on a floor from a triangle, and how they are displaced: a share of the tolerance each.
struct RayField {
    double quadratic = 0, cubic = 0, light = 0;

    LightPath at(const Vec3& w) const {
        const double u = w.y, v = w.z;
        LightPath path;
        path.ray = {{u + kTolerance * quadratic * u * u, v + kTolerance * cubic * (u * v * v), 1},
                    {0, 0, -1}};
        path.object = 1;
        path.light = Vec3(1 + light * u * v * v);
        return path;
    }
    static constexpr double kTolerance = 1e-3;
};

/// The corners, the middles of the sides, and if asked for what lies a quarter of the way in.
class Rays {
  public:
    Rays(const RayField& field, bool with_middles, bool with_inner) {
        std::vector<Vec3> places{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        if (with_middles) places.insert(places.end(), {{0, 0.5, 0.5}, {0.5, 0, 0.5}, {0.5, 0.5, 0}});
        if (with_inner)
            places.insert(places.end(), {{0.5, 0.25, 0.25}, {0.25, 0.5, 0.25}, {0.25, 0.25, 0.5}});
        for (const Vec3& w : places) paths.push_back(field.at(w));
        for (std::size_t i = 0; i < places.size(); ++i) samples.push_back({places[i], &paths[i]});
    }
    bool are_one(double faint = 0) const {
        return is_one_beam(samples, 0.5, {RayField::kTolerance, 1, 3, faint});
    }

    std::vector<LightPath> paths;
    std::vector<MergeSample> samples;
};

}  // namespace

TEST_CASE("many beams are one where a quadratic has all of their rays, and only there", "[caustics]") {
    // A quadratic is what a beam is, however far it bends, once something beside its six rays tells so.
    CHECK(Rays({100, 0, 0}, true, true).are_one());
    CHECK(Rays({1, 0, 0}, true, false).are_one());
    CHECK_FALSE(Rays({100, 0, 0}, true, false).are_one());
    CHECK_FALSE(Rays({100, 0, 0}, false, true).are_one());
    // u v^2 is off its quadratic by up to 1/32 at these places.
    CHECK(Rays({0, 0.9 * 32 * kFaintOff, 0}, true, true).are_one());
    CHECK_FALSE(Rays({0, 1.1 * 32 * kFaintOff, 0}, true, true).are_one());
    // Where light is faint it may fall beside its place: its density is 3 / 2 over an area of 1 / 2.
    CHECK(Rays({0, 100, 0}, true, true).are_one(3.1));
    CHECK_FALSE(Rays({0, 100, 0}, true, true).are_one(2.5));
    // What it carries counts alike.
    CHECK(Rays({0, 0, 0.5}, true, true).are_one());
    CHECK_FALSE(Rays({0, 0, 2}, true, true).are_one());
}

TEST_CASE("beams that meet different things are not made one", "[caustics]") {
    const RayField straight;
    Rays away(straight, true, true), step(straight, true, true), next(straight, true, true);
    CHECK(away.are_one());
    away.paths[7].object = std::numeric_limits<double>::infinity();
    CHECK_FALSE(away.are_one());
    step.paths[7].object = 1 - 2 * RayField::kTolerance;
    CHECK_FALSE(step.are_one());
    next.paths[7].object = std::numeric_limits<double>::infinity(), next.paths[7].optic = 0.5;
    CHECK_FALSE(next.are_one());
    // What all goes on to another optic needs no beam, so however it does.
    for (LightPath& path : away.paths)
        path.object = std::numeric_limits<double>::infinity(), path.optic = 0.5;
    CHECK(away.are_one());
}
