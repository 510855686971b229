// One triangle that is shaded in one light: what tests of lights and of materials look at.
#pragma once

#include <array>

#include "shade/shade.h"

namespace trilens_test {

/// White and matt until its material is changed. Not copied: its shading points at its triangle.
struct ShadedTriangle {
    trilens::TriangleScene triangles;
    trilens::ShadeScene shading;

    ShadedTriangle(const std::array<trilens::Vec3, 3>& corners, const trilens::Light& light) {
        triangles.points.assign(corners.begin(), corners.end());
        triangles.triangles = {{0, 1, 2}};
        triangles.object = triangles.primitive = {0};
        shading.triangles = &triangles;
        shading.material = {0};
        shading.materials = {trilens::Material{}};
        shading.lights = {light};
    }
    ShadedTriangle(const ShadedTriangle&) = delete;
    ShadedTriangle& operator=(const ShadedTriangle&) = delete;

    trilens::Material& material() { return shading.materials[0]; }
};

}  // namespace trilens_test
