// Lenses by their prescriptions: what lens files say, first order, Seidel's sums, rays and spots.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "arrays.h"
#include "bindings.h"
#include "python_call.h"

namespace trilens::python {
namespace {

SpectralLine line_of(const std::string& name) {
    return require_named<SpectralLine>("line", name);
}

template <typename T, std::size_t kCount>
py::dict numbers_dict(const T& of, const std::array<NamedNumber<T>, kCount>& numbers) {
    py::dict dict;
    for (const auto& [name, number] : numbers) dict[name] = of.*number;
    return dict;
}

py::dict first_order_dict(const LensPrescription& lens, const std::string& line, const std::string& section) {
    const LensSection plane = require_named<LensSection>("section", section);
    return numbers_dict(first_order(section_of(lens, plane), line_of(line)), kFirstOrderNumbers);
}

py::dict seidel_dict(const LensPrescription& lens, double pupil_radius, double field_slope,
                     const std::string& section) {
    const LensSection plane = require_named<LensSection>("section", section);
    const SeidelSums seidel = seidel_sums(section_of(lens, plane), {pupil_radius, field_slope});
    py::list rows;
    for (const SeidelTerms& row : seidel.rows) rows.append(numbers_dict(row, kSeidelNumbers));
    py::dict dict;
    dict["surfaces"] = rows;
    dict["sum"] = numbers_dict(seidel.sum, kSeidelNumbers);
    dict["image_slope"] = seidel.image_slope;
    dict["image_height"] = seidel.image_height;
    return dict;
}

py::dict spot_dict(const LensPrescription& lens, double pupil_radius, double field, const std::string& line,
                   int rings, double shift) {
    const Spot spot = spot_of(lens, {pupil_radius, field, line_of(line), rings, shift});
    py::list points;
    for (const Vec2& p : spot.points) points.append(py::make_tuple(p.x, p.y));
    py::dict dict;
    dict["points"] = points;
    dict["asked"] = spot.asked;
    dict["centroid"] = py::make_tuple(spot.centroid.x, spot.centroid.y);
    dict["rms_radius"] = spot.rms_radius;
    dict["radius"] = spot.radius;
    return dict;
}

py::object traced(const LensPrescription& lens, const Triple& origin, const Triple& direction,
                  const std::string& line) {
    const std::optional<Ray> ray = trace_lens(lens, {vec3(origin), vec3(direction)}, line_of(line));
    if (!ray) return py::none();
    return py::make_tuple(tuple_of(ray->origin), tuple_of(ray->direction));
}

}  // namespace

void bind_lens(py::module_& module) {
    py::class_<LensPrescription>(module, "Lens",
                                 "A lens by its prescription: surfaces that refract or reflect.")
        .def_readonly("name", &LensPrescription::name, "What its file calls it.")
        .def_property_readonly(
            "surface_count", [](const LensPrescription& lens) { return lens.rows.size(); },
            "Surfaces, the stop among them.")
        .def("first_order", first_order_dict, py::kw_only(), py::arg("line") = "d", py::arg("section") = "y",
             "Paraxial quantities at a spectral line (\"C\", \"d\", \"F\"), in the file's units, of the "
             "section\n"
             "along \"y\" or \"x\" (they differ where biconics and toric sides are):\n"
             "focal_length, back_focal_length, front_focus, front_principal, back_principal,\n"
             "entrance_pupil, exit_pupil (places from the first or last vertex),\n"
             "entrance_radius, exit_radius, f_number, length, petzval_radius.\n"
             "Raises InputError where the section has no focal length.")
        .def("seidel", seidel_dict, py::arg("pupil_radius"), py::arg("field_slope"), py::kw_only(),
             py::arg("section") = "y",
             "Seidel's sums as wavefront aberrations in lengths, object at infinity, of the section along\n"
             "\"y\" or \"x\", the field in it: of each of the\n"
             "surfaces and their sum (spherical, coma, astigmatism, petzval, distortion,\n"
             "axial_colour, lateral_colour), image_slope and image_height.\n"
             "Over twice image_slope they are transverse aberrations.")
        .def("spot", spot_dict, py::kw_only(), py::arg("pupil_radius") = 0.0, py::arg("field") = 0.0,
             py::arg("line") = "d", py::arg("rings") = SpotRequest().rings, py::arg("shift") = 0.0,
             "Where exact rays of a beam from infinity, `field` degrees from the axis in imaging_section,\n"
             "meet the plane `shift` behind the paraxial focus of that section: points, asked (rays sent),\n"
             "centroid, rms_radius, radius (nan where no ray comes through). pupil_radius 0: the stop's.")
        .def("trace", traced, py::arg("origin"), py::arg("direction"), py::kw_only(), py::arg("line") = "d",
             "An exact ray through all surfaces, z along the axis from the first vertex: (origin on the last "
             "surface, unit\n"
             "direction), None where it does not come through.")
        .def_property_readonly("is_round", py::overload_cast<const LensPrescription&>(is_round),
                               "Whether all its sides are of revolution.")
        .def_property_readonly(
            "imaging_section",
            [](const LensPrescription& lens) { return std::string(name_of(imaging_section(lens))); },
            "\"y\", or \"x\" where the lens gathers nothing along y, as a cylinder may.")
        .def_property_readonly("is_centred", is_centred, "Whether nothing is tilted or decentred.")
        .def("__repr__", [](const LensPrescription& lens) {
            return "<trilens.Lens \"" + lens.name + "\" " + std::to_string(lens.rows.size()) + " surfaces>";
        });
    module.def(
        "load_lens",
        [](const std::filesystem::path& file, const std::optional<std::filesystem::path>& glasses) {
            return load_lens(file.string(), glasses ? glasses->string() : "");
        },
        py::arg("file"), py::kw_only(), py::arg("glasses") = py::none(),
        "The lens of a Zemax file (.zmx), a CODE V sequence (.seq), or JSON with surfaces. `glasses`: a\n"
        "catalogue (.agf) whose names come before those that are built in.\n"
        "Raises InputError with the file and the line of what cannot be read.");
    module.def("glass_names", glass_names, "The names of the catalogue of glasses.");
}

}  // namespace trilens::python
