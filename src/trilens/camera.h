// Cameras of every kind: the exact ray of a place on the film, and where the film shows a world point.
//
//     trilens::CameraDescription from;
//     from.kind = trilens::FisheyeCamera{.fov = 200};
//     const trilens::Camera camera = trilens::make_camera(from, {640, 480});
//     const std::optional<trilens::Ray> ray = trilens::exact_ray(camera, {320.5, 240.5});
//     for (const trilens::FilmImage& image : trilens::film_positions(camera, {0, 1, -4}))
//         std::printf("%g, %g\n", image.pixel.x, image.pixel.y);
//     if (trilens::facet_kinds(camera).count(trilens::GeneralLinearKind::kPinhole) > 0)
//         std::puts("its rays meet in a point");
#pragma once

#include "camera/camera.h"
#include "camera/linear/linear_cameras.h"
