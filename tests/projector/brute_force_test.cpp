// The projector sees what long double sees, triangle by triangle.
#include "brute_force.h"
#include "base/raymesh/rasterize.h"
#include "projector/projector.h"
#include "random_cases.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

struct BruteForceTally {
    std::size_t samples = 0, seen = 0, marginal = 0, wrong = 0, inaccurate = 0;
};

/// Whether the difference between the seen triangle and the true one is one that rounding explains.
bool rounding_explains(const std::vector<PlaneHit>& hits, std::size_t seen, std::size_t truth) {
    if (seen != kNone && hits[seen].marginal()) return true;
    if (truth != kNone && hits[truth].marginal()) return true;
    if (seen == kNone || truth == kNone) return false;
    const PlaneHit &s = hits[seen], &t = hits[truth];
    return s.inside() &&
           std::fabs(s.t - t.t) <= s.t_error + t.t_error + 2 * static_cast<Real>(kDepthTie) * t.t;
}

void compare_sample(const TriangleScene& scene, const RealRay& ray, const Hit& hit, BruteForceTally& tally) {
    std::vector<PlaneHit> all(scene.size());
    for (std::size_t i = 0; i < scene.size(); ++i) all[i] = meet(ray, scene, i);
    const std::size_t truth = first_along(all, scene);
    ++tally.samples;
    if (truth != kNone) ++tally.seen;
    if (hit.triangle != truth) {
        const bool explained = rounding_explains(all, hit.triangle, truth);
        ++(explained ? tally.marginal : tally.wrong);
        return;
    }
    if (truth == kNone) return;
    const PlaneHit& t = all[truth];
    const bool good = std::fabs(hit.t - t.t) <= t.t_error + 1e-12L * t.t &&
                      std::fabs(hit.barycentric.x - t.weight[1]) <= t.weight_error &&
                      std::fabs(hit.barycentric.y - t.weight[2]) <= t.weight_error && hit.t >= 0 &&
                      hit.barycentric.x >= 0 && hit.barycentric.y >= 0;
    if (!good) ++tally.inaccurate;
}

void compare_case(const RayMesh& mesh, const TriangleScene& scene, const SampleGrid& grid,
                  const FacetSamples& owned, BruteForceTally& tally) {
    std::vector<Hit> hits(grid.size());
    draw(PreparedScene(scene), mesh, owned, grid, hits);
    for (const Id sample : owned.of(0)) {
        compare_sample(scene, ray_at(mesh, 0, grid.position(sample)), hits[sample], tally);
    }
}

}  // namespace

TEST_CASE("draw sees the same first triangle as brute force, for rays of every kind",
          "[projector][oracle][law]") {
    Random random(1);
    for (int rays = 0; rays < static_cast<int>(Rays::kCount); ++rays) {
        for (int screen = 0; screen < static_cast<int>(Screen::kCount); ++screen) {
            BruteForceTally tally;
            const int cases = static_cast<Screen>(screen) == Screen::kSliver ? 600 : 60;
            for (int i = 0; i < cases; ++i) {
                const int x0 = random.below(2000), y0 = random.below(2000);
                const SampleGrid grid{x0, y0, x0 + 19, y0 + 21, 1 + random.below(2)};
                const Frame frame = random_frame(random);
                const RayMesh mesh =
                    random_facet(random, grid, frame, static_cast<Rays>(rays), static_cast<Screen>(screen));
                const TriangleScene scene = random_triangles(random, frame, 1 + random.below(40));
                compare_case(mesh, scene, grid, rasterize_facets(mesh, grid), tally);
            }
            INFO("rays " << rays << " screen " << screen << " samples " << tally.samples << " marginal "
                         << tally.marginal);
            CHECK(tally.wrong == 0);
            CHECK(tally.inaccurate == 0);
            CHECK(tally.samples > 100);
            CHECK(tally.seen > tally.samples / 10);
            CHECK(tally.marginal <= tally.samples / 1000);
        }
    }
}

TEST_CASE("draw is right for samples outside their facet, on either side of its horizon", "[projector]") {
    Random random(2);
    BruteForceTally tally;
    for (int i = 0; i < 150; ++i) {
        const SampleGrid grid{0, 0, 24, 24, 1};
        const Frame frame = random_frame(random);
        const Screen screen = i % 2 == 0 ? Screen::kPerspective : Screen::kBehind;
        const RayMesh mesh = random_facet(random, grid, frame, static_cast<Rays>(i % 5), screen);
        const TriangleScene scene = random_triangles(random, frame, 20);
        compare_case(mesh, scene, grid, all_samples(grid), tally);
    }
    INFO("samples " << tally.samples << " marginal " << tally.marginal << " wrong " << tally.wrong);
    CHECK(tally.seen > tally.samples / 10);
    CHECK(tally.wrong == 0);
    CHECK(tally.inaccurate == 0);
    CHECK(tally.marginal <= tally.samples / 200);
}

TEST_CASE("a flat mirror's rays meet what the mirrored eye sees", "[projector][oracle]") {
    // The virtual eye is a pinhole behind the mirror; both facets must see one picture, at t apart by 1.
    Random random(3);
    const SampleGrid grid{0, 0, 40, 40, 1};
    std::size_t seen = 0, different = 0;
    for (int i = 0; i < 20; ++i) {
        const Frame frame = random_frame(random);
        RayMesh mirror = random_facet(random, grid, {}, Rays::kFlatMirror, Screen::kPerspective);
        RayMesh pinhole = mirror;
        for (std::size_t k = 0; k < 3; ++k) {
            mirror.rays[k] = {frame(mirror.rays[k].origin), frame.scale * mirror.rays[k].direction};
            pinhole.rays[k] = {mirror.rays[k].origin - mirror.rays[k].direction, mirror.rays[k].direction};
        }
        TriangleScene scene;
        for (int k = 0; k < 20; ++k) {
            const Vec3 centre = random.in_cube(2) - Vec3(0, 0, 3);
            add_random_triangle(scene, random, frame, {centre, 1});
        }
        const PreparedScene prepared(scene);
        const FacetSamples owned = rasterize_facets(mirror, grid);
        std::vector<Hit> in_mirror(grid.size()), from_eye(grid.size());
        draw(prepared, mirror, owned, grid, in_mirror);
        draw(prepared, pinhole, owned, grid, from_eye);
        for (const Id s : owned.of(0)) {
            seen += in_mirror[s].seen();
            // Triangles at t between 0 and 1 of the virtual eye lie behind the mirror.
            if (from_eye[s].seen() && from_eye[s].t < 1) continue;
            if (in_mirror[s].triangle != from_eye[s].triangle) ++different;
            if (in_mirror[s].seen()) CHECK(in_mirror[s].t + 1 == Approx(from_eye[s].t));
        }
    }
    CHECK(seen > 500);
    CHECK(different == 0);
}
