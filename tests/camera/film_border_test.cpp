// The part of a film that has rays: a camera's mesh covers it, and nothing beside it.
#include <string>
#include <vector>

#include "camera/camera.h"
#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr FilmSize kSmallFilm{96, 72};

/// How many of the mesh's facets hold the place.
int facets_over(const RayMesh& mesh, const Vec2& at) {
    int count = 0;
    for (const IdTriple& facet : mesh.facets) {
        const Vec2 a(mesh.screen[facet[0]]), b(mesh.screen[facet[1]]), c(mesh.screen[facet[2]]);
        const double x = cross(b - a, at - a), y = cross(c - b, at - b), z = cross(a - c, at - c);
        count += (x >= 0 && y >= 0 && z >= 0) || (x <= 0 && y <= 0 && z <= 0);
    }
    return count;
}

std::vector<CameraDescription> cameras_with_borders() {
    const Placement at{{0.3, 0.2, 1}, {0, 0, 0}, {0, 1, 0}};
    std::vector<CameraDescription> cameras;
    const auto add = [&](const std::string& name, const CameraKind& kind) {
        CameraDescription from;
        from.name = name;
        from.eye = at.eye, from.at = at.at, from.up = at.up;
        from.kind = kind;
        cameras.push_back(from);
        return from;
    };
    FisheyeCamera wide, narrow;
    wide.fov = 220, narrow.fov = 100, narrow.mapping = FisheyeMapping::kOrthographic;
    const CameraDescription circle = add("circle", wide), small = add("small circle", narrow);
    DistortionCamera all_around;
    all_around.context_fov = 360;
    add("beyond all around", all_around);
    MultiPerspectiveCamera several;
    several.views = {{circle, {0, 0, 0.4, 1}}, {small, {0.4, 0, 1, 1}}};
    add("two circles", several);
    several.blend = 0.2;
    add("circles into each other", several);
    several.views = {{small, {0, 0, 1, 1}}};
    several.blend = 0;
    add("one circle alone", several);
    return cameras;
}

}  // namespace

TEST_CASE("a camera's mesh covers what of the film has rays, however few its facets are, and no more",
          "[camera][law]") {
    const int facets = GENERATE(1, 3, 16, 64);
    for (CameraDescription from : cameras_with_borders()) {
        INFO(from.name << ", " << facets << " facets");
        from.facets = facets;
        const Camera camera = make_camera(from, kSmallFilm);
        Draw draw(7);
        int with = 0, without = 0, wrong = 0, twice = 0;
        for (int i = 0; i < 2000; ++i) {
            const double x = draw.uniform(0, kSmallFilm.width), y = draw.uniform(0, kSmallFilm.height);
            const bool has = exact_ray(camera, {x, y}).has_value();
            const int over = facets_over(camera.mesh, {x, y});
            (has ? with : without)++;
            wrong += has != (over > 0), twice += over > 1;
        }
        CHECK(with > 100);
        if (from.name != "beyond all around") CHECK(without > 100);
        CHECK(wrong <= 1);  // a thousandth of a pixel beside a border
        CHECK(twice == 0);
    }
}

TEST_CASE("facets along a border have exact rays at their corners", "[camera]") {
    for (CameraDescription from : cameras_with_borders()) {
        INFO(from.name);
        from.facets = 5;
        const Camera camera = make_camera(from, kSmallFilm);
        std::size_t asked = 0;
        for (const IdTriple& facet : camera.mesh.facets)
            for (const Id corner : facet) {
                const std::optional<Ray> ray = exact_ray(camera, Vec2(camera.mesh.screen[corner]));
                if (!ray) continue;  // on the border, or a break, to rounding
                ++asked;
                const Ray& own = camera.mesh.rays[corner];
                if (from.name.find("circles") != std::string::npos) continue;  // breaks: of either side
                CHECK(length(own.origin - ray->origin) < 1e-6);
                CHECK(length(own.direction - ray->direction) < 1e-6);
            }
        CHECK(asked > camera.mesh.facets.size());
    }
}
