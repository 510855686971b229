#include "scene/animation/animation_keys.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "base/util/error.h"
#include "base/util/format.h"
#include "json/schema.h"
#include "scene/data/scene_inputs.h"
#include "scene/read/override.h"
#include "scene/read/reading.h"

namespace trilens {
namespace {

enum class Course { kLinear, kSmooth, kStep };

Course course_of(const Node& track) {
    const std::string name = string_or(track, "interpolation", "linear");
    return name == "step" ? Course::kStep : name == "smooth" ? Course::kSmooth : Course::kLinear;
}

bool is_rotation(const std::string& target) {
    constexpr std::string_view kEnd = "/transform/rotate";
    return target.size() > kEnd.size() && target.compare(target.size() - kEnd.size(), kEnd.size(), kEnd) == 0;
}

/// What keeps two values from being interpolated: empty where nothing does.
std::string mismatch(const Json& a, const Json& b) {
    if (a.is_number() && b.is_number()) return "";
    if (!a.is_array() || !b.is_array()) {
        if (a.is_number() || a.is_array())
            return describe(b) + " is not like " + describe(a) + ", so that nothing lies between them";
        return describe(a) + " is no number: its interpolation can only be \"step\"";
    }
    if (a.size() != b.size()) return describe(b) + " is not like " + describe(a);
    for (std::size_t i = 0; i < a.size(); ++i)
        if (std::string why = mismatch(a[i], b[i]); !why.empty()) return why;
    return "";
}

Json number_between(const Json& a, const Json& b, double s) {
    const double from = a.get<double>(), to = b.get<double>();
    const double value = s == 1 ? to : from + s * (to - from);
    constexpr double kExactIntegers = 9e15;
    if (a.is_number_integer() && b.is_number_integer() && value == std::floor(value) &&
        std::fabs(value) < kExactIntegers)
        return static_cast<long long>(value);
    return value;
}

Json between(const Json& a, const Json& b, double s) {
    if (a.is_number()) return number_between(a, b, s);
    Json values = Json::array();
    for (std::size_t i = 0; i < a.size(); ++i) values.push_back(between(a[i], b[i], s));
    return values;
}

Vec4 unit_quaternion(const Json& value) {
    const Vec4 q = read_rotation(Node{value, "", ""});
    return q / length(q);
}

/// Along the great circle through both, the shorter way; q and -q are one rotation.
Json rotation_between(const Json& a, const Json& b, double s) {
    const Vec4 from = unit_quaternion(a);
    Vec4 to = unit_quaternion(b);
    if (dot(from, to) < 0) to = -to;
    const double sine = length(to - dot(from, to) * from), angle = std::atan2(sine, dot(from, to));
    constexpr double kNearlyOne = 1e-9;
    const Vec4 mixed = sine < kNearlyOne
                           ? (1 - s) * from + s * to
                           : (std::sin((1 - s) * angle) * from + std::sin(s * angle) * to) / sine;
    const Vec4 unit = mixed / length(mixed);
    return Json::array({unit.x, unit.y, unit.z, unit.w});
}

Json value_at(const Node& track, double frame) {
    const Json& keys = track.json.at("keys");
    std::size_t next = 0;
    while (next < keys.size() && keys[next].at("frame").get<double>() <= frame) ++next;
    if (next == 0) return keys[0].at("value");
    const Json &before = keys[next - 1], &value = before.at("value");
    if (next == keys.size() || course_of(track) == Course::kStep) return value;
    const double from = before.at("frame").get<double>(), to = keys[next].at("frame").get<double>();
    double s = (frame - from) / (to - from);
    if (s == 0) return value;
    if (course_of(track) == Course::kSmooth) s = s * s * (3 - 2 * s);
    const std::string target = track.json.at("target").get<std::string>();
    return is_rotation(target) ? rotation_between(value, keys[next].at("value"), s)
                               : between(value, keys[next].at("value"), s);
}

/// As the schema has it, and not zero.
void check_rotation(const Node& value) {
    static const Json schema{{"$ref", "#/definitions/rotation"},
                             {"definitions", scene_schema_json().at("definitions")}};
    if (value.json.is_array() && value.size() != 4) value.fail("a rotation is a quaternion: x, y, z, w");
    if (const auto found = find_problem(value.json, schema))
        fail_at(value.file, value.place + found->place, found->message);
    read_rotation(value);
}

/// Of angles that turn farther than quaternions can tell: they go by the shorter way.
void check_turn(const Node& before, const Node& after) {
    constexpr double kMostTurn = 180;
    const auto refuse_far = [&](const Json& from, const Json& to) {
        if (std::fabs(to.get<double>() - from.get<double>()) > kMostTurn)
            after.fail(
                "turns by more than 180 degrees from the key before, of which only the shorter way could be "
                "seen: give keys between them, or animate the angle itself");
    };
    if (before.has("euler") && after.has("euler"))
        for (std::size_t k = 0; k < 3; ++k) refuse_far(before.json.at("euler")[k], after.json.at("euler")[k]);
    if (before.has("angle") && after.has("angle") && before.json.at("axis") == after.json.at("axis"))
        refuse_far(before.json.at("angle"), after.json.at("angle"));
}

void check_track(const Node& root, const Node& track) {
    const Node keys = track["keys"], target = track["target"];
    const std::string pointer = target.json.get<std::string>();
    if (pointer.rfind("/animation", 0) == 0) target.fail("an animation cannot animate itself");
    if (pointer.rfind("/lenses", 0) == 0)
        target.fail(
            "a lens has no keys: its bodies are meshes, which do (/meshes/NAME/transform; scene info names "
            "them)");
    for (std::size_t k = 0; k < keys.size(); ++k) {
        const Node value = keys[k]["value"];
        if (is_rotation(pointer)) {
            check_rotation(value);
            if (k > 0 && course_of(track) != Course::kStep) check_turn(keys[k - 1]["value"], value);
        } else if (course_of(track) != Course::kStep) {
            const std::string why = mismatch(keys[std::size_t{0}]["value"].json, value.json);
            if (!why.empty()) value.fail(why);
        }
        if (k > 0 && !(keys[k]["frame"].json.get<double>() > keys[k - 1]["frame"].json.get<double>()))
            keys[k]["frame"].fail("must lie after the key before it, at " +
                                  describe(keys[k - 1]["frame"].json.get<double>()));
    }
    // The target is found, or added, as an override finds it.
    try {
        Json copy = root.json;
        const SceneOverride first{pointer, keys[std::size_t{0}]["value"].json.dump()};
        apply_overrides(copy, std::span(&first, 1), root.file);
    } catch (const InputError& error) {
        target.fail("'" + pointer + "' names no value of the scene");
    }
}

}  // namespace

void check_animation(const Node& root) {
    const Node tracks = root["animation"]["tracks"];
    std::set<std::string> targets;  // of the tracks before
    for (std::size_t i = 0; i < tracks.size(); ++i) {
        const Node target = tracks[i]["target"];
        check_track(root, tracks[i]);
        const std::string pointer = pointer_by_places(root.json, target.json.get<std::string>(), root.file);
        for (std::size_t end = pointer.find('/', 1); end != std::string::npos;
             end = pointer.find('/', end + 1))
            if (const std::string whole = pointer.substr(0, end); targets.contains(whole))
                target.fail("is a part of " + whole + ", which an earlier track animates");
        const auto inside = targets.lower_bound(pointer + "/");
        if (inside != targets.end() && inside->starts_with(pointer + "/"))
            target.fail("holds " + *inside + ", which an earlier track animates and this one would undo");
        if (!targets.insert(pointer).second) target.fail("is animated by an earlier track already");
    }
}

void apply_animation(Json& scene, double frame, const std::string& file) {
    if (!scene.contains("animation")) return;
    const Json animation = scene.at("animation");
    scene.erase("animation");
    const Node tracks{animation.at("tracks"), "/animation/tracks", file};
    for (std::size_t i = 0; i < tracks.size(); ++i) {
        const SceneOverride change{tracks[i].json.at("target").get<std::string>(),
                                   value_at(tracks[i], frame).dump()};
        apply_overrides(scene, std::span(&change, 1), file);
    }
}

}  // namespace trilens
