// Rays and what they meet, as two structured arrays: one of rays, one of their meetings with optics.
#include <pybind11/stl.h>

#include "arrays.h"
#include "bindings.h"
#include "python_call.h"
#include "rows.h"

namespace trilens::python {
namespace {

struct RayRow {
    char32_t state[10];
    std::int64_t first_event;
    Id event_count, object, primitive;
    bool cut;
    double origin[3], direction[3], position[3], t, weight[3];
};

struct ShotEventRow {
    std::int64_t ray;
    EventRow event;
};

py::dict ray_type() {
    RecordType type;
    type.add("state", "U10", offsetof(RayRow, state));
    type.add("first_event", "i8", offsetof(RayRow, first_event));
    type.add("event_count", "u4", offsetof(RayRow, event_count));
    type.add("origin", "(3,)f8", offsetof(RayRow, origin));
    type.add("direction", "(3,)f8", offsetof(RayRow, direction));
    type.add("object", "u4", offsetof(RayRow, object));
    type.add("primitive", "u4", offsetof(RayRow, primitive));
    type.add("position", "(3,)f8", offsetof(RayRow, position));
    type.add("t", "f8", offsetof(RayRow, t));
    type.add("weight", "(3,)f8", offsetof(RayRow, weight));
    type.add("cut", "?", offsetof(RayRow, cut));
    return type.of_size(sizeof(RayRow));
}

py::dict event_type() {
    RecordType type;
    type.add("ray", "i8", offsetof(ShotEventRow, ray));
    add_event_fields(type, offsetof(ShotEventRow, event));
    return type.of_size(sizeof(ShotEventRow));
}

RayRow row_of(const ShotRay& ray) {
    auto row = empty_record<RayRow>();
    copy_text(name_of(ray.state), row.state);
    row.first_event = static_cast<std::int64_t>(ray.first_event);
    row.event_count = static_cast<Id>(ray.event_count);
    row.object = ray.object, row.primitive = ray.primitive;
    row.cut = ray.cut;
    copy_vector(ray.origin, row.origin);
    copy_vector(ray.direction, row.direction);
    copy_vector(ray.position, row.position);
    row.t = ray.t;
    copy_vector(ray.weight, row.weight);
    return row;
}

ShotEventRow row_of(const PathEvent& event, std::size_t ray) {
    auto row = empty_record<ShotEventRow>();
    row.ray = static_cast<std::int64_t>(ray);
    fill_event(event, row.event);
    return row;
}

struct ShotRows {
    std::vector<RayRow> rays;
    std::vector<ShotEventRow> events;
};

ShotRows shot_rows(const ShotRays& shots) {
    ShotRows rows;
    rows.rays.reserve(shots.rays.size());
    rows.events.reserve(shots.events.size());
    for (std::size_t i = 0; i < shots.rays.size(); ++i) {
        rows.rays.push_back(row_of(shots.rays[i]));
        for (const PathEvent& event : shots.events_of(shots.rays[i])) rows.events.push_back(row_of(event, i));
    }
    return rows;
}

std::vector<Vec2> places_of(const Doubles& pixels) {
    constexpr py::ssize_t kShape[] = {-1, 2};
    require_shape(pixels, kShape, "pixels");
    const auto at = pixels.unchecked<2>();
    std::vector<Vec2> places;
    for (py::ssize_t i = 0; i < at.shape(0); ++i) places.emplace_back(at(i, 0), at(i, 1));
    return places;
}

std::vector<Ray> rays_of(const Doubles& origins, const Doubles& directions) {
    const std::vector<Vec3> from = points_of(origins, "origins"), along = points_of(directions, "directions");
    if (from.size() != along.size() && from.size() != 1)
        throw UsageError("there are " + std::to_string(from.size()) + " origins for " +
                         std::to_string(along.size()) + " directions");
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < along.size(); ++i) rays.push_back({from[from.size() == 1 ? 0 : i], along[i]});
    return rays;
}

}  // namespace

void bind_shoot(RendererClass& renderer) {
    renderer.def(
        "shoot",
        [](const Renderer& self, const std::optional<Doubles>& pixels,
           const std::optional<std::string>& camera, const std::optional<Doubles>& origins,
           const std::optional<Doubles>& directions, const std::optional<std::string>& path) {
            if (origins.has_value() != directions.has_value() || pixels.has_value() == origins.has_value())
                throw UsageError("shoot needs either pixels, or origins and directions");
            ShootRequest request;
            request.camera = frame_params(self, 0, camera).camera;
            if (path) request.path = EventWord(*path);
            const std::vector<Vec2> places = pixels ? places_of(*pixels) : std::vector<Vec2>();
            const std::vector<Ray> rays = pixels ? std::vector<Ray>() : rays_of(*origins, *directions);
            ShotRows rows = PythonCall().run(
                [&] { return shot_rows(pixels ? self.shoot(places, request) : self.shoot(rays, request)); });
            return py::make_tuple(record_array(ray_type(), std::move(rows.rays)),
                                  record_array(event_type(), std::move(rows.events)));
        },
        py::arg("pixels") = py::none(), py::arg("camera") = py::none(), py::kw_only(),
        py::arg("origins") = py::none(), py::arg("directions") = py::none(), py::arg("path") = py::none(),
        "What rays meet, event by event, on the exact surfaces: of film places, or one's own.\n\n"
        "pixels: (N, 2), from the film's top left; a pixel's centre is at .5.\n"
        "origins, directions: instead, (N, 3) each, world frame; one origin may serve all directions, whose "
        "length does\nnot matter.\n"
        "path: a word of events that each path must have, R reflected, T transmitted, ? either: \"R\", "
        "\"TT\". None: where\nglass parts light, the way that carries more.\n"
        "Returns two structured arrays: (rays, events).\n"
        "rays, (N,):\n"
        "  state        \"seen\": ends at an object; \"escapes\": in the environment; else the other fields "
        "say "
        "nothing:\n"
        "               \"no ray\": the camera has none there; \"other path\": not the word's; \"lost\": in "
        "too "
        "many bodies\n"
        "               of glass at once\n"
        "  first_event, event_count   its meetings with optics: events[first_event : first_event + "
        "event_count]\n"
        "  origin, direction          (3,): the last ray, from the last optic; world frame, the direction "
        "unit\n"
        "  object, primitive          what is seen, numbered as in images; NONE where it escapes\n"
        "  position     (3,): where, world frame\n"
        "  t            from origin to position, scene units\n"
        "  weight       (3,): the share of each colour of the light from there that the path carries\n"
        "  cut          it would meet another optic, but the scene's maxDepth ends it\n"
        "events, (M,), one ray's behind the other's:\n"
        "  ray          index into rays\n"
        "  optic        index into Renderer.optics\n"
        "  event        \"reflect\", \"transmit\" or \"pass\" (where glass has no interface)\n"
        "  front        the path comes to the surface's front\n"
        "  face, uv     (2,): where on the optic's surface, in the face's unit square or triangle\n"
        "  point, normal  (3,): world frame; the normal unit, on the surface's front\n"
        "Raises InputError for numbers that are not finite or directions of no length, UsageError for a "
        "camera or path\nthat is none.");
}

}  // namespace trilens::python
