#include "view/camera_moves.h"

#include <trilens/error.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

namespace trilens {
namespace {

Vec3 read_vec(const Json& json) {
    return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

Json vec_json(const Vec3& v) {
    return Json::array({v.x, v.y, v.z});
}

Vec3 unit_or(const Vec3& v, const Vec3& otherwise) {
    const double length = std::sqrt(dot(v, v));
    return length > 0 && std::isfinite(length) ? v / length : otherwise;
}

/// x -> rotation (x - center) + center + shift.
struct RigidMotion {
    Vec3 center{0}, axis{0, 1, 0}, shift{0};
    double angle = 0;  // radians, counterclockwise seen against the axis

    Vec3 direction(const Vec3& v) const {  // Rodrigues' formula
        const double c = std::cos(angle), s = std::sin(angle);
        return c * v + s * cross(axis, v) + (1 - c) * dot(axis, v) * axis;
    }
    Vec3 point(const Vec3& p) const { return direction(p - center) + center + shift; }
};

using MapVec = std::function<Vec3(const Vec3&)>;

void map_at(Json& json, const char* key, const MapVec& map) {
    if (json.contains(key)) json[key] = vec_json(map(read_vec(json.at(key))));
}

/// Everything of a camera that lies in the world frame.
void map_camera(Json& camera, const RigidMotion& motion) {
    const MapVec point = [&](const Vec3& p) { return motion.point(p); };
    const MapVec direction = [&](const Vec3& v) { return motion.direction(v); };
    if (camera.contains("lookAt")) {
        Json& look_at = camera["lookAt"];
        if (!look_at.contains("up")) look_at["up"] = vec_json({0, 1, 0});
        map_at(look_at, "eye", point);
        map_at(look_at, "at", point);
    }
    if (camera.value("type", "") == "viewVolume")  // what a move changes must stand there
        for (const auto& [key, value] :
             {std::pair{"vrp", Vec3(0)}, {"vpn", Vec3(0, 0, 1)}, {"vup", Vec3(0, 1, 0)}})
            if (!camera.contains(key)) camera[key] = vec_json(value);
    for (const char* key : {"vrp", "center"}) map_at(camera, key, point);
    for (const char* key : {"vpn", "vup", "travel"}) map_at(camera, key, direction);
    if (camera.contains("slits"))
        for (Json& slit : camera["slits"]) {
            slit[0] = vec_json(point(read_vec(slit.at(0))));
            slit[1] = vec_json(direction(read_vec(slit.at(1))));
        }
    if (camera.contains("rays"))
        for (Json& ray : camera["rays"]) {
            map_at(ray, "point", point);
            map_at(ray, "direction", direction);
        }
    if (camera.contains("points"))
        for (Json& one : camera["points"]) one = vec_json(point(read_vec(one)));
    if (camera.contains("directions"))
        for (Json& one : camera["directions"]) one = vec_json(direction(read_vec(one)));
    if (camera.contains("views"))
        for (Json& view : camera["views"])
            map_camera(view.contains("camera") ? view["camera"] : view, motion);
}

struct EyeAndAxis {
    Vec3 eye{0}, forward{0}, up{0, 1, 0};
    std::optional<Vec3> at;
};

/// Mean of explicit rays: where they start and go.
EyeAndAxis mean_ray(const std::vector<Vec3>& points, const std::vector<Vec3>& directions) {
    EyeAndAxis mean;
    for (const Vec3& p : points) mean.eye += p / static_cast<double>(points.size());
    for (const Vec3& d : directions) mean.forward += unit_or(d, Vec3(0));
    return mean;
}

EyeAndAxis eye_and_axis(const Json& camera) {
    EyeAndAxis found;
    if (camera.contains("lookAt")) {
        const Json& look_at = camera.at("lookAt");
        found.eye = read_vec(look_at.at("eye"));
        found.at = read_vec(look_at.at("at"));
        found.forward = *found.at - found.eye;
        if (look_at.contains("up")) found.up = read_vec(look_at.at("up"));
        return found;
    }
    if (camera.contains("vpn") || camera.contains("vrp") || camera.contains("prp")) {
        const Vec3 n = unit_or(camera.contains("vpn") ? read_vec(camera.at("vpn")) : Vec3(0, 0, 1), Vec3(0));
        if (camera.contains("vup")) found.up = read_vec(camera.at("vup"));
        const Vec3 u = unit_or(cross(found.up, n), Vec3(0)), v = cross(n, u);
        const Vec3 prp = camera.contains("prp") ? read_vec(camera.at("prp")) : Vec3(0, 0, 1);
        found.eye = (camera.contains("vrp") ? read_vec(camera.at("vrp")) : Vec3(0)) + prp.x * u + prp.y * v +
                    prp.z * n;
        found.forward = -1.0 * n;
        return found;
    }
    std::vector<Vec3> points, directions;
    if (camera.contains("rays"))
        for (const Json& ray : camera.at("rays")) {
            points.push_back(read_vec(ray.at("point")));
            directions.push_back(read_vec(ray.at("direction")));
        }
    if (camera.contains("points") && camera.contains("directions")) {
        for (const Json& one : camera.at("points")) points.push_back(read_vec(one));
        for (const Json& one : camera.at("directions")) directions.push_back(read_vec(one));
    }
    if (!points.empty()) return mean_ray(points, directions);
    if (camera.contains("views") && !camera.at("views").empty()) {
        const Json& view = camera.at("views").at(0);
        return eye_and_axis(view.contains("camera") ? view.at("camera") : view);
    }
    if (camera.contains("center")) {
        found.eye = read_vec(camera.at("center"));
        found.forward = {0, 0, -1};
    }
    return found;
}

double radians(double degrees) {
    return degrees * std::numbers::pi / 180;
}

/// A turn to the right and up about `center`, as two motions, that stops one degree before the poles.
void turn_camera(Json& camera, const CameraPose& pose, const Vec3& center, double right, double up) {
    map_camera(camera, {center, pose.turn_axis, Vec3(0), radians(right)});
    // Seen from the turned frame: up raises the eye of an orbit, so `forward` sinks.
    const RigidMotion turned{center, pose.turn_axis, Vec3(0), radians(right)};
    const double from = std::acos(std::clamp(dot(pose.forward, pose.turn_axis), -1.0, 1.0));
    const double to = std::clamp(from - radians(up), radians(1), std::numbers::pi - radians(1));
    map_camera(camera, {center, turned.direction(pose.right), Vec3(0), from - to});
}

}  // namespace

CameraPose camera_pose(const Json& camera, double distance) {
    const EyeAndAxis from = eye_and_axis(camera);
    CameraPose pose;
    pose.eye = from.eye;
    pose.distance = from.at ? std::sqrt(dot(from.forward, from.forward)) : distance;
    pose.forward = unit_or(from.forward, Vec3(0));
    pose.turn_axis = unit_or(from.up, Vec3(0));
    pose.right = unit_or(cross(pose.forward, pose.turn_axis), Vec3(0));
    if (pose.forward == Vec3(0) || pose.right == Vec3(0))
        throw InputError("", "cameras",
                         "the camera cannot be moved: it has no eye, looks nowhere or along its up");
    pose.up = cross(pose.right, pose.forward);
    pose.pivot = from.at ? *from.at : pose.eye + pose.distance * pose.forward;
    return pose;
}

void move_camera(Json& camera, const CameraMove& move, double distance) {
    if (!std::isfinite(move.by.x) || !std::isfinite(move.by.y) || !std::isfinite(move.by.z))
        throw UsageError("a camera moves by finite numbers");
    const CameraPose pose = camera_pose(camera, distance);
    const auto shift_by = [&](const Vec3& by) { map_camera(camera, {Vec3(0), {0, 1, 0}, by, 0}); };
    switch (move.kind) {
        case CameraMove::Kind::kOrbit:
            turn_camera(camera, pose, pose.pivot, move.by.x, -move.by.y);
            break;
        case CameraMove::Kind::kLook:
            turn_camera(camera, pose, pose.eye, -move.by.x, move.by.y);
            break;
        case CameraMove::Kind::kPan:
            shift_by(pose.distance * (move.by.x * pose.right + move.by.y * pose.up));
            break;
        case CameraMove::Kind::kWalk:
            shift_by(pose.distance *
                     (move.by.x * pose.right + move.by.y * pose.up + move.by.z * pose.forward));
            break;
        case CameraMove::Kind::kDolly: {
            if (!(move.by.x > 0)) throw UsageError("a dolly's factor is above 0");
            const Vec3 at = pose.pivot;
            shift_by((1 - move.by.x) * pose.distance * pose.forward);
            if (camera.contains("lookAt")) camera["lookAt"]["at"] = vec_json(at);
            break;
        }
    }
}

}  // namespace trilens
