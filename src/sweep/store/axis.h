// What a sweep varies: named lists of values, and the points that they span.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace trilens {

/// How the values of an axis are written. kWhole, kNumber: decimal numbers and ranges of them. kSize: "WxH",
/// whose number is the pixels. kJson: any JSON text; numbers and ranges of them where they read as such.
/// kWord: one of AxisKind::words. kText: anything, such as a name or a file.
enum class ValueKind { kWhole, kNumber, kSize, kJson, kWord, kText };

/// What an axis is called and takes.
struct AxisKind {
    std::string name;        // "resolution"
    std::string short_name;  // before its values in the names of runs: "n"; empty: the values stand alone
    std::string label;       // on plots, with its unit
    ValueKind values = ValueKind::kText;
    double least = -std::numeric_limits<double>::infinity();
    double most = std::numeric_limits<double>::infinity();
    bool is_scale = false;  // errors follow a power of it: fits are made along it
    std::vector<std::string> words = {};
    double most_side = std::numeric_limits<double>::infinity();  // kSize: of W and H
};

/// A value as it was written, and the number that it stands for.
struct AxisValue {
    std::string text;
    std::optional<double> number = {};
    bool operator==(const AxisValue&) const = default;
};

/// An axis as it is asked for; each value is a text as in AxisKind, or a range: "1..64:x2" multiplies by 2
/// from 1 while at most 64, "8..32:+8" adds 8.
struct AxisRequest {
    std::string axis;
    std::vector<std::string> values;
};

/// A named list of values, each once, at least one.
struct Axis {
    AxisKind kind;
    std::vector<AxisValue> values;
};

/// Axes together: every combination (the first axis changes slowest), or zipped: the first values of all, the
/// second values of all.
struct SweepAxes {
    std::vector<Axis> axes;
    bool zip = false;
};

/// Where a run stands along one axis.
struct Coordinate {
    std::string axis;
    AxisValue value;
    bool operator==(const Coordinate&) const = default;
};
using Coordinates = std::vector<Coordinate>;

/// "AXIS=VALUE,VALUE,...", cut at the commas outside brackets and quotes. Throws UsageError without "=".
AxisRequest parse_over(const std::string& text);

/// The axis of this kind with these values, ranges written out; numbers ascending unless `keeps_order`.
/// Throws UsageError whose message starts with `where`: no value, one that the kind does not take, a step
/// that does not grow, a range that runs backwards, a value twice, more than 100000 values.
Axis make_axis(const AxisKind& kind, const AxisRequest& request, const std::string& where,
               bool keeps_order = false);

/// The kind of a JSON pointer as an axis: its last part names runs, "/materials/0/ior" "ior".
AxisKind pointer_kind(const std::string& pointer);

/// The points, in the order of the plan. Throws UsageError for an axis without values, two axes of one name,
/// zipped axes of unequal length, more than 100000 points.
std::vector<Coordinates> make_points(const SweepAxes& axes);

/// A name for files, from the values: "n0008", "classic_n0008_spp2".
std::string point_id(const SweepAxes& axes, const Coordinates& point);

/// "engine = classic, resolution = 8".
std::string point_text(const Coordinates& point);

/// The value along the axis of this name; null where the point has none.
const AxisValue* find_coordinate(const Coordinates& point, const std::string& axis);

}  // namespace trilens
