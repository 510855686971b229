#include "scene/animation/frame_numbers.h"

#include <charconv>
#include <cstdlib>
#include <optional>

#include "base/util/error.h"
#include "base/util/format.h"

namespace trilens {
namespace {

std::optional<int> integer(const std::string& text) {
    int value = 0;
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || stop != end) return std::nullopt;
    return value;
}

}  // namespace

std::vector<int> parse_frames(const std::string& text) {
    const std::size_t dots = text.find("..");
    const auto first = integer(text.substr(0, dots)),
               last = dots == std::string::npos ? first : integer(text.substr(dots + 2));
    if (!first || !last) throw UsageError("frames are A..B, two whole numbers, not \"" + text + "\"");
    const long long count = std::llabs(static_cast<long long>(*last) - *first) + 1;
    if (count > kMostFrames)
        throw UsageError(fmt::format("{} are {} frames, more than {}", text, count, kMostFrames));
    std::vector<int> frames;
    for (int k = 0; k < count; ++k) frames.push_back(*first <= *last ? *first + k : *first - k);
    return frames;
}

std::string frame_file(const std::string& output, int frame) {
    const std::size_t first = output.find('#');
    if (first == std::string::npos)
        throw UsageError("the output \"" + output +
                         "\" of several frames needs a place for their numbers: f.####.exr");
    std::size_t end = first;
    while (end < output.size() && output[end] == '#') ++end;
    if (output.find('#', end) != std::string::npos)
        throw UsageError("the output \"" + output + "\" has two places for a frame's number");
    return output.substr(0, first) +
           fmt::format("{}{:0{}}", frame < 0 ? "-" : "", std::llabs(frame), end - first) + output.substr(end);
}

}  // namespace trilens
