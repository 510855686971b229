// Where world points appear, as one structured array.
#include <pybind11/stl.h>

#include <algorithm>
#include <cstddef>

#include "arrays.h"
#include "python_call.h"
#include "renderer.h"
#include "rows.h"

namespace trilens::python {
namespace {

/// One image of a point, as numpy sees it; its steps stand behind it.
struct ImageRow {
    std::int64_t point;
    double x, y, t, length;
    double derivative[2][3];
    Id optic, object, facet, step_count;
    char32_t path[7];
    bool inside, visible, refined, complete, has_derivative;
    double off, weight[3];
};

struct StepRow {
    Id optic;
    char32_t event[8];
};

/// Rows of one length: each an ImageRow and so many StepRow.
struct Rows {
    std::size_t steps = 1;
    std::vector<std::byte> bytes;

    std::size_t row_size() const { return sizeof(ImageRow) + steps * sizeof(StepRow); }
};

py::dict row_type(std::size_t steps) {
    RecordType type;
    type.add("point", "i8", offsetof(ImageRow, point));
    type.add("x", "f8", offsetof(ImageRow, x));
    type.add("y", "f8", offsetof(ImageRow, y));
    type.add("t", "f8", offsetof(ImageRow, t));
    type.add("path", "U7", offsetof(ImageRow, path));
    type.add("optic", "u4", offsetof(ImageRow, optic));
    type.add("object", "u4", offsetof(ImageRow, object));
    type.add("facet", "u4", offsetof(ImageRow, facet));
    type.add("length", "f8", offsetof(ImageRow, length));
    type.add("inside", "?", offsetof(ImageRow, inside));
    type.add("visible", "?", offsetof(ImageRow, visible));
    type.add("refined", "?", offsetof(ImageRow, refined));
    type.add("complete", "?", offsetof(ImageRow, complete));
    type.add("off", "f8", offsetof(ImageRow, off));
    type.add("weight", "(3,)f8", offsetof(ImageRow, weight));
    type.add("has_derivative", "?", offsetof(ImageRow, has_derivative));
    type.add("derivative", "(2,3)f8", offsetof(ImageRow, derivative));
    type.add("step_count", "u4", offsetof(ImageRow, step_count));
    RecordType step;
    step.add("optic", "u4", offsetof(StepRow, optic));
    step.add("event", "U8", offsetof(StepRow, event));
    type.add("steps", py::make_tuple(step.of_size(sizeof(StepRow)), py::make_tuple(steps)), sizeof(ImageRow));
    return type.of_size(sizeof(ImageRow) + steps * sizeof(StepRow));
}

ImageRow row_of(const WorldImage& image) {
    auto row = empty_record<ImageRow>();
    row.x = image.pixel.x, row.y = image.pixel.y;
    row.t = image.t, row.length = image.length;
    row.optic = image.optic, row.object = image.object, row.facet = image.facet;
    copy_text(path_name(image.path), row.path);
    row.inside = image.inside, row.visible = image.visible, row.refined = image.refined;
    row.has_derivative = image.has_derivative;
    row.off = image.off;
    copy_vector(image.weight, row.weight);
    for (std::size_t axis = 0; axis < 2; ++axis) copy_vector(image.derivative[axis], row.derivative[axis]);
    row.step_count = static_cast<Id>(image.steps.size());
    return row;
}

StepRow row_of(const Step* step) {
    auto row = empty_record<StepRow>();
    row.optic = step ? step->optic : kNone;
    if (step) copy_text(event_name(step->event), row.event);
    return row;
}

Rows rows_of(const std::vector<PointProjection>& points) {
    Rows rows;
    for (const PointProjection& point : points)
        for (const WorldImage& image : point.images) rows.steps = std::max(rows.steps, image.steps.size());
    const auto append = [&](const auto& row) {
        const std::size_t at = rows.bytes.size();
        rows.bytes.resize(at + sizeof row);
        std::memcpy(rows.bytes.data() + at, &row, sizeof row);
    };
    for (std::size_t p = 0; p < points.size(); ++p)
        for (const WorldImage& image : points[p].images) {
            ImageRow row = row_of(image);
            row.point = static_cast<std::int64_t>(p);
            row.complete = points[p].complete;
            append(row);
            for (std::size_t i = 0; i < rows.steps; ++i)
                append(row_of(i < image.steps.size() ? &image.steps[i] : nullptr));
        }
    return rows;
}

py::array rows_array(const Rows& rows) {
    return record_array(row_type(rows.steps), rows.bytes.data(), rows.bytes.size() / rows.row_size());
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
           const std::optional<std::string>& camera, const std::string& search, bool refine, bool visibility,
           bool derivatives) {
            const std::vector<Vec3> given = points_of(points, "points");
            ProjectRequest request;
            request.frame = frame_params(self, resolution, camera);
            request.search = search_of(search, refine);
            request.refine = refine;
            request.visibility = visibility;
            request.derivatives = derivatives;
            return rows_array(PythonCall().run([&] { return rows_of(self.project(given, request)); }));
        },
        py::arg("points"), py::arg("resolution") = 0, py::arg("camera") = py::none(), py::kw_only(),
        py::arg("search") = "complete", py::arg("refine") = true, py::arg("visibility") = true,
        py::arg("derivatives") = false,
        "Where world points appear: directly and over every optic, all images of all points.\n\n"
        "points: (N, 3), world frame.\n"
        "search: \"complete\" looks at every part of the exact surfaces; \"facets\" only near what the "
        "facets show,\n"
        "faster, and may miss images.\n"
        "refine: on the exact surface; False: as the facets have it, which only \"facets\" can say.\n"
        "visibility: ask what hides each image; else visible is False.\n"
        "derivatives: of the pixel with respect to the point, for images over one optic too.\n"
        "Returns a structured array with one entry per image, in the order of the points:\n"
        "  point    index into points\n"
        "  x, y     pixels from the film's top left; a pixel's centre is at .5\n"
        "  t        along the last ray, in units of its direction (direct: depth along the view axis)\n"
        "  path     \"direct\", \"reflect\" or \"refract\"\n"
        "  optic    index into Renderer.optics; object: its object id; NONE on direct paths\n"
        "  facet    of the optic's grid, or of the mesh of a rayMesh camera; else NONE on direct paths\n"
        "  length   of the last ray up to the point, scene units\n"
        "  inside   on the film\n"
        "  visible  nothing lies between\n"
        "  refined  on the exact surface\n"
        "  off      pixels that it may lie from the exact image: 0 where refined, inf where not known\n"
        "  complete no image of this point is missing from the list, which is proven\n"
        "  derivative      (2, 3): how x and y move with the point, pixels per scene unit; set where\n"
        "  has_derivative\n"
        "  step_count      meetings with optics\n"
        "  steps           which optic, and what happened there: \"reflect\", \"transmit\" or \"pass\"; as "
        "many "
        "as the\n"
        "                  longest path of all has, behind step_count of them NONE and \"\"\n"
        "Raises InputError for points that are not finite, UsageError for a camera, resolution or search "
        "that "
        "there\nis not.");
}

}  // namespace trilens::python
