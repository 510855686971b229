// Marks on pictures: points and labels of the world, which have a place but no surface.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/math/vec.h"

namespace trilens {

/// Shares of pixels that a line of text covers, 0..1: rows from the top.
struct TextMask {
    int width = 0, height = 0;
    std::vector<float> coverage;
};

/// A line of text as it is to be drawn.
struct TextStyle {
    std::string text;  // UTF-8
    double size = 16;  // pixels, of the font's line
    std::string font;  // a file of TrueType or the like; empty: DejaVu Sans
};

/// One entry of the file's `points`: a point cloud.
struct PointCloud {
    std::string name;
    std::vector<Vec3> places;  // world frame, transform applied
    std::vector<Vec3> colors;  // linear; one per place, or empty: all have `color`
    Vec3 color{1};
    double radius = 0;         // scene units, of the balls that they are; 0: `size` says
    double size = 3;           // pixels across, however far they are
    double min_weight = 0.01;  // images that carry less of their light in every colour are left out
};

/// One entry of the file's `labels`: a text beside a place.
struct Label {
    TextStyle style;
    Vec3 place{0};  // world frame
    Vec3 color{1};
    Vec2 offset{8, 0};  // pixels right and down from the place to the left end of the text's middle line
    double dot = 5;     // pixels across, at the place; 0: none
    double min_weight = 0.1;                  // as PointCloud's
    bool gives_way = false;                   // an image of it that would cover another label's is left out
    double priority = 0;                      // of two that give way, the higher one stays
    std::shared_ptr<const TextMask> letters;  // null where nobody could draw them
};

/// What a point cloud may have at most.
inline constexpr std::size_t kMostPoints = 20'000'000;

}  // namespace trilens
