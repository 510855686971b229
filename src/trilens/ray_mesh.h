// RayMeshes of one's own: who looks at the scene, and what it then sees.
//
//     trilens::TriangleScene scene;  // points, triangles, object, primitive
//     const trilens::LinearCamera camera = trilens::make_perspective({});
//     const trilens::RayMesh mesh = trilens::make_camera_mesh(camera, 640, 480);
//     const std::vector<trilens::Hit> hits = trilens::draw_through(mesh, scene, {0, 0, 640, 480, 1});
//     // Only which triangles, faster:
//     const std::vector<trilens::Visible> seen = trilens::visible_through(mesh, scene, {0, 0, 640, 480, 1});
#pragma once

#include "core/ray_mesh.h"
