// The search for images against brute force, on surfaces that have no closed form.
#include "specular/specular_search.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "base/util/parallel.h"
#include "camera/linear/linear_cameras.h"
#include "laws/worlds.h"
#include "support/test.h"
#include "surfaces/surfaces.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// A face's points on a fine lattice.
struct Lattice {
    int n = 0;
    std::vector<SurfacePoint> points;  // (n + 1)^2 of each face; outside of triangles they repeat the border
};

Lattice lattice_of(const Surface& surface, int n) {
    Lattice lattice{n, {}};
    lattice.points.resize(surface.face_count() * static_cast<std::size_t>((n + 1) * (n + 1)));
    parallel_for(surface.face_count(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t f = first; f < last; ++f)
            for (int j = 0; j <= n; ++j)
                for (int i = 0; i <= n; ++i)
                    lattice.points[(f * (n + 1) + j) * (n + 1) + i] =
                        surface.eval(static_cast<Id>(f), Vec2(i, j) / static_cast<double>(n));
    });
    return lattice;
}

/// All images that refining from each lattice point finds where the law is violated least among its
/// neighbours.
std::vector<SpecularPoint> brute_force(const Surface& surface, const Lattice& lattice,
                                       const SpecularQuery& query) {
    const int n = lattice.n, row = n + 1;
    const bool mirror = query.event == SpecularEvent::kReflect;
    std::vector<double> miss(static_cast<std::size_t>(row * row));
    std::vector<SurfaceParameter> starts;
    for (Id face = 0; face < surface.face_count(); ++face) {
        const SurfacePoint* points = &lattice.points[face * miss.size()];
        for (std::size_t k = 0; k < miss.size(); ++k) {
            const Vec3 e = normalize(points[k].position - query.camera.eye);
            const Vec3 x = normalize(points[k].position - query.point);
            const Vec3 h = (mirror ? 1 : query.eye_index) * e + (mirror ? 1 : query.point_index) * x;
            miss[k] = length(h - dot(h, points[k].normal) * points[k].normal);
        }
        for (int j = 0; j <= n; ++j) {
            for (int i = 0; i <= n; ++i) {
                bool least = true;
                for (int b = std::max(j - 1, 0); b <= std::min(j + 1, n); ++b)
                    for (int a = std::max(i - 1, 0); a <= std::min(i + 1, n); ++a)
                        least = least && miss[j * row + i] <= miss[b * row + a];
                if (least) starts.push_back({face, Vec2(i, j) / static_cast<double>(n)});
            }
        }
    }
    return specular_points(surface, starts, query);
}

/// How far an image misses the law, by the sines of the angles with the normal and by the common plane.
double law_miss(const Surface& surface, const SpecularQuery& query, const SpecularPoint& image) {
    const SurfacePoint at = surface.eval(image.at.face, image.at.uv);
    const Vec3 e = normalize(at.position - query.camera.eye), x = normalize(query.point - at.position);
    if (query.event == SpecularEvent::kReflect) return length(e - 2.0 * dot(e, at.normal) * at.normal - x);
    const Vec3 sine_e = cross(at.normal, e), sine_x = cross(at.normal, x);
    const bool same_way = dot(e, at.normal) * dot(x, at.normal) > 0;
    return length(query.eye_index * sine_e - query.point_index * sine_x) + (same_way ? 0 : 2);
}

struct SearchCounts {
    int images = 0, missing = 0, wrong = 0, more = 0, incomplete = 0;
};

struct SearchCase {
    const Surface& surface;
    SpecularEvent event;
    double inside;  // refractive index
    int fineness, points;
};

/// Random points around the surface; the camera looks at it from outside.
SearchCounts compare_with_brute_force(const SearchCase& test, unsigned seed) {
    const Surface& surface = test.surface;
    const SpecularSearcher searcher(surface);
    const Lattice lattice = lattice_of(surface, test.fineness);
    Vec3 low = lattice.points[0].position, high = low;
    for (const SurfacePoint& p : lattice.points)
        low = glm::min(low, p.position), high = glm::max(high, p.position);
    const Vec3 middle = 0.5 * (low + high);
    const double size = length(high - low);

    std::mt19937 engine(seed);
    const auto cube = [&] {
        Vec3 p;
        for (int k = 0; k < 3; ++k) p[k] = static_cast<double>(engine()) / 2147483648.0 - 1;
        return p;
    };
    SearchCounts counts;
    for (int round = 0; round < test.points; ++round) {
        PerspectiveParams camera;
        camera.look_at = {middle + size * normalize(cube()) * 1.3, middle, {0.1, 1, 0.2}};
        SpecularQuery query;
        query.camera = make_perspective(camera);
        query.point = middle + (round % 2 == 0 ? 0.4 : 1.5) * size * cube();
        query.event = test.event;
        query.point_index = test.inside;
        const SpecularSearch search = searcher.find(query);
        if (!search.complete) {
            ++counts.incomplete;
            continue;
        }
        const std::vector<SpecularPoint> brute = brute_force(surface, lattice, query);
        const auto listed = [](const std::vector<SpecularPoint>& list, const SpecularPoint& image) {
            return std::any_of(list.begin(), list.end(), [&](const SpecularPoint& other) {
                return length(other.position - image.position) < 1e-6 * image.distance;
            });
        };
        counts.images += static_cast<int>(search.images.size());
        for (const SpecularPoint& image : brute) counts.missing += !listed(search.images, image);
        for (const SpecularPoint& image : search.images) {
            counts.wrong += law_miss(surface, query, image) > 1e-9;
            counts.more += !listed(brute, image);
        }
        CHECK(search.images.size() == distinct_images(search.images).size());
    }
    return counts;
}

void check(const SearchCounts& counts, int least_images) {
    CAPTURE(counts.images, counts.missing, counts.wrong, counts.more, counts.incomplete);
    CHECK(counts.missing == 0);
    CHECK(counts.wrong == 0);
    CHECK(counts.more <= counts.images / 50);  // pairs near a caustic, which one start does not tell apart
    CHECK(counts.incomplete == 0);
    CHECK(counts.images > least_images);
}

const Surface& optic_of(const std::string& scene, std::unique_ptr<World>& world) {
    world = shipped_world(scene, 4, 64, 64);
    return *world->optics[0].surface;
}

/// An icosahedron as a Loop cage: every vertex is extraordinary.
Cage icosahedron() {
    const double g = 1.618033988749895;
    Cage cage;
    cage.scheme = SubdivisionScheme::kLoop;
    for (const double a : {-1.0, 1.0})
        for (const double b : {-g, g})
            for (const Vec3& p : {Vec3(0, a, b), Vec3(a, b, 0), Vec3(b, 0, a)}) cage.points.push_back(p);
    const auto near = [&](int a, int b) { return length(cage.points[a] - cage.points[b]) < 2.1; };
    for (int a = 0; a < 12; ++a)
        for (int b = a + 1; b < 12; ++b)
            for (int c = b + 1; c < 12; ++c) {
                if (!near(a, b) || !near(b, c) || !near(a, c)) continue;
                const bool outward = triple(cage.points[a], cage.points[b], cage.points[c]) > 0;
                for (const int k : {a, outward ? b : c, outward ? c : b})
                    cage.face_vertex_indices.push_back(k);
                cage.face_vertex_counts.push_back(3);
            }
    return cage;
}

}  // namespace

TEST_CASE("search: no image is missing on the saddle mirror", "[laws][law][thorough]") {
    std::unique_ptr<World> world;
    check(compare_with_brute_force({optic_of("saddle", world), SpecularEvent::kReflect, 1, 100, 400}, 1), 60);
}

TEST_CASE("search: no image is missing on the torus mirror", "[laws][law][thorough]") {
    std::unique_ptr<World> world;
    check(compare_with_brute_force({optic_of("torus", world), SpecularEvent::kReflect, 1, 50, 300}, 2), 600);
}

TEST_CASE("search: no image is missing through the torus as glass", "[laws][law][thorough]") {
    std::unique_ptr<World> world;
    check(compare_with_brute_force({optic_of("torus", world), SpecularEvent::kRefract, 1.5, 50, 300}, 3),
          150);
}

TEST_CASE("search: no image is missing on a piece with creases and extraordinary vertices", "[laws][law]") {
    std::unique_ptr<World> world;
    check(compare_with_brute_force({optic_of("piece", world), SpecularEvent::kReflect, 1, 40, 60}, 4), 200);
}

TEST_CASE("search: no image is missing on a Loop surface", "[laws][law][thorough]") {
    const auto surface = make_limit_surface(icosahedron(), "icosahedron", {});
    check(compare_with_brute_force({*surface, SpecularEvent::kReflect, 1, 60, 200}, 5), 200);
    check(compare_with_brute_force({*surface, SpecularEvent::kRefract, 1.7, 60, 200}, 6), 50);
}

TEST_CASE("search: no image is missing on primitives", "[laws][law][thorough]") {
    Primitive primitive;
    primitive.axis = {0.2, 1, 0.1};
    unsigned seed = 10;
    for (const PrimitiveKind& kind :
         std::initializer_list<PrimitiveKind>{SpherePrimitive(), ParaboloidPrimitive(), CylinderPrimitive(),
                                              ConePrimitive(), PlanePrimitive()}) {
        primitive.kind = kind;
        const auto surface = make_primitive_surface(primitive);
        check(compare_with_brute_force({*surface, SpecularEvent::kReflect, 1, 80, 150}, ++seed), 20);
        check(compare_with_brute_force({*surface, SpecularEvent::kRefract, 1.5, 80, 150}, ++seed), 20);
    }
}
