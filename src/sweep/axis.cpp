// What a sweep varies, and which part of it one process does: the texts of --over and --shard.
#include "sweep/axis.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <string_view>

#include "base/error.h"

namespace trilens {
namespace {

constexpr int kLargestValue = 1024;  // as everywhere: finer grids of a cage would not fit in memory
constexpr std::size_t kMostValues = 1000;

[[noreturn]] void refuse_axis(const std::string& text, const std::string& why) {
    throw UsageError("--over " + text + ": " + why +
                     " (examples: resolution=1,2,4,8  resolution=1..64:x2  "
                     "resolution=8..32:+8)");
}

/// All of `text` as a whole number; none where it is not one or does not fit.
std::optional<int> whole_number(std::string_view text) {
    int value = 0;
    const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || end.ec != std::errc() || end.ptr != text.data() + text.size()) return std::nullopt;
    return value;
}

int axis_value(const std::string& whole, std::string_view text) {
    const std::optional<int> value = whole_number(text);
    if (!value) refuse_axis(whole, "\"" + std::string(text) + "\" is not a whole number");
    if (*value < 1 || *value > kLargestValue)
        refuse_axis(whole, std::string(text) + " is not between 1 and " + std::to_string(kLargestValue));
    return *value;
}

/// Appends the values of "a..b:xK" or "a..b:+K"; `dots` is where the two dots stand in `item`.
void append_range(const std::string& whole, std::string_view item, std::size_t dots,
                  std::vector<int>& values) {
    const std::size_t colon = item.find(':', dots);
    if (colon == std::string_view::npos || colon + 2 >= item.size())
        refuse_axis(whole, "the range \"" + std::string(item) + "\" has no step");
    const int first = axis_value(whole, item.substr(0, dots));
    const int last = axis_value(whole, item.substr(dots + 2, colon - dots - 2));
    if (last < first) refuse_axis(whole, "the range \"" + std::string(item) + "\" runs backwards");

    const char kind = item[colon + 1];
    const int step = axis_value(whole, item.substr(colon + 2));
    if (kind != 'x' && kind != '+') refuse_axis(whole, "a step is xK or +K");
    if (kind == 'x' && step < 2) refuse_axis(whole, "a factor is at least 2");
    // 1024^2 fits into 64 bits, so the product is safe.
    for (long long value = first; value <= last; value = kind == 'x' ? value * step : value + step) {
        values.push_back(static_cast<int>(value));
        if (values.size() > kMostValues)
            refuse_axis(whole, "more than " + std::to_string(kMostValues) + " values");
    }
}

}  // namespace

Axis parse_axis(const std::string& text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) refuse_axis(text, "has no \"=\"");
    Axis axis{text.substr(0, equals), {}};
    if (axis.name != "resolution")
        refuse_axis(text, "unknown axis \"" + axis.name + "\", known is: resolution");

    std::string_view rest = std::string_view(text).substr(equals + 1);
    while (true) {
        const std::size_t comma = rest.find(',');
        const std::string_view item = rest.substr(0, comma);
        const std::size_t dots = item.find("..");
        if (dots == std::string_view::npos)
            axis.values.push_back(axis_value(text, item));
        else
            append_range(text, item, dots, axis.values);
        if (comma == std::string_view::npos) break;
        rest.remove_prefix(comma + 1);
    }

    std::sort(axis.values.begin(), axis.values.end());
    const auto twice = std::adjacent_find(axis.values.begin(), axis.values.end());
    if (twice != axis.values.end()) refuse_axis(text, std::to_string(*twice) + " is named twice");
    if (axis.values.size() > kMostValues)
        refuse_axis(text, "more than " + std::to_string(kMostValues) + " values");
    return axis;
}

namespace {

/// The variables of one kind of job array; null where it has none. The size is `last` or `count`.
struct ArrayVariables {
    const char *index, *first, *step, *last, *count;
    int default_first;
};

constexpr std::array<ArrayVariables, 4> kArrays = {{
    {"SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_MIN", "SLURM_ARRAY_TASK_STEP", nullptr,
     "SLURM_ARRAY_TASK_COUNT", 0},
    {"SGE_TASK_ID", "SGE_TASK_FIRST", "SGE_TASK_STEPSIZE", "SGE_TASK_LAST", nullptr, 1},
    {"LSB_JOBINDEX", nullptr, "LSB_JOBINDEX_STEP", "LSB_JOBINDEX_END", nullptr, 1},
    {"GTEST_SHARD_INDEX", nullptr, nullptr, nullptr, "GTEST_TOTAL_SHARDS", 0},
}};

std::optional<int> variable(const Environment& environment, const char* name) {
    const char* value = name ? environment(name) : nullptr;
    return value ? whole_number(value) : std::nullopt;
}

Shard shard_from(const Environment& environment) {
    for (const ArrayVariables& array : kArrays) {
        const std::optional<int> index = variable(environment, array.index);
        if (!index) continue;
        const int first = variable(environment, array.first).value_or(array.default_first);
        const int step = std::max(1, variable(environment, array.step).value_or(1));
        const std::optional<int> last = variable(environment, array.last);
        const int count = last ? (*last - first) / step + 1 : variable(environment, array.count).value_or(0);
        const Shard shard{(*index - first) / step, count};
        if (*index < first || shard.index >= shard.count)
            throw UsageError(std::string("--shard auto: ") + array.index + "=" + std::to_string(*index) +
                             " does not fit the array's size");
        return shard;
    }
    throw UsageError(
        "--shard auto: no job array's variables are set (SLURM_ARRAY_TASK_ID, SGE_TASK_ID, "
        "LSB_JOBINDEX, GTEST_SHARD_INDEX)");
}

}  // namespace

Shard parse_shard(const std::string& text, const Environment& environment) {
    if (text == "auto") return shard_from(environment);
    const std::size_t slash = text.find('/');
    const auto index = whole_number(std::string_view(text).substr(0, slash));
    const auto count =
        slash == std::string::npos ? std::nullopt : whole_number(std::string_view(text).substr(slash + 1));
    if (!index || !count || *index < 0 || *index >= *count)
        throw UsageError("--shard " + text + ": is not i/n with 0 <= i < n, nor auto");
    return {*index, *count};
}

}  // namespace trilens
