#include "inverse/fit/fit_problem.h"

#include <cmath>
#include <limits>

namespace trilens {
namespace {

using Tangents = std::array<Vec3, 2>;  // dP/du, dP/dv

/// One leg between two places: unit direction e and H = n / length (1 - e e^T); H = 0 from a parallel
/// camera.
struct PathLeg {
    Vec3 direction{0};
    double index = 1, over_length = 0;  // index / length

    Vec3 turn(const Vec3& v) const { return over_length * (v - dot(direction, v) * direction); }
};

bool is_parallel(const Camera& camera) {
    return camera.linear && camera.linear->parallel;
}

Vec3 eye_of(const Camera& camera) {
    return camera.linear ? camera.linear->eye : *camera.model->eye();
}

std::vector<PathLeg> path_legs(const FitScene& scene, const Camera& camera,
                               std::span<const OpticEvent> events, const Vec3& point) {
    std::vector<PathLeg> all;
    const auto place = [&](std::size_t i) { return i < events.size() ? events[i].point.position : point; };
    for (std::size_t i = 0; i <= events.size(); ++i) {
        PathLeg stretch;
        stretch.index = index_of(scene, i < events.size() ? events[i].before : events[i - 1].after);
        if (i == 0 && is_parallel(camera)) {
            stretch.direction = normalize(camera.linear->view_direction);
        } else {
            const Vec3 way = place(i) - (i == 0 ? eye_of(camera) : place(i - 1));
            stretch.direction = normalize(way);
            stretch.over_length = stretch.index / length(way);
        }
        all.push_back(stretch);
    }
    return all;
}

Tangents tangents(const SurfacePoint& point) {
    return {point.du, point.dv};
}

Vec2 along(const Tangents& t, const Vec3& v) {
    return {dot(t[0], v), dot(t[1], v)};
}

/// T^T M S for a symmetric map M of vectors.
template <typename Map>
Mat2 form(const Tangents& t, const Map& map, const Tangents& s) {
    Mat2 result;
    for (int c = 0; c < 2; ++c) {
        const Vec2 column = along(t, map(s[static_cast<std::size_t>(c)]));
        result[c] = column;
    }
    return result;
}

/// Solves A Z = (first, 0, ..., 0) for a block tridiagonal A = A^T, by block elimination from the last event
/// to the first (Thomas). None where a pivot is singular.
std::optional<std::vector<Mat2>> solve_from_first(const std::vector<Mat2>& diagonal,
                                                  const std::vector<Mat2>& upper, const Mat2& first) {
    const std::size_t k = diagonal.size();
    std::vector<Mat2> pivot = diagonal;
    for (std::size_t i = k; i-- > 0;) {
        if (i + 1 < k) pivot[i] -= upper[i] * glm::inverse(pivot[i + 1]) * glm::transpose(upper[i]);
        const double size =
            std::abs(pivot[i][0][0] * pivot[i][1][1]) + std::abs(pivot[i][0][1] * pivot[i][1][0]);
        if (!(std::abs(glm::determinant(pivot[i])) > 1e-12 * size)) return std::nullopt;
    }
    std::vector<Mat2> z(k);
    z[0] = glm::inverse(pivot[0]) * first;
    for (std::size_t i = 1; i < k; ++i)
        z[i] = -(glm::inverse(pivot[i]) * glm::transpose(upper[i - 1]) * z[i - 1]);
    return z;
}

/// How the camera's place of a world point moves with the point; rows x and y.
std::optional<std::array<Vec3, 2>> place_gradient(const Camera& camera, const Vec3& point, const Vec2& near) {
    std::array<Vec3, 2> rows{};
    if (camera.linear) {
        const LinearCamera& linear = *camera.linear;
        const Vec3 screen = screen_from_world(linear, point);
        if (!(screen.z > 0)) return std::nullopt;
        const Vec3 w(linear.screen_w);
        rows[0] = (Vec3(linear.screen_x) - screen.x / screen.z * w) / screen.z;
        rows[1] = (Vec3(linear.screen_y) - screen.y / screen.z * w) / screen.z;
        return rows;
    }
    const double step = 1e-5 * length(point - eye_of(camera));
    for (int k = 0; k < 3; ++k) {
        Vec3 by(0);
        by[k] = step;
        const std::optional<Vec2> low = pixel_of_point(camera, point - by, near),
                                  high = pixel_of_point(camera, point + by, near);
        if (!low || !high) return std::nullopt;
        rows[0][k] = (high->x - low->x) / (2 * step);
        rows[1][k] = (high->y - low->y) / (2 * step);
    }
    return rows;
}

/// How a place of a surface and its tangents move with a parameter.
struct PlaceDifference {
    Vec3 place{0};
    Tangents tangents{Vec3(0), Vec3(0)};
    bool is_none = true;
};

bool is_same(const FitOptic& a, const FitOptic& b) {
    return a.surface == b.surface && !b.is_moved == !a.is_moved && a.moved.linear == b.moved.linear &&
           a.moved.translation == b.moved.translation;
}

SurfacePoint point_on(const FitOptic& optic, const FitOptic& nominal, const OpticEvent& event) {
    return moved_point(
        optic, optic.surface == nominal.surface ? event.as_built : optic.surface->eval(event.face, event.uv));
}

PlaceDifference difference_of(const FitScene& scene, const ParameterDifference& parameter,
                              const OpticEvent& event) {
    const FitOptic &minus = parameter.minus.optics[event.optic], &plus = parameter.plus.optics[event.optic];
    if (is_same(minus, plus)) return {};
    const FitOptic& nominal = scene.optics[event.optic];
    const SurfacePoint low = point_on(minus, nominal, event), high = point_on(plus, nominal, event);
    const double factor = 1 / (2 * parameter.step);
    return {factor * (high.position - low.position),
            {factor * (high.du - low.du), factor * (high.dv - low.dv)},
            false};
}

/// The whole path, ready to be asked.
struct StationaryPath {
    const FitScene& scene;
    ShownPlace film;
    std::span<const OpticEvent> events;
    Vec3 point;
    std::vector<PathLeg> stretch;
    std::array<Vec3, 2> gradient;  // of the camera's place at the first event, or at the point
    std::vector<Mat2> z;           // A^-1 (G^T, 0, ...): see below

    const Camera& camera() const { return scene.cameras[film.camera]; }
};

bool solve(StationaryPath& path) {
    const std::size_t k = path.events.size();
    if (k == 0) return true;
    std::vector<Mat2> diagonal, upper;
    for (std::size_t i = 0; i < k; ++i) {
        const PathLeg &before = path.stretch[i], &after = path.stretch[i + 1];
        const SurfacePoint& p = path.events[i].point;
        const Vec3 bend = before.index * before.direction - after.index * after.direction;
        Mat2 block = form(
            tangents(p), [&](const Vec3& v) { return before.turn(v) + after.turn(v); }, tangents(p));
        const double mixed = dot(bend, p.duv);
        block += Mat2(dot(bend, p.duu), mixed, mixed, dot(bend, p.dvv));
        diagonal.push_back(block);
        if (i + 1 < k)
            upper.push_back(-1.0 * form(
                                       tangents(p), [&](const Vec3& v) { return after.turn(v); },
                                       tangents(path.events[i + 1].point)));
    }
    const Tangents first = tangents(path.events[0].point);
    const Mat2 seen(along(first, path.gradient[0]), along(first, path.gradient[1]));  // columns: x, y
    std::optional<std::vector<Mat2>> z = solve_from_first(diagonal, upper, seen);
    if (!z) return false;
    path.z = std::move(*z);
    return true;
}

std::array<double, 2> by_parameter(const StationaryPath& path, const ParameterDifference& parameter) {
    const std::size_t k = path.events.size();
    std::vector<PlaceDifference> moves;
    for (const OpticEvent& event : path.events) moves.push_back(difference_of(path.scene, parameter, event));
    const double factor = 1 / (2 * parameter.step);
    const Camera &minus = parameter.minus.cameras[path.film.camera],
                 &plus = parameter.plus.cameras[path.film.camera];

    // What moves in front of the camera, and the camera itself at a fixed place.
    const Vec3 first = k > 0 ? path.events[0].point.position : path.point;
    Vec2 moved(0);
    if (k > 0) moved = {dot(path.gradient[0], moves[0].place), dot(path.gradient[1], moves[0].place)};
    if (parameter.moves_camera) {
        const std::optional<Vec2> low = pixel_of_point(minus, first, path.film.pixel),
                                  high = pixel_of_point(plus, first, path.film.pixel);
        if (low && high) moved += factor * (*high - *low);
    }

    Vec3 eye_move(0), view_turn(0);
    if (parameter.moves_camera && k > 0) {
        if (is_parallel(path.camera()))
            view_turn =
                factor * (normalize(plus.linear->view_direction) - normalize(minus.linear->view_direction));
        else
            eye_move = factor * (eye_of(plus) - eye_of(minus));
    }
    const auto index_move = [&](Id medium) {
        return factor * (index_of(parameter.plus, medium) - index_of(parameter.minus, medium));
    };
    for (std::size_t i = 0; i < k; ++i) {
        const PathLeg &before = path.stretch[i], &after = path.stretch[i + 1];
        const Vec3 previous = i > 0 ? moves[i - 1].place : eye_move;
        const Vec3 next = i + 1 < k ? moves[i + 1].place : Vec3(0);
        Vec3 force = before.turn(moves[i].place - previous) - after.turn(next - moves[i].place);
        if (i == 0) force += before.index * view_turn;
        force += index_move(path.events[i].before) * before.direction -
                 index_move(path.events[i].after) * after.direction;
        Vec2 change = along(tangents(path.events[i].point), force);
        if (!moves[i].is_none) {
            const Vec3 bend = before.index * before.direction - after.index * after.direction;
            change += along(moves[i].tangents, bend);
        }
        moved -= glm::transpose(path.z[i]) * change;
    }
    return {moved.x, moved.y};
}

}  // namespace

std::optional<Vec2> pixel_of_point(const Camera& camera, const Vec3& point, const Vec2& near) {
    if (camera.linear) {
        const Vec3 screen = screen_from_world(*camera.linear, point);
        if (!(screen.z > 0)) return std::nullopt;
        return Vec2(screen.x, screen.y) / screen.z;
    }
    std::optional<Vec2> best;
    for (const FilmImage& image : film_positions(camera, point))
        if (!best || length(image.pixel - near) < length(*best - near)) best = image.pixel;
    return best;
}

std::optional<PathDerivatives> path_derivatives(const FitScene& scene, const ShownPlace& place,
                                                std::span<const OpticEvent> events, const Vec3& point,
                                                std::span<const ParameterDifference> parameters) {
    StationaryPath path{scene, place, events, point, {}, {}, {}};
    const Camera& camera = path.camera();
    const std::optional<std::array<Vec3, 2>> gradient =
        place_gradient(camera, events.empty() ? point : events[0].point.position, place.pixel);
    if (!gradient) return std::nullopt;
    path.gradient = *gradient;
    if (!events.empty()) path.stretch = path_legs(scene, camera, events, point);
    if (!solve(path)) return std::nullopt;

    PathDerivatives found;
    found.by_point = *gradient;
    if (!events.empty()) {
        // F moves with the point by -(dP_k/du)^T H_k.
        const Tangents last = tangents(events.back().point);
        for (int axis = 0; axis < 2; ++axis) {
            const Vec2 z = path.z.back()[axis];
            found.by_point[static_cast<std::size_t>(axis)] =
                path.stretch.back().turn(z.x * last[0] + z.y * last[1]);
        }
    }
    for (const ParameterDifference& parameter : parameters)
        found.by_parameter.push_back(by_parameter(path, parameter));
    return found;
}

}  // namespace trilens
