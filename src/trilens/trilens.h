// All of trilens: see the headers below, each with an example.
//
//     const trilens::Renderer renderer(trilens::load_scene(trilens::SceneRequest{"scene.json"}));
//     trilens::write_image("mine.exr", renderer.draw({}).image);
#pragma once

#include <trilens/anamorph.h>
#include <trilens/animation.h>
#include <trilens/camera.h>
#include <trilens/compare.h>
#include <trilens/design.h>
#include <trilens/display.h>
#include <trilens/error.h>
#include <trilens/fit.h>
#include <trilens/image.h>
#include <trilens/maps.h>
#include <trilens/project.h>
#include <trilens/ray_mesh.h>
#include <trilens/render.h>
#include <trilens/scene.h>
#include <trilens/suite.h>
#include <trilens/surface.h>
#include <trilens/sweep.h>
#include <trilens/types.h>
#include <trilens/utilities.h>
#include <trilens/version.h>
