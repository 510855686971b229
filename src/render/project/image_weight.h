// How much of a point's light an image carries: Fresnel, tint and absorption along its whole path.
#pragma once

#include "base/math/vec.h"
#include "paths/trace/history_image.h"
#include "render/frame/frame.h"
#include "render/project/facet_images.h"

namespace trilens {

/// How light comes from a point over one optic to the camera.
struct OneEventWay {
    Id optic = kNone;
    Path path = Path::kReflect;
    Ray view;           // the camera's, from where its rays start
    Vec3 from{0};       // on the optic
    bool front = true;  // the camera sees its front there
    Vec3 point{0};
};

/// The share of each colour of the point's light that comes to the camera over one optic, as pictures have
/// it. The angle of incidence is that of the law: at half of the angle between both stretches, or by Snell.
Vec3 weight_over_one(const World& world, const Frame& frame, const OneEventWay& way);

/// The share of each colour that reaches a point seen directly.
Vec3 weight_of_direct(const World& world, const Frame& frame, const Ray& view, double way);

}  // namespace trilens
