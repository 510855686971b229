// Example scenes of cameras and of a caustic, as scenes/ has them too.
#include "scene/examples/camera_examples.h"

namespace trilens {

const char* const kCamerasExample = R"json({
  // A mirror ball in a painted room, for cameras of many kinds: choose one with --camera NAME.
  "version": 1,
  "film": { "width": 640, "height": 480, "spp": 4 },
  "cameras": [
    { "name": "main", "yfov": 60, "lookAt": { "eye": [0.6, 1.8, 4.7], "at": [-0.1, 1, 0] } },
    // A fisheye in the corner of the room, before the mirror ball.
    { "name": "fisheye", "type": "fisheye", "mapping": "equisolid", "fov": 200, "tolerance": 0.25,
      "lookAt": { "eye": [-1.2, 1.7, 2.6], "at": [0, 1.2, 0] } },
    // All around, by longitude and latitude.
    { "name": "panorama", "type": "spherical", "lookAt": { "eye": [-0.4, 1.6, 2.4], "at": [0, 1.6, 0] } },
    { "name": "cylinder", "type": "cylindrical", "hfov": 300, "yfov": 75, "lookAt": { "eye": [-0.4, 1.6, 2.4], "at": [0, 1.6, 0] } },
    // Cabinet projection: what lies one unit deeper stands half a unit up and to the right.
    { "name": "oblique", "type": "oblique", "ymag": 3.5, "angle": 45, "scale": 0.5,
      "lookAt": { "eye": [1.4, 3.4, 4.9], "at": [1.4, 3.4, 0] } },
    { "name": "orthographic", "type": "orthographic", "ymag": 2.2, "lookAt": { "eye": [0, 2, 4.9], "at": [0, 2, 0] } },
    // The left half of a picture, drawn by itself.
    { "name": "left half", "type": "perspective", "yfov": 60, "shift": [-0.5, 0], "lookAt": { "eye": [0.6, 1.8, 4.7], "at": [-0.1, 1, 0] } },
    { "name": "view volume", "type": "viewVolume", "vrp": [0, 1.5, 3], "vpn": [0, 0, 1], "prp": [0.5, 0.4, 2],
      "window": [-2, 2, -1.5, 1.5], "projection": "perspective", "front": 0.5, "back": -7 },
    // A calibrated wide lens.
    { "name": "lens", "type": "opencv", "model": "pinhole", "fx": 420, "fy": 420, "cx": 320, "cy": 240,
      "distortion": [-0.22, 0.06, 0.0008, -0.0005, -0.008], "lookAt": { "eye": [0.6, 1.8, 4.7], "at": [-0.1, 1, 0] } },
    // The eye walks from left to right while the film goes by.
    { "name": "strip", "type": "pushbroom", "yfov": 62, "travel": [5, 0, 0], "lookAt": { "eye": [0, 1.6, 3.6], "at": [0, 1.3, 0] } },
    { "name": "slits", "type": "crossedSlits", "slits": [[[0, 1, 4.6], [0, 1, 0]], [[0, 1.6, 3], [1, 0, 0]]], "window": [-2.4, 2.4, -1, 1.9],
      "lookAt": { "eye": [0, 1.2, 4.8], "at": [0, 1.2, 0] } },
    { "name": "twisted", "type": "generalLinear", "lookAt": { "eye": [0, 1.4, 4.4], "at": [0, 1.2, 0] },
      "rays": [ { "point": [-0.8, 2, 4.4], "direction": [-0.5, 0.35, -1], "screen": [0, 0] }, { "point": [0.8, 2, 4.4], "direction": [0.5, 0.1, -1], "screen": [1, 0] },
                { "point": [0, 0.6, 4.4], "direction": [0.1, -0.3, -1], "screen": [0.5, 1] } ] },
    // The ball in detail, the room around it as context.
    { "name": "detail", "type": "distortion", "detail": [0.25, 0.25, 0.75, 0.75], "yfov": 24, "contextFov": 170,
      "lookAt": { "eye": [0.6, 1.8, 4.5], "at": [0, 1, 0] } },
    // Straight on in the middle, from the sides beside it.
    { "name": "several", "type": "multiPerspective", "blend": 0.1, "views": [
      { "yfov": 60, "window": [0, 0, 0.3, 1], "lookAt": { "eye": [-2.7, 1.5, 2], "at": [0, 1, 0] } },
      { "yfov": 50, "window": [0.3, 0, 0.7, 1], "lookAt": { "eye": [0, 1.5, 4.4], "at": [0, 1, 0] } },
      { "yfov": 60, "window": [0.7, 0, 1, 1], "lookAt": { "eye": [2.7, 1.5, 2], "at": [0, 1, 0] } } ] },
    // The pyramid from all sides at once.
    { "name": "around", "type": "inwardSphere", "center": [-1.55, 0.45, 1.2], "radius": 0.8, "vfov": 60, "lookAt": { "eye": [-1.55, 0.45, 4], "at": [-1.55, 0.45, 0] } }
  ],
  "materials": [
    { "name": "chrome", "baseColorFactor": [0.95, 0.95, 0.95], "metallicFactor": 1 },
    { "name": "plaster", "baseColorFactor": [0.8, 0.78, 0.72] },
    { "name": "slate", "baseColorFactor": [0.12, 0.14, 0.18] },
    { "name": "red", "baseColorFactor": [0.65, 0.09, 0.06] },
    { "name": "teal", "baseColorFactor": [0.05, 0.4, 0.42] },
    { "name": "yellow", "baseColorFactor": [0.9, 0.6, 0.08] },
    { "name": "blue", "baseColorFactor": [0.1, 0.22, 0.62] }
  ],
  "meshes": [
    { "name": "ball", "role": "optic", "material": "chrome", "resolution": 20,
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
      "faceVertexCounts": [4,4,4,4,4], "faceVertexIndices": [1,0,4,5, 2,1,5,6, 3,2,6,7, 0,3,7,4, 7,6,5,4] }
  ],
  "lights": [
    { "type": "rectangle", "name": "window", "position": [0, 3.9995, 1], "direction": [0, -1, 0], "size": [2.4, 2], "intensity": 7.5, "color": [1, 0.95, 0.85],
      "samples": 9, "shadows": true },
    { "type": "ambient", "color": [0.26, 0.27, 0.3], "distance": 1, "samples": 12, "shadows": true }
  ]
}
)json";

const char* const kCausticExample = R"json({
  // A caustic: the sun in a mirrored ring on a table draws a nephroid, as in a cup of coffee. What the ring sends there is summed
  // up over all ways of the light, in closed form ("caustics": true of a light); there is no noise, and no photon is shot.
  "version": 1,
  "film": { "width": 640, "height": 480, "spp": 4 },
  "cameras": [ { "name": "main", "yfov": 34, "lookAt": { "eye": [0, 3.6, 2.6], "at": [0, 0.1, 0.15] } } ],
  "background": { "color": [0.45, 0.57, 0.75] },
  "materials": [
    { "name": "gold", "baseColorFactor": [0.95, 0.78, 0.45], "metallicFactor": 1 },
    { "name": "table", "baseColorFactor": [0.62, 0.5, 0.4] }
  ],
  "meshes": [
    { "name": "ring", "role": "optic", "material": "gold", "resolution": 24,
      "primitive": { "type": "cylinder", "center": [0, 0.2, 0], "axis": [0, 1, 0], "radius": 1, "height": 0.4 } },
    { "name": "table", "role": "object", "material": "table", "points": [[-4,0,3],[4,0,3],[4,0,-3],[-4,0,-3]], "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3] }
  ],
  "lights": [
    { "type": "directional", "direction": [-0.85, -0.6, -0.35], "intensity": 2.2, "color": [1, 0.96, 0.88], "shadows": true, "caustics": true },
    { "type": "ambient", "color": [0.12, 0.13, 0.15] }
  ],
  "render": { "maxDepth": 4 }
}
)json";

}  // namespace trilens
