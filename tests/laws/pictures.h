// Pictures of a world by an engine, and how far two of them lie apart.
#pragma once

#include <cmath>

#include "render/picture/picture.h"
#include "support/test.h"

namespace trilens_test {

/// With spp x spp samples; all layers.
inline trilens::Image drawn_by(trilens::World& world, int spp, const trilens::EngineChoice& engine) {
    world.scene.film.spp = spp;
    trilens::PictureRequest request;
    request.engine = engine;
    return trilens::draw_picture(world, request, {}, ignore, nullptr).image;
}

/// One row of it.
inline trilens::Image row_drawn_by(const trilens::World& world, int row,
                                   const trilens::EngineChoice& engine) {
    trilens::PictureRequest request;
    request.engine = engine;
    request.layers.y0 = row;
    request.layers.x1 = world.scene.film.width;
    request.layers.y1 = row + 1;
    return trilens::draw_picture(world, request, {}, ignore, nullptr).image;
}

/// Of the green channel: root of the mean square of the differences, their mean, and the mean of `to`.
struct PictureError {
    double rms = 0, bias = 0, mean = 0;
};

inline PictureError picture_error(const trilens::Image& from, const trilens::Image& to) {
    const std::vector<float>&a = from.find("G")->floats(), &b = to.find("G")->floats();
    PictureError result;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double step = double{a[i]} - double{b[i]};
        result.rms += step * step;
        result.bias += step;
        result.mean += double{b[i]};
    }
    const auto count = static_cast<double>(a.size());
    return {std::sqrt(result.rms / count), result.bias / count, result.mean / count};
}

}  // namespace trilens_test
