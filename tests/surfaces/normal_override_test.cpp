// Laws of borrowed normals: unit, on the surface's side, a smooth function of position, the same for grid and
// surface.
#include "surfaces/normal_override.h"

#include "support/draw.h"
#include "support/test.h"
#include "support/test_surfaces.h"

using namespace trilens_test;

namespace {

NormalField noise_field(std::uint64_t seed, double amplitude, double scale) {
    NormalField field;
    field.type = NormalField::Type::kNoise;
    field.seed = seed;
    field.amplitude = amplitude;
    field.scale = scale;
    return field;
}

NormalField sphere_field(const Vec3& center) {
    NormalField field;
    field.type = NormalField::Type::kSphere;
    field.center = center;
    return field;
}

}  // namespace

TEST_CASE("a grid and its exact surface borrow the same normals", "[surfaces]") {
    const auto sphere = std::make_shared<const CubeSphere>(Vec3(0.1, 0.2, 0.3), 1.5);
    for (const NormalField& field : {NormalField{}, sphere_field({0, 0.5, 0}), noise_field(7, 0.2, 3)}) {
        SurfaceGrid grid = regular_grid(*sphere, 4);
        const SurfaceGrid before = grid;
        override_normals(grid, field);
        CHECK(grid.points == before.points);
        CHECK(grid.facets == before.facets);
        const std::unique_ptr<Surface> surface = with_normals(sphere, field);
        REQUIRE(surface->face_count() == sphere->face_count());
        for (std::size_t f = 0; f < grid.facets.size(); ++f) {
            for (std::size_t k = 0; k < 3; ++k) {
                const SurfacePoint point = surface->eval(grid.facet_face[f], grid.facet_uv[f][k]);
                const SurfacePoint own = sphere->eval(grid.facet_face[f], grid.facet_uv[f][k]);
                CHECK(point.normal == grid.corner_normal[grid.facets[f][k]]);
                CHECK(point.position == own.position);
                CHECK(point.duv == own.duv);
                CHECK(surface->eval_first_order(grid.facet_face[f], grid.facet_uv[f][k]).normal ==
                      point.normal);
                if (field.type == NormalField::Type::kSmooth) CHECK(point.normal == own.normal);
            }
        }
    }
}

TEST_CASE("normals stay unit and on the surface's side, whatever the amplitude", "[surfaces][law]") {
    Draw draw(41);
    for (int round = 0; round < 5000; ++round) {
        const double size = draw.log_uniform(1e-4, 1e4);
        const Vec3 own = draw.unit(), position = size * draw.in_cube(1);
        const NormalField noise =
            noise_field(static_cast<std::uint64_t>(round), draw.log_uniform(1e-3, 100), 10 / size);
        const Vec3 tilted = eval_normal(noise, position, own);
        CHECK(length(tilted) == Approx(1).epsilon(1e-14));
        CHECK(dot(tilted, own) > 0);

        const Vec3 center = size * draw.in_cube(1);
        const Vec3 round_normal = eval_normal(sphere_field(center), position, own);
        CHECK(dot(round_normal, own) >= 0);
        CHECK(length(cross(round_normal, normalize(position - center))) < 1e-14);
    }
}

TEST_CASE("noise is smooth, depends on its seed, and has its amplitude and scale", "[surfaces][law]") {
    Draw draw(42);
    const Vec3 up(0, 0, 1);
    double mean_square = 0, largest_step = 0, mean_x = 0, differ = 0;
    const int rounds = 20000;
    for (int round = 0; round < rounds; ++round) {
        const Vec3 position = draw.in_cube(50);
        const NormalField field = noise_field(3, 0.1, 2);
        const Vec3 here = eval_normal(field, position, up);
        const Vec3 slope(here.x / here.z, here.y / here.z, 0);
        mean_square += dot(slope, slope) / rounds;
        mean_x += slope.x / rounds;
        CHECK(length(slope) < 0.1 * 1.6);  // gradient noise stays within about one per component
        const Vec3 step = 1e-6 * draw.unit();
        largest_step = std::fmax(largest_step, length(eval_normal(field, position + step, up) - here) / 1e-6);
        differ += length(eval_normal(noise_field(4, 0.1, 2), position, up) - here) / rounds;
    }
    CHECK(std::sqrt(mean_square) > 0.02);
    CHECK(std::fabs(mean_x) < 0.003);
    CHECK(largest_step > 0.05);
    CHECK(largest_step < 0.1 * 2 * 6);  // amplitude x scale x the steepest gradient: no jumps between cells
    CHECK(differ > 0.02);
}

TEST_CASE("noise is continuous with its slope across the lattice", "[surfaces]") {
    Draw draw(43);
    const NormalField field = noise_field(11, 0.5, 1);
    const Vec3 up(0, 0, 1);
    for (int round = 0; round < 300; ++round) {
        Vec3 at = draw.in_cube(20);
        at.x = std::floor(at.x);
        const double h = 1e-4;
        const Vec3 before = eval_normal(field, at - Vec3(h, 0, 0), up), here = eval_normal(field, at, up);
        const Vec3 after = eval_normal(field, at + Vec3(h, 0, 0), up);
        CHECK(length((after - here) - (here - before)) < 100 * h * h);
    }
}

TEST_CASE("closed-form hits carry the borrowed normal", "[surfaces]") {
    // A surface whose only ray is a fixed answer: what is passed on is what counts here.
    struct Fixed : Patch {
        Fixed() : Patch(Vec3(0), 1, 0) {}
        bool has_closed_form() const override { return true; }
        std::optional<SurfaceHit> intersect(const Ray& ray, double t_min) const override {
            const double t = -ray.origin.z / ray.direction.z;
            if (!(t > t_min)) return std::nullopt;
            const Vec3 at = ray.origin + t * ray.direction;
            const Vec2 uv = 0.5 * (Vec2(at) + 1.0);
            return SurfaceHit{0, uv, t, eval(0, uv)};
        }
    };
    const auto surface = with_normals(std::make_shared<Fixed>(), sphere_field({0, 0, -2}));
    CHECK(surface->has_closed_form());
    const auto hit = surface->intersect({{0.5, 0.25, 3}, {0, 0, -1}}, 0);
    REQUIRE(hit);
    CHECK(hit->t == Approx(3));
    CHECK(length(hit->point.normal - normalize(Vec3(0.5, 0.25, 2))) < 1e-15);
    CHECK_FALSE(surface->intersect({{0.5, 0.25, 3}, {0, 0, 1}}, 0).has_value());
}

TEST_CASE("where there is no normal there is none to tilt, but a sphere's", "[surfaces]") {
    CHECK(eval_normal(noise_field(1, 1, 1), {0.3, 0.4, 0.5}, Vec3(0)) == Vec3(0));
    CHECK(eval_normal({}, {0.3, 0.4, 0.5}, Vec3(0)) == Vec3(0));
    CHECK(eval_normal(sphere_field(Vec3(0)), {0, 0, 2}, Vec3(0)) == Vec3(0, 0, 1));
    CHECK(eval_normal(sphere_field({0, 0, 2}), {0, 0, 2}, Vec3(0, 0, 1)) == Vec3(0));
}
