#include "line_arrays.h"

namespace trilens::python {
namespace {

py::array_t<double> points_array(const std::vector<Vec3>& points) {
    std::vector<double> flat;
    for (const Vec3& p : points) flat.insert(flat.end(), {p.x, p.y, p.z});
    return array_of(std::move(flat), {static_cast<py::ssize_t>(points.size()), 3});
}

}  // namespace

py::list caustic_list(const LineDrawing& drawing) {
    py::list list;
    for (const LineDrawing::Caustic& one : drawing.caustics) {
        py::dict dict;
        dict["path"] = one.path;
        dict["optic"] = one.optic == kNone ? py::object(py::none()) : py::object(py::int_(one.optic));
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

py::list fold_list(const LineDrawing& drawing) {
    py::list list;
    for (const FoldCurve& fold : drawing.fold_curves) {
        py::dict dict;
        dict["object"] = fold.object == kNone ? py::object(py::none()) : py::object(py::int_(fold.object));
        std::vector<double> points;
        for (const Vec2& p : fold.points) points.insert(points.end(), {p.x, p.y});
        dict["points"] = array_of(std::move(points), {static_cast<py::ssize_t>(fold.points.size()), 2});
        dict["places"] = points_array(fold.places);
        list.append(dict);
    }
    return list;
}

}  // namespace trilens::python
