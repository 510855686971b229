// Images of known fields: what is seen is a formula of the screen position, so displacements are known
// exactly.
#pragma once

#include <cmath>
#include <functional>
#include <optional>
#include <string>

#include "base/image/image.h"
#include "base/math/vec.h"

namespace trilens_test {

struct Seen {
    trilens::Id object = trilens::kNone, primitive = 0;
    trilens::Vec3 point{0};
};

/// The environment in a direction, which need not be a unit vector.
inline Seen environment(const trilens::Vec3& direction) {
    return {trilens::kNone, trilens::kNone, trilens::normalize(direction)};
}

/// What is seen at a position on the film, pixels from its top left.
using Field = std::function<Seen(double x, double y)>;

inline trilens::Image image_of(int width, int height, const Field& field) {
    using namespace trilens;
    Image image;
    image.width = image.data_width = width;
    image.height = image.data_height = height;
    const std::size_t pixels = image.pixels();
    std::vector<float> x(pixels, 0), y(pixels, 0), z(pixels, 0);
    std::vector<Id> object(pixels), primitive(pixels, kNone);
    for (std::size_t i = 0; i < pixels; ++i) {
        const Seen seen = field(static_cast<double>(i % static_cast<std::size_t>(width)) + 0.5,
                                static_cast<double>(i / static_cast<std::size_t>(width)) + 0.5);
        object[i] = seen.object;
        primitive[i] = seen.object == kNone ? kNone : seen.primitive;
        x[i] = static_cast<float>(seen.point.x);
        y[i] = static_cast<float>(seen.point.y);
        z[i] = static_cast<float>(seen.point.z);
    }
    image.channels.push_back({"reflect.object", object});
    image.channels.push_back({"reflect.primitive", primitive});
    image.channels.push_back({"reflect.X", x});
    image.channels.push_back({"reflect.Y", y});
    image.channels.push_back({"reflect.Z", z});
    return image;
}

/// The same picture with ids and places in layers of their own: "reflectID.object", "reflectP.X".
inline trilens::Image with_newer_names(trilens::Image image) {
    for (trilens::Channel& channel : image.channels) {
        const std::string name = channel.name.substr(channel.name.find('.') + 1);
        if (channel.name == "reflect." + name)
            channel.name = (channel.is_id() ? "reflectID." : "reflectP.") + name;
    }
    return image;
}

/// A mirror sphere of radius 1 at the origin, seen from (0, 0, 3.2) with a film of `size` pixels that just
/// holds it, in a box room of half side 4: object 7, walls as primitives 0..5 (or one primitive). Nothing
/// beside the sphere.
inline Seen mirror_sphere(double x, double y, double size, bool walls_are_primitives = true) {
    using trilens::Vec3;
    const Vec3 eye(0, 0, 3.2);
    const double half = 1.05 / std::sqrt(3.2 * 3.2 - 1);
    const Vec3 way = trilens::normalize(Vec3((2 * x / size - 1) * half, (1 - 2 * y / size) * half, -1));
    const double b = trilens::dot(eye, way), root = b * b - trilens::dot(eye, eye) + 1;
    if (root < 0) return {};
    const Vec3 hit = eye + (-b - std::sqrt(root)) * way;
    const Vec3 out = way - 2 * trilens::dot(way, hit) * hit;

    // The nearest of the six walls along the way out.
    double nearest = 1e300;
    trilens::Id wall = 0;
    for (int axis = 0; axis < 3; ++axis) {
        if (out[axis] == 0) continue;
        const double t = ((out[axis] > 0 ? 4 : -4) - hit[axis]) / out[axis];
        if (t >= nearest) continue;
        nearest = t;
        wall = static_cast<trilens::Id>(2 * axis + (out[axis] > 0));
    }
    return {7, walls_are_primitives ? wall : 0, hit + nearest * out};
}

}  // namespace trilens_test
