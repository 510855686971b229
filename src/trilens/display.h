// Pictures in the viewer tev, while they are drawn.
//
//     #include <trilens/display.h>
//     #include <trilens/render.h>
//     #include <trilens/scene.h>
//     const trilens::Renderer renderer(trilens::load_scene({"scene.json"}));
//     trilens::DisplayServer viewer("127.0.0.1:14158");
//     const trilens::StripSink shown = viewer.sink("mine");
//     trilens::PictureRequest request;
//     request.watch = &shown;
//     const trilens::Picture picture = renderer.draw(request);
#pragma once

#include "image/display_server.h"
