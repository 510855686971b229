#include "sweep/store/results.h"

namespace trilens {

const char* summary_schema() {
    return R"({
  "$schema": "http://json-schema.org/draft-07/schema#",
  "title": "summary.json of a trilens sweep",
  "description": "Fields that begin with t_, and peak_rss_mb, repeats, threads, jobs and machine_used_by_others, tell of the machine and its work, and differ from one run of the sweep to the next; all others are the same for the same scene and build.",
  "type": "object",
  "required": ["schema", "title", "axes", "zip", "counts", "fits", "runs"],
  "additionalProperties": false,
  "properties": {
    "schema": {"const": "trilens.sweep-summary/1"},
    "title": {"type": "string"},
    "axes": {"type": "array", "description": "what was varied", "items": {"$ref": "#/definitions/axis"}},
    "zip": {"type": "boolean", "description": "the axes' values side by side, not every combination"},
    "counts": {
      "type": "object", "required": ["done", "failed", "missing"], "additionalProperties": false,
      "properties": {"done": {"type": "integer"}, "failed": {"type": "integer"}, "missing": {"type": "integer"}}
    },
    "left_out": {
      "type": "array", "description": "scenes of an axis that lack what another axis varies: they have no runs",
      "items": {
        "type": "object", "required": ["scene", "reason"], "additionalProperties": false,
        "properties": {"scene": {"type": "string"}, "reason": {"type": "string"}}
      }
    },
    "fits": {"type": "array", "items": {"$ref": "#/definitions/fit"}},
    "runs": {"type": "array", "description": "in the order of the plan", "items": {"$ref": "#/definitions/run"}}
  },
  "definitions": {
    "number": {"description": "what is not finite is a string; null was not computed", "oneOf": [{"type": "number"}, {"type": "null"}, {"enum": ["nan", "inf", "-inf"]}]},
    "metrics": {
      "type": "object", "additionalProperties": {"$ref": "#/definitions/number"},
      "description": "by column name of runs.csv and displacement.csv: *_px in pixels, *_s in seconds of wall-clock time, *_mb in MiB, disp_coverage and machine_used_by_others as shares 0..1. Of a run disp_mean_px, disp_p95_px and disp_max_px are the larger of its layers', disp_coverage the smaller, and the counts those of both. t_surface_s: surfaces and trees of the scene, made once for all runs of a process; t_prepare_s: rays and what the engine needs; t_draw_s: drawing and shading; t_total_s: the picture, median of repeats drawings; t_spread_s: the longest minus the shortest of them; t_first_s: the drawing before them; t_write_s: writing image.exr; t_trace_s: tracing the truth; jobs: runs of this process at once"
    },
    "point": {"type": "object", "description": "value by axis", "additionalProperties": {"type": ["number", "string"]}},
    "axis": {
      "type": "object", "required": ["name", "short_name", "label", "is_scale", "values", "numbers"], "additionalProperties": false,
      "properties": {
        "name": {"type": "string", "description": "an axis of --over, or a JSON pointer into the scene"},
        "short_name": {"type": "string", "description": "before the value in a run's id"},
        "label": {"type": "string", "description": "on plots, with the unit"},
        "is_scale": {"type": "boolean", "description": "errors follow a power of it"},
        "values": {"type": "array", "minItems": 1, "items": {"type": ["number", "string"]}},
        "numbers": {"type": "array", "items": {"type": ["number", "null"]}, "description": "the number that each value stands for; pixels of a size"}
      }
    },
    "fit": {
      "type": "object", "description": "error = constant * n^-order, least squares of the logarithms over the points that are used",
      "required": ["optic", "axis", "group", "layer", "metric", "order", "order_low", "order_high", "constant", "r2", "n_for_1px", "n_for_half_px", "coverage", "points"],
      "additionalProperties": false,
      "properties": {
        "optic": {"type": "string", "description": "its name, or all"},
        "axis": {"type": "string", "description": "whose numbers are n"},
        "group": {"$ref": "#/definitions/point"},
        "layer": {"type": ["string", "null"], "description": "reflect, refract; null for the whole picture"},
        "metric": {"type": "string"},
        "order": {"$ref": "#/definitions/number"},
        "order_low": {"$ref": "#/definitions/number"},
        "order_high": {"$ref": "#/definitions/number"},
        "constant": {"$ref": "#/definitions/number"},
        "r2": {"$ref": "#/definitions/number"},
        "n_for_1px": {"type": ["integer", "null"]},
        "n_for_half_px": {"type": ["integer", "null"]},
        "coverage": {"$ref": "#/definitions/number"},
        "points": {
          "type": "array",
          "items": {
            "type": "object", "required": ["n", "value", "used"], "additionalProperties": false,
            "properties": {"n": {"type": "number"}, "value": {"$ref": "#/definitions/number"}, "used": {"type": "boolean"}}
          }
        }
      }
    },
    "run": {
      "type": "object", "required": ["id", "point", "hash", "status", "warnings"], "additionalProperties": false,
      "properties": {
        "id": {"type": "string", "description": "the folder under runs"},
        "n": {"type": "integer", "description": "the resolution, where it is an axis"},
        "point": {"$ref": "#/definitions/point"},
        "hash": {"type": "string", "description": "of everything that the result depends on"},
        "status": {"enum": ["done", "failed", "missing"]},
        "exit_code": {"type": "integer"},
        "error": {"type": "string"},
        "metrics": {"$ref": "#/definitions/metrics"},
        "displacement": {
          "type": "array",
          "items": {
            "type": "object", "required": ["layer", "optic", "metrics"], "additionalProperties": false,
            "properties": {"layer": {"type": "string"}, "optic": {"type": "string"}, "metrics": {"$ref": "#/definitions/metrics"}}
          }
        },
        "warnings": {"type": "array", "items": {"type": "string"}}
      }
    }
  }
}
)";
}

}  // namespace trilens
