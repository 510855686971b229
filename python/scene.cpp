// Scenes: read from files and text, and what is in them.
#include "bindings.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <filesystem>
#include <optional>

#include "python_call.h"
#include "scene_camera.h"

namespace trilens::python {
namespace {

/// numpy's arrays and numbers, and paths, as Python's own values; what else JSON lacks stays a TypeError.
py::object plain_value(const py::object& value) {
    if (py::hasattr(value, "tolist")) return value.attr("tolist")();
    if (py::hasattr(value, "__fspath__")) return value.attr("__fspath__")();
    throw py::type_error("Object of type " + text_of(py::type::of(value).attr("__name__")) +
                         " is not JSON serializable");
}

/// A key as a part of a JSON pointer.
std::string escaped(const std::string& key) {
    std::string part;
    for (const char c : key) part += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
    return part;
}

/// Throws InputError with the place of the first number that is not finite; the value has no circles.
void require_finite(const py::handle& value, const JsonOrigin& origin) {
    const auto look = [&](const std::string& key, const py::handle& part) {
        require_finite(part, {origin.file, origin.pointer + "/" + escaped(key)});
    };
    if (py::isinstance<py::float_>(value)) {
        if (!std::isfinite(value.cast<double>()))
            throw InputError(origin.file, origin.pointer,
                             "is " + text_of(value) + ", which no JSON number is");
    } else if (py::isinstance<py::dict>(value)) {
        for (const auto& [key, part] : py::reinterpret_borrow<py::dict>(value)) look(text_of(key), part);
    } else if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) {
        std::size_t i = 0;
        for (const py::handle part : value) look(std::to_string(i++), part);
    } else if (py::hasattr(value, "tolist")) {
        require_finite(value.attr("tolist")(), origin);
    }
}

}  // namespace

std::string json_text(const py::object& value, const py::object& indent, const JsonOrigin& origin) {
    try {
        return py::module_::import("json")
            .attr("dumps")(value, py::arg("indent") = indent, py::arg("allow_nan") = false,
                           py::arg("default") = py::cpp_function(plain_value))
            .cast<std::string>();
    } catch (const py::error_already_set& error) {
        // Of circles it says so, too, before it comes to a number behind them.
        if (error.matches(PyExc_ValueError) && text_of(error.value()).find("Circular") == std::string::npos)
            require_finite(value, origin);
        throw;
    }
}

namespace {

py::object json_value(const std::string& text) {
    return py::module_::import("json").attr("loads")(text);
}

void tell_warnings(const Scene& scene, PythonCall& call) {
    call.run([&] {
        call.tell_all(scene.warnings);
        return true;
    });
}

Scene load(const std::filesystem::path& file, const py::dict& overrides, int resolution,
           const ImportOptions& import, const py::object& warn) {
    PythonCall call(py::none(), warn);
    const SceneRequest request{file.string(), overrides_of(overrides), resolution, import,
                               call.progress("reading the scene")};
    Scene scene = call.run([&] { return load_scene(request); });
    tell_warnings(scene, call);
    return scene;
}

struct SceneText {
    std::string json, folder, label;
};

Scene parse(const SceneText& text, const py::dict& overrides, int resolution, const py::object& warn) {
    PythonCall call(py::none(), warn);
    const std::vector<SceneOverride> changes = overrides_of(overrides);
    Scene scene = call.run([&] {
        Scene parsed = parse_scene(text.json, text.folder, changes, text.label);
        if (resolution != 0) set_resolution(parsed, resolution);
        return parsed;
    });
    tell_warnings(scene, call);
    return scene;
}

py::object bounds_of(const Box& box) {
    if (box.empty()) return py::none();
    return py::make_tuple(tuple_of(box.low), tuple_of(box.high));
}

void bind_parts(py::module_& module) {
    py::class_<Film> film(module, "Film", "The picture plane.");
    bind_fields(film, field("width", &Film::width, "Pixels."), field("height", &Film::height, "Pixels."),
                field("spp", &Film::spp, "S: every pixel has S x S samples."));
    film.def_property_readonly(
        "filter", [](const Film& one) { return name_of(one.filter); },
        "How samples make a pixel's colour: \"box\", \"mitchell\" or \"gaussian\".");

    py::class_<TerrainInfo> terrain(module, "Terrain", "How an object was made of heights.");
    bind_fields(
        terrain, field("columns", &TerrainInfo::columns, "Samples across."),
        field("rows", &TerrainInfo::rows, "Samples down."),
        field("missing_heights", &TerrainInfo::missing_heights,
              "Samples without a height: the triangles that touch them are left out."),
        field("whole_triangles", &TerrainInfo::whole_triangles, "That the whole grid has, without holes."),
        field("greatest_error", &TerrainInfo::greatest_error,
              "How far its triangles are from those at most, along its y, before its transform."),
        field("rms_error", &TerrainInfo::rms_error, "The same in the mean of squares."));

    py::class_<MeshInfo> mesh(module, "Mesh",
                              "A mesh of the scene; its index in Scene.meshes is its object id.");
    bind_fields(
        mesh, field("name", &MeshInfo::name, "Its name."),
        field("shape", &MeshInfo::shape,
              "\"polygons\", \"terrain\", \"patches\", \"catmullClark\", \"loop\", \"bilinear\", \"sphere\", "
              "\"paraboloid\",\n"
              "\"cylinder\", \"cone\" or \"plane\"."),
        field("material", &MeshInfo::material, "Its name; \"inherit\" where triangles carry their own."),
        field("points", &MeshInfo::points, "How many; 0 for a primitive."),
        field("faces", &MeshInfo::faces, "How many; 0 for a primitive."),
        field("triangles", &MeshInfo::triangles, "How many, of an object."),
        field("resolution", &MeshInfo::resolution, "N x N facets per quad face, of an optic."));
    mesh.def_property_readonly(
            "role", [](const MeshInfo& info) { return info.role == Role::kOptic ? "optic" : "object"; },
            "\"optic\" (mirrors or refracts) or \"object\".")
        .def_property_readonly(
            "terrain", [](const MeshInfo& info) { return info.terrain; },
            "How it was made of heights; None where it was not.")
        .def_property_readonly(
            "bounds", [](const MeshInfo& info) { return bounds_of(info.bounds); },
            "((x, y, z), (x, y, z)): the lowest and the highest corner of its box, world frame; None where "
            "empty.");

    py::class_<VolumeInfo> volume(module, "Volume", "A volume of the scene.");
    bind_fields(volume, field("name", &VolumeInfo::name, "Its name."),
                field("field", &VolumeInfo::field, "Of its file; empty: it has no name."),
                field("cells", &VolumeInfo::cells, "As its file has them."),
                field("tetrahedra", &VolumeInfo::tetrahedra, "That they are cut into."),
                field("points", &VolumeInfo::points, "How many."),
                field("least", &VolumeInfo::least, "The least scalar."),
                field("most", &VolumeInfo::most, "The greatest."));
    volume.def_property_readonly(
        "bounds", [](const VolumeInfo& info) { return bounds_of(info.bounds); }, "As Mesh.bounds.");

    py::class_<CloudInfo> cloud(module, "PointCloud", "A point cloud of the scene.");
    bind_fields(cloud, field("name", &CloudInfo::name, "Its name."),
                field("points", &CloudInfo::points, "How many."),
                field("has_colors", &CloudInfo::has_colors, "Whether its file has one for each."));
    cloud.def_property_readonly(
        "bounds", [](const CloudInfo& info) { return bounds_of(info.bounds); }, "As Mesh.bounds.");
}

void bind_readers(py::module_& module) {
    module.def(
        "load_scene",
        [](const std::filesystem::path& file, const py::dict& overrides, int resolution,
           const std::vector<std::string>& optics, const std::optional<double>& time,
           const std::string& animation, const py::object& warn) {
            if (time && !(std::fabs(*time) <= 1e9)) throw UsageError("a time is a finite number of seconds");
            return load(file, overrides, resolution, {optics, time, animation}, warn);
        },
        py::arg("file"), py::arg("overrides") = py::dict(), py::arg("resolution") = 0, py::kw_only(),
        py::arg("optics") = py::list(), py::arg("time") = py::none(), py::arg("animation") = "",
        py::arg("warn") = py::none(),
        "Reads a scene file (.json), a glTF (.gltf, .glb), or the scene that an image (.exr) carries.\n\n"
        "overrides: values by JSON pointer, {\"/film/width\": 320}, in order, before the scene is checked; "
        "numpy's\n"
        "arrays and numbers, and paths, stand for lists, numbers and texts, as in the dict of parse_scene.\n"
        "resolution: 1..1024, of every optic; 0: as the scene says.\n"
        "optics, time, animation: of a glTF, or those that the scene imports: names of meshes, nodes and "
        "materials\n"
        "that are optics, as shells match them (\"Mirror*\"); seconds of its animation, None: its start; the "
        "animation's\n"
        "name, \"\": the first. Raises UsageError where there is no such thing.\n"
        "warn: called with each warning; None: the warnings module tells (TrilensWarning).\n"
        "Raises InputError with the file and the place of the first problem.");
    module.def(
        "parse_scene",
        [](const py::object& scene, const std::filesystem::path& folder, const py::dict& overrides,
           int resolution, const std::string& label, const py::object& warn) {
            const bool is_text = py::isinstance<py::str>(scene);
            const JsonOrigin origin{label.empty() ? "scene" : label};
            return parse({is_text ? scene.cast<std::string>() : json_text(scene, py::none(), origin),
                          folder.string(), label},
                         overrides, resolution, warn);
        },
        py::arg("scene"), py::arg("folder") = "", py::arg("overrides") = py::dict(),
        py::arg("resolution") = 0, py::kw_only(), py::arg("label") = "", py::arg("warn") = py::none(),
        "The same from JSON text or from a dict of the same form.\n\n"
        "folder: where relative paths start; \"\": the working directory.\n"
        "label: what messages call the scene; \"\": \"scene\".");
    module.def(
        "scene_examples",
        [] {
            py::dict examples;
            for (const SceneExample& example : scene_examples()) examples[example.name] = example.json;
            return examples;
        },
        "Small scenes that come with the program: JSON texts by name, for parse_scene.");
    module.def(
        "scene_schema", [] { return json_value(scene_schema()); },
        "The JSON Schema (draft 7) of scene files, as a dict.");
}

}  // namespace

std::vector<SceneOverride> overrides_of(const py::dict& overrides) {
    std::vector<SceneOverride> changes;
    for (const auto& [key, value] : overrides) {
        const auto pointer = key.cast<std::string>();
        changes.push_back(
            {pointer, json_text(py::reinterpret_borrow<py::object>(value), py::none(), {"", pointer})});
    }
    return changes;
}

void bind_scene(py::module_& module) {
    bind_parts(module);
    py::class_<Scene>(module, "Scene", "A scene, checked and with nothing left to load. It does not change.")
        .def_readonly("file", &Scene::file, "Where it came from; empty for scenes from memory.")
        .def_readonly("label", &Scene::label, "What messages call it where it has no file; may be empty.")
        .def_readonly("folder", &Scene::folder, "Where its relative paths start.")
        .def_readonly("film", &Scene::film)
        .def_property_readonly("cameras", cameras_of, "At least one, in scene order.")
        .def_property_readonly(
            "camera", [](const Scene& scene) { return scene.cameras[scene.own_camera].name; },
            "The name of the camera that is used where none is asked for.")
        .def_property_readonly(
            "meshes", [](const Scene& scene) { return make_scene_info(scene).meshes; },
            "In scene order: the index is the object id of images.")
        .def_property_readonly(
            "volumes", [](const Scene& scene) { return make_scene_info(scene).volumes; }, "In scene order.")
        .def_property_readonly(
            "points", [](const Scene& scene) { return make_scene_info(scene).points; }, "In scene order.")
        .def_property_readonly(
            "labels", [](const Scene& scene) { return make_scene_info(scene).labels; },
            "Their texts, in scene order.")
        .def_property_readonly(
            "bounds", [](const Scene& scene) { return bounds_of(make_scene_info(scene).bounds); },
            "The box around everything, as Mesh.bounds.")
        .def_readonly("warnings", &Scene::warnings, "What is legal but ambiguous.")
        .def_readonly("resolved", &Scene::resolved,
                      "The scene as JSON on one line, after overrides, as image headers carry it.")
        .def(
            "to_json",
            [](const Scene& scene, const py::object& indent,
               const std::optional<std::filesystem::path>& folder) {
                const std::string text =
                    folder ? scene_document(scene, std::filesystem::absolute(*folder).string())
                           : scene.resolved;
                return json_text(json_value(text), indent);
            },
            py::arg("indent") = 2, py::arg("folder") = py::none(),
            "The resolved scene as JSON text, its files named from `folder`: where the text will lie; None: "
            "from the scene's own.")
        .def(
            "to_dict", [](const Scene& scene) { return json_value(scene.resolved); },
            "The resolved scene as a new dict, which parse_scene takes.")
        .def("__copy__", [](const py::object& self) { return self; })
        .def("__deepcopy__", [](const py::object& self, const py::dict&) { return self; })
        .def(py::pickle(
            [](const Scene& scene) {
                return py::make_tuple(scene.resolved, scene.folder, scene.label, scene.file);
            },
            [](const py::tuple& state) {
                const auto text = [&](std::size_t k) { return state[k].cast<std::string>(); };
                const std::string title = text(3).empty() ? text(2) : text(3);
                const py::cpp_function told_before([](const py::object&) {});
                Scene scene = parse({text(0), text(1), title}, {}, 0, told_before);
                scene.label = text(2), scene.file = text(3);
                return scene;
            }))
        .def(
            "with_overrides",
            [](const Scene& scene, const py::dict& overrides, int resolution, const py::object& warn) {
                Scene changed =
                    parse({scene.resolved, scene.folder, scene_title(scene)}, overrides, resolution, warn);
                changed.file = scene.file;
                changed.label = scene.label;
                return changed;
            },
            py::arg("overrides") = py::dict(), py::arg("resolution") = 0, py::kw_only(),
            py::arg("warn") = py::none(), "The scene with these changes, as a new one; see load_scene.")
        .def(
            "at_frame",
            [](const Scene& scene, double frame, int frames, const std::string& camera) {
                if (!std::isfinite(frame)) throw UsageError("a frame is a finite number");
                if (frames < 0 || frames > kMostFrames || (frames > 0 && std::fabs(frame) > kMostFrames))
                    throw UsageError("a turntable has 1 to " + std::to_string(kMostFrames) +
                                     " frames, or 0: none");
                return frames > 0 ? scene_on_turntable(scene, frame, find_camera(scene, camera), frames)
                                  : scene_at_frame(scene, frame);
            },
            py::arg("frame"), py::kw_only(), py::arg("turntable") = 0, py::arg("camera") = "",
            "The scene at a frame of its animation, as a new one without animation. Values are held before "
            "their\nfirst key and after their last.\n\n"
            "turntable: frames of a whole turn of the camera about what it looks at; 0: it stays.\n"
            "camera: the one that turns; \"\": the scene's own.\n"
            "Raises UsageError for a frame that is not finite, for a camera that does not turn with what it "
            "looks at,\nand for a turn of no or more than 100000 frames, InputError for values that are "
            "none.")
        .def_property_readonly(
            "animation",
            [](const Scene& scene) -> py::object {
                const auto found = find_animation(scene);
                if (!found) return py::none();
                py::dict info;
                info["first"] = found->first;
                info["last"] = found->last;
                info["fps"] = found->fps;
                info["tracks"] = found->tracks;
                return info;
            },
            "A dict of first and last (frames with keys), fps and tracks; None where nothing moves.")
        .def("__repr__", [](const Scene& scene) {
            return "<trilens.Scene '" + scene_title(scene) + "', " + std::to_string(scene.film.width) +
                   " x " + std::to_string(scene.film.height) + ", " + std::to_string(scene.meshes.size()) +
                   " meshes>";
        });
    bind_readers(module);
}

}  // namespace trilens::python
