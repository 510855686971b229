// What the files of the Python module share: each of them binds one subject.
#pragma once

#include <pybind11/pybind11.h>
#include <trilens/trilens.h>

#include <array>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace trilens::python {

namespace py = pybind11;

void bind_errors(py::module_& module);
void bind_program(py::module_& module);
void bind_image(py::module_& module);
void bind_scene(py::module_& module);
void bind_scene_camera(py::module_& module);
void bind_renderer(py::module_& module);
void bind_compare(py::module_& module);
void bind_sweep(py::module_& module);
void bind_suite(py::module_& module);
void bind_inverse(py::module_& module);
void bind_surface(py::module_& module);
void bind_lens(py::module_& module);
void bind_ray_mesh(py::module_& module);
void bind_film_camera(py::module_& module);

/// Throws UsageError with the nearest known name unless `name` is one of them; `what`: "engine".
void require_known(const std::string& what, const std::string& name, std::span<const std::string> known);

/// The value of that name. Throws UsageError with the nearest one where there is none.
template <typename E>
E require_named(const std::string& what, const std::string& name) {
    require_known(what, name, names_of<E>());
    return *find_named<E>(name);
}

/// str(object).
inline std::string text_of(const py::handle& object) {
    return py::str(object);
}

/// (x, y, z).
inline py::tuple tuple_of(const Vec3& v) {
    return py::make_tuple(v.x, v.y, v.z);
}

/// Three numbers as Python gives them.
using Triple = std::array<double, 3>;
inline Vec3 vec3(const Triple& v) {
    return {v[0], v[1], v[2]};
}

/// A member of a plain record, by its name in Python.
template <class Record, class Value>
struct Field {
    const char* name;
    Value Record::*member;
    const char* doc;
};

template <class Record, class Value>
Field<Record, Value> field(const char* name, Value Record::*member, const char* doc) {
    return {name, member, doc};
}

/// Binds a plain record: its fields (or those of records that it extends) for reading, to_dict(), and a repr
/// that shows them.
template <class Record, class... Bound, class... Records, class... Values>
void bind_fields(py::class_<Record, Bound...>& bound, const Field<Records, Values>&... fields) {
    (bound.def_readonly(fields.name, fields.member, fields.doc), ...);
    const auto to_dict = [fields...](const Record& record) {
        py::dict values;
        ((values[fields.name] = py::cast(record.*fields.member)), ...);
        return values;
    };
    bound.def("to_dict", to_dict, "The fields as a dict.");
    bound.def("__repr__", [to_dict](const py::object& self) {
        std::string text = text_of(self.attr("__class__").attr("__name__")) + "(";
        const char* separator = "";
        for (const auto& [name, value] : to_dict(self.cast<const Record&>())) {
            text += separator + text_of(name) + "=" + text_of(py::repr(value));
            separator = ", ";
        }
        return text + ")";
    });
}

// Images as Python holds them.

/// An image and what is known of its making. Held by Python objects alone: views of channels keep those
/// alive.
struct HeldImage {
    Image image;
    py::dict statistics;  // empty where the image was not drawn here
};

/// What Image.statistics holds of a picture that was drawn.
py::dict statistics_dict(const Picture& picture);

// What render, explain and project have in common.

using RendererClass = py::class_<Renderer, std::shared_ptr<Renderer>>;

/// The camera by name (none: the scene's own) and the resolution.
FrameParams frame_params(const Renderer& renderer, int resolution, const std::optional<std::string>& camera);

/// "exact", "classic", "limit" or "facets".
EngineChoice engine_choice(const std::string& name);

void bind_project(RendererClass& renderer);
void bind_shoot(RendererClass& renderer);
void bind_bake(RendererClass& renderer);
void bind_explain(RendererClass& renderer);
void bind_facts(RendererClass& renderer);
void bind_unwrap(RendererClass& renderer, py::module_& module);  // unwrap, map, warp_mesh, anamorph

// What several subjects need of scenes.

/// What messages call a value that becomes JSON: its file, and where it stands there.
struct JsonOrigin {
    std::string file = {}, pointer = {};
};

/// As JSON, numpy's arrays and numbers, too. Throws InputError with the place of a number that is not finite.
std::string json_text(const py::object& value, const py::object& indent = py::none(),
                      const JsonOrigin& origin = {});

/// {"/json/pointer": value} as the library takes it; texts stay texts.
std::vector<SceneOverride> overrides_of(const py::dict& overrides);

// Caustics, edges and fold curves of line drawings as numpy arrays.

/// A dict for each sheet: path, optic, sheet, virtual, points, triangles, segments.
py::list caustic_list(const LineDrawing& drawing);

/// A dict for each edge: path, optic, object, points.
py::list edge_list(const LineDrawing& drawing);

/// A dict for each curve: object, points, places.
py::list fold_list(const LineDrawing& drawing);

}  // namespace trilens::python
