// The scene format as a JSON Schema (draft 7), made of the tables of settings: what the checks, --set and the
// documentation read.
#include "scene/read/scene_schema.h"

#include <string>

#include "json/schema.h"
#include "scene/read/read_lens.h"
#include "scene/read/reading.h"

namespace trilens {
namespace {

// The whole, the values that many keys share, and the parts that fill no members by themselves.
constexpr const char* kFrame = R"json({
"$schema": "http://json-schema.org/draft-07/schema#",
"$id": "trilens-scene-1.schema.json",
"title": "a scene",
"description": "Right-handed, Y up, degrees; colours are linear Rec.709; paths are relative to the scene file; keys under 'extras' or starting with 'x-' are free.",
"type": "object", "additionalProperties": false, "patternProperties": { "^(x-|extras$)": {} },
"required": ["version"],
"if": { "required": ["import"] }, "else": { "title": "a scene", "required": ["cameras"] },
"properties": {
  "$schema": { "type": "string" },
  "version": { "const": 1 },
  "import": { "$ref": "#/definitions/import" },
  "film": { "$ref": "#/definitions/film" },
  "cameras": { "type": "array", "minItems": 1, "items": { "$ref": "#/definitions/camera" } },
  "background": { "$ref": "#/definitions/background" },
  "materials": { "type": "array", "items": { "$ref": "#/definitions/material" } },
  "meshes": { "type": "array", "items": { "$ref": "#/definitions/mesh" } },
  "lenses": { "type": "array", "items": { "$ref": "#/definitions/lens" } },
  "volumes": { "type": "array", "items": { "$ref": "#/definitions/volume" } },
  "lights": { "type": "array", "items": { "$ref": "#/definitions/light" } },
  "points": { "type": "array", "items": { "$ref": "#/definitions/pointCloud" } },
  "labels": { "type": "array", "items": { "$ref": "#/definitions/label" } },
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
  "vertexColor": { "type": "array", "minItems": 3, "maxItems": 4, "items": { "$ref": "#/definitions/share" } },
  "color": { "type": "array", "minItems": 3, "maxItems": 3, "items": { "$ref": "#/definitions/notNegative" } },

  "import": {
    "title": "an import", "description": "glTF scenes that this scene takes in: a file's name, an entry, or several. Cameras, materials, meshes and lights of the scene change those of the same name key by key (null takes a key away), or are added.",
    "type": ["string", "object", "array"], "minLength": 1, "minItems": 1, "items": { "$ref": "#/definitions/importEntry" },
    "additionalProperties": false, "patternProperties": { "^(x-|extras$)": {} }, "required": ["file"],
    "properties": {
      "file": { "$ref": "#/definitions/name", "description": ".gltf or .glb." },
      "optics": { "type": "array", "items": { "$ref": "#/definitions/name" }, "description": "Names of meshes, nodes or materials that are optics, as shells match them: Mirror*." },
      "time": { "$ref": "#/definitions/number", "description": "Seconds of the animation; without it, its start." },
      "animation": { "$ref": "#/definitions/name", "description": "Its name; without it, the first." }
    }
  },

  "importEntry": {
    "title": "an import", "description": "As an import that is no list.",
    "type": ["string", "object"], "minLength": 1,
    "additionalProperties": false, "patternProperties": { "^(x-|extras$)": {} }, "required": ["file"],
    "properties": {
      "file": { "$ref": "#/definitions/name" },
      "optics": { "type": "array", "items": { "$ref": "#/definitions/name" } },
      "time": { "$ref": "#/definitions/number" },
      "animation": { "$ref": "#/definitions/name" }
    }
  },

  "lookAt": {
    "title": "a lookAt",
    "type": "object", "additionalProperties": false, "patternProperties": { "^(x-|extras$)": {} },
    "required": ["eye", "at"],
    "properties": {
      "eye": { "$ref": "#/definitions/vec3" }, "at": { "$ref": "#/definitions/vec3" },
      "up": { "$ref": "#/definitions/vec3", "default": [0, 1, 0] }
    }
  },

  "placedRay": {
    "title": "a ray",
    "type": "object", "additionalProperties": false, "patternProperties": { "^(x-|extras$)": {} },
    "required": ["point", "direction", "screen"],
    "properties": {
      "point": { "$ref": "#/definitions/vec3" }, "direction": { "$ref": "#/definitions/vec3" },
      "screen": { "$ref": "#/definitions/vec2", "description": "0..1 from the film's top left." }
    }
  },

  "transform": {
    "title": "a transform", "description": "matrix, or scale, then rotate, then translate.",
    "type": "object", "additionalProperties": false, "patternProperties": { "^(x-|extras$)": {} },
    "properties": {
      "translate": { "$ref": "#/definitions/vec3", "default": [0, 0, 0] },
      "rotate": { "$ref": "#/definitions/rotation", "default": [0, 0, 0, 1], "description": "A quaternion x, y, z, w of any length but 0; or angles." },
      "scale": { "$ref": "#/definitions/vec3", "default": [1, 1, 1], "description": "No entry may be 0; an odd number of negative ones mirrors." },
      "matrix": { "type": "array", "minItems": 16, "maxItems": 16, "items": { "$ref": "#/definitions/number" }, "description": "Column by column, as glTF; its last row is 0 0 0 1." }
    },
    "if": { "required": ["matrix"] },
    "then": { "title": "a transform with a matrix", "properties": { "translate": false, "rotate": false, "scale": false } }
  },

  "rotation": {
    "title": "a rotation", "description": "A quaternion x, y, z, w; or { euler, order }: degrees about the fixed axes x, y and z, 'XYZ' about x first (as USD's rotateXYZ); or { axis, angle }: degrees about a direction.",
    "type": ["array", "object"],
    "$comment": "a quaternion is x, y, z, w; angles in degrees are { \"euler\": [x, y, z] } or { \"axis\": [x, y, z], \"angle\": a }",
    "minItems": 4, "maxItems": 4, "items": { "$ref": "#/definitions/number" },
    "additionalProperties": false, "patternProperties": { "^(x-|extras$)": {} },
    "properties": {
      "euler": { "$ref": "#/definitions/vec3" },
      "order": { "enum": ["XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"], "default": "XYZ" },
      "axis": { "$ref": "#/definitions/vec3", "description": "Any length but 0." },
      "angle": { "$ref": "#/definitions/number" }
    },
    "dependencies": { "order": ["euler"], "axis": ["angle"], "angle": ["axis"] }
  },

  "fit": {
    "title": "a fit", "description": "Moves and scales a mesh, after its transform, until the middle of its bounds is 'center' and their longest side 'size'.",
    "type": "object", "additionalProperties": false, "patternProperties": { "^(x-|extras$)": {} },
    "required": ["size"],
    "properties": {
      "center": { "$ref": "#/definitions/vec3", "default": [0, 0, 0] },
      "size": { "$ref": "#/definitions/positive" }
    }
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
      "target": { "type": "string", "minLength": 1, "description": "JSON pointer of a number, of an array of numbers, or of a rotation, of this scene: /cameras/0/yfov, /meshes/2/points; neither a part of another track's target nor the whole that holds it." },
      "interpolation": { "enum": ["linear", "smooth", "step"], "default": "linear", "description": "From key to key; rotations, of quaternions as of angles, go by the shorter great arc." },
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
  }
}
})json";

Json make_schema() {
    Json schema = parse_json(kFrame, "the scene schema");
    Json& definitions = schema["definitions"];
    definitions["film"] = film_schema();
    definitions["camera"] = camera_schema();
    definitions["view"] = view_schema();
    definitions["background"] = background_schema();
    definitions["material"] = material_schema();
    definitions["texture"] = texture_schema();
    definitions["mesh"] = mesh_schema();
    definitions["region"] = region_schema();
    definitions["patch"] = patch_schema();
    definitions["displacement"] = displacement_schema();
    definitions["bakedLight"] = baked_light_schema();
    definitions["primitive"] = primitive_schema();
    definitions["lensSide"] = lens_side_schema();
    definitions["lens"] = lens_schema();
    definitions["lensSurface"] = lens_surface_schema();
    definitions["normals"] = normals_schema();
    definitions["light"] = light_schema();
    definitions["volume"] = volume_schema();
    definitions["volumeGrid"] = volume_grid_schema();
    definitions["transferFunction"] = transfer_schema();
    definitions["transferPoint"] = transfer_point_schema();
    definitions["pointCloud"] = point_cloud_schema();
    definitions["label"] = label_schema();
    definitions["render"] = render_schema();
    check_keywords(schema);
    return schema;
}

}  // namespace

const Json& scene_schema_json() {
    static const Json schema = make_schema();
    return schema;
}

const char* scene_schema() {
    static const std::string text = scene_schema_json().dump(2) + "\n";
    return text.c_str();
}

}  // namespace trilens
