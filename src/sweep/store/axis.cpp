// What a sweep varies: named lists of values, and the points that they span.
#include "sweep/store/axis.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <string_view>

#include "base/description/digest.h"
#include "base/util/error.h"
#include "base/util/names.h"
#include "report/text.h"

namespace trilens {
namespace {

constexpr std::size_t kMostValues = 100000;
constexpr std::size_t kLongestId = 100;

/// One axis while its values are read.
struct AxisReader {
    const AxisKind& kind;
    const std::string& where;
    std::vector<AxisValue> values = {};

    [[noreturn]] void refuse(const std::string& why) const {
        throw UsageError(where + ": " + why +
                         " (examples: resolution=1,2,4,8  resolution=1..64:x2  resolution=8..32:+8  "
                         "engine=exact,classic  /materials/0/ior=1.3,1.5)");
    }
    bool is_numeric() const {
        return kind.values == ValueKind::kWhole || kind.values == ValueKind::kNumber ||
               kind.values == ValueKind::kJson;
    }
    void add(const std::string& item);
    void add_range(const std::string& item, std::size_t dots);
    void add_number(double number);
    double number_of(const std::string& text) const;
};

/// All of `text` as a finite number; none where it is not one.
std::optional<double> as_number(std::string_view text) {
    double value = 0;
    const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || end.ec != std::errc() || end.ptr != text.data() + text.size() ||
        !std::isfinite(value))
        return std::nullopt;
    return value;
}

double AxisReader::number_of(const std::string& text) const {
    const std::optional<double> value = as_number(text);
    const bool is_whole = value && *value == std::floor(*value) && text.find_first_of(".eE") == text.npos;
    if (kind.values == ValueKind::kWhole && !is_whole) refuse("\"" + text + "\" is not a whole number");
    if (!value) refuse("\"" + text + "\" is not a number");
    if (*value < kind.least || *value > kind.most)
        refuse(text + " is not between " + shortest_text(kind.least) + " and " + shortest_text(kind.most));
    return *value;
}

void AxisReader::add_number(double number) {
    if (values.size() >= kMostValues) refuse("more than " + std::to_string(kMostValues) + " values");
    // Sums of steps such as 0.1 carry the error of the last bit, which no one wrote.
    const double rounded = std::round(number * 1e12) / 1e12;
    const double value = std::abs(number) > 1e-3 && std::abs(number) < 1e6 ? rounded : number;
    values.push_back({shortest_text(value), value});
}

/// Values of "a..b:xK" or "a..b:+K"; `dots` is where the two dots stand in `item`.
void AxisReader::add_range(const std::string& item, std::size_t dots) {
    const std::size_t colon = item.find(':', dots);
    if (colon == std::string::npos || colon + 2 >= item.size())
        refuse("the range \"" + item + "\" has no step");
    const double first = number_of(item.substr(0, dots));
    const double last = number_of(item.substr(dots + 2, colon - dots - 2));
    if (last < first) refuse("the range \"" + item + "\" runs backwards");
    const char how = item[colon + 1];
    if (how != 'x' && how != '+') refuse("a step is xK or +K");
    const AxisKind step_kind{kind.name, "", "",
                             kind.values == ValueKind::kJson ? ValueKind::kNumber : kind.values};
    const double step = AxisReader{step_kind, where}.number_of(item.substr(colon + 2));
    if (how == 'x' && !(step > 1 && first > 0)) refuse("a factor is larger than 1, of values above 0");
    if (how == '+' && !(step > 0)) refuse("what is added is above 0");
    for (int i = 0;; ++i) {
        const double value = how == 'x' ? first * std::pow(step, i) : first + i * step;
        if (value > last * (1 + 1e-12 * (last > 0 ? 1 : -1))) break;
        add_number(value);
    }
}

void AxisReader::add(const std::string& item) {
    if (item.empty()) refuse("a value is empty");
    if (values.size() >= kMostValues) refuse("more than " + std::to_string(kMostValues) + " values");
    const std::size_t dots = item.find("..");
    const bool is_range = dots != std::string::npos &&
                          (kind.values != ValueKind::kJson ||
                           (as_number(item.substr(0, dots)) && item.find(':', dots) != std::string::npos));
    if (is_numeric() && is_range) return add_range(item, dots);
    if (kind.values == ValueKind::kJson) {
        values.push_back({item, as_number(item)});
    } else if (is_numeric()) {
        values.push_back({shortest_text(number_of(item)), number_of(item)});
    } else if (kind.values == ValueKind::kSize) {
        const std::size_t x = item.find('x');
        const auto width = as_number(item.substr(0, x)),
                   height = x == item.npos ? std::nullopt : as_number(item.substr(x + 1));
        if (!width || !height || *width < 1 || *height < 1 || *width != std::floor(*width) ||
            *height != std::floor(*height))
            refuse("\"" + item + "\" is no size such as 640x480");
        if (std::max(*width, *height) > kind.most_side || *width * *height > kind.most)
            refuse(item + " is too large: at most " + shortest_text(kind.most_side) + " a side, " +
                   shortest_text(kind.most) + " pixels");
        values.push_back({item, *width * *height});
    } else if (kind.values == ValueKind::kWord &&
               std::find(kind.words.begin(), kind.words.end(), item) == kind.words.end()) {
        refuse("there is no " + kind.name + " \"" + item + "\"" + suggestion(item, kind.words));
    } else {
        values.push_back({item, std::nullopt});
    }
}

std::string for_file(const std::string& text) {
    std::string name;
    for (const char c : text) {
        const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                              c == '.' || c == '+' || c == '-';
        name += is_plain ? c : '-';
    }
    return name;
}

std::string id_part(const AxisKind& kind, const AxisValue& value) {
    if (kind.name == "scene") return for_file(std::filesystem::path(value.text).stem().string());
    std::string digits = for_file(value.text);
    // Lists of files stand in the order of the numbers.
    if (kind.values == ValueKind::kWhole && kind.most > 999 && digits.size() < 4)
        digits = std::string(4 - digits.size(), '0') + digits;
    return kind.short_name + digits;
}

}  // namespace

AxisRequest parse_over(const std::string& text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
        throw UsageError("--over " + text + ": is not AXIS=VALUE,VALUE,... (example: resolution=1,2,4,8)");
    AxisRequest request{text.substr(0, equals), {""}};
    int depth = 0;
    bool is_quoted = false;
    for (std::size_t i = equals + 1; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '"' && text[i - 1] != '\\') is_quoted = !is_quoted;
        if (!is_quoted) depth += (c == '[' || c == '{') - (c == ']' || c == '}');
        if (c == ',' && depth == 0 && !is_quoted)
            request.values.emplace_back();
        else
            request.values.back() += c;
    }
    return request;
}

Axis make_axis(const AxisKind& kind, const AxisRequest& request, const std::string& where, bool keeps_order) {
    AxisReader reader{kind, where};
    if (request.values.empty()) reader.refuse("the axis " + kind.name + " has no point");
    for (const std::string& item : request.values) reader.add(item);
    if (kind.values == ValueKind::kSize || reader.is_numeric())
        if (!keeps_order &&
            std::ranges::all_of(reader.values, [](const AxisValue& v) { return v.number.has_value(); }))
            std::ranges::stable_sort(reader.values, {}, [](const AxisValue& v) { return *v.number; });
    std::vector<std::string> texts;
    for (const AxisValue& value : reader.values) texts.push_back(value.text);
    std::ranges::sort(texts);
    const auto twice = std::ranges::adjacent_find(texts);
    if (twice != texts.end() && !keeps_order) reader.refuse(*twice + " is named twice");
    return {kind, std::move(reader.values)};
}

AxisKind pointer_kind(const std::string& pointer) {
    AxisKind kind{pointer, pointer.substr(pointer.rfind('/') + 1), pointer, ValueKind::kJson};
    return kind;
}

std::vector<Coordinates> make_points(const SweepAxes& sweep) {
    std::vector<std::string> names;
    for (const Axis& axis : sweep.axes) {
        if (std::ranges::count(names, axis.kind.name) > 0)
            throw UsageError("the axis " + axis.kind.name + " is named twice");
        if (axis.values.empty()) throw UsageError("the axis " + axis.kind.name + " has no value");
        names.push_back(axis.kind.name);
    }
    std::vector<Coordinates> points(1);
    if (sweep.zip) {
        for (const Axis& axis : sweep.axes)
            if (axis.values.size() != sweep.axes[0].values.size())
                throw UsageError("zipped axes need equally many values: " + names[0] + " has " +
                                 std::to_string(sweep.axes[0].values.size()) + ", " + axis.kind.name +
                                 " has " + std::to_string(axis.values.size()));
        points.assign(sweep.axes.empty() ? 1 : sweep.axes[0].values.size(), {});
        for (const Axis& axis : sweep.axes)
            for (std::size_t i = 0; i < points.size(); ++i)
                points[i].push_back({axis.kind.name, axis.values[i]});
        return points;
    }
    for (const Axis& axis : sweep.axes) {
        if (points.size() > kMostValues / axis.values.size())
            throw UsageError("the axes have more than " + std::to_string(kMostValues) + " points together");
        std::vector<Coordinates> longer;
        for (const Coordinates& point : points)
            for (const AxisValue& value : axis.values) {
                longer.push_back(point);
                longer.back().push_back({axis.kind.name, value});
            }
        points = std::move(longer);
    }
    return points;
}

std::string point_id(const SweepAxes& sweep, const Coordinates& point) {
    std::string id;
    for (const Axis& axis : sweep.axes)
        if (const AxisValue* value = find_coordinate(point, axis.kind.name))
            id += (id.empty() ? "" : "_") + id_part(axis.kind, *value);
    if (id.empty()) return "run";
    if (id[0] == '.') id[0] = '-';
    if (id.size() <= kLongestId) return id;
    return id.substr(0, kLongestId - 17) + "-" + hash_text(id);
}

std::string point_text(const Coordinates& point) {
    std::string text;
    for (const Coordinate& one : point)
        text +=
            (text.empty() ? "" : ", ") + (one.axis == "resolution" ? "n" : one.axis) + " = " + one.value.text;
    return text;
}

const AxisValue* find_coordinate(const Coordinates& point, const std::string& axis) {
    for (const Coordinate& one : point)
        if (one.axis == axis) return &one.value;
    return nullptr;
}

}  // namespace trilens
