// All of trilens: see the headers below, each with an example.
//
//     const trilens::Renderer renderer(trilens::load_scene(trilens::SceneRequest{"scene.json"}));
//     trilens::write_image("mine.exr", renderer.draw({}).image);
#pragma once

#include <trilens/anamorph.h>
#include <trilens/animation.h>
#include <trilens/camera.h>
#include <trilens/caustic.h>
#include <trilens/compare.h>
#include <trilens/design.h>
#include <trilens/display.h>
#include <trilens/error.h>
#include <trilens/files.h>
#include <trilens/fit.h>
#include <trilens/image.h>
#include <trilens/map.h>
#include <trilens/project.h>
#include <trilens/ray_mesh.h>
#include <trilens/regions.h>
#include <trilens/render.h>
#include <trilens/scene.h>
#include <trilens/stopwatch.h>
#include <trilens/suite.h>
#include <trilens/surface.h>
#include <trilens/sweep.h>
#include <trilens/text.h>
#include <trilens/types.h>
#include <trilens/unwrap.h>
#include <trilens/version.h>
