// The bodies of glass that a ray starts in: what a camera looks out of.
#pragma once

#include <vector>

#include "paths/trace/path_world.h"

namespace trilens {

/// A body holds the place that a ray starts from where the ray comes to its back first. Both answers list
/// the body that the ray leaves first as the last entered; of more bodies than Media can hold the ones left
/// first. `asked`: bodies that may hold the place; others are not looked at.

/// By this ray alone.
Media bodies_along(const PathWorld& world, const std::vector<Id>& asked, const Ray& ray);

/// What rays from a point start in.
struct EnclosingBodies {
    Media media;
    std::vector<Id> unsure;  // bodies that some directions say hold the point, and others say do not
};

/// By the vote of several directions, more than half of them: for a surface that is closed, and whose normals
/// point out of it, they agree.
EnclosingBodies enclosing_bodies(const PathWorld& world, const std::vector<Id>& asked, const Vec3& point);

}  // namespace trilens
