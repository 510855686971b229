// What a sweep can vary: each axis by its name, with what a value does to the request to render.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "render/frame/request.h"
#include "study/scenes.h"
#include "sweep/store/axis.h"

namespace trilens {

/// A request to render, as the point of a sweep makes it; the library's own calls take it from here.
struct PointRequest {
    SceneRequest scene;
    std::shared_ptr<const Scene> loaded = {};  // instead of `scene`, while that names no file
    std::string camera;                        // empty: the scene's own
    std::string optic;                         // empty: all; else the one that the scene keeps
    // A value of a key of every optic: "normals" and its JSON text.
    std::vector<std::pair<std::string, std::string>> of_optics = {};
    int camera_facets = 0;  // of the camera's own mesh, N x N; 0: as the scene says
    PictureRequest picture = {};
    std::string paths_start_here =
        {};  // folder of scene files that an axis names; empty: where the program runs
};

/// Every axis but the JSON pointers, in the order in which help names them.
std::vector<AxisKind> axis_kinds();

/// The kind of this name; any JSON pointer is one. Throws UsageError that starts with `where`, with the
/// nearest name.
AxisKind find_axis_kind(const std::string& name, const std::string& where);

/// Makes the point of its base: each coordinate in its turn. Throws UsageError, also for a value without the
/// number that its axis needs.
PointRequest request_at(PointRequest base, const Coordinates& point);

/// The point's scene. Throws as load_scene does; UsageError where a point would change the text of a scene in
/// memory; InputError where no optic has the point's name, or where the camera has no facets to choose.
Scene load_scene(const PointRequest& request);

}  // namespace trilens
