// Curved surfaces: limit surfaces of cages and exact primitives, in bulk.
#include "arrays.h"

#include <pybind11/stl.h>

#include <variant>

#include "python_call.h"

namespace trilens::python {
namespace {

using SurfacePointer = std::shared_ptr<Surface>;
using Faces = std::vector<std::vector<int>>;
using Creases = std::vector<std::pair<std::vector<int>, double>>;
using Corners = std::vector<std::pair<int, double>>;

SubdivisionScheme scheme_of(const std::string& name) {
    return require_named<SubdivisionScheme>("scheme", name);
}

InterpolateBoundary boundary_of(const std::string& name) {
    return require_named<InterpolateBoundary>("interpolate_boundary", name);
}

void add_faces(Cage& cage, const Faces& faces) {
    for (const std::vector<int>& face : faces) {
        cage.face_vertex_counts.push_back(static_cast<int>(face.size()));
        cage.face_vertex_indices.insert(cage.face_vertex_indices.end(), face.begin(), face.end());
    }
}

void add_sharpness(Cage& cage, const Creases& creases, const Corners& corners) {
    for (const auto& [chain, sharpness] : creases) {
        cage.crease_lengths.push_back(static_cast<int>(chain.size()));
        cage.crease_indices.insert(cage.crease_indices.end(), chain.begin(), chain.end());
        cage.crease_sharpnesses.push_back(sharpness);
    }
    for (const auto& [vertex, sharpness] : corners) {
        cage.corner_indices.push_back(vertex);
        cage.corner_sharpnesses.push_back(sharpness);
    }
}

/// One vector of every point, as an N x 3 array.
py::array vectors_of(const std::vector<SurfacePoint>& points, Vec3 SurfacePoint::*member) {
    std::vector<double> numbers;
    numbers.reserve(3 * points.size());
    for (const SurfacePoint& point : points)
        for (int k = 0; k < 3; ++k) numbers.push_back((point.*member)[k]);
    return array_of(std::move(numbers), {static_cast<py::ssize_t>(points.size()), 3});
}

py::dict eval(const Surface& surface, const py::object& face, const Doubles& uv) {
    require_shape(uv, std::array<py::ssize_t, 2>{-1, 2}, "uv");
    const auto count = static_cast<std::size_t>(uv.shape(0));
    std::vector<Id> faces = ids_of(face, "face");
    if (array_from(face, "face").ndim() == 0) faces.assign(count, faces[0]);
    if (faces.size() != count) throw UsageError("face is one face, or one for each uv");
    const double* numbers = uv.data();
    for (std::size_t i = 0; i < count; ++i) {
        if (faces[i] >= surface.face_count())
            throw UsageError("there is no face " + std::to_string(faces[i]) + "; the surface has " +
                             std::to_string(surface.face_count()));
        if (!std::isfinite(numbers[2 * i]) || !std::isfinite(numbers[2 * i + 1]))
            throw InputError("", "uv/" + std::to_string(i), "is not finite");
    }
    const std::vector<SurfacePoint> points = PythonCall().run([&] {
        std::vector<SurfacePoint> found(count);
        for (std::size_t i = 0; i < count; ++i)
            found[i] = surface.eval(faces[i], {numbers[2 * i], numbers[2 * i + 1]});
        return found;
    });
    py::dict arrays;
    arrays["position"] = vectors_of(points, &SurfacePoint::position);
    arrays["du"] = vectors_of(points, &SurfacePoint::du);
    arrays["dv"] = vectors_of(points, &SurfacePoint::dv);
    arrays["duu"] = vectors_of(points, &SurfacePoint::duu);
    arrays["duv"] = vectors_of(points, &SurfacePoint::duv);
    arrays["dvv"] = vectors_of(points, &SurfacePoint::dvv);
    arrays["normal"] = vectors_of(points, &SurfacePoint::normal);
    return arrays;
}

const char* domain_name(const Surface& surface, Id face) {
    if (face >= surface.face_count()) throw UsageError("there is no face " + std::to_string(face));
    return surface.domain(face) == FaceDomain::kSquare ? "square" : "triangle";
}

/// What the maker takes, of whatever kind.
struct Lengths {
    double radius, focal_length, height;
    Vec2 size;
    LensPrimitive lens;
};

/// (radius, aperture, conic, coefficients of r^2, r^4, ...), the last two may be left out, the coefficients
/// one after the other or as a sequence of their own; or as scenes have it.
using Side = std::variant<py::dict, std::vector<std::variant<double, std::vector<double>>>>;

/// All numbers in a row. Throws UsageError for a sequence in another place than the coefficients'.
std::vector<double> numbers_of_side(const Side& given, const char* name) {
    std::vector<double> numbers;
    const auto& parts = std::get<std::vector<std::variant<double, std::vector<double>>>>(given);
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const auto* const list = std::get_if<std::vector<double>>(&parts[i]);
        if (!list) {
            numbers.push_back(std::get<double>(parts[i]));
            continue;
        }
        if (i != 3 || parts.size() > 4)
            throw UsageError(
                std::string(name) +
                " is (radius, aperture, conic, coefficients): numbers, and at its end a sequence");
        numbers.insert(numbers.end(), list->begin(), list->end());
    }
    return numbers;
}

LensSide lens_side(const Side& given, const char* name) {
    if (const auto* const keys = std::get_if<py::dict>(&given))
        return parse_lens_side(json_text(*keys, py::none(), {name}), name);
    const std::vector<double> numbers = numbers_of_side(given, name);
    if (numbers.size() < 2 || numbers.size() > 3 + kAsphereTerms)
        throw UsageError(std::string(name) + " is (radius, aperture), then conic and up to " +
                         std::to_string(kAsphereTerms) + " coefficients");
    LensSide side;
    side.curvature = numbers[0] == 0 ? 0 : 1 / numbers[0];
    side.aperture = numbers[1];
    if (numbers.size() > 2) side.conic = numbers[2];
    for (std::size_t i = 3; i < numbers.size(); ++i) side.coefficients[i - 3] = numbers[i];
    return side;
}

PrimitiveKind primitive_kind(const std::string& type, const Lengths& of) {
    const std::vector<PrimitiveKind> kinds{SpherePrimitive{of.radius},
                                           ParaboloidPrimitive{of.radius, of.focal_length},
                                           CylinderPrimitive{of.radius, of.height},
                                           ConePrimitive{of.radius, of.height},
                                           PlanePrimitive{of.size},
                                           of.lens};
    std::vector<std::string> names;
    for (const PrimitiveKind& kind : kinds) {
        names.emplace_back(std::visit([](const auto& one) { return one.kName; }, kind));
        if (names.back() == type) return kind;
    }
    require_known("primitive", type, names);
    return {};
}

void bind_grid(py::module_& module) {
    const auto view = [](auto member) {
        return [member](const py::object& self) {
            return constant_view(self.cast<const SurfaceGrid&>().*member, self);
        };
    };
    py::class_<SurfaceGrid>(module, "SurfaceGrid",
                            "Facets whose corners lie on a surface. The arrays are views, without a copy.")
        .def_property_readonly("points", view(&SurfaceGrid::points), "(P, 3): on the surface, world frame.")
        .def_property_readonly("corner_point", view(&SurfaceGrid::corner_point), "(C,): index into points.")
        .def_property_readonly("corner_normal", view(&SurfaceGrid::corner_normal),
                               "(C, 3): unit; zero where the surface has none.")
        .def_property_readonly("facets", view(&SurfaceGrid::facets),
                               "(F, 3): corners, counter-clockwise seen from the front.")
        .def_property_readonly("facet_face", view(&SurfaceGrid::facet_face), "(F,): face of the surface.")
        .def_property_readonly(
            "facet_uv",
            [](const py::object& self) {
                const auto& uv = self.cast<const SurfaceGrid&>().facet_uv;
                return constant_view(reinterpret_cast<const double*>(uv.data()),
                                     {{static_cast<py::ssize_t>(uv.size()), 3, 2},
                                      {6 * sizeof(double), 2 * sizeof(double), sizeof(double)}},
                                     self);
            },
            "(F, 3, 2): (u, v) of the facets' corners in that face.")
        .def("__repr__", [](const SurfaceGrid& grid) {
            return "<trilens.SurfaceGrid " + std::to_string(grid.facets.size()) + " facets>";
        });
}

void bind_surface_makers(py::module_& module) {
    module.def(
        "limit_surface",
        [](const Doubles& points, const Faces& faces, const Creases& creases, const Corners& corners,
           const std::vector<int>& holes, const std::string& scheme, const std::string& interpolate_boundary,
           const std::string& name, const py::object& warn) {
            Cage cage;
            cage.points = points_of(points, "points");
            cage.scheme = scheme_of(scheme);
            cage.interpolate_boundary = boundary_of(interpolate_boundary);
            cage.hole_indices = holes;
            add_faces(cage, faces);
            add_sharpness(cage, creases, corners);
            PythonCall call(py::none(), warn);
            return call.run([&]() -> SurfacePointer { return make_surface(cage, name, call.warner()); });
        },
        py::arg("points"), py::arg("faces"), py::kw_only(), py::arg("creases") = Creases(),
        py::arg("corners") = Corners(), py::arg("holes") = std::vector<int>(),
        py::arg("scheme") = "catmullClark", py::arg("interpolate_boundary") = "edgeAndCorner",
        py::arg("name") = "cage", py::arg("warn") = py::none(),
        "The limit surface of a cage, in the cage's frame: one face per quad, one per corner of other "
        "polygons\n"
        "(loop: one per triangle).\n\n"
        "points: (P, 3). faces: lists of indices into points, counter-clockwise from the front.\n"
        "creases: pairs (chain of indices, sharpness); corners: pairs (index, sharpness); 10 and more is "
        "infinite.\n"
        "holes: faces that are not there. scheme: \"catmullClark\", \"loop\" or \"bilinear\".\n"
        "interpolate_boundary: \"none\", \"edgeOnly\" or \"edgeAndCorner\". name: stands in messages.\n"
        "Raises InputError where the cage has no limit surface.");
    const Primitive unit;
    module.def(
        "primitive_surface",
        [](const std::string& type, const Triple& center, const Triple& axis, const Triple& tangent,
           double radius, double focal_length, double height, const std::array<double, 2>& size,
           double thickness, const Side& front, const Side& back, double hole) {
            const LensPrimitive lens{thickness, lens_side(front, "front"), lens_side(back, "back"), hole};
            const Lengths lengths{radius, focal_length, height, {size[0], size[1]}, lens};
            return SurfacePointer(
                make_surface({vec3(center), vec3(axis), vec3(tangent), primitive_kind(type, lengths)}));
        },
        py::arg("type"), py::kw_only(), py::arg("center") = tuple_of(unit.center),
        py::arg("axis") = tuple_of(unit.axis), py::arg("tangent") = tuple_of(unit.tangent),
        py::arg("radius") = SpherePrimitive().radius,
        py::arg("focal_length") = ParaboloidPrimitive().focal_length,
        py::arg("height") = CylinderPrimitive().height,
        py::arg("size") = py::make_tuple(PlanePrimitive().size.x, PlanePrimitive().size.y),
        py::arg("thickness") = LensPrimitive().thickness, py::arg("front") = py::make_tuple(0.0, 1.0),
        py::arg("back") = py::make_tuple(0.0, 1.0), py::arg("hole") = LensPrimitive().hole,
        "The exact surface of a \"sphere\", \"paraboloid\", \"cylinder\", \"cone\", \"plane\" or \"lens\", "
        "world frame and units.\n\n"
        "center: of sphere, cylinder and plane, of the cone's base; the paraboloid's apex. axis: from the "
        "apex to the\n"
        "focus, along the cylinder, from the cone's base to its apex, or the plane's normal. tangent: where "
        "u begins.\n"
        "radius: of sphere and cylinder, of the cone's base, of the paraboloid's rim. focal_length: apex to "
        "focus.\n"
        "height: the cylinder's or the cone's. size: the plane's sides. thickness, front, back: the lens', "
        "whose\n"
        "center is its front's vertex; a side is (radius, aperture, conic, coefficients of r^2, r^4, ...), "
        "radius 0 flat,\n"
        "or a dict with the keys of scenes: radius, aperture, conic, coefficients, normalDepartures, qcon, "
        "qbfs,\n"
        "normalizationRadius, radiusX, conicX, rotationRadius, profileAlong.\n"
        "hole: radius of a hole along the lens' axis.\n"
        "Raises InputError for sizes that are not positive and for dicts that are no sides.");
}

}  // namespace

void bind_surface(py::module_& module) {
    bind_grid(module);
    py::class_<Surface, SurfacePointer>(module, "Surface", "A surface of numbered faces.")
        .def_property_readonly("face_count", &Surface::face_count)
        .def("domain", domain_name, py::arg("face"),
             "\"square\": (u, v) in 0..1; \"triangle\": u >= 0, v >= 0, u + v <= 1.")
        .def("eval", eval, py::arg("face"), py::arg("uv"),
             "Positions and derivatives at parameters, exact, in bulk.\n\n"
             "face: one face, or (N,). uv: (N, 2); outside of the domain they are clamped to it.\n"
             "Returns (N, 3) arrays: position, du, dv, duu, duv, dvv, and normal (unit; zero where there is "
             "none).")
        .def(
            "grid",
            [](const Surface& surface, int n) {
                return PythonCall().run([&] { return make_surface_grid(surface, n); });
            },
            py::arg("n"),
            "n x n squares of two facets on each face of four sides, n^2 facets on each triangular one; n in "
            "1..1024.");
    bind_surface_makers(module);
}

}  // namespace trilens::python
