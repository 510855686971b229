// Tangents of normal maps: against closed forms, against the definition asked of every pair of triangles, and
// as files give them.
#include "scene/meshes/tangents.h"

#include <cmath>
#include <numbers>

#include "gltf_scene_text.h"
#include "support/draw.h"

using namespace trilens;
using namespace trilens_test;

namespace {

std::vector<Material> mapped_material() {
    std::vector<Material> materials(1);
    materials[0].normal_texture.picture = std::make_shared<Texture>(Texture{1, 1, {0.5F, 0.5F, 1.0F}, {}});
    return materials;
}

/// A surface over the unit square, sampled by n x n quads, each cut in two; corners are points of their own.
template <class PointAt, class NormalAt>
ObjectMesh sampled(int n, const PointAt& point_at, const NormalAt& normal_at) {
    ObjectMesh mesh;
    const auto add = [&](const std::array<Vec2, 3>& uv) {
        IdTriple corners;
        std::array<Vec3, 3> normals;
        for (std::size_t k = 0; k < 3; ++k) {
            corners[k] = static_cast<Id>(mesh.points.size());
            mesh.points.push_back(point_at(uv[k]));
            normals[k] = normal_at(uv[k]);
        }
        mesh.triangles.push_back(corners);
        mesh.uvs.push_back(uv);
        mesh.normals.push_back(normals);
        mesh.material.push_back(0);
    };
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const auto at = [&](int di, int dj) { return Vec2(i + di, j + dj) / double(n); };
            add({at(0, 0), at(1, 0), at(1, 1)});
            add({at(0, 0), at(1, 1), at(0, 1)});
        }
    return mesh;
}

/// What the tangents are by definition: groups grow from pair to pair of all triangles until none grows.
std::vector<std::array<Vec4, 3>> by_definition(const ObjectMesh& mesh) {
    const std::size_t count = mesh.triangles.size();
    std::vector<std::array<std::size_t, 3>> group(count);
    std::vector<double> area(count);
    const auto point = [&](std::size_t t, std::size_t k) { return mesh.points[mesh.triangles[t][k % 3]]; };
    const auto is_same = [&](std::size_t t, std::size_t k, std::size_t s, std::size_t l) {
        k %= 3, l %= 3;
        return point(t, k) == point(s, l) && mesh.normals[t][k] == mesh.normals[s][l] &&
               mesh.uvs[t][k] == mesh.uvs[s][l];
    };
    for (std::size_t t = 0; t < count; ++t) {
        group[t] = {3 * t, 3 * t + 1, 3 * t + 2};
        const auto& uv = mesh.uvs[t];
        area[t] = (uv[1].x - uv[0].x) * (uv[2].y - uv[0].y) - (uv[1].y - uv[0].y) * (uv[2].x - uv[0].x);
    }
    for (bool grows = true; grows;) {
        grows = false;
        for (std::size_t t = 0; t < count; ++t)
            for (std::size_t s = 0; s < count; ++s)
                for (std::size_t e = 0; s != t && e < 9; ++e) {
                    const std::size_t k = e / 3, l = e % 3;  // edges k, k + 1 and l, l + 1
                    if (!is_same(t, k, s, l + 1) || !is_same(t, k + 1, s, l) || area[t] * area[s] < 0)
                        continue;
                    for (const auto& [a, b] : {std::pair(k, (l + 1) % 3), std::pair((k + 1) % 3, l)})
                        if (group[t][a] != group[s][b]) {
                            grows = true;
                            group[t][a] = group[s][b] = std::min(group[t][a], group[s][b]);
                        }
                }
    }
    std::vector<Vec3> sum(3 * count, Vec3(0));
    const auto flat = [&](const Vec3& v, const Vec3& normal) { return v - dot(v, normal) * normal; };
    for (std::size_t t = 0; t < count; ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3& n = mesh.normals[t][k];
            const Vec3 a = normalize(flat(point(t, k + 1) - point(t, k), n)),
                       b = normalize(flat(point(t, k + 2) - point(t, k), n));
            // The derivative of the point by u, by Cramer's rule.
            const auto& uv = mesh.uvs[t];
            const Vec3 along = ((uv[2].y - uv[0].y) * (point(t, 1) - point(t, 0)) -
                                (uv[1].y - uv[0].y) * (point(t, 2) - point(t, 0))) /
                               area[t];
            sum[group[t][k]] += std::acos(std::clamp(dot(a, b), -1.0, 1.0)) * normalize(flat(along, n));
        }
    std::vector<std::array<Vec4, 3>> result(count);
    for (std::size_t t = 0; t < count; ++t)
        for (std::size_t k = 0; k < 3; ++k)
            result[t][k] = Vec4(normalize(sum[group[t][k]]), area[t] < 0 ? -1 : 1);
    return result;
}

double farthest(const std::vector<std::array<Vec4, 3>>& a, const std::vector<std::array<Vec4, 3>>& b) {
    REQUIRE(a.size() == b.size());
    double far = 0;
    for (std::size_t t = 0; t < a.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) far = std::max(far, glm::length(a[t][k] - b[t][k]));
    return far;
}

}  // namespace

TEST_CASE("tangents of a torus come to its circles as triangles get small", "[scene][oracle]") {
    const auto angle = [](double x) { return 2 * std::numbers::pi * x; };
    const auto normal_at = [&](const Vec2& uv) {
        return Vec3(std::cos(angle(uv.x)) * std::cos(angle(uv.y)), std::sin(angle(uv.y)),
                    -std::sin(angle(uv.x)) * std::cos(angle(uv.y)));
    };
    const auto point_at = [&](const Vec2& uv) {
        return 2.0 * Vec3(std::cos(angle(uv.x)), 0, -std::sin(angle(uv.x))) + normal_at(uv);
    };
    constexpr double kSlant = 0.6;  // of the lines of equal v
    double last = 1;
    for (const int n : {12, 24, 48}) {
        ObjectMesh torus = sampled(n, point_at, normal_at);
        const ObjectMesh plain = torus;
        for (auto& corners : torus.uvs)
            for (Vec2& uv : corners) uv.y += kSlant * uv.x;
        add_tangents(torus, mapped_material());
        double off = 0;
        for (std::size_t t = 0; t < torus.tangents.size(); ++t)
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec2& uv = plain.uvs[t][k];
                const bool is_inner = uv.x > 0.01 && uv.x < 0.99 && uv.y > 0.01 && uv.y < 0.99;
                const double a = angle(uv.x), b = angle(uv.y);
                const Vec3 around(-std::sin(a), 0, -std::cos(a)),
                    up(-std::cos(a) * std::sin(b), std::cos(b), std::sin(a) * std::sin(b));
                const Vec3 exact = normalize((2 + std::cos(b)) * around - kSlant * up);
                CHECK(torus.tangents[t][k].w == 1);
                CHECK(std::fabs(dot(Vec3(torus.tangents[t][k]), torus.normals[t][k])) < 1e-12);
                if (is_inner) off = std::max(off, length(Vec3(torus.tangents[t][k]) - exact));
            }
        INFO(n << " segments: " << off);
        CHECK(off > 0);
        CHECK(off < 0.3 * last);  // like the square of the segments
        last = off;
    }
}

TEST_CASE("tangents are those of the definition, asked of every pair of triangles", "[scene][oracle]") {
    Draw draw(5);
    for (int trial = 0; trial < 40; ++trial) {
        // A crumpled sheet whose map is folded along lines of u and v, so that parts of it are mirrored.
        const double fold_u = draw.uniform(0.2, 0.8), fold_v = draw.uniform(0.2, 0.8);
        ObjectMesh sheet = sampled(
            5, [&](const Vec2& uv) { return Vec3(uv.x, 0.3 * std::sin(9 * uv.x + 7 * uv.y + trial), uv.y); },
            [&](const Vec2& uv) {
                return normalize(Vec3(std::sin(50 * uv.x + trial), 3, std::cos(40 * uv.y - trial)));
            });
        for (auto& corners : sheet.uvs)
            for (Vec2& uv : corners) uv = {std::fabs(uv.x - fold_u), std::fabs(uv.y - fold_v)};
        const auto expected = by_definition(sheet);
        add_tangents(sheet, mapped_material());
        CHECK(farthest(sheet.tangents, expected) < 1e-9);
    }
}

TEST_CASE("what has no direction of its own takes its neighbours', and what has no map none", "[scene]") {
    // Four triangles around the origin; the second's uv have no area.
    ObjectMesh fan;
    fan.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
    fan.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}};
    fan.uvs = {{Vec2(0, 0), Vec2(0, 1), Vec2(-1, 0)},
               {Vec2(0, 0), Vec2(-1, 0), Vec2(-2, 0)},
               {Vec2(0, 0), Vec2(-2, 0), Vec2(0, -1)}};
    fan.material = {0, 0, 0};
    const ObjectMesh bare = fan;
    add_tangents(fan, mapped_material());
    CHECK(fan.tangents[0][0].w == 1);
    CHECK(length(Vec3(fan.tangents[0][1]) - Vec3(0, -1, 0)) < 1e-12);
    CHECK(fan.tangents[1][0] == fan.tangents[0][0]);
    CHECK(fan.tangents[1][1] == fan.tangents[0][2]);  // the corner that it shares with the first
    CHECK(fan.tangents[1][2] == fan.tangents[2][1]);  // with the third

    std::vector<Material> materials = mapped_material();
    materials.emplace_back();
    fan = bare;
    fan.material[0] = 1;
    add_tangents(fan, materials);
    CHECK(fan.tangents[0][0] == Vec4(0));
    CHECK(Vec3(fan.tangents[2][2]) != Vec3(0));
    fan.material = {1, 1, 1};
    add_tangents(fan, materials);
    CHECK(fan.tangents.empty());

    // Those of the file stay.
    fan = bare;
    fan.tangents.resize(3);
    fan.tangents[0].fill(Vec4(0, 0, 1, -1));
    add_tangents(fan, mapped_material());
    CHECK(fan.tangents[0][0] == Vec4(0, 0, 1, -1));
    CHECK(Vec3(fan.tangents[2][0]) != Vec3(0));
}

TEST_CASE("a glTF's tangents go with nodes, morph targets and skins", "[scene]") {
    const std::string folder = scratch_dir("scene_gltf_tangents");
    GltfBuffer buffer = make_buffer();
    const auto named = [](int accessor) { return std::to_string(accessor); };
    const std::string normals = named(buffer.add({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3)),
                      tangents =
                          named(buffer.add({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, "VEC4", 4)),
                      steps = named(buffer.add({0, 2, 0, 0, 2, 0, 0, 2, 0, 0, 2, 0}, "VEC3", 3)),
                      uvs = named(buffer.add({0, 1, 1, 1, 0, 0, 1, 0}, "VEC2", 2)),
                      unhanded =
                          named(buffer.add({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", 4));
    GltfParts parts;
    parts.materials = R"([{"normalTexture":{"index":0}}])";
    const std::string picture =
        R"(,"textures":[{"source":0}],"images":[{"uri":"data:image/png;base64,iVBO"}])";
    parts.more = picture;
    const auto primitive = [&](const std::string& attributes, const std::string& more = "") {
        return R"({"attributes":{"POSITION":0,"TEXCOORD_0":)" + uvs + attributes +
               R"(},"indices":1,"material":0)" + more + "}";
    };
    const std::string given = R"(,"NORMAL":)" + normals + R"(,"TANGENT":)" + tangents;
    const auto tangent = [&](std::size_t corner = 0) {
        return load(write_gltf(folder, parts, buffer)).meshes[0].object.tangents.at(0)[corner];
    };

    // Stretched along y and x unlike, turned about z, and mirrored: as the surface, not as its normal.
    parts.primitive = primitive(given);
    parts.nodes = R"([{"mesh":0,"matrix":[0,2,0,0, -3,0,0,0, 0,0,1,0, 0,0,0,1]}])";
    CHECK(glm::length(tangent() - Vec4(0, 1, 0, 1)) < 1e-12);
    parts.nodes = R"([{"mesh":0,"scale":[-1,1,1]}])";
    CHECK(glm::length(tangent() - Vec4(-1, 0, 0, -1)) < 1e-12);

    parts.primitive = primitive(given, R"(,"targets":[{"TANGENT":)" + steps + "}]");
    parts.nodes = R"([{"mesh":0,"weights":[0.5]}])";
    CHECK(glm::length(tangent() - Vec4(std::sqrt(0.5), std::sqrt(0.5), 0, 1)) < 1e-12);

    // Point 1 goes with the second joint alone, a quarter turn about z.
    parts.primitive = primitive(given + R"(,"JOINTS_0":3,"WEIGHTS_0":4)");
    parts.nodes = R"([{"mesh":0,"skin":0},{"children":[2]},{"rotation":[0,0,0.70710678,0.70710678]}])";
    parts.roots = "[0,1]";
    parts.more = picture + R"(,"skins":[{"joints":[1,2],"inverseBindMatrices":5}])";
    CHECK(glm::length(tangent(0) - Vec4(1, 0, 0, 1)) < 1e-7);
    CHECK(glm::length(tangent(1) - Vec4(0, 1, 0, 1)) < 1e-7);

    // Without normals they do not count, and without a side neither: u runs along x, v downward in the file.
    parts = {.primitive = "", .materials = parts.materials, .more = picture};
    parts.primitive = primitive(R"(,"TANGENT":)" + unhanded);
    CHECK(tangent() == Vec4(1, 0, 0, 1));
    parts.primitive = primitive(R"(,"NORMAL":)" + normals + R"(,"TANGENT":)" + unhanded);
    CHECK(tangent() == Vec4(1, 0, 0, 1));
    CHECK(warns(load(write_gltf(folder, parts, buffer)), "handedness is neither 1 nor -1"));
}

TEST_CASE("tangents of mirrors in a glTF go with their nodes, and a cage says that it ignores them",
          "[scene]") {
    const std::string folder = scratch_dir("scene_gltf_optic_tangents");
    GltfBuffer buffer = make_buffer();
    const auto named = [](int accessor) { return std::to_string(accessor); };
    const std::string normals = named(buffer.add({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3)),
                      tangents =
                          named(buffer.add({1, 0, 0, -1, 1, 0, 0, -1, 1, 0, 0, -1, 1, 0, 0, -1}, "VEC4", 4)),
                      uvs = named(buffer.add({0, 1, 1, 1, 0, 0, 1, 0}, "VEC2", 2));
    const std::string square =
        R"({"attributes":{"POSITION":0,"NORMAL":)" + normals + R"(,"TEXCOORD_0":)" + uvs;
    GltfParts parts;
    parts.materials = R"([{"normalTexture":{"index":0},
        "pbrMetallicRoughness":{"metallicFactor":1,"roughnessFactor":0}}])";
    parts.more = R"(,"textures":[{"source":0}],"images":[{"uri":"data:image/png;base64,iVBO"}])";
    parts.primitive = square + R"(,"TANGENT":)" + tangents + R"(},"indices":1,"material":0})";
    Scene scene = load(write_gltf(folder, parts, buffer));
    REQUIRE(scene.meshes[0].role == Role::kOptic);
    CHECK(scene.meshes[0].cage_tangents == std::vector<Vec4>(6, Vec4(1, 0, 0, -1)));

    // Mirrored along x, with a second part that has none.
    parts.nodes = R"([{"mesh":0,"scale":[-1,1,1]}])";
    parts.primitive += "," + square + R"(},"indices":1,"material":0})";
    scene = load(write_gltf(folder, parts, buffer));
    REQUIRE(scene.meshes[0].cage_tangents.size() == 12);
    CHECK(scene.meshes[0].cage_tangents[0] == Vec4(-1, 0, 0, 1));
    CHECK(scene.meshes[0].cage_tangents[6] == Vec4(0));
    CHECK(!warns(scene, "the tangents of its points are ignored"));

    parts.nodes = R"([{"mesh":0,"extras":{"trilens":{"subdivision":"loop"}}}])";
    scene = load(write_gltf(folder, parts, buffer));
    CHECK(scene.meshes[0].cage_tangents.empty());
    CHECK(warns(scene, "the tangents of its points are ignored: it is subdivided"));
}
