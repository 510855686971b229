#include "volume/transfer_function.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/math/srgb.h"
#include "base/util/check.h"
#include "base/util/error.h"
#include "base/util/names.h"

namespace trilens {
namespace {

Vec3 linear_of_srgb(unsigned rgb) {
    return {linear_from_srgb((rgb >> 16 & 255) / 255.0), linear_from_srgb((rgb >> 8 & 255) / 255.0),
            linear_from_srgb((rgb & 255) / 255.0)};
}

}  // namespace

TransferPoint TransferFunction::at(double value) const {
    TRILENS_CHECK(!points.empty(), "a transfer function has points");
    const auto above = std::upper_bound(points.begin(), points.end(), value,
                                        [](double v, const TransferPoint& p) { return v < p.value; });
    if (above == points.begin()) return {value, above->color, above->extinction};
    const TransferPoint& low = *(above - 1);
    if (above == points.end()) return {value, low.color, low.extinction};
    const double share = (value - low.value) / (above->value - low.value);
    return {value, low.color + share * (above->color - low.color),
            low.extinction + share * (above->extinction - low.extinction)};
}

const std::vector<std::string>& color_map_names() {
    static const std::vector<std::string> names{"grey", "heat", "viridis"};
    return names;
}

std::vector<Vec3> color_map(const std::string& name) {
    if (name == "grey") return {Vec3(0), Vec3(1)};
    if (name == "heat") return {Vec3(0), {1, 0, 0}, {1, 1, 0}, Vec3(1)};
    if (name != "viridis")
        throw UsageError("there is no colour map \"" + name + "\"" + suggestion(name, color_map_names()));
    std::vector<Vec3> colors;
    for (const unsigned rgb : {0x440154u, 0x482878u, 0x3e4989u, 0x31688eu, 0x26828eu, 0x1f9e89u, 0x35b779u,
                               0x6ece58u, 0xb5de2bu, 0xfde725u})
        colors.push_back(linear_of_srgb(rgb));
    return colors;
}

}  // namespace trilens
