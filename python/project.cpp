// Where world points appear, as one structured array.
#include <pybind11/stl.h>

#include <cstddef>
#include <cstring>

#include "arrays.h"
#include "renderer.h"
#include "talk.h"

namespace trilens::python {
namespace {

/// One image of a point, as numpy sees it.
struct ImageRow {
    std::int64_t point;
    double x, y, t, length;
    Id optic, object, facet;
    char32_t path[7];
    bool inside, visible, refined, complete;
};

py::object row_type() {
    py::list names, formats, offsets;
    const auto add = [&](const char* name, const char* format, std::size_t offset) {
        names.append(name);
        formats.append(format);
        offsets.append(offset);
    };
    add("point", "i8", offsetof(ImageRow, point));
    add("x", "f8", offsetof(ImageRow, x));
    add("y", "f8", offsetof(ImageRow, y));
    add("t", "f8", offsetof(ImageRow, t));
    add("path", "U7", offsetof(ImageRow, path));
    add("optic", "u4", offsetof(ImageRow, optic));
    add("object", "u4", offsetof(ImageRow, object));
    add("facet", "u4", offsetof(ImageRow, facet));
    add("length", "f8", offsetof(ImageRow, length));
    add("inside", "?", offsetof(ImageRow, inside));
    add("visible", "?", offsetof(ImageRow, visible));
    add("refined", "?", offsetof(ImageRow, refined));
    add("complete", "?", offsetof(ImageRow, complete));
    py::dict type;
    type["names"] = names;
    type["formats"] = formats;
    type["offsets"] = offsets;
    type["itemsize"] = sizeof(ImageRow);
    return type;
}

std::vector<ImageRow> rows_of(const std::vector<PointProjection>& points) {
    std::vector<ImageRow> rows;
    for (std::size_t p = 0; p < points.size(); ++p) {
        for (const WorldImage& image : points[p].images) {
            ImageRow row;
            std::memset(&row, 0, sizeof row);  // the gaps too: equal images, equal bytes
            row.point = static_cast<std::int64_t>(p);
            row.x = image.pixel.x, row.y = image.pixel.y;
            row.t = image.t, row.length = image.length;
            row.optic = image.optic, row.object = image.object, row.facet = image.facet;
            const std::string_view path = path_name(image.path);
            std::copy(path.begin(), path.end(), row.path);
            row.inside = image.inside, row.visible = image.visible, row.refined = image.refined;
            row.complete = points[p].complete;
            rows.push_back(row);
        }
    }
    return rows;
}

/// What the facets have is all that can be told without refining.
ImageSearch search_of(const std::string& search, bool refine) {
    if (search != "complete" && search != "facets")
        throw UsageError("search is \"complete\" or \"facets\", not \"" + search + "\"");
    return search == "complete" && refine ? ImageSearch::kComplete : ImageSearch::kFacets;
}

}  // namespace

void bind_project(RendererClass& renderer) {
    renderer.def(
        "project",
        [](const Renderer& self, const Doubles& points, int resolution,
           const std::optional<std::string>& camera, const std::string& search, bool refine,
           bool visibility) {
            const std::vector<Vec3> given = points_of(points, "points");
            ProjectRequest request;
            request.frame = frame_params(self, resolution, camera);
            request.search = search_of(search, refine);
            request.refine = refine;
            request.visibility = visibility;
            return records_of(Talk().run([&] { return rows_of(self.project(given, request)); }), row_type());
        },
        py::arg("points"), py::arg("resolution") = 0, py::arg("camera") = py::none(), py::kw_only(),
        py::arg("search") = "complete", py::arg("refine") = true, py::arg("visibility") = true,
        "Where world points appear: directly and over every optic, all images of all points.\n\n"
        "points: (N, 3), world frame.\n"
        "search: \"complete\" looks at every part of the exact surfaces; \"facets\" only near what the "
        "facets show,\n"
        "faster, and may miss images.\n"
        "refine: on the exact surface; False: as the facets have it, which only \"facets\" can say.\n"
        "visibility: ask what hides each image; else visible is False.\n"
        "Returns a structured array with one entry per image, in the order of the points:\n"
        "  point    index into points\n"
        "  x, y     pixels from the film's top left; a pixel's centre is at .5\n"
        "  t        along the last ray, in units of its direction (direct: depth along the view axis)\n"
        "  path     \"direct\", \"reflect\" or \"refract\"\n"
        "  optic    index into Renderer.optics; object: its object id; NONE on direct paths\n"
        "  facet    of the optic's grid; NONE on direct paths\n"
        "  length   of the last ray up to the point, scene units\n"
        "  inside   on the film\n"
        "  visible  nothing lies between\n"
        "  refined  on the exact surface\n"
        "  complete no image of this point is missing from the list, which is proven\n"
        "Raises InputError for points that are not finite.");
}

}  // namespace trilens::python
