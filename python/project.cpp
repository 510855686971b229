// Where world points appear, as one structured array.
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <type_traits>

#include "arrays.h"
#include "bindings.h"
#include "python_call.h"
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

/// Rows of one length: each an ImageRow, so many EventRow, and two numbers for each parameter.
struct Rows {
    std::size_t steps = 1, parameters = 0;
    ZeroedRecords records;

    std::size_t parameters_at() const { return sizeof(ImageRow) + steps * sizeof(EventRow); }
    std::size_t row_size() const { return parameters_at() + 2 * parameters * sizeof(double); }
};

py::dict row_type(const Rows& rows) {
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
    add_event_fields(step);
    type.add("steps", py::make_tuple(step.of_size(sizeof(EventRow)), py::make_tuple(rows.steps)),
             sizeof(ImageRow));
    if (rows.parameters > 0)
        type.add("by_parameter", py::make_tuple("f8", py::make_tuple(2, rows.parameters)),
                 rows.parameters_at());
    return type.of_size(rows.row_size());
}

void fill_row(const WorldImage& image, ImageRow& row) {
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
}

void fill_row(const WorldImage& image, std::size_t place, EventRow& row) {
    row.optic = row.face = kNone;
    if (place >= image.steps.size()) return;
    if (place < image.events.size()) {
        fill_event(image.events[place], row);
    } else {
        row.optic = image.steps[place].optic;
        copy_text(event_name(image.steps[place].event), row.event);
    }
}

/// Writes rows one behind the other; their numbers of steps and parameters, and how many there are, are
/// known.
class RowWriter {
  public:
    RowWriter(Rows& rows, std::size_t count) : rows_(rows) {
        rows.records = ZeroedRecords(count, rows.row_size());
        next_ = rows.records.data();
    }

    void add(const WorldImage& image, std::size_t point, bool complete) {
        auto& row = next<ImageRow>();
        row.point = static_cast<std::int64_t>(point);
        row.complete = complete;
        fill_row(image, row);
        for (std::size_t i = 0; i < rows_.steps; ++i) fill_row(image, i, next<EventRow>());
        for (int axis = 0; axis < 2; ++axis)
            for (std::size_t k = 0; k < rows_.parameters; ++k)
                next<double>() = k < image.by_parameter.size() ? image.by_parameter[k][axis] : std::nan("");
    }

  private:
    /// All of them are of eights of bytes, and zero.
    template <class Value>
    Value& next() {
        static_assert(sizeof(Value) % 8 == 0 && alignof(Value) <= 8 && std::is_trivial_v<Value>);
        auto* value = reinterpret_cast<Value*>(next_);
        next_ += sizeof(Value);
        return *value;
    }

    Rows& rows_;
    std::byte* next_ = nullptr;
};

Rows rows_of(const std::vector<PointProjection>& points, std::size_t parameters) {
    Rows rows;
    rows.parameters = parameters;
    std::size_t count = 0;
    for (const PointProjection& point : points) {
        count += point.images.size();
        for (const WorldImage& image : point.images) rows.steps = std::max(rows.steps, image.steps.size());
    }
    RowWriter writer(rows, count);
    for (std::size_t p = 0; p < points.size(); ++p)
        for (const WorldImage& image : points[p].images) writer.add(image, p, points[p].complete);
    return rows;
}

/// One row per start; where there is no image it has no place.
Rows rows_of(const std::vector<std::optional<WorldImage>>& images, const std::vector<ImageStart>& starts,
             std::size_t parameters) {
    Rows rows;
    rows.parameters = parameters;
    for (const ImageStart& start : starts) rows.steps = std::max(rows.steps, start.events.size());
    RowWriter writer(rows, images.size());
    for (std::size_t i = 0; i < images.size(); ++i) {
        WorldImage lost;
        lost.pixel = Vec2(std::nan(""));
        lost.off = kUnknownOffset;
        for (const PathEvent& event : starts[i].events) lost.steps.push_back({event.optic, event.event});
        writer.add(images[i] ? *images[i] : lost, starts[i].point, false);
    }
    return rows;
}

/// Throws UsageError for what no call of project can have returned.
void check_images(const py::object& images) {
    const auto has = [](const py::object& type, std::initializer_list<const char*> fields) {
        const py::object names = py::getattr(type, "names", py::none());
        return !names.is_none() && std::all_of(fields.begin(), fields.end(),
                                               [&](const char* field) { return names.contains(field); });
    };
    bool is_such = py::isinstance<py::array>(images) &&
                   py::reinterpret_borrow<py::array>(images).ndim() == 1 &&
                   has(images.attr("dtype"), {"point", "step_count", "steps", "x", "y"});
    if (is_such) {
        const py::object steps = images[py::str("steps")];
        is_such = has(steps.attr("dtype"), {"optic", "face", "front", "event", "uv"}) &&
                  py::reinterpret_borrow<py::array>(steps).ndim() == 2;
    }
    if (!is_such) throw UsageError("start is an array of images that project has returned");
}

/// The paths of images that an earlier call has returned.
std::vector<ImageStart> starts_of(const py::object& images) {
    check_images(images);
    const auto numbers = [](const py::object& field) { return Indices(field); };
    const py::object steps = images["steps"];
    const Indices point = numbers(images["point"]), count = numbers(images["step_count"]),
                  optic = numbers(steps["optic"]), face = numbers(steps["face"]),
                  front = numbers(steps["front"]);
    const Indices reflects = numbers(steps["event"].attr("__eq__")("reflect")),
                  passes = numbers(steps["event"].attr("__eq__")("pass"));
    const Doubles uv = Doubles(py::array_t<double, py::array::c_style | py::array::forcecast>(steps["uv"]));
    const auto wide = static_cast<std::size_t>(optic.ndim() == 2 ? optic.shape(1) : 0);
    const auto coordinates = [&](const char* field) {
        return Doubles(py::array_t<double, py::array::c_style | py::array::forcecast>(images[field]));
    };
    const Doubles x = coordinates("x"), y = coordinates("y");
    std::vector<ImageStart> starts(static_cast<std::size_t>(point.size()));
    for (std::size_t i = 0; i < starts.size(); ++i) {
        starts[i].point = static_cast<std::size_t>(point.data()[i]);
        if (std::isfinite(x.data()[i]) && std::isfinite(y.data()[i]))
            starts[i].pixel = Vec2(x.data()[i], y.data()[i]);
        const auto used =
            std::min(wide, static_cast<std::size_t>(std::max<std::int64_t>(0, count.data()[i])));
        for (std::size_t k = i * wide; k < i * wide + used; ++k) {
            PathEvent& event = starts[i].events.emplace_back();
            event.optic = static_cast<Id>(optic.data()[k]);
            event.face = static_cast<Id>(face.data()[k]);
            event.front = front.data()[k] != 0;
            event.event = reflects.data()[k] != 0 ? Event::kReflect
                          : passes.data()[k] != 0 ? Event::kPass
                                                  : Event::kTransmit;
            event.uv = {uv.data()[2 * k], uv.data()[2 * k + 1]};
        }
    }
    return starts;
}

py::array rows_array(Rows rows) {
    return record_array(row_type(rows), std::move(rows.records));
}

/// What the facets have is all that can be told without refining.
ImageSearch search_of(const std::string& search, bool refine) {
    if (search != "complete" && search != "facets")
        throw UsageError("search is \"complete\" or \"facets\", not \"" + search + "\"");
    return search == "complete" && refine ? ImageSearch::kComplete : ImageSearch::kFacets;
}

}  // namespace

namespace {

/// What project is told.
struct ProjectArguments {
    std::optional<Doubles> points, directions;
    std::optional<py::object> start;
    py::object derivatives;
};

/// True, False, or pointers; returns how many columns these have.
std::size_t set_derivatives(const Renderer& renderer, const py::object& derivatives,
                            ProjectRequest& request) {
    if (py::isinstance<py::bool_>(derivatives)) {
        request.derivatives = derivatives.cast<bool>();
        return 0;
    }
    request.derivatives = true;
    if (py::isinstance<py::str>(derivatives))
        request.parameters = {derivatives.cast<std::string>()};
    else
        request.parameters = derivatives.cast<std::vector<std::string>>();
    return find_numbers(renderer.scene(), request.parameters).size();
}

py::array project(const Renderer& self, const ProjectArguments& given, ProjectRequest request,
                  const py::object& progress) {
    if (given.points.has_value() == given.directions.has_value())
        throw UsageError("project needs either points or directions");
    const std::size_t columns = set_derivatives(self, given.derivatives, request);
    const std::vector<Vec3> places =
        given.points ? points_of(*given.points, "points") : points_of(*given.directions, "directions");
    PythonCall call(progress);
    if (given.start) {
        if (!given.points) throw UsageError("start goes with points");
        const std::vector<ImageStart> starts = starts_of(*given.start);
        return rows_array(
            call.run([&] { return rows_of(self.refine(places, starts, request), starts, columns); }));
    }
    return rows_array(call.run([&] {
        const Progress told = call.progress("project");
        return rows_of(given.points ? self.project(places, request, told)
                                    : self.project_directions(places, request, told),
                       columns);
    }));
}

}  // namespace

void bind_project(RendererClass& renderer) {
    renderer.def(
        "project",
        [](const Renderer& self, const std::optional<Doubles>& points, int resolution,
           const std::optional<std::string>& camera, const std::optional<Doubles>& directions,
           const std::optional<std::string>& path, const std::string& search, bool refine, bool visibility,
           const py::object& derivatives, std::int64_t max_images, double min_weight,
           const std::optional<py::object>& start, const py::object& progress) {
            ProjectRequest request;
            request.frame = frame_params(self, resolution, camera);
            request.frame.facets = FacetUse::kAll;  // an image is in whatever facet it is
            request.search = search_of(search, refine);
            request.refine = refine;
            request.visibility = visibility;
            if (path) request.path = EventWord(*path);
            if (max_images < 0)
                throw UsageError("max_images is 0 or more, not " + std::to_string(max_images));
            request.max_images = static_cast<std::size_t>(max_images);
            request.min_weight = min_weight;
            return project(self, {points, directions, start, derivatives}, request, progress);
        },
        py::arg("points") = py::none(), py::arg("resolution") = 0, py::arg("camera") = py::none(),
        py::kw_only(), py::arg("directions") = py::none(), py::arg("path") = py::none(),
        py::arg("search") = "complete", py::arg("refine") = true, py::arg("visibility") = true,
        py::arg("derivatives") = false, py::arg("max_images") = 0, py::arg("min_weight") = 0.0,
        py::arg("start") = py::none(), py::arg("progress") = py::none(),
        "Where world points appear: directly and over every optic, all images of all points.\n\n"
        "points: (N, 3), world frame.\n"
        "directions: instead, (N, 3): points at infinity, from the scene towards them; of any length.\n"
        "path: a word of events, R reflected, T transmitted, ? either, or D, seen directly: only images of "
        "these events, whatever "
        "the scene's\nmaxDepth; \"R\", \"TT\". None: all, as deep as the scene follows paths.\n"
        "search: \"complete\" looks at every part of the exact surfaces; \"facets\" only near what the "
        "facets show,\n"
        "faster, and may miss images.\n"
        "refine: on the exact surface; False: as the facets have it, which only \"facets\" can say.\n"
        "visibility: ask what hides each image; else visible is False.\n"
        "derivatives: of the pixel with respect to the point, for images over one optic too. A list of JSON "
        "pointers into\nscene.to_json(), to numbers or arrays of them: with respect to these as well, "
        "by_parameter.\n"
        "max_images: of a point, the strongest; 0: all. min_weight: images that carry less in every colour "
        "are "
        "left out.\n"
        "start: images that an earlier call returned: each is moved to where it is now by Newton's method, "
        "without a search;\none entry for each, in their order, x and y nan and refined False where none is "
        "near; complete is then False.\n"
        "With visibility=False nothing but surfaces is built for it.\n"
        "progress: called with (done, \"project\"), done in 0..1; returning False stops.\n"
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
        "  steps           as many as the longest path of all has, behind step_count of them NONE and \"\":\n"
        "    optic, event  which, and what happened there: \"reflect\", \"transmit\" or \"pass\"\n"
        "    front, face, uv (2,), point (3,), normal (3,)  where, as in Renderer.shoot; where refined\n"
        "  by_parameter    (2, C), where derivatives names numbers: pixels per unit of each, in their order, "
        "arrays\n"
        "                  entry by entry; nan where not known\n"
        "Of directions t and length are inf, and derivative is per radian.\n"
        "Raises InputError for points beyond 1e30 or not finite and for pointers that name no number, "
        "UsageError for a\ncamera, resolution, search or path that there is not.");
}

}  // namespace trilens::python
