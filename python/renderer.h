// What render, explain and project have in common.
#pragma once

#include <optional>

#include "bindings.h"

namespace trilens::python {

using RendererClass = py::class_<Renderer, std::shared_ptr<Renderer>>;

/// The camera by name (none: the scene's own) and the resolution.
FrameParams frame_params(const Renderer& renderer, int resolution, const std::optional<std::string>& camera);

/// "exact", "classic", "limit" or "facets".
EngineChoice engine_choice(const std::string& name);

void bind_project(RendererClass& renderer);
void bind_shoot(RendererClass& renderer);
void bind_unwrap(RendererClass& renderer, py::module_& module);  // unwrap, map, warp_mesh, anamorph
void bind_explain(RendererClass& renderer);

}  // namespace trilens::python
