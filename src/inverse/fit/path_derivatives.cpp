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

/// How far the surfaces of the path move its image, at its fixed places on them.
Vec2 by_surfaces(const FitScene& scene, const ParameterDifference& parameter,
                 std::span<const OpticEvent> events, const PathSensitivity& sensitivity) {
    Vec2 moved(0);
    for (std::size_t i = 0; i < events.size(); ++i) {
        const std::size_t optic = events[i].optic;
        const FitOptic &minus = parameter.minus.optics[optic], &plus = parameter.plus.optics[optic];
        if (is_same(minus, plus)) continue;
        const FitOptic& nominal = scene.optics[optic];
        moved += sensitivity.by_surface(i, point_on(minus, nominal, events[i]),
                                        point_on(plus, nominal, events[i]));
    }
    return moved;
}

/// And the glass along it.
Vec2 by_glass(const ParameterDifference& parameter, std::span<const OpticEvent> events,
              const PathSensitivity& sensitivity) {
    Vec2 moved(0);
    for (std::size_t s = 0; s <= events.size(); ++s) {
        const Id medium = s == 0 ? events[0].before : events[s - 1].after;
        moved +=
            sensitivity.by_index(s, index_of(parameter.plus, medium) - index_of(parameter.minus, medium));
    }
    return moved;
}

/// How the cameras of both sides show a place differently; nothing where one shows it nowhere.
Vec2 shown_change(const ParameterDifference& parameter, const ShownPlace& place, const Vec3& point) {
    const std::optional<Vec2> before = film_pixel(parameter.minus.cameras[place.camera], point, place.pixel),
                              after = film_pixel(parameter.plus.cameras[place.camera], point, place.pixel);
    return before && after ? *after - *before : Vec2(0);
}

/// And the camera: its eye, or the direction of its rays, and what its film shows of the place.
Vec2 by_camera(const ParameterDifference& parameter, const ShownPlace& place, const Vec3& first,
               const PathSensitivity& sensitivity) {
    if (!parameter.moves_camera) return Vec2(0);
    const Vec3 eye = chain_eye(parameter.plus.cameras[place.camera])->place -
                     chain_eye(parameter.minus.cameras[place.camera])->place;
    return shown_change(parameter, place, first) + sensitivity.by_eye(eye);
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
            const Vec2 moved = parameter.moves_camera ? shown_change(parameter, place, point) : Vec2(0);
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
        const Vec2 moved = by_surfaces(scene, parameter, events, sensitivity) +
                           by_glass(parameter, events, sensitivity) +
                           by_camera(parameter, place, points[0].position, sensitivity);
        found.by_parameter.push_back(moved / (2 * parameter.step));
    }
    return found;
}

}  // namespace trilens
