// The limit tracer against closed forms and against marching with exact distances in long double.
#include "intersect/limit_tracer.h"

#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "base/util/parallel.h"
#include "random_scene.h"
#include "support/test.h"
#include "surfaces/surfaces.h"
#include "test_surfaces.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// The hits of a line with a sphere, in long double: t of both and the cosine of incidence; none where it
/// passes by.
struct SphereHits {
    double t_near = 0, t_far = 0, cosine = 0;
};
std::optional<SphereHits> sphere_hits(const Vec3& centre, double radius, const Ray& ray) {
    long double aa = 0, ab = 0, bb = 0;
    for (int k = 0; k < 3; ++k) {
        const long double d = ray.direction[k], o = static_cast<long double>(ray.origin[k]) - centre[k];
        aa += d * d, ab += d * o, bb += o * o;
    }
    const long double t_middle = -ab / aa, nearest_2 = bb - ab * ab / aa,
                      half_2 = radius * 1.0L * radius - nearest_2;
    if (half_2 < 0) return std::nullopt;
    const long double half = std::sqrt(half_2 / aa);
    return SphereHits{static_cast<double>(t_middle - half), static_cast<double>(t_middle + half),
                      static_cast<double>(std::sqrt(half_2) / radius)};
}

// Hit or miss, t and normal must be those of the sphere, but for rays that touch it to rounding.
void check_sphere(const LimitTracer& tracer, const Vec3& centre, double radius, const Ray& ray,
                  int* touching) {
    const auto exact = sphere_hits(centre, radius, ray);
    const double size = length(ray.origin) + length(centre) + radius, speed = length(ray.direction);
    const double blur = 1e-13 * size / radius;  // share of the radius that rounding may move the ray
    if (exact ? exact->cosine * exact->cosine < 4 * blur
              : sphere_hits(centre, radius * (1 + 4 * blur), ray).has_value()) {
        ++*touching;
        return;
    }
    const auto hit = tracer.first_hit(ray);
    const bool ahead = exact && exact->t_far > 0;
    REQUIRE(hit.has_value() == ahead);
    if (!hit) return;
    const double t = exact->t_near > 0 ? exact->t_near : exact->t_far;
    CHECK(std::fabs(hit->t - t) * speed <= 2e-13 * size / exact->cosine);
    CHECK(length(hit->point.position - (ray.origin + hit->t * ray.direction)) <= 2e-13 * size);
    CHECK(length(hit->point.normal - (hit->point.position - centre) / radius) <= 1e-13 * size / radius);
}

/// The stretch of a ray to march along, and the size of what it passes.
struct March {
    double t_min = 0, t_max = 0, size = 1;
};
/// The first t where the distance function vanishes, by steps that cannot pass a zero; none up to t_max.
/// `closest`: the smallest distance on the way, as a share of the size.
template <typename Distance>
std::optional<double> march(const Ray& ray, const March& way, const Distance& distance, double* closest) {
    const long double speed = length(ray.direction);
    const auto at = [&](long double t) {
        return distance(std::array<long double, 3>{ray.origin.x + t * ray.direction.x,
                                                   ray.origin.y + t * ray.direction.y,
                                                   ray.origin.z + t * ray.direction.z});
    };
    long double t = way.t_min;
    const long double side = at(t) > 0 ? 1 : -1;
    *closest = std::numeric_limits<double>::infinity();
    while (t <= way.t_max) {
        const long double d = side * at(t);
        if (d < 1e-16L * way.size) return static_cast<double>(t);
        *closest = std::min(*closest, static_cast<double>(d / way.size));
        t += d / speed;
    }
    return std::nullopt;
}

}  // namespace

TEST_CASE("a sphere of faces is met where the sphere is, at every scale and from every side",
          "[intersect][law]") {
    Random random(11);
    int touching = 0, rays = 0;
    for (int trial = 0; trial < 8; ++trial) {
        const FaceDomain domain = trial % 2 == 0 ? FaceDomain::kSquare : FaceDomain::kTriangle;
        const double radius = random.log_uniform(1e-4, 1e4);
        const Vec3 centre = radius * random.log_uniform(0.1, 10) * random.direction();
        const ProjectedSphere sphere(domain, centre, radius);
        const LimitTracer tracer(sphere, grid_of(sphere, 16));
        for (int i = 0; i < 1500; ++i, ++rays) {
            const double reach = i % 4 == 0 ? random.uniform(0, 0.99) : random.log_uniform(1.01, 100);
            const Vec3 origin = centre + radius * reach * random.direction();
            const Vec3 target = centre + radius * 1.1 * random.in_box(1);
            check_sphere(tracer, centre, radius, {origin, random.log_uniform(1e-3, 1e3) * (target - origin)},
                         &touching);
        }
    }
    INFO(touching << " of " << rays << " rays touch");
    CHECK(touching < 5);
}

TEST_CASE("rays that graze the silhouette hit or miss as the surface says, not as the fine grid says",
          "[intersect]") {
    Random random(12);
    const Vec3 centre(0.2, -0.1, 0.3);
    const ProjectedSphere sphere(FaceDomain::kSquare, centre, 1);
    int touching = 0;
    for (const int n : {4, 16, 48}) {
        const LimitTracer tracer(sphere, grid_of(sphere, n));
        for (int i = 0; i < 3000; ++i) {
            // A line at distance 1 -+ 1e-10..1e-2 from the centre.
            const Vec3 direction = random.direction(), side = normalize(cross(direction, random.direction()));
            const double gap = random.log_uniform(1e-10, 1e-2) * (i % 2 ? 1 : -1);
            const Vec3 origin = centre + (1 + gap) * side - random.log_uniform(1, 10) * direction;
            check_sphere(tracer, centre, 1, {origin, direction}, &touching);
        }
    }
    CHECK(touching < 50);
}

TEST_CASE("no ray slips between faces, not even straight at their edges and corners", "[intersect][law]") {
    Random random(17);
    for (const FaceDomain domain : {FaceDomain::kSquare, FaceDomain::kTriangle}) {
        const double radius = random.log_uniform(1e-4, 1e4);
        const Vec3 centre = radius * random.direction();
        const ProjectedSphere sphere(domain, centre, radius);
        const LimitTracer tracer(sphere, grid_of(sphere, 12));
        int leaks = 0;
        for (int i = 0; i < 6000; ++i) {
            const double along = i % 3 == 0 ? static_cast<double>(random.below(2)) : random.uniform(0, 1);
            const Vec2 uv = i % 2 == 0 ? Vec2(along, 0) : Vec2(0, along);
            const Vec3 target = sphere.eval(static_cast<Id>(random.below(sphere.face_count())), uv).position;
            const Vec3 origin = centre + radius * 0.9 * random.in_box(0.5);
            leaks += tracer.first_hit({origin, target - origin}) ? 0 : 1;
        }
        CHECK(leaks == 0);
    }
}

TEST_CASE("a torus shows the first of its up to four hits", "[intersect]") {
    Random random(13);
    int touching = 0, later = 0, hits = 0;
    for (const double scale : {1e-4, 1.0, 1e4}) {
        const Torus torus(1.0 * scale, 0.45 * scale);
        const LimitTracer tracer(torus, grid_of(torus, 24));
        for (int i = 0; i < 2500; ++i) {
            const Vec3 target =
                scale * Vec3(random.uniform(-1.6, 1.6), random.uniform(-0.5, 0.5), random.uniform(-1.6, 1.6));
            const Vec3 origin = i % 4 == 0 ? scale * 1.5 * random.in_box(1)
                                           : scale * random.log_uniform(2, 30) * random.direction();
            const Ray ray{origin, normalize(target - origin) * random.log_uniform(1e-2, 1e2)};
            double closest = 0;
            const double t_max = 2 * (length(origin) + 2 * scale) / length(ray.direction);
            const auto exact = march(
                ray, {0, t_max, scale}, [&](const auto& x) { return torus.distance(x); }, &closest);
            const auto hit = tracer.first_hit(ray);
            if (!exact && closest < 1e-11) {
                ++touching;
                continue;
            }
            REQUIRE(hit.has_value() == exact.has_value());
            if (!hit) continue;
            ++hits;
            const double cosine = std::fabs(dot(normalize(ray.direction), hit->point.normal));
            if (cosine < 1e-5) {
                ++touching;
                continue;
            }
            CHECK(std::fabs(hit->t - *exact) * length(ray.direction) <=
                  3e-13 * (length(origin) + scale) / cosine);
            later += tracer.first_hit(ray, hit->t + tracer.self_hit_t_min(ray)) ? 1 : 0;
        }
    }
    CHECK(touching < 5);
    CHECK(hits > 3000);
    CHECK(later > 1000);
}

TEST_CASE("waves seen along their crests show the first crest", "[intersect]") {
    Random random(14);
    const Waves waves(0.12, 9);
    const LimitTracer tracer(waves, grid_of(waves, 24));
    int touching = 0, hits = 0;
    for (int i = 0; i < 6000; ++i) {
        const Vec3 target(random.uniform(-0.9, 0.9), random.uniform(-0.12, 0.12), random.uniform(-0.9, 0.9));
        Vec3 direction = random.direction();
        direction.y *= random.log_uniform(1e-2, 1);
        const Ray ray{target - 3.0 * direction, direction};
        // The stretch of the ray over the field.
        double t_low = 0, t_high = 1e9;
        for (const int k : {0, 2}) {
            const double a = (-1 - ray.origin[k]) / direction[k], b = (1 - ray.origin[k]) / direction[k];
            t_low = std::max(t_low, std::min(a, b)), t_high = std::min(t_high, std::max(a, b));
        }
        double closest = 0;
        const auto exact = march(
            ray, {t_low, t_high, 1}, [&](const auto& x) { return waves.distance(x); }, &closest);
        const auto hit = tracer.first_hit(ray);
        const Vec3 end = ray.origin + (exact ? *exact : t_high) * direction;
        const bool at_border = std::max(std::fabs(end.x), std::fabs(end.z)) > 1 - 1e-8;
        const double cosine = hit ? std::fabs(dot(normalize(direction), hit->point.normal)) : 1;
        if ((!exact && closest < 1e-11) || (exact && at_border) || cosine < 1e-5) {
            ++touching;
            continue;
        }
        REQUIRE(hit.has_value() == exact.has_value());
        if (!hit) continue;
        ++hits;
        CHECK(std::fabs(hit->t - *exact) <= 1e-12 / cosine);
    }
    CHECK(touching < 60);
    CHECK(hits > 3000);
}

TEST_CASE("hits are found where derivatives vanish or have no bound", "[intersect]") {
    Random random(15);
    for (const double power : {0.6, 0.85, 1.285}) {
        const PinchedParaboloid surface(power);
        const LimitTracer tracer(surface, grid_of(surface, 16));
        int missed = 0, wrong = 0;
        for (int i = 0; i < 4000; ++i) {
            // Rays straight down at a point of the surface, near the middle as often as at any other
            // magnitude.
            const double r = random.log_uniform(1e-8, 0.9), phi = random.uniform(0, 2 * M_PI);
            const Vec3 target(r * std::cos(phi), -0.5 * r * r, r * std::sin(phi));
            const Vec3 origin = target + Vec3(0, 3, 0) + 0.1 * random.in_box(r);
            const auto hit = tracer.first_hit({origin, target - origin});
            missed += hit ? 0 : 1;
            wrong += hit && std::fabs(hit->t - 1) > 1e-12 ? 1 : 0;
        }
        INFO("power " << power);
        CHECK(missed == 0);
        CHECK(wrong == 0);
    }
}

TEST_CASE("a collapsed edge gives the facet's normal", "[intersect]") {
    // A cone: the face's edge v = 1 is one point, where du and the normal vanish.
    class Cone : public Surface {
      public:
        std::size_t face_count() const override { return 1; }
        FaceDomain domain(Id) const override { return FaceDomain::kSquare; }
        SurfacePoint eval(Id, const Vec2& at) const override {
            const Vec2 uv = glm::clamp(at, 0.0, 1.0);
            const double c = std::cos(uv.x), s = std::sin(uv.x), r = 1 - uv.y;
            SurfacePoint p;
            p.position = {r * c, uv.y, -r * s};
            p.du = {-r * s, 0, -r * c}, p.dv = {-c, 1, s};
            p.duu = {-r * c, 0, r * s}, p.duv = {s, 0, c};
            set_normal(p);
            return p;
        }
    };
    const Cone cone;
    const LimitTracer tracer(cone, grid_of(cone, 16));
    const Vec3 apex(0, 1, 0), from(2, 2, -1);
    const auto hit = tracer.first_hit({from, apex - from});
    REQUIRE(hit.has_value());
    CHECK(hit->t == Approx(1).epsilon(1e-9));
    CHECK(length(hit->point.normal) == Approx(1));
    CHECK(hit->point.normal.y > 0.5);
}

TEST_CASE("surfaces with a closed form are asked for it", "[intersect][oracle]") {
    class Plane : public Surface {
      public:
        std::size_t face_count() const override { return 1; }
        FaceDomain domain(Id) const override { return FaceDomain::kSquare; }
        SurfacePoint eval(Id, const Vec2& uv) const override {
            SurfacePoint p;
            p.position = {uv.x, uv.y, 0}, p.du = {1, 0, 0}, p.dv = {0, 1, 0}, p.normal = {0, 0, 1};
            return p;
        }
        bool has_closed_form() const override { return true; }
        std::optional<SurfaceHit> intersect(const Ray& ray, double t_min) const override {
            const double t = -ray.origin.z / ray.direction.z;
            const Vec3 at = ray.origin + t * ray.direction;
            if (!(t > t_min)) return std::nullopt;
            return SurfaceHit{0, {at.x, at.y}, t, eval(0, {at.x, at.y})};
        }
    };
    const Plane plane;
    const LimitTracer tracer(plane, SurfaceGrid{});
    const auto hit = tracer.first_hit({{0.25, 0.5, 2}, {0, 0, -0.5}});
    REQUIRE(hit.has_value());
    CHECK(hit->t == 4);
    CHECK(hit->uv == Vec2(0.25, 0.5));
    CHECK_FALSE(tracer.first_hit({{0.25, 0.5, 2}, {0, 0, -0.5}}, 4).has_value());
    CHECK(tracer.self_hit_t_min({{}, {0, 0, 0.1}}) == Approx(1e-8 * std::sqrt(0.5)));
}

namespace {

/// The tracer's first hit of each ray, the rays in parallel.
std::vector<std::optional<SurfaceHit>> first_hits(const LimitTracer& tracer, const std::vector<Ray>& rays) {
    std::vector<std::optional<SurfaceHit>> hits(rays.size());
    parallel_for(rays.size(), 64, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) hits[i] = tracer.first_hit(rays[i], 0);
    });
    return hits;
}

}  // namespace

TEST_CASE(
    "hits on the limit have the same bits for every instruction set, thread count and alone or in a batch",
    "[intersect][law]") {
    Random random(16);
    const Torus torus(1, 0.45);
    const SurfaceGrid grid = grid_of(torus, 12);
    const LimitTracer tracer(torus, grid), sse2(torus, grid, "sse2");
    std::vector<Ray> rays;
    for (int i = 0; i < 3000; ++i) {
        const Vec3 origin = 3.0 * random.direction();
        rays.push_back({origin, 1.5 * random.in_box(1) - origin});
    }
    const std::vector<std::optional<SurfaceHit>> many = first_hits(tracer, rays);
    set_thread_count(1);
    const std::vector<std::optional<SurfaceHit>> one = first_hits(tracer, rays),
                                                 other = first_hits(sse2, rays);
    set_thread_count(0);
    int hits = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        for (const auto* hit : {&one[i], &other[i]}) {
            REQUIRE(hit->has_value() == many[i].has_value());
            if (many[i])
                REQUIRE(
                    ((*hit)->t == many[i]->t && (*hit)->uv == many[i]->uv && (*hit)->face == many[i]->face));
        }
        hits += many[i] ? 1 : 0;
    }
    CHECK(hits > 800);
}
