// Freeform mirrors: the surface in which an eye sees what is wished.
//
//     #include <trilens/design.h>
//     const trilens::DesignWish wish = trilens::read_wish("wish.json");
//     const trilens::Design mirror = trilens::design_mirror(wish);
//     std::printf("%g degrees in the mean, curl %g\n", mirror.errors.mean, mirror.curl);
//     trilens::replace_text_file("mirror.json", trilens::design_scene(wish, mirror));
#pragma once

#include "inverse/design/design.h"
#include "trilens/utilities.h"
