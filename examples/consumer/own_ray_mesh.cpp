// Draws one triangle through a RayMesh of our own, a cylinder of rays that looks outwards: the core alone.
#include <trilens/error.h>
#include <trilens/ray_mesh.h>

#include <cmath>
#include <cstdio>

int main() try {
    // A panorama of 180 degrees: 32 columns of two facets; each corner looks its own way from the axis.
    constexpr int kColumns = 32, kWidth = 64, kHeight = 16;
    trilens::RayMesh mesh;
    for (int i = 0; i <= kColumns; ++i) {
        const double share = static_cast<double>(i) / kColumns, angle = M_PI * (share - 0.5);
        for (const double y : {0.25, -0.25}) {
            mesh.rays.push_back({{0, 0, 0}, {std::sin(angle), y, -std::cos(angle)}});
            mesh.screen.push_back({share * kWidth, y > 0 ? 0 : kHeight, 1});
        }
        const trilens::Id a = static_cast<trilens::Id>(2 * i);
        if (i < kColumns) {
            mesh.facets.push_back({a, a + 1, a + 2});
            mesh.facets.push_back({a + 2, a + 1, a + 3});
        }
    }

    trilens::TriangleScene scene;
    scene.points = {{-1, -0.4, -3}, {1, -0.4, -3}, {0, 0.6, -3}};
    scene.triangles = {{0, 1, 2}};
    scene.object = {0};
    scene.primitive = {0};
    int seen = 0;
    const std::vector<trilens::Hit> hits = trilens::draw_through(mesh, scene, {0, 0, kWidth, kHeight, 1});
    for (std::size_t s = 0; s < hits.size(); ++s) {
        seen += hits[s].seen();
        std::putchar(hits[s].seen() ? '#' : '.');
        if (s % kWidth == kWidth - 1) std::putchar('\n');
    }

    // Data that is none is told, and ends nothing.
    scene.triangles[0][2] = 7;
    try {
        trilens::draw_through(mesh, scene, {0, 0, kWidth, kHeight, 1});
        return 1;
    } catch (const trilens::InputError& error) {
        std::printf("told: %s\n", error.what());
    }
    return seen > 20 ? 0 : 1;
} catch (const trilens::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
