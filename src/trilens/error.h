// What the library throws, how it says what it does, and how it is stopped.
//
// Every function of the public headers throws trilens::Error, or std::bad_alloc, and nothing else; none ends
// the program over a caller's data. An index that a member takes is one that exists, as with a vector's [] (a
// face of a Surface, a facet of a RayMesh's own members). "No answer" is no error: it is an empty optional or
// an empty list.
//
//     #include <trilens/scene.h>
//     try {
//         const trilens::Scene scene = trilens::load_scene({"scene.json"});
//     } catch (const trilens::InputError& error) {
//         std::fprintf(stderr, "%s\n", error.what());  // scene.json: /meshes/0/file: ...
//     }
#pragma once

#include "base/util/error.h"
