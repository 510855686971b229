#include "arrays.h"

#include "bindings.h"

namespace trilens::python {
namespace {

std::string shape_text(std::span<const py::ssize_t> shape) {
    std::string text;
    for (const py::ssize_t length : shape)
        text += (text.empty() ? "" : " x ") + (length < 0 ? "N" : std::to_string(length));
    return shape.empty() ? "a number" : text;
}

}  // namespace

void require_shape(const py::array& array, std::span<const py::ssize_t> shape, const std::string& name) {
    const std::span<const py::ssize_t> given(array.shape(), static_cast<std::size_t>(array.ndim()));
    bool fits = given.size() == shape.size();
    for (std::size_t k = 0; fits && k < shape.size(); ++k) fits = shape[k] < 0 || shape[k] == given[k];
    if (!fits) throw UsageError(name + " has the shape " + shape_text(shape) + ", not " + shape_text(given));
}

std::vector<Vec3> points_of(const Doubles& array, const std::string& name) {
    require_shape(array, std::array<py::ssize_t, 2>{-1, 3}, name);
    static_assert(sizeof(Vec3) == 3 * sizeof(double));
    const auto* first = reinterpret_cast<const Vec3*>(array.data());
    return {first, first + array.shape(0)};
}

void refuse_masked(py::handle given) {
    if (!py::hasattr(given, "mask") || !py::hasattr(given, "fill_value")) return;
    if (given.attr("mask").attr("any")().cast<bool>())
        throw UsageError("an array with masked values is given: leave them out, or fill them with filled()");
}

py::array array_from(const py::object& object, const std::string& name) {
    refuse_masked(object);
    py::array array = py::array::ensure(object);
    if (!array) throw py::type_error(name + " is no array");
    return array;
}

std::vector<Id> ids_of(const py::array& array, const std::string& name) {
    const char kind = array.dtype().kind();
    if (array.size() > 0 && kind != 'i' && kind != 'u')
        throw UsageError(name + " holds whole numbers, not values of type " + text_of(array.dtype()));
    const Indices numbers(array);
    std::vector<Id> ids(static_cast<std::size_t>(numbers.size()));
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const std::int64_t number = numbers.data()[i];
        if (number < 0 || number > static_cast<std::int64_t>(kNone))
            throw UsageError(name + " holds " + std::to_string(number) + ", which is no index");
        ids[i] = static_cast<Id>(number);
    }
    return ids;
}

std::vector<IdTriple> triples_of(const py::object& object, const std::string& name) {
    const py::array array = array_from(object, name);
    require_shape(array, std::array<py::ssize_t, 2>{-1, 3}, name);
    const std::vector<Id> ids = ids_of(array, name);
    std::vector<IdTriple> triples(ids.size() / 3);
    for (std::size_t i = 0; i < triples.size(); ++i)
        triples[i] = {ids[3 * i], ids[3 * i + 1], ids[3 * i + 2]};
    return triples;
}

py::array_t<double> constant_view(const std::vector<Vec3>& values, const py::object& owner) {
    return constant_view(reinterpret_cast<const double*>(values.data()),
                         {{static_cast<py::ssize_t>(values.size()), 3}, {sizeof(Vec3), sizeof(double)}},
                         owner);
}

py::array_t<Id> constant_view(const std::vector<IdTriple>& values, const py::object& owner) {
    return constant_view(reinterpret_cast<const Id*>(values.data()),
                         {{static_cast<py::ssize_t>(values.size()), 3}, {sizeof(IdTriple), sizeof(Id)}},
                         owner);
}

namespace {

py::array_t<double> points_array(const std::vector<Vec3>& points) {
    std::vector<double> flat;
    for (const Vec3& p : points) flat.insert(flat.end(), {p.x, p.y, p.z});
    return array_of(std::move(flat), {static_cast<py::ssize_t>(points.size()), 3});
}

py::object id_or_none(Id id) {
    return id == kNone ? py::object(py::none()) : py::object(py::int_(id));
}

py::array pixels_array(const std::vector<Vec2>& places) {
    std::vector<double> numbers;
    for (const Vec2& p : places) numbers.insert(numbers.end(), {p.x, p.y});
    return array_of(std::move(numbers), {static_cast<py::ssize_t>(places.size()), 2});
}

}  // namespace

py::list caustic_list(const LineDrawing& drawing) {
    py::list list;
    for (const LineDrawing::Caustic& one : drawing.caustics) {
        py::dict dict;
        dict["path"] = one.path;
        dict["optic"] = id_or_none(one.optic);
        dict["sheet"] = one.sheet.sheet;
        dict["virtual"] = one.sheet.is_virtual;
        dict["points"] = points_array(one.sheet.points);
        std::vector<Id> triangles, segments;
        for (const IdTriple& t : one.sheet.triangles) triangles.insert(triangles.end(), t.begin(), t.end());
        for (const auto& s : one.sheet.segments) segments.insert(segments.end(), s.begin(), s.end());
        const auto rows = [](const auto& all) { return static_cast<py::ssize_t>(all.size()); };
        dict["triangles"] = array_of(std::move(triangles), {rows(one.sheet.triangles), 3});
        dict["segments"] = array_of(std::move(segments), {rows(one.sheet.segments), 2});
        list.append(dict);
    }
    return list;
}

py::list edge_list(const LineDrawing& drawing) {
    py::list list;
    for (const EdgeLine& edge : drawing.edge_lines) {
        py::dict dict;
        dict["path"] = edge.path;
        dict["optic"] = id_or_none(edge.optic);
        dict["object"] = id_or_none(edge.object);
        dict["points"] = pixels_array(edge.points);
        list.append(dict);
    }
    return list;
}

py::list fold_list(const LineDrawing& drawing) {
    py::list list;
    for (const FoldCurve& fold : drawing.fold_curves) {
        py::dict dict;
        dict["object"] = id_or_none(fold.object);
        dict["points"] = pixels_array(fold.points);
        dict["places"] = points_array(fold.places);
        list.append(dict);
    }
    return list;
}

}  // namespace trilens::python
