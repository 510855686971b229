#include "thesis/scene_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "thesis/search.h"
#include "trilinear/outline.h"

namespace trilens {
namespace {

constexpr int kSweepPieces = 24;  // of the swept surface, each way

std::string text(double value) {
    char buffer[64];
    std::snprintf(buffer, sizeof buffer, "%.*f", kDecimals, value);
    std::string digits(buffer);
    digits.erase(digits.find_last_not_of('0') + 1);
    if (digits.back() == '.') digits.pop_back();
    return digits == "-0" ? "0" : digits;
}

std::string text(const Vec3& v) {
    return "[" + text(v.x) + ", " + text(v.y) + ", " + text(v.z) + "]";
}

template <class List, class Text>
std::string joined(const List& list, Text item) {
    std::string all;
    for (const auto& one : list) all += (all.empty() ? "" : ", ") + item(one);
    return "[" + all + "]";
}

std::string points_text(const std::vector<Vec3>& points) {
    return joined(points, [](const Vec3& p) { return text(p); });
}

std::string extras(const Origin& origin) {
    std::string json = "\"figure\": \"" + origin.figure + "\", \"seed\": " + std::to_string(origin.seed);
    if (!origin.configuration.empty())
        json += ", \"configuration\": " +
                joined(origin.configuration, [](std::size_t n) { return std::to_string(n); });
    return "{" + json + "}";
}

std::string ray_mesh_camera(const std::vector<Ray>& rays, const std::string& screen,
                            const std::string& triangles) {
    std::vector<Vec3> points, directions;
    for (const Ray& ray : rays) points.push_back(ray.origin), directions.push_back(ray.direction);
    return "    {\n      \"name\": \"main\",\n      \"type\": \"rayMesh\",\n      \"points\": " +
           points_text(points) + ",\n      \"directions\": " + points_text(directions) +
           ",\n      \"screen\": " + screen + ",\n      \"triangles\": " + triangles + "\n    }";
}

std::string triangle_mesh(const SceneTriangle& triangle) {
    return "    {\n      \"name\": \"triangle\",\n      \"role\": \"object\",\n      \"material\": "
           "\"panel\",\n      \"points\": " +
           points_text({triangle.corner.begin(), triangle.corner.end()}) +
           ",\n      \"faceVertexCounts\": [3],\n      \"faceVertexIndices\": [0, 1, 2],\n"
           "      \"uvs\": [[0, 0], [1, 0], [0.5, 1]]\n    }";
}

struct SceneText {
    std::string film, camera, meshes, materials, lights;
};

const std::string kPanel =
    "    {\"name\": \"panel\", \"baseColorTexture\": \"../textures/panel.png\", \"unlit\": true}";

void write_scene(const std::string& file, const Origin& origin, const SceneText& scene) {
    std::ofstream out(file, std::ios::binary);
    out << "{\n  \"version\": 1,\n  \"film\": " << scene.film << ",\n  \"cameras\": [\n"
        << scene.camera
        << "\n  ],\n  \"background\": {\"color\": [0.02, 0.025, 0.035]},\n  \"materials\": [\n"
        << scene.materials << "\n  ],\n  \"meshes\": [\n"
        << scene.meshes << "\n  ],\n  \"lights\": [" << scene.lights << "],\n  \"extras\": " << extras(origin)
        << "\n}\n";
    out.close();
    if (!out) throw std::runtime_error("cannot write " + file);
}

double rounded(double value) {
    return std::stod(text(value));
}
Vec3 rounded(const Vec3& v) {
    return {rounded(v.x), rounded(v.y), rounded(v.z)};
}

/// A sheet of quads between two rays, t from 0 to `far`.
std::string swept_mesh(const Ray& first, const Ray& second, double far) {
    std::vector<Vec3> points;
    std::vector<std::string> indices;
    for (int i = 0; i <= kSweepPieces; ++i)
        for (int j = 0; j <= kSweepPieces; ++j) {
            const double t = far * i / kSweepPieces, u = 1.0 * j / kSweepPieces;
            points.push_back((1 - u) * (first.origin + t * first.direction) +
                             u * (second.origin + t * second.direction));
            if (i == kSweepPieces || j == kSweepPieces) continue;
            const int k = i * (kSweepPieces + 1) + j;
            for (const int corner : {k, k + 1, k + kSweepPieces + 2, k + kSweepPieces + 1})
                indices.push_back(std::to_string(corner));
        }
    const std::string counts =
        joined(std::vector<int>(kSweepPieces * kSweepPieces, 4), [](int n) { return std::to_string(n); });
    return "    {\n      \"name\": \"swept edge\",\n      \"role\": \"object\",\n      \"material\": "
           "\"sheet\",\n      \"points\": " +
           points_text(points) + ",\n      \"faceVertexCounts\": " + counts +
           ",\n      \"faceVertexIndices\": " + joined(indices, [](const std::string& s) { return s; }) +
           "\n    }";
}

}  // namespace

FacetScene rounded(const FacetScene& scene) {
    FacetScene result = scene;
    for (Ray& ray : result.facet.corner) ray = {rounded(ray.origin), rounded(ray.direction)};
    for (Vec3& corner : result.triangle.corner) corner = rounded(corner);
    return result;
}

void write_facet_scene(const std::string& file, const Origin& origin, const FacetScene& scene) {
    const std::vector<Ray> rays(scene.facet.corner.begin(), scene.facet.corner.end());
    write_scene(file, origin,
                {"{\"width\": 480, \"height\": 480, \"spp\": 2}",
                 ray_mesh_camera(rays, "[[-0.5, 1], [1.5, 1], [0.5, -1]]", "[[0, 1, 2]]"),
                 triangle_mesh(scene.triangle), kPanel, ""});
}

void write_two_facets(const std::string& file, const Origin& origin, const TwoFacets& two) {
    const std::vector<Ray> rays(two.corner.begin(), two.corner.end());
    write_scene(file, origin,
                {"{\"width\": 480, \"height\": 480, \"spp\": 2}",
                 ray_mesh_camera(rays, "[[0, 0], [1, 0], [1, 1], [0, 1]]", "[[0, 1, 2], [0, 2, 3]]"),
                 triangle_mesh(two.triangle), kPanel, ""});
}

void write_swept_edge(const std::string& file, const Origin& origin, const TwoFacets& two) {
    const std::string camera =
        "    {\n      \"name\": \"main\",\n      \"type\": \"perspective\",\n      \"yfov\": 36,\n"
        "      \"lookAt\": {\"eye\": [4.2, 2.6, 3.2], \"at\": [0, -0.1, -1.5], \"up\": [0, 1, 0]}\n    }";
    const std::string facets =
        "    {\n      \"name\": \"facets\",\n      \"role\": \"object\",\n      \"material\": \"facets\",\n  "
        "    \"points\": " +
        points_text(
            {two.corner[0].origin, two.corner[1].origin, two.corner[2].origin, two.corner[3].origin}) +
        ",\n      \"faceVertexCounts\": [3, 3],\n      \"faceVertexIndices\": [0, 1, 2, 0, 2, 3]\n    }";
    write_scene(
        file, origin,
        {"{\"width\": 640, \"height\": 480, \"spp\": 2}", camera,
         triangle_mesh(two.triangle) + ",\n" + swept_mesh(two.corner[0], two.corner[2], 1.8) + ",\n" + facets,
         kPanel + ",\n    {\"name\": \"sheet\", \"baseColorFactor\": [0.75, 0.3, 0.12]},\n"
                  "    {\"name\": \"facets\", \"baseColorFactor\": [0.3, 0.35, 0.42]}",
         "{\"type\": \"directional\", \"direction\": [-1, -2, -0.6], \"intensity\": 2.2}, {\"type\": "
         "\"ambient\", \"color\": [0.3, 0.3, "
         "0.3]}"});
}

namespace {

constexpr int kDraws = 20000, kSteps = 8000;
constexpr double kWantedGap = 0.12;  // of the shared edge

/// A triangle's part of one facet: its share of the facet, and where it lies on the edge from corner 0 to
/// corner 2.
struct Part {
    double area = 0, low = 1, high = 0;
};

/// `shared` are the facet's local numbers of the ends of the shared edge; none where the part is not one
/// polygon.
Part part_of(const FacetScene& scene, std::array<int, 2> shared) {
    ShapeParams params;
    params.curves = Curves::kStraight, params.clip = Clip::kScreen;
    const std::vector<Outline> outlines = project_triangle(scene.facet, scene.triangle, params);
    if (outlines.size() != 1) return {};
    Part part;
    const std::vector<ImageVertex>& v = outlines[0].vertex;
    const int opposite = 3 - shared[0] - shared[1];
    for (std::size_t i = 0; i < v.size(); ++i) {
        const Vec3 &p = v[i].weights, &q = v[(i + 1) % v.size()].weights;
        if (p[opposite] != 0 && std::min(p[shared[0]], p[shared[1]]) == 0) return {};  // beyond the film
        part.area += p.y * q.z - p.z * q.y;
        if (p[opposite] != 0) continue;
        part.low = std::min(part.low, p[shared[1]]), part.high = std::max(part.high, p[shared[1]]);
    }
    part.area = std::fabs(part.area);
    return part;
}

double score_of(TwoFacets& two) {
    const std::array<Ray, 4>& c = two.corner;
    const Part first = part_of({{{c[0], c[1], c[2]}}, two.triangle}, {0, 2});
    const Part second = part_of({{{c[0], c[2], c[3]}}, two.triangle}, {0, 1});
    const double shared = std::min(first.high - first.low, second.high - second.low);
    if (!(shared > 0.15) || std::min(first.low, second.low) < 0.05 ||
        std::max(first.high, second.high) > 0.95)
        return 0;
    two.gap = std::max(std::fabs(first.low - second.low), std::fabs(first.high - second.high));
    return std::min(first.area, second.area) + 3 * std::min(two.gap, kWantedGap);
}

TwoFacets random_two(Dice& dice) {
    TwoFacets two;
    const Vec3 square[4] = {{-1, 1, 0}, {1, 1, 0}, {1, -1, 0}, {-1, -1, 0}};
    for (std::size_t k = 0; k < 4; ++k) two.corner[k] = {square[k], Vec3(0, 0, -2) + 0.5 * dice.normal()};
    for (Vec3& corner : two.triangle.corner) corner = Vec3(0, 0, -2) + 0.9 * dice.normal();
    return two;
}

}  // namespace

TwoFacets search_discontinuity(std::uint64_t seed) {
    Dice dice(seed);
    TwoFacets best;
    double score = 0;
    for (int i = 0; i < kDraws + kSteps; ++i) {
        TwoFacets next = i < kDraws || score == 0 ? random_two(dice) : best;
        if (i >= kDraws && score > 0) {
            for (Ray& ray : next.corner) ray.direction += 0.05 * dice.normal();
            for (Vec3& corner : next.triangle.corner) corner += 0.05 * dice.normal();
        }
        const double reached = score_of(next);
        if (reached > score) best = next, score = reached;
    }
    return best;
}

}  // namespace trilens
