// Cameras and RayMeshes of one's own: who looks at triangles, and what is then seen.
#include "arrays.h"

#include <pybind11/stl.h>

#include <limits>
#include <numeric>

#include "python_call.h"

namespace trilens::python {
namespace {

/// Homogeneous screen positions from (C, 3), or from pixels (C, 2) with w = 1.
std::vector<Vec3> screen_of(const Doubles& screen) {
    if (screen.ndim() != 2 || screen.shape(1) != 2) return points_of(screen, "screen");
    std::vector<Vec3> positions;
    for (py::ssize_t i = 0; i < screen.shape(0); ++i)
        positions.emplace_back(screen.at(i, 0), screen.at(i, 1), 1);
    return positions;
}

RayMesh ray_mesh_of(const Doubles& origins, const Doubles& directions, const Doubles& screen,
                    const py::object& facets) {
    const std::vector<Vec3> from = points_of(origins, "origins"), along = points_of(directions, "directions");
    if (from.size() != along.size()) throw UsageError("there are not as many directions as origins");
    RayMesh mesh;
    for (std::size_t i = 0; i < from.size(); ++i) mesh.rays.push_back({from[i], along[i]});
    mesh.screen = screen_of(screen);
    mesh.facets = triples_of(facets, "facets");
    check_ray_mesh(mesh);
    return mesh;
}

/// Origins or directions of a mesh's rays, which lie side by side.
py::array rays_view(const py::object& self, Vec3 Ray::*member) {
    static_assert(sizeof(Ray) == 6 * sizeof(double));
    const RayMesh& mesh = self.cast<const RayMesh&>();
    const double* data =
        mesh.rays.empty() ? nullptr : reinterpret_cast<const double*>(&(mesh.rays.front().*member));
    return constant_view(
        data, {{static_cast<py::ssize_t>(mesh.rays.size()), 3}, {sizeof(Ray), sizeof(double)}}, self);
}

TriangleScene triangles_of(const Doubles& points, const py::object& triangles, const py::object& object,
                           const py::object& primitive) {
    TriangleScene scene;
    scene.points = points_of(points, "points");
    scene.triangles = triples_of(triangles, "triangles");
    scene.object = object.is_none() ? std::vector<Id>(scene.size(), 0) : ids_of(object, "object");
    if (!primitive.is_none()) {
        scene.primitive = ids_of(primitive, "primitive");
    } else {
        scene.primitive.resize(scene.size());
        std::iota(scene.primitive.begin(), scene.primitive.end(), Id{0});
    }
    return scene;
}

/// Of an array with an entry per sample.
std::vector<py::ssize_t> shape_of(const SampleGrid& grid) {
    std::vector<py::ssize_t> shape{grid.height(), grid.width()};
    if (grid.side > 1) shape.insert(shape.end(), 2, grid.side);
    return shape;
}

py::dict hit_arrays(const std::vector<Hit>& hits, const SampleGrid& grid) {
    constexpr double kUnset = std::numeric_limits<double>::quiet_NaN();
    std::vector<Id> triangle;
    std::vector<double> t, barycentric;
    for (const Hit& hit : hits) {
        triangle.push_back(hit.triangle);
        t.push_back(hit.seen() ? hit.t : kUnset);
        barycentric.push_back(hit.seen() ? hit.barycentric.x : kUnset);
        barycentric.push_back(hit.seen() ? hit.barycentric.y : kUnset);
    }
    std::vector<py::ssize_t> shape = shape_of(grid);
    py::dict arrays;
    arrays["triangle"] = array_of(std::move(triangle), shape);
    arrays["t"] = array_of(std::move(t), shape);
    shape.push_back(2);
    arrays["barycentric"] = array_of(std::move(barycentric), shape);
    return arrays;
}

py::dict draw(const RayMesh& mesh, const TriangleScene& scene, const SampleGrid& grid) {
    return hit_arrays(PythonCall().run([&] { return draw_through(mesh, scene, grid); }), grid);
}

py::dict visible_arrays(const std::vector<Visible>& visible, const SampleGrid& grid) {
    std::vector<Id> triangle;
    std::vector<float> low, high;
    for (const Visible& seen : visible) {
        triangle.push_back(seen.triangle);
        low.push_back(seen.t_low);
        high.push_back(seen.t_high);
    }
    const std::vector<py::ssize_t> shape = shape_of(grid);
    py::dict arrays;
    arrays["triangle"] = array_of(std::move(triangle), shape);
    arrays["t_low"] = array_of(std::move(low), shape);
    arrays["t_high"] = array_of(std::move(high), shape);
    return arrays;
}

py::dict image_arrays(const RayMesh& mesh, const Doubles& points) {
    const std::vector<Vec3> given = points_of(points, "points");
    for (std::size_t i = 0; i < given.size(); ++i)
        if (!std::isfinite(given[i].x + given[i].y + given[i].z))
            throw InputError("", "points/" + std::to_string(i), "is not finite");
    const PointImageLists lists = PythonCall().run([&] { return MeshPointImages(mesh).images(given); });
    std::vector<std::int64_t> point;
    std::vector<Id> facet;
    std::vector<double> x, y, t, weights;
    for (std::size_t i = 0; i < given.size(); ++i) {
        for (const MeshPointImage& image : lists.of(i)) {
            point.push_back(static_cast<std::int64_t>(i));
            facet.push_back(image.facet);
            x.push_back(image.screen.x), y.push_back(image.screen.y), t.push_back(image.t);
            for (int k = 0; k < 3; ++k) weights.push_back(image.weights[k]);
        }
    }
    const auto count = static_cast<py::ssize_t>(point.size());
    py::dict arrays;
    arrays["point"] = array_of(std::move(point));
    arrays["x"] = array_of(std::move(x));
    arrays["y"] = array_of(std::move(y));
    arrays["t"] = array_of(std::move(t));
    arrays["facet"] = array_of(std::move(facet));
    arrays["weights"] = array_of(std::move(weights), {count, 3});
    return arrays;
}

void bind_camera(py::module_& module) {
    py::class_<LinearCamera>(module, "LinearCamera", "A perspective or parallel camera, world frame.")
        .def_readonly("parallel", &LinearCamera::parallel, "Whether all rays share one direction.")
        .def_property_readonly("eye", [](const LinearCamera& camera) { return tuple_of(camera.eye); })
        .def_property_readonly(
            "view_direction", [](const LinearCamera& camera) { return tuple_of(camera.view_direction); },
            "Unit: the view axis, which is the direction of parallel rays.")
        .def(
            "project",
            [](const LinearCamera& camera, const Doubles& points) {
                std::vector<double> screen;
                for (const Vec3& point : points_of(points, "points")) {
                    const Vec3 at = screen_from_world(camera, point);
                    screen.insert(screen.end(), {at.x, at.y, at.z});
                }
                return array_of(std::move(screen), {points.shape(0), 3});
            },
            py::arg("points"),
            "points (N, 3) on the screen, homogeneous: (N, 3) of (x w, y w, w), x and y in pixels from the "
            "film's top\n"
            "left, w the depth along the view axis (parallel: 1). w <= 0: not in front of the camera.");
    const PerspectiveParams perspective;
    const auto& look = perspective.look_at;
    module.def(
        "make_perspective",
        [](const Triple& eye, const Triple& at, const Triple& up, double yfov, int width, int height) {
            return make_perspective({{vec3(eye), vec3(at), vec3(up)},
                                     yfov,
                                     static_cast<double>(width),
                                     static_cast<double>(height)});
        },
        py::arg("eye") = tuple_of(look.eye), py::arg("at") = tuple_of(look.at),
        py::arg("up") = tuple_of(look.up), py::arg("yfov") = perspective.yfov_degrees,
        py::arg("width") = static_cast<int>(perspective.width),
        py::arg("height") = static_cast<int>(perspective.height),
        "A pinhole at eye, square pixels. yfov: the whole vertical angle, degrees. width, height: pixels.\n"
        "Raises InputError where this leaves no camera.");
    const OrthographicParams orthographic;
    module.def(
        "make_orthographic",
        [](const Triple& eye, const Triple& at, const Triple& up, double world_height, int width,
           int height) {
            return make_orthographic({{vec3(eye), vec3(at), vec3(up)},
                                      world_height,
                                      static_cast<double>(width),
                                      static_cast<double>(height)});
        },
        py::arg("eye") = tuple_of(look.eye), py::arg("at") = tuple_of(look.at),
        py::arg("up") = tuple_of(look.up), py::arg("world_height") = orthographic.world_height,
        py::arg("width") = static_cast<int>(orthographic.width),
        py::arg("height") = static_cast<int>(orthographic.height),
        "Parallel rays; the film's middle is at eye. world_height: what the film's height covers, scene "
        "units.\n"
        "Raises InputError where this leaves no camera.");
}

void bind_makers(py::module_& module) {
    const py::call_guard<py::gil_scoped_release> released;
    module.def(
        "camera_mesh",
        [](const LinearCamera& camera, double width, double height) {
            return make_camera_mesh(camera, width, height);
        },
        py::arg("camera"), py::arg("width"), py::arg("height"),
        "The film, width x height pixels, as two facets; t is the depth along the view axis. Raises "
        "InputError "
        "for\na film without pixels.");
    module.def(
        "mirror_mesh", make_mirror_mesh, py::arg("grid"), py::arg("camera"), released,
        "What the camera sees in a mirror of this grid; facet f is facet f of the grid, also where the "
        "camera "
        "sees its\nback: leave out those with (corner - eye) . normal > 0 before following rays. Raises "
        "InputError for\n"
        "numbers that are not finite or too large.");
    module.def("lens_mesh", make_lens_mesh, py::arg("grid"), py::arg("camera"), py::arg("ior"), released,
               "What it sees through one interface. ior: the refractive index behind the grid's front over "
               "that before\n"
               "it. Facets that lie partly in total reflection have no rays (NONE). Raises InputError as "
               "mirror_mesh does, "
               "and\nfor an ior that is not positive.");
}

}  // namespace

void bind_ray_mesh(py::module_& module) {
    py::class_<RayMesh>(module, "RayMesh",
                        "A triangle mesh on the screen whose corners carry rays; arrays are views.")
        .def(py::init(&ray_mesh_of), py::arg("origins"), py::arg("directions"), py::arg("screen"),
             py::arg("facets"),
             "origins, directions: (C, 3), world frame; a direction's length is the unit of t.\n"
             "screen: (C, 2) pixels from the film's top left, or homogeneous (C, 3): (x w, y w, w).\n"
             "facets: (F, 3) corners; NONE NONE NONE for a facet without rays.\n"
             "Raises InputError where they do not fit together or hold what is not finite or beyond 1e30, "
             "UsageError\nfor arrays of other shapes.")
        .def_property_readonly("origins",
                               [](const py::object& self) { return rays_view(self, &Ray::origin); })
        .def_property_readonly("directions",
                               [](const py::object& self) { return rays_view(self, &Ray::direction); })
        .def_property_readonly(
            "screen",
            [](const py::object& self) { return constant_view(self.cast<const RayMesh&>().screen, self); },
            "(C, 3), homogeneous: (x w, y w, w), x and y in pixels from the film's top left, w the depth "
            "along "
            "the view\naxis (1 where places are affine).")
        .def_property_readonly(
            "facets",
            [](const py::object& self) { return constant_view(self.cast<const RayMesh&>().facets, self); })
        .def("images", image_arrays, py::arg("points"),
             "Where world points (N, 3) appear: arrays with one entry per image, in the points' order: "
             "point, x, y\n"
             "(pixels), t, facet, weights (n, 3) of the facet's corners. Images lie inside their facets, at "
             "t >= 0. Raises\n"
             "InputError for points that are not finite or beyond 1e30.")
        .def("__repr__", [](const RayMesh& mesh) {
            return "<trilens.RayMesh " + std::to_string(mesh.facets.size()) + " facets>";
        });
    module.def(
        "draw_through",
        [](const RayMesh& mesh, const Doubles& points, const py::object& triangles,
           const std::array<int, 4>& window, int side, const py::object& object,
           const py::object& primitive) {
            return draw(mesh, triangles_of(points, triangles, object, primitive),
                        {window[0], window[1], window[2], window[3], side});
        },
        py::arg("mesh"), py::arg("points"), py::arg("triangles"), py::arg("window"), py::arg("side") = 1,
        py::kw_only(), py::arg("object") = py::none(), py::arg("primitive") = py::none(),
        "The first triangle along the ray of every sample, exact on edges.\n\n"
        "points: (P, 3), world frame. triangles: (T, 3) indices into points.\n"
        "window: (x0, y0, x1, y1) in pixels, x1 and y1 outside. side: every pixel has side x side samples.\n"
        "object, primitive: (T,) ids that settle ties in depth; None: 0, and the triangle's number.\n"
        "Returns arrays (h, w), or (h, w, side, side) for more samples: triangle (uint32, NONE where nothing "
        "is\n"
        "seen), t (in units of the ray's direction) and barycentric (one axis more, of 2: the weights of "
        "the\n"
        "triangle's second and third corner), NaN where nothing is seen.\n"
        "Raises InputError where mesh and triangles do not fit together, and for a window without samples, "
        "with "
        "more\nthan 2147483647 of them, or with more than this machine's memory holds.");
    module.def(
        "visible_through",
        [](const RayMesh& mesh, const Doubles& points, const py::object& triangles,
           const std::array<int, 4>& window, int side, const py::object& object,
           const py::object& primitive) {
            const TriangleScene scene = triangles_of(points, triangles, object, primitive);
            const SampleGrid grid{window[0], window[1], window[2], window[3], side};
            return visible_arrays(PythonCall().run([&] { return visible_through(mesh, scene, grid); }), grid);
        },
        py::arg("mesh"), py::arg("points"), py::arg("triangles"), py::arg("window"), py::arg("side") = 1,
        py::kw_only(), py::arg("object") = py::none(), py::arg("primitive") = py::none(),
        "Which triangle draw_through sees in every sample, but not where on it: less time and memory.\n\n"
        "Arguments and errors as draw_through's. Returns arrays (h, w), or (h, w, side, side) for more "
        "samples:\n"
        "triangle (uint32, NONE where nothing is seen), t_low and t_high (float32): draw_through's t lies "
        "between "
        "them, most\noften a ten-thousandth of it apart; both infinite where nothing is seen.");
    bind_camera(module);
    bind_makers(module);
}

}  // namespace trilens::python
