// The vector engine draws the plain engine's bits where rays pass triangles, edges and corners by a hair.
#include "engines_compared.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

// Which side of a triangle faces a ray that grazes it is nearly anybody's guess: for all of a tile where the
// rays are parallel.
TEST_CASE("the vector engine draws the plain engine's bits where rays graze triangles from either side",
          "[projector][oracle]") {
    Random random(29);
    for (const DrawOptions& way : all_ways()) {
        Tally tally;
        for (int i = 0; i < 100; ++i) {
            const SampleGrid grid{0, 0, 24, 20, 1};
            const Frame frame = random_frame(random);
            const double bow = i % 2 == 0 ? 0 : random.log_uniform(1e-9, 1e-2);
            const RayMesh mesh = film_mesh(grid, 1, [&](double x, double y) {
                return Ray{frame(Vec3(x, y, 0)), frame.scale * Vec3(bow * x, bow * y, 1)};
            });
            TriangleScene scene;
            for (int k = 0; k < 40; ++k) {
                // Along a sample's ray, through it, leaning off it by a hair.
                const double x = 2 * (random.below(24) + 0.5) / 24 - 1,
                             y = 2 * (random.below(20) + 0.5) / 20 - 1;
                const double near = random.uniform(0.5, 3), far = near + random.log_uniform(1e-2, 10),
                             lean = random.log_uniform(1e-13, 1e-3), turn = random.uniform(0, 6.2831853);
                const Vec3 across(std::cos(turn), std::sin(turn), 0), off(-std::sin(turn), std::cos(turn), 0);
                const auto at = [&](double z, double a, double o) {
                    return frame(Vec3((1 + bow * z) * x, (1 + bow * z) * y, z) + a * across + o * off);
                };
                const double wide = random.log_uniform(1e-4, 1);
                const Vec3 a = at(near, -wide, lean), b = at(near, wide, lean), c = at(far, 0, -lean);
                if (k % 2 == 0)
                    add_triangle(scene, a, b, c);
                else
                    add_triangle(scene, b, a, c);
            }
            compare({scene, mesh, grid, rasterize_facets(mesh, grid)}, way, tally);
        }
        INFO("mode " << static_cast<int>(way.kernel.leaf_mode) << " mixed below "
                     << (way.tiles ? way.tiles->mixed_below : 0) << " samples " << tally.samples << " seen "
                     << tally.seen);
        CHECK(tally.different == 0);
        CHECK(tally.seen > 1000);
    }
}

namespace {

/// Triangles with an edge or a corner a hair from a ray, or two a hair behind one another on it; of all
/// sizes.
void add_hairs(TriangleScene& scene, Random& random, const Ray& ray) {
    const double length = random.log_uniform(1e-3, 10), size = length * random.log_uniform(1e-6, 10),
                 hair = random.log_uniform(1e-16, 1e-3);
    const Vec3 unit = glm::normalize(ray.direction), some = random.in_cube(1),
               across = glm::normalize(some - glm::dot(some, unit) * unit), up = glm::cross(unit, across);
    const double reach = glm::length(ray.direction);
    const Vec3 at = ray.origin + length * ray.direction, lean = random.uniform(-3, 3) * unit;
    const auto point = [&](double x, double y) { return at + reach * size * (x * (across + lean) + y * up); };
    const double turned = random.below(2) == 0 ? 1 : -1, off = turned * hair;
    switch (random.below(3)) {
        case 0:
            return add_triangle(scene, point(off, -1), point(off, 1), point(1, 0));
        case 1:
            return add_triangle(scene, point(off, hair), point(turned, 1), point(turned, -1));
        default:
            for (const double behind : {0.0, hair})
                add_triangle(scene, point(-1, -turned) + behind * reach * length * unit, point(1, -turned),
                             point(0, turned));
    }
}

}  // namespace

TEST_CASE("the vector engine draws the plain engine's bits where rays pass edges and corners by a hair",
          "[projector][oracle][many]") {
    Random random(30);
    for (const DrawOptions& way : all_ways()) {
        Tally tally;
        for (int i = 0; i < 75; ++i) {
            const SampleGrid grid{3, 1, 27, 21, 1 + i % 2};
            const Frame frame = random_frame(random);
            const RayMesh mesh = i % 6 == 5 ? bowed_mesh(grid, frame, 1 + random.below(6))
                                            : random_facet(random, grid, frame, static_cast<Rays>(i % 5),
                                                           static_cast<Screen>(i / 5 % 4));
            const FacetSamples owned = rasterize_facets(mesh, grid);
            TriangleScene scene;
            for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
                const std::span<const Id> samples = owned.of(f);
                if (samples.empty()) continue;
                const FacetWeights weights = facet_weights(mesh, f);
                for (int k = 0; k < 40; ++k) {
                    const Id s =
                        samples[static_cast<std::size_t>(random.below(static_cast<int>(samples.size())))];
                    add_hairs(scene, random, sample_ray(mesh, f, weights, grid.position(s)));
                }
            }
            compare({scene, mesh, grid, owned}, way, tally);
        }
        INFO("mode " << static_cast<int>(way.kernel.leaf_mode) << " mixed below "
                     << (way.tiles ? way.tiles->mixed_below : 0) << " samples " << tally.samples << " seen "
                     << tally.seen);
        CHECK(tally.different == 0);
        CHECK(tally.seen > 1000);
    }
}
