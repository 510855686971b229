// Which proxy geometry stands for what a photograph of a mirror does not say: how far away things are.
#pragma once

#include <string>

#include "base/math/box.h"

namespace trilens {

/// kScene: the scene's objects, and infinity where there are none. kInfinity: light from afar. kSphere: of
/// this radius about the centre. kBox: the walls of a room, seen from inside. kMesh: the triangles of an OBJ
/// file, and infinity between them.
enum class ProxyKind { kScene, kInfinity, kSphere, kBox, kMesh };

struct ProxyDescription {
    ProxyKind kind = ProxyKind::kScene;
    double radius = 1;
    Box box;
    std::string file;  // kMesh
};

/// Reads "scene", "infinity", "sphere:R", "box:x0,y0,z0,x1,y1,z1", or the name of an OBJ file ("room.obj").
/// Throws UsageError that says what is wrong.
ProxyDescription parse_proxy(const std::string& text);

}  // namespace trilens
