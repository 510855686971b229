// How many separate shapes a picture shows.
//
//     #include <trilens/image.h>
//     const trilens::Image image = trilens::read_image("picture.exr");
//     std::printf("%zu shapes\n", trilens::count_regions(image));
#pragma once

#include "measure/pixel/regions.h"
