// What a renderer says of itself, and of one pixel, as a dict of the command's form.
#include <pybind11/stl.h>

#include "bindings.h"
#include "python_call.h"

namespace trilens::python {
namespace {

py::dict ray_dict(const Ray& ray) {
    py::dict dict;
    dict["origin"] = tuple_of(ray.origin);
    dict["direction"] = tuple_of(ray.direction);
    return dict;
}

py::object hit_dict(const Renderer& renderer, const Hit& hit) {
    if (!hit.seen()) return py::none();
    const SeenTriangle seen = renderer.seen_triangle(hit);
    py::dict dict;
    dict["object"] = seen.object;
    dict["name"] = renderer.scene().meshes[seen.object].name;
    dict["primitive"] = seen.primitive;
    dict["t"] = hit.t;
    dict["barycentric"] = py::make_tuple(hit.barycentric.x, hit.barycentric.y);
    dict["position"] = tuple_of(seen.position);
    return dict;
}

py::object kind_name(const std::optional<GeneralLinearKind>& kind) {
    return kind ? py::object(py::str(general_linear_kind_name(*kind))) : py::none();
}

py::object end_dict(const Renderer& renderer, const PixelEnd* end) {
    if (!end) return py::none();
    py::dict dict;
    py::list steps;
    for (const Step& step : end->steps) {
        py::dict one;
        one["optic"] = renderer.optics()[step.optic].name;
        one["event"] = event_name(step.event);
        steps.append(one);
    }
    dict["path"] = steps;
    dict["weight"] = tuple_of(end->weight);
    dict["ray"] = ray_dict(end->ray);
    dict["facet_kind"] = kind_name(end->facet_kind);
    dict["sees"] = hit_dict(renderer, end->hit);
    dict["cut"] = end->cut;
    return dict;
}

py::dict explanation_dict(const Renderer& renderer, Engine engine, const PixelExplanation& pixel) {
    py::dict dict;
    dict["pixel"] = py::make_tuple(pixel.x, pixel.y);
    dict["engine"] = engine_name(engine);
    if (pixel.camera_facet != kNone) {
        py::dict camera;
        camera["facet"] = pixel.camera_facet;
        camera["facet_kind"] = kind_name(pixel.camera_kind);
        dict["camera"] = camera;
    }
    dict["ray"] = ray_dict(pixel.ray);
    dict["depth"] = pixel.depth;
    dict["sees"] = hit_dict(renderer, pixel.hit);
    if (pixel.optic != kNone) {
        const OpticInfo optic = renderer.optics()[pixel.optic];
        py::dict shown;
        shown["object"] = optic.object;
        shown["name"] = optic.name;
        shown["facet"] = pixel.facet;
        shown["uv"] = py::make_tuple(pixel.uv.x, pixel.uv.y);
        shown["cos_incident"] = pixel.cos_incident;
        shown["front"] = pixel.front;
        dict["optic"] = shown;
        for (const Path path : {Path::kReflect, Path::kRefract})
            dict[path_name(path)] = end_dict(renderer, pixel.find(path));
        py::list ends;
        for (const PixelEnd& end : pixel.ends) ends.append(end_dict(renderer, &end));
        dict["ends"] = ends;
        dict["method"] = pixel.traced ? "traced" : pixel.level > 0 ? "subdivided" : "projected";
        dict["level"] = pixel.level;
    }
    py::dict colour;
    colour["direct"] = tuple_of(pixel.direct);
    colour["reflect"] = tuple_of(pixel.reflect);
    colour["refract"] = tuple_of(pixel.refract);
    dict["colour"] = colour;
    return dict;
}

}  // namespace

void bind_explain(RendererClass& renderer) {
    renderer.def(
        "explain",
        [](const Renderer& self, int x, int y, int resolution, const std::optional<std::string>& camera,
           const std::string& engine) {
            const PictureRequest request{frame_params(self, resolution, camera), engine_choice(engine), {}};
            const PixelExplanation pixel = PythonCall().run([&] { return self.explain(request, x, y); });
            return explanation_dict(self, request.engine.engine, pixel);
        },
        py::arg("x"), py::arg("y"), py::arg("resolution") = 0, py::arg("camera") = py::none(),
        py::arg("engine") = "exact",
        "How the centre of the pixel (x, y) of the film comes about: every ray, hit and colour behind it, "
        "as\n"
        "`trilens render --pixel` says it. World frame; t in units of the ray's direction.\n"
        "facet_kind: what the corner rays of the camera's or an optic's facet make among the general linear\n"
        "cameras (Yu and McMillan 2004), as FilmCamera.facet_kinds names them; None where no facet was "
        "used.\n"
        "cut: the path would meet another optic, but the scene's maxDepth ends it: what it sees lies "
        "straight "
        "on,\npast that optic, in pictures too. method: \"projected\", \"subdivided\" or \"traced\".\n"
        "engine: \"exact\", \"classic\", \"envmap\", \"planar\", \"limit\" or \"facets\". Raises UsageError "
        "outside of "
        "the\nfilm and for a camera or resolution that there is not, InputError as render does.");
}

void bind_facts(RendererClass& renderer) {
    renderer
        .def_property_readonly(
            "scene", [](const Renderer& self) -> const Scene& { return self.scene(); },
            py::return_value_policy::reference_internal)
        .def_property_readonly("optics", &Renderer::optics, "In scene order.")
        .def_property_readonly("triangle_count", &Renderer::triangle_count, "Of the objects.")
        .def("facet_count", &Renderer::facet_count, py::arg("resolution") = 0,
             "Of the optics' grids; 0: at the scene's resolutions. Raises UsageError for one beyond 1..1024.")
        .def("digest", &Renderer::digest, py::call_guard<py::gil_scoped_release>(),
             "16 hexadecimal digits of what the scene loaded from all its files: equal digests, equal "
             "pictures of\n"
             "equal scenes.");
}

}  // namespace trilens::python
