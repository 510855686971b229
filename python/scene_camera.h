// A camera as its scene gives it.
#pragma once

#include "bindings.h"

namespace trilens::python {

struct SceneCamera {
    py::object scene;  // a Scene, which it keeps alive
    std::size_t index;

    const Scene& whole() const { return scene.cast<const Scene&>(); }
    const CameraDescription& description() const { return whole().cameras[index]; }
};

/// All of them, in scene order.
py::list cameras_of(const py::object& scene);

}  // namespace trilens::python
