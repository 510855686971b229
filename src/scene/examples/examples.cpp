// The example scenes, each for one capability.
#include "scene/examples/examples.h"

#include "scene/examples/camera_examples.h"

namespace trilens {
namespace {

constexpr const char* kMirrorSphere = R"json({
  // An exact mirror sphere in a painted room. Everything it shows lies in this file; the front wall is behind the camera.
  "version": 1,
  "film": { "width": 640, "height": 480, "spp": 2 },
  "cameras": [ { "name": "main", "yfov": 42, "lookAt": { "eye": [0.6, 1.8, 4.7], "at": [-0.1, 1, 0] } } ],
  "materials": [
    { "name": "chrome", "baseColorFactor": [0.95, 0.95, 0.95], "metallicFactor": 1 },
    { "name": "plaster", "baseColorFactor": [0.8, 0.78, 0.72] },
    { "name": "slate", "baseColorFactor": [0.12, 0.14, 0.18] },
    { "name": "red", "baseColorFactor": [0.65, 0.09, 0.06] },
    { "name": "teal", "baseColorFactor": [0.05, 0.4, 0.42] },
    { "name": "yellow", "baseColorFactor": [0.9, 0.6, 0.08] },
    { "name": "blue", "baseColorFactor": [0.1, 0.22, 0.62] },
    { "name": "lamp", "baseColorFactor": [1, 0.97, 0.88], "unlit": true }
  ],
  "meshes": [
    { "name": "ball", "role": "optic", "material": "chrome", "resolution": 16,
      "primitive": { "type": "sphere", "center": [0, 1, 0], "radius": 1 } },
    // Floor, ceiling, back and front.
    { "name": "room", "role": "object", "material": "plaster",
      "points": [[-3,0,-3],[3,0,-3],[3,0,5],[-3,0,5], [-3,4,-3],[3,4,-3],[3,4,5],[-3,4,5]],
      "faceVertexCounts": [4,4,4,4], "faceVertexIndices": [3,2,1,0, 4,5,6,7, 0,1,5,4, 2,3,7,6] },
    { "name": "left wall", "role": "object", "material": "red",
      "points": [[-3,0,5],[-3,0,-3],[-3,4,-3],[-3,4,5]], "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3] },
    { "name": "right wall", "role": "object", "material": "teal",
      "points": [[3,0,-3],[3,0,5],[3,4,5],[3,4,-3]], "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3] },
    // Every other tile of the floor, row by row.
    { "name": "tiles", "role": "object", "material": "slate", "transform": { "translate": [0, 0.002, 0] },
      "points": [[-3,0,-3],[-1,0,-3],[1,0,-3],[3,0,-3], [-3,0,-1],[-1,0,-1],[1,0,-1],[3,0,-1],
                 [-3,0,1],[-1,0,1],[1,0,1],[3,0,1], [-3,0,3],[-1,0,3],[1,0,3],[3,0,3], [-3,0,5],[-1,0,5],[1,0,5],[3,0,5]],
      "faceVertexCounts": [4,4,4,4,4,4], "faceVertexIndices": [0,4,5,1, 2,6,7,3, 5,9,10,6, 8,12,13,9, 10,14,15,11, 13,17,18,14] },
    { "name": "pyramid", "role": "object", "material": "yellow", "transform": { "translate": [-1.55, 0, 1.2] },
      "points": [[-0.4,0,-0.4],[0.4,0,-0.4],[0.4,0,0.4],[-0.4,0,0.4],[0,0.9,0]],
      "faceVertexCounts": [3,3,3,3], "faceVertexIndices": [1,0,4, 2,1,4, 3,2,4, 0,3,4] },
    { "name": "box", "role": "object", "material": "blue", "transform": { "translate": [1.65, 0, 0.5] },
      "points": [[-0.4,0,-0.3],[0.3,0,-0.4],[0.4,0,0.3],[-0.3,0,0.4], [-0.4,0.8,-0.3],[0.3,0.8,-0.4],[0.4,0.8,0.3],[-0.3,0.8,0.4]],
      "faceVertexCounts": [4,4,4,4,4], "faceVertexIndices": [1,0,4,5, 2,1,5,6, 3,2,6,7, 0,3,7,4, 7,6,5,4] },
    { "name": "window", "role": "object", "material": "lamp",
      "points": [[-1.2,3.9995,0],[1.2,3.9995,0],[1.2,3.9995,2],[-1.2,3.9995,2]], "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3] }
  ],
  "lights": [
    { "type": "point", "position": [0, 3.7, 1], "intensity": 26, "color": [1, 0.95, 0.85], "shadows": true },
    { "type": "ambient", "color": [0.16, 0.17, 0.2] }
  ]
}
)json";

constexpr const char* kCreasedCage = R"json({
  // A twisted gold tower of twelve points: a Catmull-Clark cage with semi-sharp edges, a sharp lid and base, and sharp
  // corners. It shows lamps, posts and the striped table.
  "version": 1,
  "film": { "width": 640, "height": 480, "spp": 2 },
  "cameras": [ { "name": "main", "yfov": 32, "lookAt": { "eye": [3.1, 2.3, 6], "at": [0, 1.25, 0] } } ],
  "background": { "color": [0.62, 0.7, 0.8] },
  "materials": [
    { "name": "gold", "baseColorFactor": [1, 0.77, 0.34], "metallicFactor": 1 },
    { "name": "table", "baseColorFactor": [0.5, 0.5, 0.52] },
    { "name": "ink", "baseColorFactor": [0.07, 0.1, 0.2] },
    { "name": "rose", "baseColorFactor": [0.75, 0.12, 0.2] },
    { "name": "lamp", "baseColorFactor": [1, 0.98, 0.94], "unlit": true }
  ],
  "meshes": [
    // Three squares, each turned on the one below, then four faces, four faces, lid and base.
    { "name": "tower", "role": "optic", "material": "gold", "resolution": 16,
      "points": [[0.39,0,1.45],[1.45,0,-0.39],[-0.39,0,-1.45],[-1.45,0,0.39],
                 [0.78,1.3,0.78],[0.78,1.3,-0.78],[-0.78,1.3,-0.78],[-0.78,1.3,0.78],
                 [0.77,2.6,0.21],[0.21,2.6,-0.77],[-0.77,2.6,-0.21],[-0.21,2.6,0.77]],
      "faceVertexCounts": [4,4,4,4, 4,4,4,4, 4,4],
      "faceVertexIndices": [0,1,5,4, 1,2,6,5, 2,3,7,6, 3,0,4,7, 4,5,9,8, 5,6,10,9, 6,7,11,10, 7,4,8,11, 8,9,10,11, 3,2,1,0],
      "creaseIndices": [0,4,8, 1,5,9, 2,6,10, 3,7,11, 8,9,10,11,8, 0,1,2,3,0], "creaseLengths": [3,3,3,3,5,5],
      "creaseSharpnesses": [2,2,2,2,10,10], "cornerIndices": [0,1,2,3], "cornerSharpnesses": [10,10,10,10] },
    { "name": "table", "role": "object", "material": "table",
      "points": [[-400,0,-400],[400,0,-400],[400,0,400],[-400,0,400]], "faceVertexCounts": [4], "faceVertexIndices": [3,2,1,0] },
    { "name": "stripes", "role": "object", "material": "ink", "transform": { "translate": [0, 0.003, 0] },
      "points": [[-30,0,-8],[30,0,-8],[30,0,-7],[-30,0,-7], [-30,0,-6],[30,0,-6],[30,0,-5],[-30,0,-5],
                 [-30,0,-4],[30,0,-4],[30,0,-3],[-30,0,-3], [-30,0,-2],[30,0,-2],[30,0,-1],[-30,0,-1],
                 [-30,0,0],[30,0,0],[30,0,1],[-30,0,1], [-30,0,2],[30,0,2],[30,0,3],[-30,0,3],
                 [-30,0,4],[30,0,4],[30,0,5],[-30,0,5], [-30,0,6],[30,0,6],[30,0,7],[-30,0,7]],
      "faceVertexCounts": [4,4,4,4,4,4,4,4],
      "faceVertexIndices": [3,2,1,0, 7,6,5,4, 11,10,9,8, 15,14,13,12, 19,18,17,16, 23,22,21,20, 27,26,25,24, 31,30,29,28] },
    // Two posts, left and right of the box.
    { "name": "posts", "role": "object", "material": "rose",
      "points": [[-2.4,0,1],[-2,0,1],[-2,0,1.4],[-2.4,0,1.4],[-2.2,1.6,1.2], [2,0,-1.4],[2.4,0,-1.4],[2.4,0,-1],[2,0,-1],[2.2,1.6,-1.2]],
      "faceVertexCounts": [3,3,3,3,3,3,3,3], "faceVertexIndices": [1,0,4, 2,1,4, 3,2,4, 0,3,4, 6,5,9, 7,6,9, 8,7,9, 5,8,9] },
    // A lamp before each side that the camera sees.
    { "name": "lamps", "role": "object", "material": "lamp",
      "points": [[-2,0.8,6],[1.5,0.8,6],[1.5,4,6],[-2,4,6], [6,0.8,1.5],[6,0.8,-2],[6,4,-2],[6,4,1.5]],
      "faceVertexCounts": [4,4], "faceVertexIndices": [0,1,2,3, 4,5,6,7] }
  ],
  "lights": [
    { "type": "directional", "direction": [0.5, -1, -0.55], "intensity": 2.4, "shadows": true },
    { "type": "ambient", "color": [0.25, 0.27, 0.32] }
  ]
}
)json";

constexpr const char* kWaterPatch = R"json({
  // A pool seen through its own surface: refraction by one wavy interface, with the reflection that Fresnel leaves to it.
  // The pole stands straight; only water bends it.
  "version": 1,
  "film": { "width": 640, "height": 480, "spp": 2 },
  "cameras": [ { "name": "main", "yfov": 38, "lookAt": { "eye": [0.6, 2.7, 4.9], "at": [0, -0.3, 0] } } ],
  "background": { "color": [0.55, 0.72, 0.92] },
  "materials": [
    { "name": "water", "transmissionFactor": 1, "ior": 1.333, "volume": { "attenuationColor": [0.45, 0.85, 0.92], "attenuationDistance": 2.5 } },
    { "name": "deck", "baseColorFactor": [0.72, 0.62, 0.48] },
    { "name": "pale", "baseColorFactor": [0.6, 0.82, 0.85] },
    { "name": "blue", "baseColorFactor": [0.04, 0.2, 0.4] },
    { "name": "red", "baseColorFactor": [0.8, 0.1, 0.08] },
    { "name": "yellow", "baseColorFactor": [0.95, 0.65, 0.05] }
  ],
  "meshes": [
    { "name": "surface", "role": "optic", "material": "water", "resolution": 12,
      "points": [[-2,0,-2],[-1,0.05,-2],[0,-0.05,-2],[1,0.05,-2],[2,0,-2], [-2,-0.05,-1],[-1,0.09,-1],[0,0.02,-1],[1,-0.09,-1],[2,0.05,-1],
                 [-2,0.05,0],[-1,-0.07,0],[0,0.08,0],[1,0.04,0],[2,-0.05,0], [-2,-0.05,1],[-1,0.06,1],[0,-0.08,1],[1,0.08,1],[2,0.05,1],
                 [-2,0,2],[-1,-0.05,2],[0,0.05,2],[1,-0.05,2],[2,0,2]],
      "faceVertexCounts": [4,4,4,4, 4,4,4,4, 4,4,4,4, 4,4,4,4],
      "faceVertexIndices": [0,5,6,1, 1,6,7,2, 2,7,8,3, 3,8,9,4, 5,10,11,6, 6,11,12,7, 7,12,13,8, 8,13,14,9,
                            10,15,16,11, 11,16,17,12, 12,17,18,13, 13,18,19,14, 15,20,21,16, 16,21,22,17, 17,22,23,18, 18,23,24,19] },
    { "name": "basin", "role": "object", "material": "pale",
      "points": [[-2,0.15,-2],[2,0.15,-2],[2,0.15,2],[-2,0.15,2], [-2,-1.2,-2],[2,-1.2,-2],[2,-1.2,2],[-2,-1.2,2]],
      "faceVertexCounts": [4,4,4,4,4], "faceVertexIndices": [7,6,5,4, 4,5,1,0, 6,7,3,2, 7,4,0,3, 5,6,2,1] },
    { "name": "lines", "role": "object", "material": "blue", "transform": { "translate": [0, -1.195, 0] },
      "points": [[-1.6,0,-2],[-1.2,0,-2],[-1.2,0,2],[-1.6,0,2], [-0.2,0,-2],[0.2,0,-2],[0.2,0,2],[-0.2,0,2], [1.2,0,-2],[1.6,0,-2],[1.6,0,2],[1.2,0,2],
                 [-2,0,-1.3],[2,0,-1.3],[2,0,-1.1],[-2,0,-1.1], [-2,0,-0.1],[2,0,-0.1],[2,0,0.1],[-2,0,0.1], [-2,0,1.1],[2,0,1.1],[2,0,1.3],[-2,0,1.3]],
      "faceVertexCounts": [4,4,4,4,4,4],
      "faceVertexIndices": [3,2,1,0, 7,6,5,4, 11,10,9,8, 15,14,13,12, 19,18,17,16, 23,22,21,20] },
    { "name": "deck", "role": "object", "material": "deck",
      "points": [[-9,0.15,-9],[9,0.15,-9],[9,0.15,9],[-9,0.15,9], [-2,0.15,-2],[2,0.15,-2],[2,0.15,2],[-2,0.15,2]],
      "faceVertexCounts": [4,4,4,4], "faceVertexIndices": [0,4,5,1, 1,5,6,2, 2,6,7,3, 3,7,4,0] },
    { "name": "pole", "role": "object", "material": "red",
      "points": [[-0.9,-1.2,-0.9],[-0.78,-1.2,-0.9],[-0.78,-1.2,-0.78],[-0.9,-1.2,-0.78], [0.1,1.3,-0.9],[0.22,1.3,-0.9],[0.22,1.3,-0.78],[0.1,1.3,-0.78]],
      "faceVertexCounts": [4,4,4,4,4], "faceVertexIndices": [1,0,4,5, 2,1,5,6, 3,2,6,7, 0,3,7,4, 7,6,5,4] },
    { "name": "block", "role": "object", "material": "yellow", "transform": { "translate": [0.9, -1.2, 0.6] },
      "points": [[-0.3,0,-0.3],[0.3,0,-0.3],[0.3,0,0.3],[-0.3,0,0.3], [-0.3,0.5,-0.3],[0.3,0.5,-0.3],[0.3,0.5,0.3],[-0.3,0.5,0.3]],
      "faceVertexCounts": [4,4,4,4,4], "faceVertexIndices": [1,0,4,5, 2,1,5,6, 3,2,6,7, 0,3,7,4, 7,6,5,4] }
  ],
  "lights": [
    { "type": "directional", "direction": [0.5, -1, -0.35], "intensity": 2.6, "shadows": true },
    { "type": "ambient", "color": [0.25, 0.27, 0.3] }
  ]
}
)json";

constexpr const char* kMirrorCylinder = R"json({
  // Anamorphic art: the sheet holds a stretched shape, which a mirror cylinder folds back into a heart for this camera.
  "version": 1,
  "film": { "width": 640, "height": 480, "spp": 2 },
  "cameras": [ { "name": "main", "yfov": 38, "lookAt": { "eye": [0, 3.7, 4.6], "at": [0, 0.25, 0.7] } } ],
  "background": { "color": [0.2, 0.17, 0.15] },
  "materials": [
    { "name": "mirror", "baseColorFactor": [0.96, 0.96, 0.96], "metallicFactor": 1 },
    { "name": "red", "baseColorFactor": [0.78, 0.03, 0.08] },
    { "name": "paper", "baseColorFactor": [0.9, 0.88, 0.82] },
    { "name": "steel", "baseColorFactor": [0.3, 0.32, 0.36] },
    { "name": "oak", "baseColorFactor": [0.34, 0.2, 0.1] },
    { "name": "walnut", "baseColorFactor": [0.25, 0.14, 0.07] }
  ],
  "meshes": [
    { "name": "cylinder", "role": "optic", "material": "mirror", "resolution": 24,
      "primitive": { "type": "cylinder", "center": [0, 0.75, 0], "axis": [0, 1, 0], "radius": 0.5, "height": 1.5 } },
    // The edge of the heart nearer to the cylinder from left to right, then the farther one, joined by strips.
    { "name": "stretched heart", "role": "object", "material": "red",
      "points": [[-1.73,0.01,0.61],[-1.64,0.01,0.67],[-1.52,0.01,0.83],[-1.34,0.01,1.05],[-1.08,0.01,1.27],[-0.74,0.01,1.44],[-0.37,0.01,1.51],[0,0.01,1.38],
                 [0.37,0.01,1.51],[0.74,0.01,1.44],[1.08,0.01,1.27],[1.34,0.01,1.05],[1.52,0.01,0.83],[1.64,0.01,0.67],[1.73,0.01,0.61],[-1.81,0.01,0.7],
                 [-1.84,0.01,0.94],[-1.77,0.01,1.29],[-1.54,0.01,1.7],[-1.13,0.01,2.04],[-0.58,0.01,2.23],[0,0.01,2.04],[0.58,0.01,2.23],[1.13,0.01,2.04],
                 [1.54,0.01,1.7],[1.77,0.01,1.29],[1.84,0.01,0.94],[1.81,0.01,0.7]],
      "faceVertexCounts": [3,4,4,4,4,4,4,4,4,4,4,4,4,3],
      "faceVertexIndices": [0,1,15, 1,2,16,15, 2,3,17,16, 3,4,18,17, 4,5,19,18, 5,6,20,19, 6,7,21,20,
                            7,8,22,21, 8,9,23,22, 9,10,24,23, 10,11,25,24, 11,12,26,25, 12,13,27,26, 13,14,27] },
    { "name": "sheet", "role": "object", "material": "paper", "transform": { "translate": [0, 0.005, 0.9] },
      "points": [[-2.7,0,-2.2],[2.7,0,-2.2],[2.7,0,2.1],[-2.7,0,2.1]], "faceVertexCounts": [4], "faceVertexIndices": [3,2,1,0] },
    { "name": "lid", "role": "object", "material": "steel",
      "points": [[0,1.5,0.52],[0.2,1.5,0.48],[0.37,1.5,0.37],[0.48,1.5,0.2],[0.52,1.5,0],[0.48,1.5,-0.2],[0.37,1.5,-0.37],[0.2,1.5,-0.48],
                 [0,1.5,-0.52],[-0.2,1.5,-0.48],[-0.37,1.5,-0.37],[-0.48,1.5,-0.2],[-0.52,1.5,0],[-0.48,1.5,0.2],[-0.37,1.5,0.37],[-0.2,1.5,0.48]],
      "faceVertexCounts": [16], "faceVertexIndices": [0,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15] },
    { "name": "table", "role": "object", "material": "oak",
      "points": [[-12,0,-12],[12,0,-12],[12,0,12],[-12,0,12]], "faceVertexCounts": [4], "faceVertexIndices": [3,2,1,0] },
    { "name": "planks", "role": "object", "material": "walnut", "transform": { "translate": [0, 0.002, 0] },
      "points": [[-12,0,-3.2],[12,0,-3.2],[12,0,-2],[-12,0,-2], [-12,0,-0.8],[12,0,-0.8],[12,0,0.4],[-12,0,0.4],
                 [-12,0,1.6],[12,0,1.6],[12,0,2.8],[-12,0,2.8], [-12,0,4],[12,0,4],[12,0,5.2],[-12,0,5.2]],
      "faceVertexCounts": [4,4,4,4], "faceVertexIndices": [3,2,1,0, 7,6,5,4, 11,10,9,8, 15,14,13,12] }
  ],
  "lights": [
    { "type": "point", "position": [-3, 4.5, 2.5], "intensity": 60, "color": [1, 0.93, 0.82], "shadows": true },
    { "type": "ambient", "color": [0.25, 0.25, 0.28] }
  ]
}
)json";

constexpr const char* kCrystalBall = R"json({
  // A crystal ball on a ring of brass before a checkered floor: light goes into the glass and out of it, and what is behind
  // hangs upside down in it.
  "version": 1,
  "film": { "width": 640, "height": 480, "spp": 2 },
  "cameras": [ { "name": "main", "yfov": 34, "lookAt": { "eye": [0.5, 1.9, 5.4], "at": [0, 1, 0] } } ],
  "background": { "color": [0.55, 0.68, 0.85] },
  "materials": [
    { "name": "crystal", "transmissionFactor": 1, "ior": 1.5, "volume": { "attenuationColor": [0.9, 0.96, 0.94], "attenuationDistance": 4 } },
    { "name": "marble", "baseColorFactor": [0.8, 0.79, 0.75] },
    { "name": "slate", "baseColorFactor": [0.1, 0.11, 0.13] },
    { "name": "brass", "baseColorFactor": [0.55, 0.4, 0.14] },
    { "name": "red", "baseColorFactor": [0.7, 0.1, 0.07] },
    { "name": "blue", "baseColorFactor": [0.1, 0.22, 0.62] }
  ],
  "meshes": [
    { "name": "ball", "role": "optic", "material": "crystal", "resolution": 16,
      "primitive": { "type": "sphere", "center": [0, 1.15, 0], "radius": 1 } },
    // Eight-sided, its upper edge just below the ball.
    { "name": "ring", "role": "object", "material": "brass",
      "points": [[0.6,0,0],[0.42,0,0.42],[0,0,0.6],[-0.42,0,0.42],[-0.6,0,0],[-0.42,0,-0.42],[0,0,-0.6],[0.42,0,-0.42],
                 [0.5,0.26,0],[0.35,0.26,0.35],[0,0.26,0.5],[-0.35,0.26,0.35],[-0.5,0.26,0],[-0.35,0.26,-0.35],[0,0.26,-0.5],[0.35,0.26,-0.35]],
      "faceVertexCounts": [4,4,4,4,4,4,4,4],
      "faceVertexIndices": [1,0,8,9, 2,1,9,10, 3,2,10,11, 4,3,11,12, 5,4,12,13, 6,5,13,14, 7,6,14,15, 0,7,15,8] },
    { "name": "floor", "role": "object", "material": "marble",
      "points": [[-6,0,-8],[6,0,-8],[6,0,8],[-6,0,8]], "faceVertexCounts": [4], "faceVertexIndices": [3,2,1,0] },
    // Every other tile of those between the ball and the horizon, row by row.
    { "name": "tiles", "role": "object", "material": "slate", "transform": { "translate": [0, 0.002, 0] },
      "points": [[-4,0,-6],[-4,0,-5],[-3,0,-5],[-3,0,-6],[-2,0,-6],[-2,0,-5],[-1,0,-5],[-1,0,-6],[0,0,-6],[0,0,-5],
                 [1,0,-5],[1,0,-6],[2,0,-6],[2,0,-5],[3,0,-5],[3,0,-6],[-3,0,-4],[-2,0,-4],[-1,0,-4],[0,0,-4],[1,0,-4],
                 [2,0,-4],[3,0,-4],[4,0,-4],[4,0,-5],[-4,0,-4],[-4,0,-3],[-3,0,-3],[-2,0,-3],[-1,0,-3],[0,0,-3],
                 [1,0,-3],[2,0,-3],[3,0,-3],[-3,0,-2],[-2,0,-2],[-1,0,-2],[0,0,-2],[1,0,-2],[2,0,-2],[3,0,-2],[4,0,-2],
                 [4,0,-3],[-4,0,-2],[-4,0,-1],[-3,0,-1],[-2,0,-1],[-1,0,-1],[0,0,-1],[1,0,-1],[2,0,-1],[3,0,-1],
                 [-3,0,0],[-2,0,0],[-1,0,0],[0,0,0],[1,0,0],[2,0,0],[3,0,0],[4,0,0],[4,0,-1],[-4,0,0],[-4,0,1],
                 [-3,0,1],[-2,0,1],[-1,0,1],[0,0,1],[1,0,1],[2,0,1],[3,0,1],[-3,0,2],[-2,0,2],[-1,0,2],[0,0,2],[1,0,2],
                 [2,0,2],[3,0,2],[4,0,2],[4,0,1],[-4,0,2],[-4,0,3],[-3,0,3],[-2,0,3],[-1,0,3],[0,0,3],[1,0,3],[2,0,3],
                 [3,0,3]],
      "faceVertexCounts": [4,4,4,4,4,4,4,4,4,4,4,4,4,4,4,4,4,4,4,4,4,4,4,4,4,4,4,4,4,4,4,4,4,4,4,4],
      "faceVertexIndices": [0,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,2,16,17,5,6,18,19,9,10,20,21,13,14,22,23,24,
                           25,26,27,16,17,28,29,18,19,30,31,20,21,32,33,22,27,34,35,28,29,36,37,30,31,38,39,32,
                           33,40,41,42,43,44,45,34,35,46,47,36,37,48,49,38,39,50,51,40,45,52,53,46,47,54,55,48,
                           49,56,57,50,51,58,59,60,61,62,63,52,53,64,65,54,55,66,67,56,57,68,69,58,63,70,71,64,
                           65,72,73,66,67,74,75,68,69,76,77,78,79,80,81,70,71,82,83,72,73,84,85,74,75,86,87,76] },
    { "name": "pillar", "role": "object", "material": "red", "transform": { "translate": [-1.7, 0, -3.2] },
      "points": [[-0.4,0,-0.4],[0.4,0,-0.4],[0.4,0,0.4],[-0.4,0,0.4],[-0.4,2.4,-0.4],[0.4,2.4,-0.4],[0.4,2.4,0.4],[-0.4,2.4,0.4]],
      "faceVertexCounts": [4,4,4,4,4], "faceVertexIndices": [1,0,4,5, 2,1,5,6, 3,2,6,7, 0,3,7,4, 7,6,5,4] },
    { "name": "pyramid", "role": "object", "material": "blue", "transform": { "translate": [1.5, 0, -2.2] },
      "points": [[-0.6,0,-0.6],[0.6,0,-0.6],[0.6,0,0.6],[-0.6,0,0.6],[0,1.3,0]],
      "faceVertexCounts": [3,3,3,3], "faceVertexIndices": [1,0,4, 2,1,4, 3,2,4, 0,3,4] }
  ],
  "lights": [
    { "type": "directional", "direction": [-0.5, -1, -0.6], "intensity": 2.2, "shadows": true },
    { "type": "ambient", "color": [0.26, 0.27, 0.3] }
  ]
}
)json";

const SceneExample kExamples[] = {
    {"mirror-sphere", "an exact mirror sphere in a painted room", kMirrorSphere},
    {"creased-cage", "a gold Catmull-Clark cage with semi-sharp edges and sharp corners", kCreasedCage},
    {"water-patch", "a pool: refraction through a wavy interface of water", kWaterPatch},
    {"mirror-cylinder", "anamorphic art: a mirror cylinder folds a stretched shape into a heart",
     kMirrorCylinder},
    {"crystal-ball", "light into glass and out of it again, and what is behind upside down", kCrystalBall},
    {"cameras", "a mirror ball in a room, seen by fifteen cameras: fisheye, panorama, strip, slits, ...",
     kCamerasExample},
    {"caustic", "a mirrored ring lit by parallel rays, whose caustic is a nephroid", kCausticExample},
};

}  // namespace

std::span<const SceneExample> scene_examples() {
    return kExamples;
}

}  // namespace trilens
