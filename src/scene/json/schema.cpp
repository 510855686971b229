// The scene format as a JSON Schema (draft 7): the one table that the checks, --set and the documentation
// read.
#include <string>

#include "scene/json/schema.h"
#include "scene/json/schema_parts.h"

namespace trilens {

const char* scene_schema() {
    static const std::string text = R"json({
"$schema": "http://json-schema.org/draft-07/schema#",
"$id": "trilens-scene-1.schema.json",
"title": "a scene",
"description": "Right-handed, Y up, degrees; colours are linear Rec.709; paths are relative to the scene file; keys under 'extras' or starting with 'x-' are free.",
"type": "object", "additionalProperties": false, "patternProperties": { "^(x-|extras$)": {} },
"required": ["version", "cameras"],
"properties": {
  "$schema": { "type": "string" },
  "version": { "const": 1 },
  "film": { "$ref": "#/definitions/film" },
  "cameras": { "type": "array", "minItems": 1, "items": { "$ref": "#/definitions/camera" } },
  "background": { "$ref": "#/definitions/background" },
  "materials": { "type": "array", "items": { "$ref": "#/definitions/material" } },
  "meshes": { "type": "array", "items": { "$ref": "#/definitions/mesh" } },
  "lights": { "type": "array", "items": { "$ref": "#/definitions/light" } },
  "render": { "$ref": "#/definitions/render" },
  "animation": { "$ref": "#/definitions/animation" }
},
"definitions": {
  "number": { "type": "number", "minimum": -1e30, "maximum": 1e30 },
  "positive": { "type": "number", "exclusiveMinimum": 0, "maximum": 1e30 },
  "notNegative": { "type": "number", "minimum": 0, "maximum": 1e30 },
  "share": { "type": "number", "minimum": 0, "maximum": 1 },
  "index": { "type": "integer", "minimum": 0, "maximum": 2147483647 },
  "name": { "type": "string", "minLength": 1 },
  "vec2": { "type": "array", "minItems": 2, "maxItems": 2, "items": { "$ref": "#/definitions/number" } },
  "vec3": { "type": "array", "minItems": 3, "maxItems": 3, "items": { "$ref": "#/definitions/number" } },
  "color": { "type": "array", "minItems": 3, "maxItems": 3, "items": { "$ref": "#/definitions/notNegative" } },

  "film": {
    "title": "a film", "description": "At most 2^28 pixels.",
    "type": "object", "additionalProperties": false, "patternProperties": { "^(x-|extras$)": {} },
    "properties": {
      "width": { "type": "integer", "minimum": 1, "maximum": 32768, "default": 640 },
      "height": { "type": "integer", "minimum": 1, "maximum": 32768, "default": 480 },
      "spp": { "type": "integer", "minimum": 1, "maximum": 64, "default": 1, "description": "S: S x S samples per pixel." },
      "filter": { "enum": ["box", "mitchell", "gaussian"], "default": "box", "description": "How samples make a pixel's colour: the mean of its own, or weighted with those of pixels around." }
    }
  },
)json" + std::string(camera_schema()) +
                                    R"json(
  "background": {
    "title": "a background", "description": "A colour, or a latitude-longitude picture turned about +Y by 'rotate' degrees.",
    "type": "object", "additionalProperties": false, "patternProperties": { "^(x-|extras$)": {} },
    "properties": {
      "color": { "$ref": "#/definitions/color", "default": [0, 0, 0] },
      "file": { "$ref": "#/definitions/name" },
      "rotate": { "$ref": "#/definitions/number", "default": 0 }
    },
    "dependencies": { "rotate": ["file"] },
    "if": { "required": ["file"] },
    "then": { "title": "a background with a file", "properties": { "color": false } }
  },

  "material": {
    "title": "a material", "description": "glTF's names. An optic needs metallicFactor 1 (mirror) or transmissionFactor 1 (glass), and roughnessFactor 0.",
    "type": "object", "additionalProperties": false, "patternProperties": { "^(x-|extras$)": {} },
    "required": ["name"],
    "properties": {
      "name": { "type": "string", "minLength": 1, "description": "Unique; 'inherit' is taken." },
      "baseColorFactor": { "$ref": "#/definitions/color", "default": [1, 1, 1] },
      "baseColorTexture": { "$ref": "#/definitions/name" },
      "unlit": { "type": "boolean", "default": false },
      "metallicFactor": { "$ref": "#/definitions/share", "default": 0 },
      "roughnessFactor": { "$ref": "#/definitions/share", "default": 0 },
      "transmissionFactor": { "$ref": "#/definitions/share", "default": 0 },
      "ior": { "type": "number", "exclusiveMinimum": 0, "maximum": 10, "default": 1.5 },
      "dispersion": { "$ref": "#/definitions/notNegative", "default": 0, "description": "glTF's: 20 / Abbe number; light then parts into three colours." },
      "volume": {
        "title": "a volume",
        "type": "object", "additionalProperties": false, "patternProperties": { "^(x-|extras$)": {} },
        "properties": {
          "attenuationColor": { "type": "array", "minItems": 3, "maxItems": 3, "items": { "$ref": "#/definitions/share" }, "default": [1, 1, 1] },
          "attenuationDistance": { "$ref": "#/definitions/notNegative", "default": 0, "description": "0: no absorption." }
        }
      }
    }
  },

  "transform": {
    "title": "a transform", "description": "matrix, or scale, then rotate, then translate.",
    "type": "object", "additionalProperties": false, "patternProperties": { "^(x-|extras$)": {} },
    "properties": {
      "translate": { "$ref": "#/definitions/vec3", "default": [0, 0, 0] },
      "rotate": { "type": "array", "minItems": 4, "maxItems": 4, "items": { "$ref": "#/definitions/number" }, "default": [0, 0, 0, 1], "description": "Quaternion x, y, z, w, any length but 0." },
      "scale": { "$ref": "#/definitions/vec3", "default": [1, 1, 1], "description": "No entry may be 0; an odd number of negative ones mirrors." },
      "matrix": { "type": "array", "minItems": 16, "maxItems": 16, "items": { "$ref": "#/definitions/number" }, "description": "Column by column, as glTF; its last row is 0 0 0 1." }
    },
    "if": { "required": ["matrix"] },
    "then": { "title": "a transform with a matrix", "properties": { "translate": false, "rotate": false, "scale": false } }
  },
)json"
                                    R"json(
  "primitive": {
    "title": "a primitive", "description": "An optic given by a formula. axis: paraboloid from apex to focus, cylinder along it; tangent: where u begins.",
    "type": "object", "additionalProperties": false, "patternProperties": { "^(x-|extras$)": {} },
    "required": ["type"],
    "properties": {
      "type": { "enum": ["sphere", "paraboloid", "cylinder", "plane"] },
      "center": { "$ref": "#/definitions/vec3", "default": [0, 0, 0], "description": "paraboloid: its apex." },
      "radius": { "$ref": "#/definitions/positive", "default": 1, "description": "paraboloid: of its rim." },
      "axis": { "$ref": "#/definitions/vec3", "default": [0, 1, 0] },
      "normal": { "$ref": "#/definitions/vec3", "default": [0, 1, 0] },
      "tangent": { "$ref": "#/definitions/vec3", "description": "Default: a direction at right angles to axis or normal, +X for +Y." },
      "focalLength": { "$ref": "#/definitions/positive", "default": 1 },
      "height": { "$ref": "#/definitions/positive", "default": 2 },
      "size": { "type": "array", "minItems": 2, "maxItems": 2, "items": { "$ref": "#/definitions/positive" }, "default": [2, 2], "description": "Along tangent and normal x tangent." }
    },
    "allOf": [
      { "if": { "properties": { "type": { "const": "sphere" } } },
        "then": { "title": "a sphere", "properties": { "axis": false, "normal": false, "tangent": false, "focalLength": false, "height": false, "size": false } } },
      { "if": { "properties": { "type": { "const": "paraboloid" } } },
        "then": { "title": "a paraboloid", "properties": { "normal": false, "height": false, "size": false } } },
      { "if": { "properties": { "type": { "const": "cylinder" } } },
        "then": { "title": "a cylinder", "properties": { "normal": false, "focalLength": false, "size": false } } },
      { "if": { "properties": { "type": { "const": "plane" } } },
        "then": { "title": "a plane", "properties": { "axis": false, "radius": false, "focalLength": false, "height": false } } }
    ]
  },

  "normals": {
    "title": "a normals override",
    "type": "object", "additionalProperties": false, "patternProperties": { "^(x-|extras$)": {} },
    "required": ["type"],
    "properties": {
      "type": { "enum": ["smooth", "sphere", "noise"] },
      "center": { "$ref": "#/definitions/vec3", "default": [0, 0, 0], "description": "sphere: normals point away from it; world frame." },
      "seed": { "$ref": "#/definitions/index", "default": 0 },
      "amplitude": { "$ref": "#/definitions/notNegative", "default": 0 },
      "scale": { "$ref": "#/definitions/positive", "default": 1 }
    },
    "allOf": [
      { "if": { "properties": { "type": { "const": "smooth" } } },
        "then": { "title": "smooth normals", "properties": { "center": false, "seed": false, "amplitude": false, "scale": false } } },
      { "if": { "properties": { "type": { "const": "sphere" } } },
        "then": { "title": "sphere normals", "properties": { "seed": false, "amplitude": false, "scale": false } } },
      { "if": { "properties": { "type": { "const": "noise" } } },
        "then": { "title": "noise normals", "properties": { "center": false } } }
    ]
  },

  "mesh": {
    "title": "a mesh", "description": "UsdGeomMesh's names. Objects are drawn as their polygons, optics as their limit surface: what an object has no use for (resolution, creases, normals) it ignores. No point of an optic's cage may lie more than 1e4 times as far from their middle (the median along each axis) as half of them do.",
    "type": "object", "additionalProperties": false, "patternProperties": { "^(x-|extras$)": {} },
    "required": ["role"],
    "oneOf": [ { "required": ["points"] }, { "required": ["file"] }, { "required": ["primitive"] } ],
    "dependencies": {
      "points": ["faceVertexCounts", "faceVertexIndices"], "faceVertexCounts": ["points"], "faceVertexIndices": ["points"],
      "uvIndices": ["uvs"], "creaseIndices": ["creaseSharpnesses"], "creaseSharpnesses": ["creaseIndices"],
      "creaseLengths": ["creaseIndices"], "cornerIndices": ["cornerSharpnesses"], "cornerSharpnesses": ["cornerIndices"]
    },
    "properties": {
      "name": { "$ref": "#/definitions/name" },
      "role": { "enum": ["object", "optic"] },
      "material": { "type": "string", "minLength": 1, "description": "A name of 'materials'; 'inherit' (the default of an object from a file): the file's own." },
      "resolution": { "type": "integer", "minimum": 1, "maximum": 1024, "default": 8, "description": "optic: N x N facets per quad face." },
      "rays": { "enum": ["fitted", "interpolated"], "default": "fitted", "description": "optic: at the corners of its facets the exact rays, with straight interpolation between them, or rays fitted so that what lies between is nearest to exact in the mean." },
      "grid": { "enum": ["surface", "screen"], "default": "surface", "description": "optic: its facets lie on the surface, N x N per face, or on the film, N x N over its bounds there." },
      "seenOptics": { "enum": ["layers", "divided"], "default": "layers", "description": "optic that mirrors: an optic seen in it is drawn as a layer, its own grid as this one shows it, where that can be; or this optic's facets are divided along its outline, and at last traced." },
      "priority": { "type": "integer", "minimum": -1000, "maximum": 1000, "default": 0, "description": "optic of glass: where bodies overlap the one of higher priority is inside, as a glass around its liquid." },
      "transform": { "$ref": "#/definitions/transform" },
      "file": { "type": "string", "minLength": 1, "description": "OBJ; for objects glTF and GLB too." },
      "primitive": { "$ref": "#/definitions/primitive" },
      "points": { "type": "array", "minItems": 3, "items": { "$ref": "#/definitions/vec3" } },
      "faceVertexCounts": { "type": "array", "minItems": 1, "items": { "type": "integer", "minimum": 3, "maximum": 255 } },
      "faceVertexIndices": { "type": "array", "minItems": 3, "items": { "$ref": "#/definitions/index" } },
      "uvs": { "type": "array", "minItems": 1, "items": { "$ref": "#/definitions/vec2" }, "description": "v upward. One per entry of faceVertexIndices, or, with uvIndices, those it names." },
      "uvIndices": { "type": "array", "minItems": 3, "items": { "$ref": "#/definitions/index" }, "description": "One per entry of faceVertexIndices; a copy of faceVertexIndices makes uvs one per point." },
      "subdivisionScheme": { "enum": ["catmullClark", "loop", "bilinear"], "default": "catmullClark" },
      "interpolateBoundary": { "enum": ["none", "edgeOnly", "edgeAndCorner"], "default": "edgeAndCorner" },
      "creaseIndices": { "type": "array", "items": { "$ref": "#/definitions/index" }, "description": "Chains of points, one after the other." },
      "creaseLengths": { "type": "array", "items": { "type": "integer", "minimum": 2, "maximum": 2147483647 }, "description": "Points per chain; absent: pairs." },
      "creaseSharpnesses": { "type": "array", "items": { "$ref": "#/definitions/notNegative" }, "description": "One per chain, or one per edge; 10 and more is infinite." },
      "cornerIndices": { "type": "array", "items": { "$ref": "#/definitions/index" } },
      "cornerSharpnesses": { "type": "array", "items": { "$ref": "#/definitions/notNegative" } },
      "holeIndices": { "type": "array", "items": { "$ref": "#/definitions/index" }, "description": "Faces that are not drawn." },
      "normals": { "$ref": "#/definitions/normals" }
    },
    "allOf": [
      { "if": { "properties": { "role": { "const": "object" } } },
        "then": { "title": "an object", "properties": { "primitive": false } } },
      { "if": { "properties": { "role": { "const": "optic" } } },
        "then": { "title": "an optic", "required": ["material"] } },
      { "if": { "required": ["file"] },
        "then": { "title": "a mesh with a file", "properties": { "uvs": false, "uvIndices": false } } },
      { "if": { "required": ["primitive"] },
        "then": { "title": "a primitive", "properties": { "uvs": false, "uvIndices": false, "subdivisionScheme": false, "interpolateBoundary": false,
          "creaseIndices": false, "cornerIndices": false, "holeIndices": false } } }
    ]
  },

  "light": {
    "title": "a light",
    "type": "object", "additionalProperties": false, "patternProperties": { "^(x-|extras$)": {} },
    "required": ["type"],
    "properties": {
      "name": { "$ref": "#/definitions/name" },
      "type": { "enum": ["directional", "point", "ambient"] },
      "color": { "$ref": "#/definitions/color", "default": [1, 1, 1] },
      "intensity": { "$ref": "#/definitions/notNegative", "default": 1, "description": "directional: lux; point: candela; ambient: radiance." },
      "direction": { "$ref": "#/definitions/vec3", "description": "directional: the way the light travels." },
      "position": { "$ref": "#/definitions/vec3" },
      "shadows": { "type": "boolean", "default": false, "description": "Whether objects and mirrors cast shadows in this light: objects by their triangles, mirrors by their exact surface, at any resolution. Glass casts none: it lets the light through, unbent and undimmed." }
    },
    "allOf": [
      { "if": { "properties": { "type": { "const": "directional" } } },
        "then": { "title": "a directional light", "required": ["direction"], "properties": { "position": false } } },
      { "if": { "properties": { "type": { "const": "point" } } },
        "then": { "title": "a point light", "required": ["position"], "properties": { "direction": false } } },
      { "if": { "properties": { "type": { "const": "ambient" } } },
        "then": { "title": "an ambient light", "properties": { "position": false, "direction": false, "shadows": false } } }
    ]
  },

  "animation": {
    "title": "an animation", "description": "Values of this scene by frame; without a frame that is asked for, the scene is as it stands.",
    "type": "object", "additionalProperties": false, "patternProperties": { "^(x-|extras$)": {} },
    "required": ["tracks"],
    "properties": {
      "fps": { "$ref": "#/definitions/positive", "default": 24, "description": "Frames per second of an animated picture." },
      "tracks": { "type": "array", "minItems": 1, "items": { "$ref": "#/definitions/track" } }
    }
  },

  "track": {
    "title": "a track", "description": "One value over time: held before the first key and after the last.",
    "type": "object", "additionalProperties": false, "patternProperties": { "^(x-|extras$)": {} },
    "required": ["target", "keys"],
    "properties": {
      "target": { "type": "string", "minLength": 1, "description": "JSON pointer of a number, or of an array of numbers, of this scene: /cameras/0/yfov, /meshes/2/points." },
      "interpolation": { "enum": ["linear", "smooth", "step"], "default": "linear", "description": "From key to key; rotations go by the shorter great arc." },
      "keys": { "type": "array", "minItems": 1, "items": { "$ref": "#/definitions/key" } }
    }
  },

  "key": {
    "title": "a key",
    "type": "object", "additionalProperties": false, "patternProperties": { "^(x-|extras$)": {} },
    "required": ["frame", "value"],
    "properties": {
      "frame": { "$ref": "#/definitions/number" },
      "value": {}
    }
  },

  "render": {
    "title": "render settings",
    "type": "object", "additionalProperties": false, "patternProperties": { "^(x-|extras$)": {} },
    "properties": {
      "maxDepth": { "type": "integer", "minimum": 0, "maximum": 64, "default": 8, "description": "Optic hits after the first; 0: paths end after their first optic, as if there were no other." },
      "paths": { "type": "array", "minItems": 1, "uniqueItems": true, "items": { "enum": ["direct", "reflect", "refract"] }, "default": ["direct", "reflect", "refract"] },
      "fresnel": { "type": "boolean", "default": true },
      "maxError": { "type": "number", "minimum": 0, "maximum": 1000, "default": 0, "description": "Pixels: facets whose predicted displacement against the exact paths is more are divided, and at last traced; 0: they are as 'resolution' says, but for those that are off by far more than facets of their size are: a pixel at 32 on a film 480 high, by the square of both." }
    }
  }
}
})json";
    return text.c_str();
}

}  // namespace trilens
