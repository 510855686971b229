// Cut-outs against the opacity that each point of the surface has.
#include <cmath>
#include <memory>
#include <random>

#include "base/image/texture_lookup.h"
#include "scene/data/alpha_cut.h"
#include "scene/data/polygons.h"
#include "scene/meshes/weld.h"
#include "support/test.h"

using namespace trilens;

namespace {

/// Two triangles of a unit square in z = 0; uv from 0 to `repeats`.
ObjectMesh square(double repeats) {
    ObjectMesh mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    const double r = repeats;
    mesh.uvs = {{Vec2(0, 0), Vec2(r, 0), Vec2(r, r)}, {Vec2(0, 0), Vec2(r, r), Vec2(0, r)}};
    mesh.material = {0, 0};
    return mesh;
}

Material masked(int width, int height, const std::vector<float>& alpha) {
    auto texture = std::make_shared<Texture>();
    texture->width = width;
    texture->height = height;
    texture->rgb.assign(3 * alpha.size(), 1);
    texture->alpha = alpha;
    Material material;
    material.base_color_texture = texture;
    material.alpha_mode = AlphaMode::kMask;
    return material;
}

double area_of(const ObjectMesh& mesh) {
    double area = 0;
    for (const IdTriple& t : mesh.triangles)
        area += 0.5 * cross(mesh.points[t[1]] - mesh.points[t[0]], mesh.points[t[2]] - mesh.points[t[0]]).z;
    return area;
}

bool covers(const ObjectMesh& mesh, const Vec2& p) {
    for (const IdTriple& t : mesh.triangles) {
        bool inside = true;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 a = mesh.points[t[k]], b = mesh.points[t[(k + 1) % 3]];
            inside = inside && (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) >= 0;
        }
        if (inside) return true;
    }
    return false;
}

}  // namespace

TEST_CASE("a straight edge of opacity is cut where it lies", "[scene]") {
    // Two columns, clamped: opacity rises from 0 at x = 1/4 to 1 at x = 3/4.
    Material material = masked(2, 1, {0, 1});
    material.base_color_sampler.wrap_s = material.base_color_sampler.wrap_t = Wrap::kClampToEdge;
    for (const double cutoff : {0.25, 0.5, 0.9}) {
        material.alpha_cutoff = cutoff;
        ObjectMesh mesh = square(1);
        const AlphaCut cut = cut_by_alpha(mesh, {material});
        CHECK(cut.cut == 2);
        CHECK(area_of(mesh) == Approx(1 - (0.25 + 0.5 * cutoff)).epsilon(1e-12));
        CHECK(mesh.uvs.size() == mesh.triangles.size());
        CHECK(mesh.material.size() == mesh.triangles.size());
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3& p = mesh.points[mesh.triangles[t][k]];
                CHECK(length(Vec2(p.x, p.y) - mesh.uvs[t][k]) < 1e-12);
            }
    }
    material.alpha_factor = 0.5;
    material.alpha_cutoff = 0.25;
    ObjectMesh mesh = square(1);
    cut_by_alpha(mesh, {material});
    CHECK(area_of(mesh) == Approx(0.5).epsilon(1e-12));
    material.alpha_factor = 0.1;
    mesh = square(1);
    cut_by_alpha(mesh, {material});
    CHECK(mesh.triangles.empty());
    material.alpha_mode = AlphaMode::kOpaque;
    mesh = square(1);
    CHECK(cut_by_alpha(mesh, {material}).cut == 0);
    CHECK(mesh.triangles.size() == 2);
}

TEST_CASE("law: what is left of a cut-out is what is opaque", "[scene][law]") {
    std::mt19937_64 random(9);
    std::uniform_real_distribution<double> share(0, 1);
    const int size = 6;
    int checked = 0;
    for (const Wrap wrap : {Wrap::kRepeat, Wrap::kMirroredRepeat, Wrap::kClampToEdge}) {
        std::vector<float> alpha;
        for (int i = 0; i < size * size; ++i) alpha.push_back(static_cast<float>(share(random)));
        Material material = masked(size, size, alpha);
        material.base_color_sampler.wrap_s = material.base_color_sampler.wrap_t = wrap;
        ObjectMesh mesh = square(1.7);
        cut_by_alpha(mesh, {material});
        const auto texel = [&](int x, int y) {
            const auto place = [&](int i) {
                if (wrap == Wrap::kClampToEdge) return std::clamp(i, 0, size - 1);
                const int period = wrap == Wrap::kRepeat ? size : 2 * size,
                          in = ((i % period) + period) % period;
                return in < size ? in : period - 1 - in;
            };
            return static_cast<double>(alpha[static_cast<std::size_t>(place(y) * size + place(x))]);
        };
        for (int i = 0; i < 1500; ++i) {
            const Vec2 p(share(random), share(random));
            const double x = 1.7 * p.x * size - 0.5, y = (1 - 1.7 * p.y) * size - 0.5;
            const double x0 = std::floor(x), y0 = std::floor(y), u = x - x0, v = y - y0;
            const int ix = static_cast<int>(x0), iy = static_cast<int>(y0);
            const double opacity = (1 - v) * ((1 - u) * texel(ix, iy) + u * texel(ix + 1, iy)) +
                                   v * ((1 - u) * texel(ix, iy + 1) + u * texel(ix + 1, iy + 1));
            if (std::abs(opacity - 0.5) < 0.04) continue;  // between the contour and its chords
            CHECK(covers(mesh, p) == (opacity > 0.5));
            ++checked;
        }
    }
    CHECK(checked > 3000);
}

TEST_CASE("masks of holes and of whole texels are cut without triangles that have no area", "[scene]") {
    std::mt19937_64 random(3);
    for (int trial = 0; trial < 6; ++trial) {
        std::vector<float> alpha;
        for (int i = 0; i < 64; ++i) alpha.push_back(random() % 2 == 0 ? 0.0f : 1.0f);
        ObjectMesh mesh = square(1);
        cut_by_alpha(mesh, {masked(8, 8, alpha)});
        REQUIRE(mesh.triangles.size() > 50);
        CHECK(count_without_area(mesh) == 0);
    }
    // Half of it is there, up to an edge along the grid.
    ObjectMesh mesh = square(1);
    cut_by_alpha(mesh, {masked(2, 1, {0, 1})});
    CHECK(count_without_area(mesh) == 0);
    CHECK(area_of(mesh) == Approx(0.5).epsilon(1e-12));
    // A triangle without area stays as it is.
    mesh = square(1);
    mesh.points[3] = mesh.points[0];
    cut_by_alpha(mesh, {masked(8, 8, std::vector<float>(64, 0.0f))});
    CHECK(mesh.triangles == std::vector<IdTriple>{{0, 2, 3}});
}

TEST_CASE("law: of opaque texels that face each other as much is left as opacity's saddle says",
          "[scene][law]") {
    // Between four texels the opacity is (1-u)(1-v) a + u v c + ((1-u) v + u (1-v)) b.
    const auto left = [](float a, float b, float c, double cutoff = 0.5) {
        Material material = masked(2, 2, {a, b, b, c});
        material.alpha_cutoff = cutoff;
        material.base_color_sampler.wrap_s = material.base_color_sampler.wrap_t = Wrap::kClampToEdge;
        ObjectMesh mesh = square(1);
        cut_by_alpha(mesh, {material});
        return mesh;
    };
    CHECK(area_of(left(1, 0, 1)) == Approx(0.5).epsilon(1e-12));
    CHECK(area_of(left(0, 1, 0)) == Approx(0.5).epsilon(1e-12));
    CHECK(covers(left(1, 0.1f, 1), {0.5, 0.5}));
    CHECK(!covers(left(0.9f, 0, 0.9f), {0.5, 0.5}));
    // A saddle a fifth, and some more, of the way, where of a quarter between the texels the ends are opaque.
    CHECK(covers(left(0.35f, 0.15f, 0.95f, 0.3), {0.35, 0.65}));
    CHECK(!covers(left(0.35f, 0.15f, 0.7f, 0.3), {0.383, 0.617}));

    // Shares of masks of black and white, against a grid of points.
    std::mt19937_64 random(5);
    double off = 0;
    for (int trial = 0; trial < 8; ++trial) {
        std::vector<float> alpha;
        for (int i = 0; i < 64; ++i) alpha.push_back(random() % 2 == 0 ? 0.0f : 1.0f);
        const Material material = masked(8, 8, alpha);
        ObjectMesh mesh = square(1);
        cut_by_alpha(mesh, {material});
        double expected = 0;
        for (int j = 0; j < 128; ++j)
            for (int i = 0; i < 128; ++i)
                if (lookup_alpha(*material.base_color_texture, material.base_color_sampler,
                                 {(i + 0.5) / 128, (j + 0.5) / 128}) >= 0.5)
                    expected += 1.0 / (128 * 128);
        CHECK(area_of(mesh) == Approx(expected).margin(0.015));
        off += (area_of(mesh) - expected) / 8;
    }
    CHECK(std::abs(off) < 0.005);
}

TEST_CASE("points of one place are welded, and quads joined again", "[scene]") {
    PolygonMesh mesh;
    mesh.cage.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-0.0, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 1, 0}};
    mesh.cage.face_vertex_counts = {3, 3, 3};
    mesh.cage.face_vertex_indices = {0, 1, 2, 3, 4, 5, 2, 6, 0};  // the third has two corners at one place
    mesh.normals.assign(9, Vec3(0, 0, 1));
    weld_points(mesh);
    CHECK(mesh.cage.points.size() == 4);
    CHECK(mesh.cage.face_vertex_counts == std::vector<int>{3, 3});
    CHECK(mesh.cage.face_vertex_indices == std::vector<int>{0, 1, 2, 0, 2, 3});
    CHECK(mesh.normals.size() == 6);
    join_quads(mesh);
    CHECK(mesh.cage.face_vertex_counts == std::vector<int>{4});
    CHECK(mesh.normals.size() == 4);
    CHECK(mesh.cage.face_vertex_indices == std::vector<int>{2, 3, 0, 1});
    cut_into_triangles(mesh);
    CHECK(mesh.cage.face_vertex_counts == std::vector<int>{3, 3});
}
