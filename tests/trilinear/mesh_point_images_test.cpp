// Laws of images through a whole mesh: the tree loses none, shared borders count once, threads do not matter.
#include "trilinear/points/point_images.h"

#include <vector>

#include "base/util/parallel.h"
#include "random_facets.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

std::vector<Vec3> random_points(Random& random, std::size_t count, double reach) {
    std::vector<Vec3> points(count);
    for (Vec3& p : points) p = random.in_box(reach);
    return points;
}

}  // namespace

TEST_CASE("mesh point images: the tree finds what every facet by itself finds",
          "[trilinear][mesh_point_images][oracle][law]") {
    Random random(1);
    for (const double scale : {1e-4, 1.0, 1e4}) {
        RayMesh mesh = sphere_mirror(scale * Vec3(0.3, 0, 1), scale * Vec3(0, 1, 4), 12, 9);
        mesh.facets[5] = {kNone, kNone, kNone};
        const MeshPointImages prepared(mesh);
        int total = 0;
        for (const Vec3& point : random_points(random, 400, 6 * scale)) {
            const std::vector<MeshPointImage> images = prepared.images(point);
            std::size_t at = 0;
            for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
                if (!mesh.has_rays(f)) continue;
                for (const PointImage& image :
                     point_images(make_coplanarity(trilinear_facet(mesh, f)), point)) {
                    REQUIRE(at < images.size());
                    CHECK(images[at].facet == f);
                    CHECK(images[at].t == image.t);
                    ++at, ++total;
                }
            }
            CHECK(at == images.size());
        }
        CHECK(total > 100);
    }
}

TEST_CASE("mesh point images: a sphere shows a point where the mirror law puts it",
          "[trilinear][mesh_point_images]") {
    // A fine mesh converges to the sphere: the image's ray leaves the sphere near where the angles are equal.
    const Vec3 center(0, 0, 0), eye(0, 0, 4);
    const int n = 60;
    const RayMesh mesh = sphere_mirror(center, eye, n, n);
    const MeshPointImages prepared(mesh);
    Random random(2);
    int seen = 0;
    for (int trial = 0; trial < 200; ++trial) {
        const Vec3 point(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(1.5, 3));
        for (const MeshPointImage& image : prepared.images(point)) {
            ++seen;
            const IdTriple& c = mesh.facets[image.facet];
            Vec3 origin(0);
            for (int k = 0; k < 3; ++k)
                origin += image.weights[k] * mesh.rays[c[static_cast<std::size_t>(k)]].origin;
            const Vec3 normal = normalize(origin - center);
            CHECK(dot(normal, normalize(eye - origin)) ==
                  Approx(dot(normal, normalize(point - origin))).margin(5e-3));
            // The screen position is the grid's: within the cell that holds the facet.
            const int cell = static_cast<int>(image.facet) / 2;
            CHECK(image.screen.x >= cell % n - 1e-6);
            CHECK(image.screen.x <= cell % n + 1 + 1e-6);
            CHECK(image.screen.y >= cell / n - 1e-6);
            CHECK(image.screen.y <= cell / n + 1 + 1e-6);
        }
    }
    CHECK(seen > 150);
}

TEST_CASE("mesh point images: on shared edges and corners an image counts once",
          "[trilinear][mesh_point_images]") {
    const RayMesh mesh = sphere_mirror(Vec3(0, 0, 0), Vec3(0, 0, 4), 10, 10);
    const MeshPointImages prepared(mesh);
    Random random(3);
    for (int trial = 0; trial < 2000; ++trial) {
        // An inner edge of the grid, or one of its corners.
        const int i = 1 + random.below(9), j = 1 + random.below(9);
        const Id a = static_cast<Id>(j * 11 + i), b = random.below(2) ? a + 1 : a + 11;
        const double u = trial % 4 == 0 ? 0 : random.uniform(0, 1), t = random.uniform(0.05, 2);
        const Ray& p = mesh.rays[a];
        const Ray& q = mesh.rays[b];
        const Vec3 point = (1 - u) * (p.origin + t * p.direction) + u * (q.origin + t * q.direction);
        const std::vector<MeshPointImage> images = prepared.images(point);
        REQUIRE(images.size() == 1);
        CHECK(images[0].t == Approx(t));
        CHECK(images[0].screen.x == Approx((1 - u) * mesh.screen[a].x + u * mesh.screen[b].x).margin(1e-9));
        CHECK(images[0].screen.y == Approx((1 - u) * mesh.screen[a].y + u * mesh.screen[b].y).margin(1e-9));
    }
}

TEST_CASE("mesh point images: many points at once are the same, for any number of threads",
          "[trilinear][mesh_point_images][law]") {
    const MeshPointImages prepared(sphere_mirror(Vec3(0), Vec3(1, 2, 3), 10, 10));
    Random random(4);
    const std::vector<Vec3> points = random_points(random, 3000, 5);
    for (const int threads : {1, 3, 0}) {
        set_thread_count(threads);
        const PointImageLists lists = prepared.images(points);
        REQUIRE(lists.first.size() == points.size() + 1);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const std::vector<MeshPointImage> alone = prepared.images(points[i]);
            if (alone.size() != lists.of(i).size()) FAIL("point " << i);
            for (std::size_t k = 0; k < alone.size(); ++k) {
                if (alone[k].facet != lists.of(i)[k].facet || alone[k].t != lists.of(i)[k].t)
                    FAIL("point " << i);
            }
        }
    }
    set_thread_count(0);
    CHECK(prepared.images(std::span<const Vec3>{}).first.size() == 1);
    CHECK(MeshPointImages(RayMesh{}).images(Vec3(1)).empty());
}
