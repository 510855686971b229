// Point clouds: places with or without colours, out of PLY or text.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/math/vec.h"

namespace trilens {

/// Points that may have colours.
struct ColoredPoints {
    std::vector<Vec3> points;
    std::vector<Vec3> colors;  // linear; one per point, or none
};

/// The vertices of a PLY file, ASCII or binary: x, y and z, with red, green and blue where all three are
/// there (of 8 and 16 bits as sRGB, others linear); all else is passed over. Throws InputError(file, "line
/// n"; of binary data, "") for what is malformed, shorter than its header counts, or has more than
/// kMostPoints.
ColoredPoints parse_ply(std::string_view bytes, const std::string& file);

/// A point cloud by the ending of its file's name: .ply, else text with x,y,z or x,y,z,red,green,blue
/// (linear) on each line, all lines alike. Throws InputError as parse_ply and read_points do.
ColoredPoints parse_cloud(const std::string& bytes, const std::string& file);

}  // namespace trilens
