// How far two pictures are apart: pixel by pixel, and in what their optics show.
//
//     #include <trilens/image.h>
//     const trilens::Image truth = trilens::read_image("truth.exr"), image = trilens::read_image("mine.exr");
//     const trilens::Comparison comparison = trilens::compare(truth, image);
//     std::printf("rmse %g\n", comparison.metrics.rmse);
//     for (const trilens::LayerComparison& layer : trilens::compare_layers(truth, image))
//         if (layer.displacement && layer.displacement->summary)
//             std::printf("%s moved by %g px\n", layer.layer.c_str(), layer.displacement->summary->mean);
//     std::printf("%zu separate shapes\n", trilens::count_regions(truth));
//     // Of a file of other programs, the layer that stands for it:
//     const trilens::Image other = trilens::read_compared_image("truth.exr");
#pragma once

#include "measure/common/comparable.h"
#include "measure/common/statistics.h"
#include "measure/compare.h"
#include "measure/pixel/regions.h"
#include "study/compare_inputs.h"
