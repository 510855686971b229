// Line drawings beside pictures: whether every border between objects that a picture shows has a line.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "trilens/trilens.h"

namespace trilens_test {

/// Between pixels that show different objects.
inline std::vector<trilens::Vec2> object_borders(const trilens::Renderer& renderer) {
    trilens::PictureRequest request;
    request.layers.layers = {"position", "reflect"};
    const trilens::Image image = renderer.draw(request).image;
    const std::vector<trilens::Id>& direct = image.find("directID.object")->ids();
    const trilens::Channel* reflected = image.find("reflectID.object");
    const auto seen = [&](int x, int y) {
        const std::size_t at = static_cast<std::size_t>(y * image.width + x);
        return std::pair(direct[at], reflected ? reflected->ids()[at] : trilens::kNone);
    };
    std::vector<trilens::Vec2> borders;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            if (x > 0 && seen(x, y) != seen(x - 1, y)) borders.push_back({x, y + 0.5});
            if (y > 0 && seen(x, y) != seen(x, y - 1)) borders.push_back({x + 0.5, y});
        }
    return borders;
}

inline double distance_to_lines(const trilens::Vec2& p, const std::vector<trilens::EdgeLine>& lines) {
    double nearest = HUGE_VAL;
    for (const trilens::EdgeLine& line : lines)
        for (std::size_t i = 0; i + 1 < line.points.size(); ++i) {
            const trilens::Vec2 along = line.points[i + 1] - line.points[i];
            const double u =
                std::clamp(dot(p - line.points[i], along) / std::max(dot(along, along), 1e-300), 0.0, 1.0);
            nearest = std::min(nearest, length(p - line.points[i] - u * along));
        }
    return nearest;
}

/// How many borders of a picture's objects there are, and how many have no line within a pixel.
struct LinedBorders {
    std::size_t count = 0, without = 0;
    double farthest = 0;  // pixels to the nearest line
};

inline LinedBorders lined_borders(const trilens::Renderer& renderer) {
    const std::vector<trilens::EdgeLine> lines = renderer.draw_lines({}).edge_lines;
    LinedBorders borders;
    for (const trilens::Vec2& p : object_borders(renderer)) {
        const double off = distance_to_lines(p, lines);
        ++borders.count, borders.without += !(off <= 1);
        borders.farthest = std::max(borders.farthest, off);
    }
    return borders;
}

inline double length_of(const std::vector<trilens::EdgeLine>& lines) {
    double sum = 0;
    for (const trilens::EdgeLine& line : lines)
        for (std::size_t i = 0; i + 1 < line.points.size(); ++i)
            sum += length(line.points[i + 1] - line.points[i]);
    return sum;
}

}  // namespace trilens_test
