// The tables of a scene's settings: what its JSON Schema and its readers are made of.
#pragma once

#include <vector>

#include "scene/data/primitive_mesh.h"
#include "scene/data/scene.h"
#include "scene/json/fields.h"

namespace trilens {

const std::vector<Field<CameraDescription>>& camera_fields();
const std::vector<Field<Film>>& film_fields();
const std::vector<Field<Background>>& background_fields();
const std::vector<Field<Material>>& material_fields();
const std::vector<Field<Light>>& light_fields();
const std::vector<Field<RenderSettings>>& render_fields();
const std::vector<Field<Mesh>>& mesh_fields();
const std::vector<Field<Cage>>& subdivision_fields();  // keys of a mesh, too
const std::vector<Field<ObjectPrimitive>>& primitive_fields();
const std::vector<Field<NormalOverride>>& normal_fields();

/// scene_schema(), parsed; made once.
const Json& scene_schema_json();

// Their schemas, as definitions of the scene's.
Json camera_schema();
Json view_schema();  // of a multiPerspective camera
Json film_schema();
Json background_schema();
Json material_schema();
Json texture_schema();
Json light_schema();
Json render_schema();
Json mesh_schema();
Json primitive_schema();
Json normals_schema();

}  // namespace trilens
