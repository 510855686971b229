// Laws of the cones of normals: they leave out no face that shows the point, and most of those that do not.
#include "specular/cones/normal_cones.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "specular/specular_search.h"
#include "support/closed_forms.h"
#include "support/draw.h"
#include "support/test.h"

using namespace trilens_test;

namespace {

/// A ball of 2 x 24 x 12 triangles whose normals at the corners are its own, tilted at random.
struct TiltedBall : Surface {
    struct Face {
        std::array<Vec3, 3> point, normal;
    };
    std::vector<Face> faces;

    TiltedBall(Draw& draw, double radius, double tilt, bool is_bounded = true) : bounded_(is_bounded) {
        constexpr int kAround = 24, kRows = 12;
        const auto at = [&](int row, int column) {
            const double polar = M_PI * (row + 0.5) / (kRows + 1), around = 2 * M_PI * column / kAround;
            return Vec3(std::sin(polar) * std::cos(around), std::cos(polar),
                        std::sin(polar) * std::sin(around));
        };
        const auto add = [&](const std::array<Vec3, 3>& corner) {
            Face face;
            for (std::size_t k = 0; k < 3; ++k) {
                face.point[k] = radius * corner[k];
                face.normal[k] = normalize(corner[k] + tilt * draw.in_cube(1));
            }
            faces.push_back(face);
        };
        for (int row = 0; row < kRows; ++row)
            for (int column = 0; column < kAround; ++column) {
                add({at(row, column), at(row, column + 1), at(row + 1, column)});
                add({at(row + 1, column), at(row, column + 1), at(row + 1, column + 1)});
            }
    }
    std::size_t face_count() const override { return faces.size(); }
    FaceDomain domain(Id) const override { return FaceDomain::kTriangle; }
    SurfacePoint eval(Id face, const Vec2& uv) const override {
        const Face& here = faces[face];
        SurfacePoint point;
        point.du = here.point[1] - here.point[0], point.dv = here.point[2] - here.point[0];
        point.position = here.point[0] + uv.x * point.du + uv.y * point.dv;
        point.normal = normalize_or_zero((1 - uv.x - uv.y) * here.normal[0] + uv.x * here.normal[1] +
                                         uv.y * here.normal[2]);
        return point;
    }
    std::optional<FaceBounds> face_bounds(Id face) const override {
        if (!bounded_) return std::nullopt;
        FaceBounds bounds;
        bounds.normal = normalize(faces[face].normal[0] + faces[face].normal[1] + faces[face].normal[2]);
        for (std::size_t k = 0; k < 3; ++k) {
            bounds.box.include(faces[face].point[k]);
            bounds.angle = std::max(bounds.angle, std::acos(dot(bounds.normal, faces[face].normal[k])));
        }
        return bounds;
    }

  private:
    bool bounded_;
};

SpecularQuery random_query(Draw& draw, double radius) {
    SpecularQuery query;
    query.camera = camera_at(radius * draw.unit() * draw.log_uniform(0.2, 30), Vec3(0));
    query.point = radius * draw.unit() * draw.log_uniform(0.2, 30);
    if (draw.uniform(0, 1) < 0.3) {
        query.event = SpecularEvent::kRefract;
        query.eye_index = 1, query.point_index = draw.uniform(1.1, 2.5);
        if (draw.uniform(0, 1) < 0.5) std::swap(query.eye_index, query.point_index);
    }
    query.own_normals = false;
    return query;
}

}  // namespace

TEST_CASE("cones of normals leave out no image, and most faces that show none", "[specular][law]") {
    Draw draw(77);
    std::size_t looked_at = 0, all = 0, images = 0;
    for (int k = 0; k < 60; ++k) {
        const double radius = draw.log_uniform(1e-3, 1e3),
                     tilt = k % 3 == 0 ? 0 : draw.log_uniform(1e-3, 0.8);
        Draw same = draw;
        const TiltedBall ball(draw, radius, tilt), without(same, radius, tilt, false);
        const SpecularQuery query = random_query(draw, radius);
        const Vec3 way = draw.unit();
        const auto faces_it = [&](const FaceBounds& bounds) {
            return std::acos(dot(bounds.normal, way)) <= bounds.angle + 0.3;
        };
        const std::vector<Id> faces = NormalCones(ball).faces_where(faces_it);
        std::vector<Id> each;
        for (Id face = 0; face < ball.face_count(); ++face)
            if (faces_it(*ball.face_bounds(face))) each.push_back(face);
        CHECK(faces == each);
        CHECK(NormalCones(without).faces_where(faces_it).size() == without.face_count());

        const SpecularSearch search = SpecularSearcher(ball).find(query),
                             whole = SpecularSearcher(without).find(query);
        CHECK(!search.complete);
        if (tilt < 0.1) looked_at += search.cells, all += whole.cells;
        REQUIRE(search.images.size() == whole.images.size());
        for (std::size_t i = 0; i < whole.images.size(); ++i) {
            CHECK(search.images[i].pixel == whole.images[i].pixel);
            CHECK(search.images[i].at.face == whole.images[i].at.face);
        }
        images += whole.images.size();
    }
    CHECK(images > 60);
    CHECK(looked_at < all / 4);
}
