// Cameras: their settings, and what is read of them by hand.
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

void read_parts(const Node& node, RayMeshCamera& camera, Reading& reading) {
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

Vec3 direction_at(const Node& node) {
    const Vec3 direction = to_vec3(node.json);
    if (direction == Vec3(0)) node.fail("a direction must not be zero");
    return direction;
}

void read_parts(const Node& node, CrossedSlitsCamera& camera, Reading&) {
    for (std::size_t k = 0; k < 2; ++k) {
        const Node slit = node["slits"][k];
        camera.slits[k] = {to_vec3(slit[std::size_t{0}].json), direction_at(slit[std::size_t{1}])};
    }
}

void read_parts(const Node& node, ThreeRayCamera& camera, Reading&) {
    for (std::size_t k = 0; k < 3; ++k) {
        const Node ray = node["rays"][k];
        camera.placed_rays[k] = {to_vec3(ray["point"].json), direction_at(ray["direction"]),
                                 to_vec2(ray["screen"].json)};
    }
}

void read_parts(const Node& node, PlanarContextCamera& camera, Reading&) {
    camera.ground_point = to_vec3(node["ground"][std::size_t{0}].json);
    camera.ground_normal = direction_at(node["ground"][std::size_t{1}]);
}

/// A view without a lookAt has the camera's.
void read_parts(const Node& node, MultiPerspectiveCamera& camera, Reading& reading) {
    for (std::size_t i = 0; i < node["views"].size(); ++i) {
        const Node view = node["views"][i];
        WindowedCamera one;
        one.camera = read_camera(view, i, reading);
        if (view.has("window")) from_json_value(view["window"].json, one.window);
        if (!view.has("lookAt")) {
            if (!node.has("lookAt")) view.fail("needs 'lookAt', since the camera has none");
            read_look_at(node["lookAt"], one.camera);
        }
        camera.views.push_back(std::move(one));
    }
}

}  // namespace

CameraDescription read_camera(const Node& node, std::size_t index, Reading& reading) {
    CameraDescription camera;
    camera.name = "camera" + std::to_string(index);
    if (node.has("lookAt")) read_look_at(node["lookAt"], camera);
    read_fields(node, camera_fields(), camera);
    if (node.has("facets") && node.has("tolerance"))
        node["tolerance"].fail("stands beside facets: only one of them may be given");
    std::visit(
        [&](auto& kind) {
            if constexpr (requires { read_parts(node, kind, reading); }) read_parts(node, kind, reading);
        },
        camera.kind);
    return camera;
}

}  // namespace trilens
