// The example scenes, each for one capability.
#include "scene/examples.h"

namespace trilens {
namespace {

constexpr const char* kMirrorSphere = R"json({
  // An exact mirror sphere in a room whose walls have different colours.
  "version": 1,
  "film": { "width": 640, "height": 480 },
  "cameras": [ { "name": "main", "yfov": 45, "lookAt": { "eye": [0, 0.4, 3.6], "at": [0, 0, 0] } } ],
  "background": { "color": [0.02, 0.02, 0.03] },
  "materials": [
    { "name": "chrome", "baseColorFactor": [0.95, 0.95, 0.95], "metallicFactor": 1 },
    { "name": "white", "baseColorFactor": [0.8, 0.8, 0.8] },
    { "name": "red", "baseColorFactor": [0.8, 0.1, 0.1] },
    { "name": "green", "baseColorFactor": [0.1, 0.6, 0.1] },
    { "name": "blue", "baseColorFactor": [0.1, 0.2, 0.8] },
    { "name": "lamp", "baseColorFactor": [1, 1, 0.9], "unlit": true }
  ],
  "meshes": [
    { "name": "ball", "role": "optic", "material": "chrome", "resolution": 16,
      "primitive": { "type": "sphere", "center": [0, 0, 0], "radius": 1 } },
    { "name": "floor", "role": "object", "material": "white",
      "points": [[-4,-2,-4],[4,-2,-4],[4,-2,4],[-4,-2,4]], "faceVertexCounts": [4], "faceVertexIndices": [3,2,1,0] },
    { "name": "left wall", "role": "object", "material": "red",
      "points": [[-4,-2,-4],[-4,3,-4],[-4,3,4],[-4,-2,4]], "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3] },
    { "name": "right wall", "role": "object", "material": "green",
      "points": [[4,-2,-4],[4,3,-4],[4,3,4],[4,-2,4]], "faceVertexCounts": [4], "faceVertexIndices": [3,2,1,0] },
    { "name": "back wall", "role": "object", "material": "blue",
      "points": [[-4,-2,-4],[4,-2,-4],[4,3,-4],[-4,3,-4]], "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3] },
    { "name": "panel", "role": "object", "material": "lamp",
      "points": [[-1,2.9,-1],[1,2.9,-1],[1,2.9,1],[-1,2.9,1]], "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3] }
  ],
  "lights": [ { "type": "point", "position": [0, 2.5, 2], "intensity": 12 }, { "type": "ambient", "color": [0.15, 0.15, 0.15] } ]
}
)json";

constexpr const char* kCreasedCage = R"json({
  // A mirrored box: a Catmull-Clark cage whose upper edges are semi-sharp and whose lower corners are sharp.
  "version": 1,
  "film": { "width": 640, "height": 480 },
  "cameras": [ { "name": "main", "yfov": 40, "lookAt": { "eye": [2.2, 1.8, 3.4], "at": [0, 0, 0] } } ],
  "background": { "color": [0.25, 0.4, 0.65] },
  "materials": [
    { "name": "gold", "baseColorFactor": [1, 0.77, 0.34], "metallicFactor": 1 },
    { "name": "dark", "baseColorFactor": [0.1, 0.1, 0.12] },
    { "name": "light", "baseColorFactor": [0.85, 0.85, 0.8] }
  ],
  "meshes": [
    { "name": "box", "role": "optic", "material": "gold", "resolution": 16,
      "points": [[-1,-1,-1],[1,-1,-1],[1,1,-1],[-1,1,-1],[-1,-1,1],[1,-1,1],[1,1,1],[-1,1,1]],
      "faceVertexCounts": [4,4,4,4,4,4],
      "faceVertexIndices": [4,5,6,7, 1,0,3,2, 5,1,2,6, 0,4,7,3, 7,6,2,3, 0,1,5,4],
      "creaseIndices": [2,3,7,6,2], "creaseLengths": [5], "creaseSharpnesses": [2.5],
      "cornerIndices": [0,1,4,5], "cornerSharpnesses": [10,10,10,10] },
    { "name": "dark tiles", "role": "object", "material": "dark", "transform": { "translate": [0, -1.2, 0] },
      "points": [[-6,0,-6],[0,0,-6],[6,0,-6],[-6,0,0],[0,0,0],[6,0,0],[-6,0,6],[0,0,6],[6,0,6]],
      "faceVertexCounts": [4,4], "faceVertexIndices": [0,3,4,1, 4,7,8,5] },
    { "name": "light tiles", "role": "object", "material": "light", "transform": { "translate": [0, -1.2, 0] },
      "points": [[-6,0,-6],[0,0,-6],[6,0,-6],[-6,0,0],[0,0,0],[6,0,0],[-6,0,6],[0,0,6],[6,0,6]],
      "faceVertexCounts": [4,4], "faceVertexIndices": [1,4,5,2, 3,6,7,4] }
  ],
  "lights": [ { "type": "directional", "direction": [-1, -2, -1], "intensity": 2 }, { "type": "ambient", "color": [0.2, 0.2, 0.2] } ]
}
)json";

constexpr const char* kWaterPatch = R"json({
  // A wavy interface of water over a pool's floor of four colours: refraction through one surface, with Fresnel reflection.
  "version": 1,
  "film": { "width": 640, "height": 480 },
  "cameras": [ { "name": "main", "yfov": 40, "lookAt": { "eye": [0, 2.6, 3.2], "at": [0, 0, 0] } } ],
  "background": { "color": [0.5, 0.65, 0.85] },
  "materials": [
    { "name": "water", "transmissionFactor": 1, "ior": 1.333, "volume": { "attenuationColor": [0.5, 0.8, 0.9], "attenuationDistance": 3 } },
    { "name": "sand", "baseColorFactor": [0.8, 0.7, 0.5] },
    { "name": "teal", "baseColorFactor": [0.1, 0.5, 0.5] },
    { "name": "coral", "baseColorFactor": [0.9, 0.35, 0.25] },
    { "name": "stone", "baseColorFactor": [0.35, 0.35, 0.4] }
  ],
  "meshes": [
    { "name": "surface", "role": "optic", "material": "water", "resolution": 12,
      "points": [[-2,0,-2],[-0.7,0.2,-2],[0.7,-0.2,-2],[2,0,-2],
                 [-2,-0.2,-0.7],[-0.7,0.3,-0.7],[0.7,-0.1,-0.7],[2,0.2,-0.7],
                 [-2,0.2,0.7],[-0.7,-0.2,0.7],[0.7,0.3,0.7],[2,-0.1,0.7],
                 [-2,0,2],[-0.7,-0.1,2],[0.7,0.2,2],[2,0,2]],
      "faceVertexCounts": [4,4,4,4,4,4,4,4,4],
      "faceVertexIndices": [0,4,5,1, 1,5,6,2, 2,6,7,3, 4,8,9,5, 5,9,10,6, 6,10,11,7, 8,12,13,9, 9,13,14,10, 10,14,15,11] },
    { "name": "floor 1", "role": "object", "material": "sand",
      "points": [[-3,-1,-3],[0,-1,-3],[0,-1,0],[-3,-1,0]], "faceVertexCounts": [4], "faceVertexIndices": [3,2,1,0] },
    { "name": "floor 2", "role": "object", "material": "teal",
      "points": [[0,-1,-3],[3,-1,-3],[3,-1,0],[0,-1,0]], "faceVertexCounts": [4], "faceVertexIndices": [3,2,1,0] },
    { "name": "floor 3", "role": "object", "material": "coral",
      "points": [[-3,-1,0],[0,-1,0],[0,-1,3],[-3,-1,3]], "faceVertexCounts": [4], "faceVertexIndices": [3,2,1,0] },
    { "name": "floor 4", "role": "object", "material": "stone",
      "points": [[0,-1,0],[3,-1,0],[3,-1,3],[0,-1,3]], "faceVertexCounts": [4], "faceVertexIndices": [3,2,1,0] }
  ],
  "lights": [ { "type": "directional", "direction": [0.3, -1, -0.4], "intensity": 2.5 }, { "type": "ambient", "color": [0.15, 0.15, 0.15] } ]
}
)json";

constexpr const char* kMirrorCylinder = R"json({
  // A mirror cylinder on a sheet of coloured strips, as for anamorphic pictures: seen in it, the strips bend.
  "version": 1,
  "film": { "width": 640, "height": 480 },
  "cameras": [ { "name": "main", "yfov": 35, "lookAt": { "eye": [0, 2.2, 4.5], "at": [0, 0.5, 0] } } ],
  "background": { "color": [0.6, 0.6, 0.6] },
  "materials": [
    { "name": "mirror", "metallicFactor": 1 },
    { "name": "ink", "baseColorFactor": [0.05, 0.05, 0.3], "unlit": true },
    { "name": "paper", "baseColorFactor": [0.9, 0.9, 0.85], "unlit": true },
    { "name": "orange", "baseColorFactor": [0.9, 0.4, 0.05], "unlit": true }
  ],
  "meshes": [
    { "name": "cylinder", "role": "optic", "material": "mirror", "resolution": 24,
      "primitive": { "type": "cylinder", "center": [0, 0.75, 0], "axis": [0, 1, 0], "radius": 0.5, "height": 1.5 } },
    { "name": "ink strip", "role": "object", "material": "ink",
      "points": [[-3,0,-1],[3,0,-1],[3,0,0.7],[-3,0,0.7]], "faceVertexCounts": [4], "faceVertexIndices": [3,2,1,0] },
    { "name": "orange strip", "role": "object", "material": "orange",
      "points": [[-3,0,0.7],[3,0,0.7],[3,0,1.4],[-3,0,1.4]], "faceVertexCounts": [4], "faceVertexIndices": [3,2,1,0] },
    { "name": "paper strip", "role": "object", "material": "paper",
      "points": [[-3,0,1.4],[3,0,1.4],[3,0,3],[-3,0,3]], "faceVertexCounts": [4], "faceVertexIndices": [3,2,1,0] }
  ]
}
)json";

constexpr SceneExample kExamples[] = {
    {"mirror-sphere", "an exact mirror sphere in a room of coloured walls", kMirrorSphere},
    {"creased-cage", "a mirrored Catmull-Clark cage with semi-sharp edges and sharp corners", kCreasedCage},
    {"water-patch", "refraction through a wavy interface of water", kWaterPatch},
    {"mirror-cylinder", "a mirror cylinder on coloured strips, as for anamorphic pictures", kMirrorCylinder},
};

}  // namespace

std::span<const SceneExample> scene_examples() {
    return kExamples;
}

}  // namespace trilens
