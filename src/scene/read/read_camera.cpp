// Cameras out of checked JSON.
#include <algorithm>
#include <cmath>

#include "scene/read/reading.h"

namespace trilens {
namespace {

constexpr double kSamePoint =
    1e-12;  // eye and at closer than this share of their distance from the origin: no direction
constexpr double kParallel = 1e-9;  // sine of an angle that counts as none

void read_look_at(const Node& look_at, CameraDescription& camera) {
    camera.eye = to_vec3(look_at["eye"].json);
    camera.at = to_vec3(look_at["at"].json);
    camera.up = vec3_or(look_at, "up", {0, 1, 0});
    const Vec3 view = camera.at - camera.eye;
    if (!(length(view) > kSamePoint * std::max(length(camera.at), length(camera.eye))))
        look_at.fail("eye and at are the same point: the camera looks nowhere");
    const Vec3 up = normalize_or_zero(camera.up);
    if (up == Vec3(0)) look_at["up"].fail("must not be zero");
    if (!(length(cross(normalize_or_zero(view), up)) > kParallel)) {
        const std::string message = "up is parallel to the view from eye to at";
        look_at.has("up") ? look_at["up"].fail(message) : look_at.fail(message + " (up is 0 1 0 by default)");
    }
}

void read_ray_mesh(const Node& node, CameraDescription& camera, Reading& reading) {
    const std::size_t corners = node["points"].size();
    for (const char* key : {"directions", "screen"})
        if (node[key].size() != corners)
            node[key].fail("has " + std::to_string(node[key].size()) + " entries, but points has " +
                           std::to_string(corners));
    for (std::size_t i = 0; i < corners; ++i) {
        camera.points.push_back(to_vec3(node["points"].json[i]));
        camera.directions.push_back(to_vec3(node["directions"].json[i]));
        if (camera.directions.back() == Vec3(0)) node["directions"][i].fail("a direction must not be zero");
        camera.screen.push_back(to_vec2(node["screen"].json[i]));
    }
    std::size_t without_area = 0;
    for (std::size_t i = 0; i < node["triangles"].size(); ++i) {
        IdTriple triangle{};
        for (std::size_t k = 0; k < 3; ++k) {
            triangle[k] = node["triangles"].json[i][k].get<Id>();
            if (triangle[k] >= corners)
                node["triangles"][i][k].fail("index " + std::to_string(triangle[k]) +
                                             " is out of range: there are " + std::to_string(corners) +
                                             " points");
        }
        camera.triangles.push_back(triangle);
        const Vec2 a = camera.screen[triangle[0]], ab = camera.screen[triangle[1]] - a,
                   ac = camera.screen[triangle[2]] - a;
        if (ab.x * ac.y == ab.y * ac.x) ++without_area;
    }
    if (without_area > 0)
        reading.warn(
            node["triangles"].place,
            std::to_string(without_area) + " triangles have no area on the screen: no pixel sees them");
}

std::array<double, 4> window_or(const Node& node, const char* key, const std::array<double, 4>& fallback) {
    if (!node.has(key)) return fallback;
    std::array<double, 4> window{};
    for (std::size_t k = 0; k < 4; ++k) window[k] = node.json.at(key)[k].get<double>();
    return window;
}

Vec3 direction_at(const Node& node) {
    const Vec3 direction = to_vec3(node.json);
    if (direction == Vec3(0)) node.fail("a direction must not be zero");
    return direction;
}

void read_view_volume(const Node& node, ViewVolume& volume) {
    volume.vrp = vec3_or(node, "vrp", volume.vrp);
    volume.vpn = vec3_or(node, "vpn", volume.vpn);
    volume.vup = vec3_or(node, "vup", volume.vup);
    volume.prp = to_vec3(node["prp"].json);
    volume.window = window_or(node, "window", volume.window);
    volume.parallel = string_or(node, "projection", "perspective") == "parallel";
    volume.front = number_or(node, "front", volume.front);
    volume.back = number_or(node, "back", volume.back);
}

void read_opencv(const Node& node, OpencvLens& lens) {
    lens.fisheye = string_or(node, "model", "pinhole") == "fisheye";
    lens.fx = number_or(node, "fx", lens.fx);
    lens.fy = number_or(node, "fy", lens.fy);
    lens.cx = number_or(node, "cx", lens.cx);
    lens.cy = number_or(node, "cy", lens.cy);
    if (node.has("distortion"))
        for (const Json& value : node.json.at("distortion")) lens.distortion.push_back(value.get<double>());
}

void read_lines(const Node& node, CameraDescription& camera) {
    if (node.has("slits"))
        for (std::size_t k = 0; k < 2; ++k) {
            const Node slit = node["slits"][k];
            camera.slits[k] = {to_vec3(slit[std::size_t{0}].json), direction_at(slit[std::size_t{1}])};
        }
    if (node.has("rays"))
        for (std::size_t k = 0; k < 3; ++k) {
            const Node ray = node["rays"][k];
            camera.placed_rays[k] = {to_vec3(ray["point"].json), direction_at(ray["direction"]),
                                     to_vec2(ray["screen"].json)};
        }
}

void read_ground(const Node& node, CameraDescription& camera) {
    if (!node.has("ground")) return;
    camera.ground_point = to_vec3(node["ground"][std::size_t{0}].json);
    camera.ground_normal = direction_at(node["ground"][std::size_t{1}]);
}

FisheyeMapping mapping_of(const std::string& name) {
    if (name == "equisolid") return FisheyeMapping::kEquisolid;
    if (name == "stereographic") return FisheyeMapping::kStereographic;
    if (name == "orthographic") return FisheyeMapping::kOrthographic;
    return FisheyeMapping::kEquidistant;
}

CameraType type_of(const std::string& name) {
    const auto found = std::find(kCameraTypeNames.begin(), kCameraTypeNames.end(), name);
    return static_cast<CameraType>(found - kCameraTypeNames.begin());
}

void read_numbers(const Node& node, CameraDescription& camera) {
    camera.yfov = number_or(node, "yfov", camera.yfov);
    if (node.has("shift")) camera.shift = to_vec2(node["shift"].json);
    camera.near_depth = number_or(node, "near", camera.near_depth);
    camera.far_depth = number_or(node, "far", camera.far_depth);
    camera.ymag = number_or(node, "ymag", camera.ymag);
    camera.angle = number_or(node, "angle", camera.angle);
    camera.scale = number_or(node, "scale", camera.scale);
    camera.hfov = number_or(node, "hfov", camera.hfov);
    camera.vfov = number_or(node, "vfov", camera.vfov);
    camera.mapping = mapping_of(string_or(node, "mapping", "equidistant"));
    camera.fov = number_or(node, "fov", camera.fov);
    camera.travel = vec3_or(node, "travel", camera.travel);
    camera.detail = window_or(node, "detail", camera.detail);
    camera.context_fov = number_or(node, "contextFov", camera.context_fov);
    camera.blend = number_or(node, "blend", camera.blend);
    camera.center = vec3_or(node, "center", camera.center);
    camera.radius = number_or(node, "radius", camera.radius);
    camera.bend = number_or(node, "bend", camera.bend);
    camera.facets = int_or(node, "facets", camera.facets);
    camera.tolerance = number_or(node, "tolerance", camera.tolerance);
    if (node.has("facets") && node.has("tolerance"))
        node["tolerance"].fail("stands beside facets: only one of them may be given");
}

void read_views(const Node& node, CameraDescription& camera, Reading& reading) {
    for (std::size_t i = 0; i < node["views"].size(); ++i) {
        const Node view = node["views"][i];
        WindowedCamera one;
        one.camera = read_camera(view, i, reading);
        one.window = window_or(view, "window", one.window);
        if (!view.has("lookAt")) {
            if (!node.has("lookAt")) view.fail("needs 'lookAt', since the camera has none");
            one.camera.eye = camera.eye;
            one.camera.at = camera.at;
            one.camera.up = camera.up;
        }
        camera.views.push_back(std::move(one));
    }
}

}  // namespace

CameraDescription read_camera(const Node& node, std::size_t index, Reading& reading) {
    CameraDescription camera;
    camera.name = string_or(node, "name", "camera" + std::to_string(index));
    camera.type = type_of(string_or(node, "type", "perspective"));
    if (node.has("lookAt")) read_look_at(node["lookAt"], camera);
    read_numbers(node, camera);
    read_lines(node, camera);
    read_ground(node, camera);
    switch (camera.type) {
        case CameraType::kRayMesh:
            read_ray_mesh(node, camera, reading);
            break;
        case CameraType::kViewVolume:
            read_view_volume(node, camera.view_volume);
            break;
        case CameraType::kCrossedSlits:
            camera.window = window_or(node, "window", camera.window);
            break;
        case CameraType::kOpencv:
            read_opencv(node, camera.lens);
            break;
        case CameraType::kMultiPerspective:
            read_views(node, camera, reading);
            break;
        default:
            break;
    }
    return camera;
}

}  // namespace trilens
