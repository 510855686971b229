// How far two pictures are apart: pixel by pixel, and in what their optics show.
//
//     const trilens::Image truth = trilens::read_image("truth.exr");
//     const trilens::Image image = trilens::read_image("projected.exr");
//     const trilens::Comparison comparison = trilens::compare(truth, image);
//     std::printf("rmse %g\n", comparison.metrics.rmse);
//     for (const trilens::LayerComparison& layer : trilens::compare_layers(truth, image))
//         if (layer.displacement && layer.displacement->summary)
//             std::printf("%s: %g px, over %g of it\n", layer.layer.c_str(),
//                         layer.displacement->summary->mean, *layer.displacement->coverage);
#pragma once

#include "measure/compare.h"
#include "measure/compare_layers.h"
#include "measure/difference.h"
#include "measure/fit.h"
