// The cameras of scenes: exact rays of film places, film places of world points.
#include <cmath>
#include <limits>

#include "arrays.h"

namespace trilens::python {
namespace {

Camera camera_of(const Scene& scene, const std::string& name) {
    const std::size_t index = find_camera(scene, name);
    const FilmSize film{static_cast<double>(scene.film.width), static_cast<double>(scene.film.height)};
    return make_camera(scene.cameras[index], film, {scene.file, "/cameras/" + std::to_string(index)});
}

py::dict rays_at(const Camera& camera, const Doubles& places) {
    if (places.ndim() != 2 || places.shape(1) != 2) throw UsageError("places must be an N x 2 array");
    std::vector<double> origins, directions;
    for (py::ssize_t i = 0; i < places.shape(0); ++i) {
        Ray ray{Vec3(std::numeric_limits<double>::quiet_NaN()),
                Vec3(std::numeric_limits<double>::quiet_NaN())};
        if (const auto found = exact_ray(camera, {places.at(i, 0), places.at(i, 1)})) ray = *found;
        for (int k = 0; k < 3; ++k) origins.push_back(ray.origin[k]), directions.push_back(ray.direction[k]);
    }
    py::dict arrays;
    arrays["origin"] = array_of(std::move(origins), {places.shape(0), 3});
    arrays["direction"] = array_of(std::move(directions), {places.shape(0), 3});
    return arrays;
}

py::dict kinds_of(const Camera& camera) {
    const FacetKinds kinds = facet_kinds(camera);
    py::dict counts;
    for (std::size_t k = 0; k < kGeneralLinearKindCount; ++k)
        if (kinds.of_kind[k] > 0)
            counts[general_linear_kind_name(static_cast<GeneralLinearKind>(k))] = kinds.of_kind[k];
    if (kinds.without > 0) counts["none"] = kinds.without;
    return counts;
}

py::dict images_of(const Camera& camera, const Doubles& points) {
    const std::vector<Vec3> given = points_of(points, "points");
    std::vector<std::int64_t> point;
    std::vector<double> x, y, t;
    for (std::size_t i = 0; i < given.size(); ++i)
        for (const FilmImage& image : film_positions(camera, given[i])) {
            point.push_back(static_cast<std::int64_t>(i));
            x.push_back(image.pixel.x), y.push_back(image.pixel.y), t.push_back(image.t);
        }
    py::dict arrays;
    arrays["point"] = array_of(std::move(point));
    arrays["x"] = array_of(std::move(x));
    arrays["y"] = array_of(std::move(y));
    arrays["t"] = array_of(std::move(t));
    return arrays;
}

}  // namespace

void bind_film_camera(py::module_& module) {
    py::class_<Camera>(module, "FilmCamera",
                       "A scene's camera, of any kind, before its film: exact rays and exact places.")
        .def(py::init(&camera_of), py::arg("scene"), py::arg("camera") = "",
             "camera: its name; \"\": the scene's own. Raises UsageError where there is none of that name, "
             "InputError where\n"
             "its description is none of a camera.")
        .def_property_readonly(
            "is_linear", [](const Camera& camera) { return camera.linear.has_value(); },
            "Whether straight lines stay straight: perspective and parallel cameras.")
        .def_property_readonly(
            "mesh", [](const Camera& camera) { return camera.mesh; },
            "The RayMesh through which the camera draws; of a linear camera it is exact.")
        .def_property_readonly(
            "facet_kinds", &kinds_of,
            "What the mesh's facets are among the general linear cameras of Yu and McMillan (2004), across\n"
            "the view axis: a dict of counts by \"pinhole\", \"orthographic\", \"pushbroom\", "
            "\"crossedSlits\",\n"
            "\"pencil\", \"twistedOrthographic\", \"bilinear\", \"plane\", where there are any, and \"none\" "
            "for\n"
            "facets that are none of them.")
        .def("rays", &rays_at, py::arg("places"),
             "Exact rays of film places (N, 2), in pixels from the top left: a dict of origin and direction "
             "(N, 3);\nNaN where the camera has no ray.")
        .def("project", &images_of, py::arg("points"),
             "Where the film shows world points (N, 3), whatever hides them: a dict of point (which one), x, "
             "y (pixels)\nand t >= 0, between the camera's clipping planes. A point may have several images, "
             "or "
             "none; one that\nlies beyond the film is listed only where it is the only one.");
}

}  // namespace trilens::python
