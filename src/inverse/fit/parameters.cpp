#include "inverse/fit/fit_problem.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <optional>
#include <set>

#include "base/util/format.h"
#include "base/util/names.h"
#include "json/schema.h"
#include "scene/parameters.h"
#include "scene/read/override.h"
#include "scene/read/reading.h"

namespace trilens {
namespace {

constexpr double kDegree = 0.017453292519943295;

std::vector<std::string> keys_of(const std::string& pointer, const std::string& file) {
    if (pointer.empty() || pointer[0] != '/')
        fail_at(file, pointer, "is no JSON pointer: it must begin with '/'");
    std::vector<std::string> keys;
    for (std::size_t i = 0; i < pointer.size(); ++i) {
        if (pointer[i] == '/')
            keys.emplace_back();
        else if (pointer[i] == '~' && i + 1 < pointer.size() &&
                 (pointer[i + 1] == '0' || pointer[i + 1] == '1'))
            keys.back() += pointer[++i] == '0' ? '~' : '/';
        else
            keys.back() += pointer[i];
    }
    return keys;
}

/// The place of an array's entry that is named by place or by its name.
std::optional<std::size_t> find_entry(const Json& array, const std::string& key) {
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), index);
    if (error == std::errc() && end == key.data() + key.size())
        return index < array.size() ? std::optional(index) : std::nullopt;
    for (std::size_t i = 0; i < array.size(); ++i)
        if (array[i].is_object() && array[i].contains("name") && array[i]["name"] == key) return i;
    return std::nullopt;
}

/// The default that the schema of an object gives its key; null where it gives none.
const Json* default_of(const Json& object_schema, const std::string& key, const Json& root) {
    const Json& object = resolve_schema(object_schema, root);
    if (!object.contains("properties") || !object.at("properties").contains(key)) return nullptr;
    const Json& part = object.at("properties").at(key);  // beside a "$ref" its own goes first
    if (part.contains("default")) return &part.at("default");
    const Json& resolved = resolve_schema(part, root);
    return resolved.contains("default") ? &resolved.at("default") : nullptr;
}

/// A pointer followed through document and schema; missing keys with defaults are added.
struct Followed {
    Json* value = nullptr;
    std::vector<std::string> keys;  // with places instead of names
};

Followed follow(Json& document, const std::string& pointer, const std::string& file) {
    const Json& root = scene_schema_json();
    const Json* schema = &root;
    Followed found{&document, {}};
    for (const std::string& key : keys_of(pointer, file)) {
        if (found.value->is_array()) {
            const std::optional<std::size_t> entry = find_entry(*found.value, key);
            if (!entry)
                fail_at(
                    file, pointer,
                    fmt::format("names nothing: there is no entry '{}' among {}", key, found.value->size()));
            found.keys.push_back(std::to_string(*entry));
            found.value = &(*found.value)[*entry];
        } else {
            if (!found.value->is_object())
                fail_at(file, pointer,
                        "names nothing: " + describe(*found.value) + " has no part '" + key + "'");
            const Json* part = schema ? schema_of_part(*schema, key, root) : nullptr;
            if (!found.value->contains(key)) {
                if (!part)
                    fail_at(file, pointer,
                            "names nothing: unknown key '" + key + "'" +
                                (schema ? suggestion(key, known_keys(resolve_schema(*schema, root)))
                                        : std::string()));
                const Json& resolved = resolve_schema(*part, root);
                if (const Json* usual = default_of(*schema, key, root))
                    (*found.value)[key] = *usual;
                else if (resolved.contains("type") && resolved.at("type") == "object")
                    (*found.value)[key] = Json::object();
                else
                    fail_at(file, pointer, "names nothing: there is no '" + key + "' yet, and no default");
            }
            found.keys.push_back(key);
            found.value = &(*found.value)[key];
        }
        schema = schema ? schema_of_part(*schema, key, root) : nullptr;
    }
    return found;
}

bool is_one_of(const std::string& key, std::initializer_list<const char*> names) {
    return std::any_of(names.begin(), names.end(), [&](const char* name) { return key == name; });
}

/// The key that says what kind of number it is: the last that is no place in an array.
std::string kind_of(const std::vector<std::string>& keys) {
    for (auto key = keys.rbegin(); key != keys.rend(); ++key)
        if (key->find_first_not_of("0123456789") != std::string::npos) return *key;
    return "";
}

double scale_of(const std::vector<std::string>& keys, double value, double extent, const Json& film) {
    const std::string kind = kind_of(keys);
    if (is_one_of(kind, {"yfov", "hfov", "vfov", "fov", "contextFov", "angle", "euler"})) return 30;
    if (is_one_of(kind, {"fx", "fy", "cx", "cy"}))
        return film.is_object() && film.contains("width") ? film["width"].get<double>() : 640;
    if (is_one_of(kind, {"eye", "at", "center", "translate", "points", "radius", "height", "focalLength",
                         "size", "ymag", "vrp", "prp"}))
        return extent;
    return std::max(1.0, std::abs(value));
}

std::string joined_pointer(const std::vector<std::string>& keys, std::size_t from) {
    std::string pointer;
    for (std::size_t k = from; k < keys.size(); ++k) pointer += "/" + escape_key(keys[k]);
    return pointer;
}

ScenePart part_named(const std::vector<std::string>& keys, const std::string& pointer,
                     const std::string& file) {
    if (keys.size() >= 3) {
        if (keys[0] == "cameras") return ScenePart::kCamera;
        if (keys[0] == "meshes") return ScenePart::kMesh;
        if (keys[0] == "materials") return ScenePart::kMaterial;
    }
    fail_at(file, pointer, "is no number of a camera, a mesh or a material, on which images depend");
}

/// Adds the numbers below `value`.
void add_numbers(const Json& value, const FitParameter& like, const std::vector<std::string>& keys,
                 const std::function<double(double)>& scale, std::vector<FitParameter>& found) {
    if (value.is_array()) {
        for (std::size_t i = 0; i < value.size(); ++i) {
            std::vector<std::string> below = keys;
            below.push_back(std::to_string(i));
            add_numbers(value[i], like, below, scale, found);
        }
        return;
    }
    FitParameter parameter = like;
    parameter.name = joined_pointer(keys, 0);
    parameter.inside = joined_pointer(keys, 2);
    if (!value.is_number()) fail_at("", parameter.name, "is " + describe(value) + ", no number");
    parameter.scale = scale(value.get<double>());
    found.push_back(parameter);
}

Quat quaternion_in(const Json& rotate) {
    return normalize(Quat(rotate[3].get<double>(), rotate[0].get<double>(), rotate[1].get<double>(),
                          rotate[2].get<double>()));
}

}  // namespace

std::vector<FitParameter> find_parameters(Json& document, std::span<const std::string> pointers,
                                          const std::string& file, double extent) {
    std::vector<FitParameter> found;
    for (const std::string& pointer : pointers) {
        const Followed at = follow(document, pointer, file);
        FitParameter like;
        like.part = part_named(at.keys, pointer, file);
        like.index = std::stoul(at.keys[1]);
        const bool is_quaternion =
            at.keys.back() == "rotate" && at.value->is_array() && at.value->size() == 4;
        if (is_quaternion) {
            like.is_turn = true;
            like.inside = joined_pointer(at.keys, 2);
            like.scale = 30;
            for (int k = 0; k < 3; ++k) {
                like.axis = Vec3(0);
                like.axis[k] = 1;
                like.name = joined_pointer(at.keys, 0) + "/" + "xyz"[k];
                found.push_back(like);
            }
            continue;
        }
        if (!at.value->is_number() && !at.value->is_array())
            fail_at(file, pointer, "is " + describe(*at.value) + ", no number");
        const Json film = document.contains("film") ? document.at("film") : Json();
        try {
            add_numbers(
                *at.value, like, at.keys,
                [&](double value) { return scale_of(at.keys, value, extent, film); }, found);
        } catch (const InputError& error) {
            throw InputError(file, "", error.what());
        }
    }
    std::set<std::string> names;
    for (const FitParameter& parameter : found)
        if (!names.insert(parameter.name).second) fail_at(file, parameter.name, "is free twice");
    return found;
}

void require_same_scene(const Scene& scene, std::span<const std::string> free) {
    const std::string file = scene_title(scene);
    const Json before = resolved_json(scene);
    for (const std::string& pointer : free) {
        Json document = before;
        find_parameters(document, std::span(&pointer, 1), file, 1);
        if (document == before) continue;
        std::string why = "the scene is another";
        try {
            if (is_same_scene(scene, document.dump())) continue;
        } catch (const InputError& error) {
            why = error.what();
        }
        throw InputError(file, pointer, "is not in the scene, and with its default there: " + why);
    }
}

Json& part_of(Json& document, const FitParameter& parameter) {
    const char* key = parameter.part == ScenePart::kCamera ? "cameras"
                      : parameter.part == ScenePart::kMesh ? "meshes"
                                                           : "materials";
    return document.at(key).at(parameter.index);
}

const Json& part_of(const Json& document, const FitParameter& parameter) {
    return part_of(const_cast<Json&>(document), parameter);
}

void move_parameter(Json& part, const FitParameter& parameter, double amount) {
    Json& value = part.at(Json::json_pointer(parameter.inside));
    if (!parameter.is_turn) {
        value = value.get<double>() + amount;
        return;
    }
    const Quat turned = glm::angleAxis(amount * kDegree, parameter.axis) * quaternion_in(value);
    value = Json::array({turned.x, turned.y, turned.z, turned.w});
}

double parameter_value(const Json& document, const FitParameter& parameter, const Json& start) {
    const Json::json_pointer inside(parameter.inside);
    const Json& value = part_of(document, parameter).at(inside);
    if (!parameter.is_turn) return value.get<double>();
    Quat turn = quaternion_in(value) * glm::conjugate(quaternion_in(part_of(start, parameter).at(inside)));
    if (turn.w < 0) turn = -turn;
    const Vec3 sine(turn.x, turn.y, turn.z);
    const double half = std::atan2(length(sine), turn.w);
    const double factor = length(sine) > 0 ? 2 * half / length(sine) / kDegree : 0;
    return factor * dot(sine, parameter.axis);
}

std::string describe_motion(std::span<const FitParameter> parameters, std::span<const double> motion) {
    double largest = 0;
    for (const double m : motion) largest = std::max(largest, std::abs(m));
    std::vector<std::size_t> moved;
    for (std::size_t i = 0; i < motion.size(); ++i)
        if (std::abs(motion[i]) >= 0.1 * largest) moved.push_back(i);
    std::stable_sort(moved.begin(), moved.end(),
                     [&](std::size_t a, std::size_t b) { return std::abs(motion[a]) > std::abs(motion[b]); });

    const FitParameter& first = parameters[moved.front()];
    const bool is_turn = std::all_of(moved.begin(), moved.end(), [&](std::size_t i) {
        return parameters[i].is_turn && parameters[i].part == first.part &&
               parameters[i].index == first.index;
    });
    if (is_turn) {
        Vec3 axis(0);
        for (const std::size_t i : moved) axis += motion[i] * parameters[i].axis;
        axis = normalize(axis);
        const std::string mesh = first.name.substr(0, first.name.find("/transform"));
        return fmt::format("turning {} about the axis ({:.3g}, {:.3g}, {:.3g})", mesh, axis.x + 0.0,
                           axis.y + 0.0, axis.z + 0.0);
    }
    std::string text;
    constexpr std::size_t kMostNamed = 4;
    for (std::size_t k = 0; k < std::min(moved.size(), kMostNamed); ++k)
        text += (k > 0 ? " with " : "") + parameters[moved[k]].name;
    if (moved.size() > kMostNamed) text += fmt::format(" and {} more", moved.size() - kMostNamed);
    return text;
}

}  // namespace trilens
