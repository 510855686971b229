// The cameras' part of the scene's JSON Schema.
#include "scene/json/schema_parts.h"

namespace trilens {

const char* camera_schema() {
    return R"json(
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

  "camera": {
    "title": "a camera",
    "type": "object", "additionalProperties": false, "patternProperties": { "^(x-|extras$)": {} },
    "properties": {
      "name": { "$ref": "#/definitions/name" },
      "type": { "enum": ["perspective", "orthographic", "oblique", "viewVolume", "cylindrical", "spherical", "fisheye", "opencv", "pushbroom", "crossedSlits", "generalLinear", "distortion", "multiPerspective", "inwardSphere", "planarContext", "rayMesh"], "default": "perspective" },
      "yfov": { "type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 180, "default": 40, "description": "The whole vertical angle, degrees; distortion: of the detail." },
      "lookAt": { "$ref": "#/definitions/lookAt" },
      "shift": { "type": "array", "minItems": 2, "maxItems": 2, "items": { "type": "number", "minimum": -1000, "maximum": 1000 }, "default": [0, 0], "description": "perspective: the window moves by this share of the film's width and height, x right, y up." },
      "near": { "$ref": "#/definitions/notNegative", "default": 0, "description": "perspective: what lies nearer along the view axis is not seen." },
      "far": { "$ref": "#/definitions/positive", "description": "perspective: likewise what lies farther." },
      "ymag": { "$ref": "#/definitions/positive", "default": 1, "description": "orthographic, oblique: half the film's height in the world." },
      "angle": { "type": "number", "minimum": -360, "maximum": 360, "default": 45, "description": "oblique: of receding lines on the film, from the right towards the top; planarContext: how far the ground turns up, at most 90." },
      "scale": { "$ref": "#/definitions/notNegative", "default": 1, "description": "oblique: length of receding lines on the film, 1 cavalier, 0.5 cabinet." },
      "vrp": { "$ref": "#/definitions/vec3", "default": [0, 0, 0], "description": "viewVolume: a point of the view plane." },
      "vpn": { "$ref": "#/definitions/vec3", "default": [0, 0, 1], "description": "viewVolume: its normal, towards the viewer." },
      "vup": { "$ref": "#/definitions/vec3", "default": [0, 1, 0] },
      "prp": { "$ref": "#/definitions/vec3", "description": "viewVolume: the eye in (u, v, n) from the vrp; parallel: rays go from it to the window's middle." },
      "window": { "type": "array", "minItems": 4, "maxItems": 4, "items": { "$ref": "#/definitions/number" }, "description": "viewVolume, crossedSlits: umin, umax, vmin, vmax on the view plane (crossedSlits: through 'at' of lookAt), which fill the film." },
      "projection": { "enum": ["perspective", "parallel"] },
      "front": { "$ref": "#/definitions/number", "description": "viewVolume: n of the clipping plane; without it none." },
      "back": { "$ref": "#/definitions/number", "description": "viewVolume: likewise." },
      "hfov": { "type": "number", "exclusiveMinimum": 0, "maximum": 360, "default": 360, "description": "Longitudes across the film, degrees." },
      "vfov": { "type": "number", "exclusiveMinimum": 0, "maximum": 180, "default": 180, "description": "Latitudes over the film, degrees." },
      "mapping": { "enum": ["equidistant", "equisolid", "stereographic", "orthographic"], "default": "equidistant", "description": "fisheye: how the distance from the film's middle grows with the angle from the axis." },
      "fov": { "type": "number", "exclusiveMinimum": 0, "maximum": 360, "default": 180, "description": "fisheye: degrees across the film's smaller side; beyond that circle there are no rays." },
      "model": { "enum": ["pinhole", "fisheye"] },
      "fx": { "$ref": "#/definitions/positive", "description": "opencv: pixels of the film." },
      "fy": { "$ref": "#/definitions/positive" },
      "cx": { "$ref": "#/definitions/number", "description": "opencv: pixels from the film's left edge, where a pixel's centre is at .5: OpenCV's own cx + 0.5." },
      "cy": { "$ref": "#/definitions/number", "description": "opencv: likewise from the top." },
      "distortion": { "type": "array", "maxItems": 14, "items": { "$ref": "#/definitions/number" }, "default": [], "description": "opencv: k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 tx ty (4, 5, 8, 12 or 14 of them), or the fisheye's k1 k2 k3 k4." },
      "travel": { "$ref": "#/definitions/vec3", "description": "pushbroom: the eye's way from the film's left edge to its right; lookAt's eye is in the middle." },
      "slits": { "type": "array", "minItems": 2, "maxItems": 2, "items": { "type": "array", "minItems": 2, "maxItems": 2, "items": { "$ref": "#/definitions/vec3" } }, "description": "crossedSlits: a point and a direction each; rays begin at the first." },
      "rays": { "type": "array", "minItems": 3, "maxItems": 3, "items": { "$ref": "#/definitions/placedRay" }, "description": "generalLinear: all rays are affine combinations of these." },
      "detail": { "type": "array", "minItems": 4, "maxItems": 4, "items": { "$ref": "#/definitions/share" }, "description": "distortion: x0, y0, x1, y1 of the film from its top left, drawn in perspective." },
      "contextFov": { "type": "number", "exclusiveMinimum": 0, "maximum": 360, "default": 150, "description": "distortion: twice the angle from the view axis at the film's border." },
      "views": { "type": "array", "minItems": 1, "maxItems": 64, "items": { "$ref": "#/definitions/view" }, "description": "multiPerspective: a view without a lookAt has the camera's." },
      "blend": { "$ref": "#/definitions/share", "default": 0, "description": "multiPerspective: share of the film's width and height over which rays pass from one view to the next." },
      "center": { "$ref": "#/definitions/vec3", "description": "inwardSphere: rays go to it, and on." },
      "radius": { "$ref": "#/definitions/positive", "description": "inwardSphere: rays begin there." },
      "ground": { "type": "array", "minItems": 2, "maxItems": 2, "items": { "$ref": "#/definitions/vec3" }, "description": "planarContext: a point and the normal." },
      "bend": { "$ref": "#/definitions/positive", "description": "planarContext: distance from which the ground turns up, over an arc as long." },
      "facets": { "type": "integer", "minimum": 1, "maximum": 1024, "default": 64, "description": "N x N over the film, where a camera is not linear." },
      "tolerance": { "$ref": "#/definitions/positive", "description": "Pixels: as many facets as leave no place further off; instead of facets." },
      "points": { "type": "array", "minItems": 3, "items": { "$ref": "#/definitions/vec3" }, "description": "rayMesh: origin of each corner's ray." },
      "directions": { "type": "array", "minItems": 3, "items": { "$ref": "#/definitions/vec3" }, "description": "rayMesh: one per corner, any length but 0." },
      "screen": { "type": "array", "minItems": 3, "description": "rayMesh: one per corner, 0..1 from the film's top left; a facet may reach beyond the film.",
        "items": { "type": "array", "minItems": 2, "maxItems": 2, "items": { "type": "number", "minimum": -1000, "maximum": 1000 } } },
      "triangles": { "type": "array", "minItems": 1, "description": "rayMesh: three corners each.",
        "items": { "type": "array", "minItems": 3, "maxItems": 3, "items": { "$ref": "#/definitions/index" } } }
    },
    "allOf": [
      { "if": { "properties": { "type": { "const": "perspective" } } },
        "then": { "title": "a perspective camera", "required": ["lookAt"], "properties": {
          "ymag": false, "angle": false, "scale": false, "vrp": false, "vpn": false, "vup": false, "prp": false, "window": false, "projection": false, "front":
          false, "back": false, "hfov": false, "vfov": false, "mapping": false, "fov": false, "model": false, "fx": false, "fy": false, "cx": false,
          "cy": false, "distortion": false, "travel": false, "slits": false, "rays": false, "detail": false, "contextFov": false, "views": false,
          "blend": false, "center": false, "radius": false, "ground": false, "bend": false, "facets": false, "tolerance": false, "points": false,
          "directions": false, "screen": false, "triangles": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "orthographic" } } },
        "then": { "title": "an orthographic camera", "required": ["lookAt"], "properties": {
          "yfov": false, "shift": false, "near": false, "far": false, "angle": false, "scale": false, "vrp": false, "vpn": false, "vup": false, "prp": false,
          "window": false, "projection": false, "front": false, "back": false, "hfov": false, "vfov": false, "mapping": false, "fov": false, "model":
          false, "fx": false, "fy": false, "cx": false, "cy": false, "distortion": false, "travel": false, "slits": false, "rays": false, "detail":
          false, "contextFov": false, "views": false, "blend": false, "center": false, "radius": false, "ground": false, "bend": false, "facets":
          false, "tolerance": false, "points": false, "directions": false, "screen": false, "triangles": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "oblique" } } },
        "then": { "title": "an oblique camera", "required": ["lookAt"], "properties": {
          "yfov": false, "shift": false, "near": false, "far": false, "vrp": false, "vpn": false, "vup": false, "prp": false, "window": false, "projection":
          false, "front": false, "back": false, "hfov": false, "vfov": false, "mapping": false, "fov": false, "model": false, "fx": false, "fy":
          false, "cx": false, "cy": false, "distortion": false, "travel": false, "slits": false, "rays": false, "detail": false, "contextFov": false,
          "views": false, "blend": false, "center": false, "radius": false, "ground": false, "bend": false, "facets": false, "tolerance": false,
          "points": false, "directions": false, "screen": false, "triangles": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "viewVolume" } } },
        "then": { "title": "a viewVolume camera", "required": ["prp", "window", "projection"], "properties": {
          "yfov": false, "lookAt": false, "shift": false, "near": false, "far": false, "ymag": false, "angle": false, "scale": false, "hfov": false, "vfov":
          false, "mapping": false, "fov": false, "model": false, "fx": false, "fy": false, "cx": false, "cy": false, "distortion": false, "travel":
          false, "slits": false, "rays": false, "detail": false, "contextFov": false, "views": false, "blend": false, "center": false, "radius":
          false, "ground": false, "bend": false, "facets": false, "tolerance": false, "points": false, "directions": false, "screen": false,
          "triangles": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "cylindrical" } } },
        "then": { "title": "a cylindrical camera", "required": ["lookAt"], "properties": {
          "shift": false, "near": false, "far": false, "ymag": false, "angle": false, "scale": false, "vrp": false, "vpn": false, "vup": false, "prp": false,
          "window": false, "projection": false, "front": false, "back": false, "vfov": false, "mapping": false, "fov": false, "model": false, "fx":
          false, "fy": false, "cx": false, "cy": false, "distortion": false, "travel": false, "slits": false, "rays": false, "detail": false,
          "contextFov": false, "views": false, "blend": false, "center": false, "radius": false, "ground": false, "bend": false, "points": false,
          "directions": false, "screen": false, "triangles": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "spherical" } } },
        "then": { "title": "a spherical camera", "required": ["lookAt"], "properties": {
          "yfov": false, "shift": false, "near": false, "far": false, "ymag": false, "angle": false, "scale": false, "vrp": false, "vpn": false, "vup": false,
          "prp": false, "window": false, "projection": false, "front": false, "back": false, "mapping": false, "fov": false, "model": false, "fx":
          false, "fy": false, "cx": false, "cy": false, "distortion": false, "travel": false, "slits": false, "rays": false, "detail": false,
          "contextFov": false, "views": false, "blend": false, "center": false, "radius": false, "ground": false, "bend": false, "points": false,
          "directions": false, "screen": false, "triangles": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "fisheye" } } },
        "then": { "title": "a fisheye camera", "required": ["lookAt"], "properties": {
          "yfov": false, "shift": false, "near": false, "far": false, "ymag": false, "angle": false, "scale": false, "vrp": false, "vpn": false, "vup": false,
          "prp": false, "window": false, "projection": false, "front": false, "back": false, "hfov": false, "vfov": false, "model": false, "fx":
          false, "fy": false, "cx": false, "cy": false, "distortion": false, "travel": false, "slits": false, "rays": false, "detail": false,
          "contextFov": false, "views": false, "blend": false, "center": false, "radius": false, "ground": false, "bend": false, "points": false,
          "directions": false, "screen": false, "triangles": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "opencv" } } },
        "then": { "title": "an opencv camera", "required": ["lookAt", "model", "fx", "fy", "cx", "cy"], "properties": {
          "yfov": false, "shift": false, "near": false, "far": false, "ymag": false, "angle": false, "scale": false, "vrp": false, "vpn": false, "vup": false,
          "prp": false, "window": false, "projection": false, "front": false, "back": false, "hfov": false, "vfov": false, "mapping": false, "fov":
          false, "travel": false, "slits": false, "rays": false, "detail": false, "contextFov": false, "views": false, "blend": false, "center":
          false, "radius": false, "ground": false, "bend": false, "points": false, "directions": false, "screen": false, "triangles": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "pushbroom" } } },
        "then": { "title": "a pushbroom camera", "required": ["lookAt", "travel"], "properties": {
          "shift": false, "near": false, "far": false, "ymag": false, "angle": false, "scale": false, "vrp": false, "vpn": false, "vup": false, "prp": false,
          "window": false, "projection": false, "front": false, "back": false, "hfov": false, "vfov": false, "mapping": false, "fov": false, "model":
          false, "fx": false, "fy": false, "cx": false, "cy": false, "distortion": false, "slits": false, "rays": false, "detail": false,
          "contextFov": false, "views": false, "blend": false, "center": false, "radius": false, "ground": false, "bend": false, "points": false,
          "directions": false, "screen": false, "triangles": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "crossedSlits" } } },
        "then": { "title": "a crossedSlits camera", "required": ["lookAt", "slits", "window"], "properties": {
          "yfov": false, "shift": false, "near": false, "far": false, "ymag": false, "angle": false, "scale": false, "vrp": false, "vpn": false, "vup": false,
          "prp": false, "projection": false, "front": false, "back": false, "hfov": false, "vfov": false, "mapping": false, "fov": false, "model":
          false, "fx": false, "fy": false, "cx": false, "cy": false, "distortion": false, "travel": false, "rays": false, "detail": false,
          "contextFov": false, "views": false, "blend": false, "center": false, "radius": false, "ground": false, "bend": false, "points": false,
          "directions": false, "screen": false, "triangles": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "generalLinear" } } },
        "then": { "title": "a generalLinear camera", "required": ["lookAt", "rays"], "properties": {
          "yfov": false, "shift": false, "near": false, "far": false, "ymag": false, "angle": false, "scale": false, "vrp": false, "vpn": false, "vup": false,
          "prp": false, "window": false, "projection": false, "front": false, "back": false, "hfov": false, "vfov": false, "mapping": false, "fov":
          false, "model": false, "fx": false, "fy": false, "cx": false, "cy": false, "distortion": false, "travel": false, "slits": false, "detail":
          false, "contextFov": false, "views": false, "blend": false, "center": false, "radius": false, "ground": false, "bend": false, "points":
          false, "directions": false, "screen": false, "triangles": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "distortion" } } },
        "then": { "title": "a distortion camera", "required": ["lookAt", "detail"], "properties": {
          "shift": false, "near": false, "far": false, "ymag": false, "angle": false, "scale": false, "vrp": false, "vpn": false, "vup": false, "prp": false,
          "window": false, "projection": false, "front": false, "back": false, "hfov": false, "vfov": false, "mapping": false, "fov": false, "model":
          false, "fx": false, "fy": false, "cx": false, "cy": false, "distortion": false, "travel": false, "slits": false, "rays": false, "views":
          false, "blend": false, "center": false, "radius": false, "ground": false, "bend": false, "points": false, "directions": false, "screen":
          false, "triangles": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "multiPerspective" } } },
        "then": { "title": "a multiPerspective camera", "required": ["views"], "properties": {
          "yfov": false, "shift": false, "near": false, "far": false, "ymag": false, "angle": false, "scale": false, "vrp": false, "vpn": false, "vup": false,
          "prp": false, "window": false, "projection": false, "front": false, "back": false, "hfov": false, "vfov": false, "mapping": false, "fov":
          false, "model": false, "fx": false, "fy": false, "cx": false, "cy": false, "distortion": false, "travel": false, "slits": false, "rays":
          false, "detail": false, "contextFov": false, "center": false, "radius": false, "ground": false, "bend": false, "points": false,
          "directions": false, "screen": false, "triangles": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "inwardSphere" } } },
        "then": { "title": "an inwardSphere camera", "required": ["lookAt", "center", "radius"], "properties": {
          "yfov": false, "shift": false, "near": false, "far": false, "ymag": false, "angle": false, "scale": false, "vrp": false, "vpn": false, "vup": false,
          "prp": false, "window": false, "projection": false, "front": false, "back": false, "mapping": false, "fov": false, "model": false, "fx":
          false, "fy": false, "cx": false, "cy": false, "distortion": false, "travel": false, "slits": false, "rays": false, "detail": false,
          "contextFov": false, "views": false, "blend": false, "ground": false, "bend": false, "points": false, "directions": false, "screen": false,
          "triangles": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "planarContext" } } },
        "then": { "title": "a planarContext camera", "required": ["lookAt", "ground", "bend"], "properties": {
          "shift": false, "near": false, "far": false, "ymag": false, "scale": false, "vrp": false, "vpn": false, "vup": false, "prp": false, "window": false,
          "projection": false, "front": false, "back": false, "hfov": false, "vfov": false, "mapping": false, "fov": false, "model": false, "fx":
          false, "fy": false, "cx": false, "cy": false, "distortion": false, "travel": false, "slits": false, "rays": false, "detail": false,
          "contextFov": false, "views": false, "blend": false, "center": false, "radius": false, "points": false, "directions": false, "screen":
          false, "triangles": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "rayMesh" } } },
        "then": { "title": "a rayMesh camera", "required": ["points", "directions", "screen", "triangles"], "properties": {
          "yfov": false, "lookAt": false, "shift": false, "near": false, "far": false, "ymag": false, "angle": false, "scale": false, "vrp": false, "vpn":
          false, "vup": false, "prp": false, "window": false, "projection": false, "front": false, "back": false, "hfov": false, "vfov": false,
          "mapping": false, "fov": false, "model": false, "fx": false, "fy": false, "cx": false, "cy": false, "distortion": false, "travel": false,
          "slits": false, "rays": false, "detail": false, "contextFov": false, "views": false, "blend": false, "center": false, "radius": false,
          "ground": false, "bend": false, "facets": false, "tolerance": false } } }
    ]
  },
)json"
           R"json(
  "view": {
    "title": "a view", "description": "A camera of a multiPerspective one, with its window: x0, y0, x1, y1 in shares of the film from its top left.",
    "type": "object", "additionalProperties": false, "patternProperties": { "^(x-|extras$)": {} },
    "required": ["window"],
    "properties": {
      "name": { "$ref": "#/definitions/name" },
      "type": { "enum": ["perspective", "orthographic", "oblique", "cylindrical", "spherical", "fisheye", "opencv", "pushbroom", "generalLinear", "distortion", "inwardSphere", "planarContext"], "default": "perspective" },
      "yfov": { "type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 180, "default": 40, "description": "The whole vertical angle, degrees; distortion: of the detail." },
      "lookAt": { "$ref": "#/definitions/lookAt" },
      "shift": { "type": "array", "minItems": 2, "maxItems": 2, "items": { "type": "number", "minimum": -1000, "maximum": 1000 }, "default": [0, 0], "description": "perspective: the window moves by this share of the film's width and height, x right, y up." },
      "near": { "$ref": "#/definitions/notNegative", "default": 0, "description": "perspective: what lies nearer along the view axis is not seen." },
      "far": { "$ref": "#/definitions/positive", "description": "perspective: likewise what lies farther." },
      "ymag": { "$ref": "#/definitions/positive", "default": 1, "description": "orthographic, oblique: half the film's height in the world." },
      "angle": { "type": "number", "minimum": -360, "maximum": 360, "default": 45, "description": "oblique: of receding lines on the film, from the right towards the top; planarContext: how far the ground turns up, at most 90." },
      "scale": { "$ref": "#/definitions/notNegative", "default": 1, "description": "oblique: length of receding lines on the film, 1 cavalier, 0.5 cabinet." },
      "window": { "type": "array", "minItems": 4, "maxItems": 4, "items": { "$ref": "#/definitions/share" } },
      "hfov": { "type": "number", "exclusiveMinimum": 0, "maximum": 360, "default": 360, "description": "Longitudes across the film, degrees." },
      "vfov": { "type": "number", "exclusiveMinimum": 0, "maximum": 180, "default": 180, "description": "Latitudes over the film, degrees." },
      "mapping": { "enum": ["equidistant", "equisolid", "stereographic", "orthographic"], "default": "equidistant", "description": "fisheye: how the distance from the film's middle grows with the angle from the axis." },
      "fov": { "type": "number", "exclusiveMinimum": 0, "maximum": 360, "default": 180, "description": "fisheye: degrees across the film's smaller side; beyond that circle there are no rays." },
      "model": { "enum": ["pinhole", "fisheye"] },
      "fx": { "$ref": "#/definitions/positive", "description": "opencv: pixels of the film." },
      "fy": { "$ref": "#/definitions/positive" },
      "cx": { "$ref": "#/definitions/number", "description": "opencv: pixels from the film's left edge, where a pixel's centre is at .5: OpenCV's own cx + 0.5." },
      "cy": { "$ref": "#/definitions/number", "description": "opencv: likewise from the top." },
      "distortion": { "type": "array", "maxItems": 14, "items": { "$ref": "#/definitions/number" }, "default": [], "description": "opencv: k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 tx ty (4, 5, 8, 12 or 14 of them), or the fisheye's k1 k2 k3 k4." },
      "travel": { "$ref": "#/definitions/vec3", "description": "pushbroom: the eye's way from the film's left edge to its right; lookAt's eye is in the middle." },
      "rays": { "type": "array", "minItems": 3, "maxItems": 3, "items": { "$ref": "#/definitions/placedRay" }, "description": "generalLinear: all rays are affine combinations of these." },
      "detail": { "type": "array", "minItems": 4, "maxItems": 4, "items": { "$ref": "#/definitions/share" }, "description": "distortion: x0, y0, x1, y1 of the film from its top left, drawn in perspective." },
      "contextFov": { "type": "number", "exclusiveMinimum": 0, "maximum": 360, "default": 150, "description": "distortion: twice the angle from the view axis at the film's border." },
      "center": { "$ref": "#/definitions/vec3", "description": "inwardSphere: rays go to it, and on." },
      "radius": { "$ref": "#/definitions/positive", "description": "inwardSphere: rays begin there." },
      "ground": { "type": "array", "minItems": 2, "maxItems": 2, "items": { "$ref": "#/definitions/vec3" }, "description": "planarContext: a point and the normal." },
      "bend": { "$ref": "#/definitions/positive", "description": "planarContext: distance from which the ground turns up, over an arc as long." }
    },
    "allOf": [
      { "if": { "properties": { "type": { "const": "perspective" } } },
        "then": { "title": "a perspective view", "properties": {
          "ymag": false, "angle": false, "scale": false, "hfov": false, "vfov": false, "mapping": false, "fov": false, "model": false, "fx": false, "fy": false,
          "cx": false, "cy": false, "distortion": false, "travel": false, "rays": false, "detail": false, "contextFov": false, "center": false,
          "radius": false, "ground": false, "bend": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "orthographic" } } },
        "then": { "title": "an orthographic view", "properties": {
          "yfov": false, "shift": false, "near": false, "far": false, "angle": false, "scale": false, "hfov": false, "vfov": false, "mapping": false, "fov":
          false, "model": false, "fx": false, "fy": false, "cx": false, "cy": false, "distortion": false, "travel": false, "rays": false, "detail":
          false, "contextFov": false, "center": false, "radius": false, "ground": false, "bend": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "oblique" } } },
        "then": { "title": "an oblique view", "properties": {
          "yfov": false, "shift": false, "near": false, "far": false, "hfov": false, "vfov": false, "mapping": false, "fov": false, "model": false, "fx": false,
          "fy": false, "cx": false, "cy": false, "distortion": false, "travel": false, "rays": false, "detail": false, "contextFov": false, "center":
          false, "radius": false, "ground": false, "bend": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "cylindrical" } } },
        "then": { "title": "a cylindrical view", "properties": {
          "shift": false, "near": false, "far": false, "ymag": false, "angle": false, "scale": false, "vfov": false, "mapping": false, "fov": false, "model":
          false, "fx": false, "fy": false, "cx": false, "cy": false, "distortion": false, "travel": false, "rays": false, "detail": false,
          "contextFov": false, "center": false, "radius": false, "ground": false, "bend": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "spherical" } } },
        "then": { "title": "a spherical view", "properties": {
          "yfov": false, "shift": false, "near": false, "far": false, "ymag": false, "angle": false, "scale": false, "mapping": false, "fov": false, "model":
          false, "fx": false, "fy": false, "cx": false, "cy": false, "distortion": false, "travel": false, "rays": false, "detail": false,
          "contextFov": false, "center": false, "radius": false, "ground": false, "bend": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "fisheye" } } },
        "then": { "title": "a fisheye view", "properties": {
          "yfov": false, "shift": false, "near": false, "far": false, "ymag": false, "angle": false, "scale": false, "hfov": false, "vfov": false, "model":
          false, "fx": false, "fy": false, "cx": false, "cy": false, "distortion": false, "travel": false, "rays": false, "detail": false,
          "contextFov": false, "center": false, "radius": false, "ground": false, "bend": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "opencv" } } },
        "then": { "title": "an opencv view", "required": ["model", "fx", "fy", "cx", "cy"], "properties": {
          "yfov": false, "shift": false, "near": false, "far": false, "ymag": false, "angle": false, "scale": false, "hfov": false, "vfov": false, "mapping":
          false, "fov": false, "travel": false, "rays": false, "detail": false, "contextFov": false, "center": false, "radius": false, "ground":
          false, "bend": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "pushbroom" } } },
        "then": { "title": "a pushbroom view", "required": ["travel"], "properties": {
          "shift": false, "near": false, "far": false, "ymag": false, "angle": false, "scale": false, "hfov": false, "vfov": false, "mapping": false, "fov":
          false, "model": false, "fx": false, "fy": false, "cx": false, "cy": false, "distortion": false, "rays": false, "detail": false,
          "contextFov": false, "center": false, "radius": false, "ground": false, "bend": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "generalLinear" } } },
        "then": { "title": "a generalLinear view", "required": ["rays"], "properties": {
          "yfov": false, "shift": false, "near": false, "far": false, "ymag": false, "angle": false, "scale": false, "hfov": false, "vfov": false, "mapping":
          false, "fov": false, "model": false, "fx": false, "fy": false, "cx": false, "cy": false, "distortion": false, "travel": false, "detail":
          false, "contextFov": false, "center": false, "radius": false, "ground": false, "bend": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "distortion" } } },
        "then": { "title": "a distortion view", "required": ["detail"], "properties": {
          "shift": false, "near": false, "far": false, "ymag": false, "angle": false, "scale": false, "hfov": false, "vfov": false, "mapping": false, "fov":
          false, "model": false, "fx": false, "fy": false, "cx": false, "cy": false, "distortion": false, "travel": false, "rays": false, "center":
          false, "radius": false, "ground": false, "bend": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "inwardSphere" } } },
        "then": { "title": "an inwardSphere view", "required": ["center", "radius"], "properties": {
          "yfov": false, "shift": false, "near": false, "far": false, "ymag": false, "angle": false, "scale": false, "mapping": false, "fov": false, "model":
          false, "fx": false, "fy": false, "cx": false, "cy": false, "distortion": false, "travel": false, "rays": false, "detail": false,
          "contextFov": false, "ground": false, "bend": false } } },
      { "if": { "required": ["type"], "properties": { "type": { "const": "planarContext" } } },
        "then": { "title": "a planarContext view", "required": ["ground", "bend"], "properties": {
          "shift": false, "near": false, "far": false, "ymag": false, "scale": false, "hfov": false, "vfov": false, "mapping": false, "fov": false, "model":
          false, "fx": false, "fy": false, "cx": false, "cy": false, "distortion": false, "travel": false, "rays": false, "detail": false,
          "contextFov": false, "center": false, "radius": false } } }
    ]
  },
)json";
}

}  // namespace trilens
