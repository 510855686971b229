#include "inverse/fit/fit_problem.h"
#include "render/frame/image_chain.h"
#include "specular/chain/path_chain.h"

namespace trilens {
namespace {

PathChain chain_of(const FitScene& scene, std::size_t camera, std::span<const OpticEvent> events,
                   const Vec3& point) {
    PathChain chain;
    chain.eye = *chain_eye(scene.cameras[camera]);
    chain.point = {point, false};
    for (const OpticEvent& event : events)
        chain.events.push_back(
            {nullptr, index_of(scene, event.before), index_of(scene, event.after), event.reflects});
    return chain;
}

bool is_same(const FitOptic& a, const FitOptic& b) {
    return a.surface == b.surface && !b.is_moved == !a.is_moved && a.moved.linear == b.moved.linear &&
           a.moved.translation == b.moved.translation;
}

SurfacePoint point_on(const FitOptic& optic, const FitOptic& nominal, const OpticEvent& event) {
    return moved_point(
        optic, optic.surface == nominal.surface ? event.as_built : optic.surface->eval(event.face, event.uv));
}

/// A path at its fixed places on the surfaces of a scene.
struct FixedPath {
    std::vector<SurfacePoint> points;
    PerEvent<Vec2> law;
};

/// With the surfaces, the glass and the camera that `moved` has.
FixedPath fixed_path(const FitScene& scene, const FitScene& moved, const ShownPlace& place,
                     std::span<const OpticEvent> events, const Vec3& point) {
    FixedPath path;
    for (const OpticEvent& event : events)
        path.points.push_back(is_same(moved.optics[event.optic], scene.optics[event.optic])
                                  ? event.point
                                  : point_on(moved.optics[event.optic], scene.optics[event.optic], event));
    path.law = chain_law(chain_bend(chain_of(moved, place.camera, events, point), path.points), path.points);
    return path;
}

bool touches(const ParameterDifference& parameter, std::span<const OpticEvent> events) {
    if (parameter.moves_camera) return true;
    for (const OpticEvent& event : events) {
        if (!is_same(parameter.minus.optics[event.optic], parameter.plus.optics[event.optic])) return true;
        for (const Id medium : {event.before, event.after})
            if (index_of(parameter.minus, medium) != index_of(parameter.plus, medium)) return true;
    }
    return false;
}

/// How the cameras of both sides show two places of theirs differently; nothing where one shows none.
Vec2 shown_change(const ParameterDifference& parameter, const ShownPlace& place, const Vec3& low,
                  const Vec3& high) {
    const std::optional<Vec2> before = film_pixel(parameter.minus.cameras[place.camera], low, place.pixel),
                              after = film_pixel(parameter.plus.cameras[place.camera], high, place.pixel);
    return before && after ? *after - *before : Vec2(0);
}

}  // namespace

std::optional<PathDerivatives> path_derivatives(const FitScene& scene, const ShownPlace& place,
                                                std::span<const OpticEvent> events, const Vec3& point,
                                                std::span<const ParameterDifference> parameters) {
    const Camera& camera = scene.cameras[place.camera];
    const std::optional<FilmPlace> film =
        film_place(camera, events.empty() ? point : events[0].point.position, place.pixel);
    if (!film) return std::nullopt;
    PathDerivatives found;
    if (events.empty()) {
        found.by_point = film->slope;
        for (const ParameterDifference& parameter : parameters) {
            const Vec2 moved =
                parameter.moves_camera ? shown_change(parameter, place, point, point) : Vec2(0);
            found.by_parameter.push_back(moved / (2 * parameter.step));
        }
        return found;
    }
    std::vector<SurfacePoint> points;
    for (const OpticEvent& event : events) points.push_back(event.point);
    const PathSensitivity sensitivity(chain_of(scene, place.camera, events, point), points, film->slope);
    if (!sensitivity.is_regular()) return std::nullopt;
    found.by_point = sensitivity.by_point();
    for (const ParameterDifference& parameter : parameters) {
        if (!touches(parameter, events)) {
            found.by_parameter.emplace_back(0);
            continue;
        }
        const FixedPath low = fixed_path(scene, parameter.minus, place, events, point),
                        high = fixed_path(scene, parameter.plus, place, events, point);
        const Vec3 &from = low.points[0].position, &to = high.points[0].position;
        const Vec2 change = parameter.moves_camera
                                ? shown_change(parameter, place, from, to)
                                : Vec2(dot(film->slope[0], to - from), dot(film->slope[1], to - from));
        PerEvent<Vec2> law = high.law;
        for (std::size_t i = 0; i < law.size(); ++i) law[i] -= low.law[i];
        found.by_parameter.push_back(sensitivity.moved(change, law) / (2 * parameter.step));
    }
    return found;
}

}  // namespace trilens
