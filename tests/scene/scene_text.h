// What the tests of the scene room share: a scene to break, and the message of what broke.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/util/error.h"
#include "scene/load.h"
#include "support/test.h"

namespace trilens_test {

inline constexpr const char* kRoom = R"json({
  "version": 1,
  "film": { "width": 64, "height": 48, "spp": 2 },
  "cameras": [
    { "name": "main", "yfov": 40, "lookAt": { "eye": [0,1,4], "at": [0,0,0], "up": [0,1,0] } },
    { "name": "rays", "type": "rayMesh", "points": [[0,0,0],[1,0,0],[0,1,0]], "directions": [[0,0,-1],[0,0,-1],[0,0,-2]],
      "screen": [[0,0],[1,0],[0,1]], "triangles": [[0,1,2]] }
  ],
  "background": { "color": [0.2,0.3,0.5] },
  "materials": [
    { "name": "chrome", "baseColorFactor": [0.9,0.9,0.9], "metallicFactor": 1, "roughnessFactor": 0 },
    { "name": "glass", "transmissionFactor": 1, "ior": 1.5, "volume": { "attenuationColor": [1,0.5,1], "attenuationDistance": 2 } },
    { "name": "red", "baseColorFactor": [0.8,0.1,0.1], "unlit": true }
  ],
  "meshes": [
    { "name": "cage", "role": "optic", "material": "glass", "resolution": 4, "subdivisionScheme": "catmullClark",
      "interpolateBoundary": "edgeOnly", "points": [[-1,-1,0],[1,-1,0],[1,1,0],[-1,1,0],[3,-1,0],[3,1,0]],
      "faceVertexCounts": [4,4], "faceVertexIndices": [0,1,2,3,1,4,5,2],
      "creaseIndices": [0,1,2], "creaseLengths": [3], "creaseSharpnesses": [2.5], "cornerIndices": [3], "cornerSharpnesses": [10],
      "transform": { "translate": [0,0,1], "rotate": [0,0,0,1], "scale": [1,2,1] }, "normals": { "type": "noise", "seed": 7, "amplitude": 0.2, "scale": 3 } },
    { "name": "ball", "role": "optic", "material": "chrome", "primitive": { "type": "sphere", "center": [0,0,0], "radius": 1 } },
    { "name": "wall", "role": "object", "material": "red", "points": [[-4,-4,-4],[4,-4,-4],[4,4,-4],[-4,4,-4]],
      "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3], "uvs": [[0,0],[1,0],[1,1],[0,1]] }
  ],
  "lights": [ { "type": "directional", "direction": [-1,-2,-1], "intensity": 2, "shadows": true },
              { "type": "point", "position": [2,3,2], "intensity": 60 }, { "type": "ambient", "color": [0.1,0.1,0.1] } ],
  "render": { "maxDepth": 0, "paths": ["direct","reflect","refract"], "fresnel": true }
})json";

/// Every picture is one white texel.
inline trilens::TextureReader white_textures() {
    auto white = std::make_shared<trilens::Texture>();
    white->width = white->height = 1;
    white->rgb = {1, 1, 1};
    trilens::TextureReader reader;
    reader.from_file = [white](const std::string&) { return white; };
    reader.from_memory = [white](std::span<const unsigned char>, const std::string&) { return white; };
    return reader;
}

inline trilens::Scene load_text(const std::string& text,
                                const std::vector<trilens::SceneOverride>& overrides = {},
                                const std::string& file = "room.json") {
    return trilens::load_scene_text(text, file, overrides, white_textures());
}

/// The message of the InputError that loading ends in; "" where it loads.
inline std::string error_of(const std::string& text,
                            const std::vector<trilens::SceneOverride>& overrides = {},
                            const std::string& file = "room.json") {
    try {
        load_text(text, overrides, file);
        return "";
    } catch (const trilens::InputError& error) {
        return error.what();
    }
}

/// The room with one part set.
inline std::string error_with(const std::string& pointer, const std::string& value) {
    return error_of(kRoom, {{pointer, value}});
}

inline bool begins_with(const std::string& text, const std::string& start) {
    return text.rfind(start, 0) == 0;
}
inline bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

/// `text` with the first `from` replaced.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

}  // namespace trilens_test
