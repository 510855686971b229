// What the values of a script's steps are: numbers in their ranges, names, settings.
#include <trilens/error.h>
#include <trilens/utilities.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "view/script.h"

namespace trilens {

std::vector<double> numbers_in(const Json& value, std::size_t count) {
    std::vector<double> numbers;
    if (value.is_array() && value.size() == count)
        for (const Json& one : value)
            if (one.is_number()) numbers.push_back(one.get<double>());
    if (value.is_number() && count == 1) numbers.push_back(value.get<double>());
    if (numbers.size() != count)
        throw UsageError(fmt::format("needs {} number{}", count, count == 1 ? "" : "s"));
    return numbers;
}

double number_in(const Json& value, double least, double most) {
    const double number = numbers_in(value, 1)[0];
    if (number >= least && number <= most) return number;
    throw UsageError(std::isinf(most)
                         ? fmt::format("{:g} is out of range: at least {:g}", number, least)
                         : fmt::format("{:g} is out of range: {:g} to {:g}", number, least, most));
}

int count_in(const Json& value, int most) {
    const double number = number_in(value, 1, most);
    if (number != std::floor(number)) throw UsageError(fmt::format("{:g} is no whole number", number));
    return static_cast<int>(number);
}

std::string text_in(const Json& value) {
    if (!value.is_string()) throw UsageError("needs a text");
    return value.get<std::string>();
}

bool flag_in(const Json& value) {
    if (!value.is_boolean()) throw UsageError("needs true or false");
    return value.get<bool>();
}

namespace {

constexpr int kFinestGrid = 1024;
constexpr double kSmallest = 1e-6, kEndless = std::numeric_limits<double>::infinity();

template <typename E>
E named_in(const Json& value) {
    const auto found = find_named<E>(text_in(value));
    if (!found)
        throw UsageError("unknown: \"" + text_in(value) + "\"" + suggestion(text_in(value), names_of<E>()));
    return *found;
}

/// The same, or null for what the scene says.
template <typename E>
std::optional<E> chosen_in(const Json& value) {
    return value.is_null() ? std::nullopt : std::optional<E>(named_in<E>(value));
}

std::size_t camera_in(const Json& value, const Json& scene) {
    const Json& cameras = scene.at("cameras");
    for (std::size_t i = 0; i < cameras.size(); ++i)
        if (value.is_string() ? cameras[i].value("name", "") == value.get<std::string>()
                              : value.is_number_unsigned() && value.get<std::size_t>() == i)
            return i;
    throw UsageError("the scene has no camera " + value.dump());
}

using TakeSetting = std::function<void(ViewSettings&, const Json& value, const Json& scene)>;

const std::map<std::string, TakeSetting>& setting_takers() {
    static const std::map<std::string, TakeSetting> kTakers{
        {"n", [](ViewSettings& to, const Json& v,
                 const Json&) { to.frame.resolution = v.is_null() ? 0 : count_in(v, kFinestGrid); }},
        {"rays",
         [](ViewSettings& to, const Json& v, const Json&) { to.frame.rays = chosen_in<CornerRays>(v); }},
        {"grid",
         [](ViewSettings& to, const Json& v, const Json&) { to.frame.grid = chosen_in<GridKind>(v); }},
        {"facetUse",
         [](ViewSettings& to, const Json& v, const Json&) { to.frame.facets = named_in<FacetUse>(v); }},
        {"maxError",
         [](ViewSettings& to, const Json& v, const Json&) {
             to.frame.max_error =
                 v.is_null() ? std::nullopt : std::optional(number_in(v, kSmallest, kEndless));
         }},
        {"camera",
         [](ViewSettings& to, const Json& v, const Json& scene) { to.frame.camera = camera_in(v, scene); }},
        {"engine", [](ViewSettings& to, const Json& v, const Json&) { to.engine = named_in<Engine>(v); }},
        {"exposure", [](ViewSettings& to, const Json& v,
                        const Json&) { to.tone.exposure = number_in(v, -kEndless, kEndless); }},
        {"tone",
         [](ViewSettings& to, const Json& v, const Json&) { to.tone.curve = tone_curve(text_in(v)); }},
        {"layer",
         [](ViewSettings& to, const Json& v, const Json&) {
             static const std::vector<std::string> kLayers{"", "direct", "reflect", "refract"};
             if (std::find(kLayers.begin(), kLayers.end(), text_in(v)) == kLayers.end())
                 throw UsageError("unknown layer" + suggestion(text_in(v), kLayers));
             to.layer = text_in(v);
         }},
        {"left", [](ViewSettings& to, const Json& v, const Json&) { to.left = named_in<ShownPicture>(v); }},
        {"right", [](ViewSettings& to, const Json& v, const Json&) { to.right = named_in<ShownPicture>(v); }},
        {"wipe", [](ViewSettings& to, const Json& v, const Json&) { to.wipe = number_in(v, 0, 1); }},
        {"scale", [](ViewSettings& to, const Json& v,
                     const Json&) { to.difference_scale = number_in(v, kSmallest, kEndless); }},
        {"facets", [](ViewSettings& to, const Json& v, const Json&) { to.overlays.facets = flag_in(v); }},
        {"edges", [](ViewSettings& to, const Json& v, const Json&) { to.overlays.edges = flag_in(v); }},
        {"folds", [](ViewSettings& to, const Json& v, const Json&) { to.overlays.folds = flag_in(v); }},
        {"method", [](ViewSettings& to, const Json& v, const Json&) { to.overlays.method = flag_in(v); }},
        {"caustics", [](ViewSettings& to, const Json& v, const Json&) { to.overlays.caustics = flag_in(v); }},
        {"birdsEye", [](ViewSettings& to, const Json& v, const Json&) { to.birds_eye.shown = flag_in(v); }},
        {"azimuth", [](ViewSettings& to, const Json& v,
                       const Json&) { to.birds_eye.azimuth = number_in(v, -kEndless, kEndless); }},
        {"elevation", [](ViewSettings& to, const Json& v,
                         const Json&) { to.birds_eye.elevation = number_in(v, -89, 89); }},
        {"distance", [](ViewSettings& to, const Json& v, const Json&) {
             to.birds_eye.distance = number_in(v, 0.01, kEndless);
         }}};
    return kTakers;
}

}  // namespace

ViewSettings shown_settings(const Json& show, const ViewSettings& from, const Json& scene) {
    if (!show.is_object()) throw UsageError("\"show\" needs an object of settings");
    ViewSettings to = from;
    for (const auto& [key, value] : show.items()) {
        const auto taker = setting_takers().find(key);
        if (taker == setting_takers().end()) {
            std::vector<std::string> known;
            for (const auto& one : setting_takers()) known.push_back(one.first);
            throw UsageError("unknown setting \"" + key + "\"" + suggestion(key, known));
        }
        try {
            taker->second(to, value, scene);
        } catch (const UsageError& error) {
            throw UsageError(key + ": " + error.what());
        }
    }
    return to;
}

}  // namespace trilens
