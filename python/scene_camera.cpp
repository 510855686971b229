// Cameras of scenes: pose, settings, and the matrix of pinholes.
#include "scene_camera.h"

#include <cmath>
#include <numbers>

#include "arrays.h"

namespace trilens::python {
namespace {

/// {key: schema} of what cameras of that type have.
py::dict type_properties(const std::string& type) {
    const py::dict camera =
        py::module_::import("json").attr("loads")(scene_schema())["definitions"]["camera"];
    py::dict properties = camera["properties"];
    for (const py::handle rule : camera["allOf"]) {
        if (text_of(rule["if"]["properties"]["type"]["const"]) != type) continue;
        for (const auto& [key, schema] : rule["then"]["properties"].cast<py::dict>())
            if (schema.ptr() == Py_False) properties.attr("pop")(key);
    }
    return properties;
}

/// What the scene gives of the camera after overrides, and the schema's defaults of the rest.
py::dict settings_of(const SceneCamera& camera) {
    const py::object scene = py::module_::import("json").attr("loads")(camera.whole().resolved);
    const py::dict given = scene["cameras"][py::int_(camera.index)];
    py::dict settings;
    for (const auto& [key, schema] : type_properties(std::string(kind_name(camera.description()))))
        if (py::isinstance<py::dict>(schema) && schema.contains("default")) settings[key] = schema["default"];
    for (const auto& [key, value] : given) settings[key] = value;
    if (given.contains("tolerance") && !given.contains("facets")) settings.attr("pop")("facets", py::none());
    for (const char* elsewhere : {"name", "type", "lookAt"})
        if (settings.contains(elsewhere)) settings.attr("pop")(elsewhere);
    return settings;
}

/// Rows (fx, 0, cx), (0, fy, cy), (0, 0, 1).
py::object matrix_of(const SceneCamera& camera) {
    const CameraDescription& from = camera.description();
    const Film& film = camera.whole().film;
    double fx = 0, fy = 0, cx = 0, cy = 0;
    if (const auto* pinhole = std::get_if<PerspectiveCamera>(&from.kind)) {
        fx = fy = 0.5 * film.height / std::tan(pinhole->yfov * std::numbers::pi / 360);
        cx = (0.5 - pinhole->shift.x) * film.width;
        cy = (0.5 + pinhole->shift.y) * film.height;
    } else if (const auto* lens = std::get_if<OpencvLens>(&from.kind)) {
        fx = lens->fx, fy = lens->fy, cx = lens->cx, cy = lens->cy;
    } else {
        return py::none();
    }
    return array_of<double>({fx, 0, cx, 0, fy, cy, 0, 0, 1}, {3, 3});
}

std::optional<double> yfov_of(const SceneCamera& camera) {
    return std::visit(
        [](const auto& kind) -> std::optional<double> {
            if constexpr (requires { kind.yfov; }) return kind.yfov;
            return std::nullopt;
        },
        camera.description().kind);
}

std::string described(const SceneCamera& camera) {
    const CameraDescription& from = camera.description();
    std::string text = "<trilens.Camera '" + from.name + "': " + kind_name(from);
    for (const auto& [key, value] : settings_of(camera))
        if (py::isinstance<py::float_>(value) || py::isinstance<py::int_>(value) ||
            py::isinstance<py::str>(value))
            text += ", " + text_of(key) + " " + text_of(value);
    return text + ">";
}

}  // namespace

py::list cameras_of(const py::object& scene) {
    py::list cameras;
    for (std::size_t k = 0; k < scene.cast<const Scene&>().cameras.size(); ++k)
        cameras.append(SceneCamera{scene, k});
    return cameras;
}

void bind_scene_camera(py::module_& module) {
    const auto triple = [](Vec3 CameraDescription::*member) {
        return [member](const SceneCamera& camera) { return tuple_of(camera.description().*member); };
    };
    py::class_<SceneCamera>(module, "Camera", "A camera as the scene gives it; FilmCamera has its rays.")
        .def_property_readonly("name", [](const SceneCamera& camera) { return camera.description().name; })
        .def_property_readonly(
            "type", [](const SceneCamera& camera) { return std::string(kind_name(camera.description())); },
            "As in scene files: \"perspective\", \"fisheye\", \"rayMesh\", ...")
        .def_property_readonly("yfov", yfov_of,
                               "The whole vertical angle, degrees; None of types that have none.")
        .def_property_readonly("eye", triple(&CameraDescription::eye), "World frame.")
        .def_property_readonly("at", triple(&CameraDescription::at), "World frame.")
        .def_property_readonly("up", triple(&CameraDescription::up), "World frame.")
        .def_property_readonly(
            "settings", settings_of,
            "What scene files say of a camera of this type beside its pose, as a new dict by their "
            "names:\nwhat the scene gives, after overrides, and defaults.")
        .def_property_readonly(
            "intrinsics", matrix_of,
            "Of perspective cameras and OpenCV's lenses the matrix ((fx, 0, cx), (0, fy, cy), (0, 0, 1)) as "
            "a "
            "new array,\npixels of the film from its top left, a pixel's centre at .5, before distortion: a "
            "point (x, y, z) in the\ncamera's frame (x right, y down, z forward) is seen at (fx x / z + cx, "
            "fy y / z + cy). None of others.")
        .def("__repr__", described);
}

}  // namespace trilens::python
