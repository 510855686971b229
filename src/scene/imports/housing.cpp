#include "scene/imports/housing.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "base/files/files.h"
#include "base/math/vec.h"
#include "base/util/error.h"
#include "base/util/format.h"
#include "scene/formats/line_scanner.h"

namespace trilens {
namespace {

/// Sides of a flat port, in its distance and thickness: rays at 89 degrees meet it.
constexpr double kPortSides = 200;

/// COLMAP's names, how many focal lengths the parameters begin with, and how many follow the principal point.
struct LensModel {
    std::string_view name;
    std::size_t focal_lengths, distortions;
    bool fisheye = false;
};
constexpr std::array kLensModels{LensModel{"SIMPLE_PINHOLE", 1, 0},
                                 LensModel{"PINHOLE", 2, 0},
                                 LensModel{"SIMPLE_RADIAL", 1, 1},
                                 LensModel{"RADIAL", 1, 2},
                                 LensModel{"OPENCV", 2, 4},
                                 LensModel{"FULL_OPENCV", 2, 8},
                                 LensModel{"SIMPLE_RADIAL_FISHEYE", 1, 1, true},
                                 LensModel{"RADIAL_FISHEYE", 1, 2, true},
                                 LensModel{"OPENCV_FISHEYE", 2, 4, true}};

constexpr std::size_t kPortNumbers = 8;

/// A port's numbers: normal or centre, distance or radius, thickness, and the three indices.
struct Port {
    bool is_dome = false;
    Vec3 at{0};
    double inside = 0, thickness = 0, air = 1, glass = 1, water = 1;

    bool operator==(const Port&) const = default;
};

struct CalibratedCamera {
    std::string name;
    const LensModel* model = nullptr;
    int width = 0, height = 0;
    std::vector<double> parameters = {};
    std::optional<Port> port = {};
};

/// A place of a text, for messages.
struct TextPlace {
    const std::string& file;
    std::size_t line;

    [[noreturn]] void fail(const std::string& message) const {
        throw InputError(file, line == 0 ? "" : "line " + std::to_string(line), message);
    }
    double number(std::string_view word) const {
        const std::optional<double> value = parse_number(word);
        if (!value || !std::isfinite(*value)) fail("\"" + std::string(word) + "\" is no number");
        return *value;
    }
    int size(std::string_view word) const {
        const std::optional<int> value = parse_integer(word);
        if (!value || *value < 1) fail("\"" + std::string(word) + "\" is no size in pixels");
        return *value;
    }
};

const LensModel& model_named(std::string_view name, const TextPlace& place) {
    const auto* const found = std::ranges::find(kLensModels, name, &LensModel::name);
    if (found != kLensModels.end()) return *found;
    std::string known;
    for (const LensModel& model : kLensModels) known += (known.empty() ? "" : ", ") + std::string(model.name);
    place.fail("there is no camera model \"" + std::string(name) + "\"; known: " + known);
}

Port port_named(std::string_view name, const std::vector<double>& numbers, const TextPlace& place) {
    if (name != "FLATPORT" && name != "DOMEPORT")
        place.fail("there is no port \"" + std::string(name) + "\"; known: FLATPORT, DOMEPORT");
    if (numbers.size() != kPortNumbers)
        place.fail(fmt::format("a port has {} numbers, not {}", kPortNumbers, numbers.size()));
    Port port{name == "DOMEPORT", {numbers[0], numbers[1], numbers[2]},
              numbers[3],         numbers[4],
              numbers[5],         numbers[6],
              numbers[7]};
    for (const auto& [value, what] : {std::pair(port.inside, port.is_dome ? "radius" : "distance"),
                                      {port.thickness, "thickness"},
                                      {port.air, "index of air"},
                                      {port.glass, "index of glass"},
                                      {port.water, "index of water"}})
        if (!(value > 0)) place.fail(fmt::format("a port's {} is a positive number, not {}", what, value));
    if (port.is_dome && !(length(port.at) < port.inside)) place.fail("the camera stands outside of its dome");
    if (!port.is_dome && !(port.at.z > 0))
        place.fail("a flat port's normal looks away from the camera: Nz > 0");
    return port;
}

std::size_t parameters_of(const LensModel& model) {
    return model.focal_lengths + 2 + model.distortions;
}

void check_parameters(const CalibratedCamera& camera, const TextPlace& place) {
    const std::size_t wanted = parameters_of(*camera.model);
    if (camera.parameters.size() != wanted)
        place.fail(fmt::format("a camera {} has {} parameters, not {}", camera.model->name, wanted,
                               camera.parameters.size()));
    for (std::size_t k = 0; k < camera.model->focal_lengths; ++k)
        if (!(camera.parameters[k] > 0)) place.fail("a focal length is a positive number of pixels");
}

/// "[1, 2, 3]" as numbers; anything else is one word.
std::vector<double> numbers_of_list(std::string_view text, const TextPlace& place) {
    if (text.size() < 2 || text.front() != '[' || text.back() != ']')
        place.fail("needs a list of numbers, [a, b, ...] on one line");
    std::string inner(text.substr(1, text.size() - 2));
    std::ranges::replace(inner, ',', ' ');
    std::vector<double> numbers;
    for (const std::string_view word : split_words(inner)) numbers.push_back(place.number(word));
    return numbers;
}

/// A line of the part of YAML that Calibmar writes: "key: value", a comment, or nothing.
struct YamlLine {
    std::string key, value;
};
YamlLine yaml_line(std::string_view line, const TextPlace& place) {
    line = line.substr(0, line.find('#'));
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back()))) line.remove_suffix(1);
    if (line.empty() || line == "---" || line == "...") return {};
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) place.fail("is no \"key: value\"");
    std::string_view value = line.substr(colon + 1);
    while (!value.empty() && std::isspace(static_cast<unsigned char>(value.front()))) value.remove_prefix(1);
    return {std::string(line.substr(0, colon)), std::string(value)};
}

std::vector<std::string_view> lines_of(std::string_view text) {
    std::vector<std::string_view> lines;
    for (std::size_t from = 0; from < text.size();) {
        const std::size_t end = std::min(text.find('\n', from), text.size());
        lines.push_back(text.substr(from, end - from));
        from = end + 1;
    }
    return lines;
}

CalibratedCamera read_calibmar(std::string_view text, const std::string& file) {
    CalibratedCamera camera{.name = "main", .model = nullptr};
    std::string port_name;
    std::vector<double> port_numbers;
    std::size_t number = 0, port_line = 0, parameter_line = 0;
    for (const std::string_view line : lines_of(text)) {
        const TextPlace place{file, ++number};
        const auto [key, value] = yaml_line(line, place);
        if (key == "model") camera.model = &model_named(value, place);
        if (key == "parameters") camera.parameters = numbers_of_list(value, place), parameter_line = number;
        if (key == "width") camera.width = place.size(value);
        if (key == "height") camera.height = place.size(value);
        if (key == "non_svp_model" && value != "NONE") port_name = value, port_line = number;
        if (key == "non_svp_parameters") port_numbers = numbers_of_list(value, place);
    }
    const TextPlace whole{file, 0};
    if (!camera.model) whole.fail("has no \"model\": it is no calibration of Calibmar's");
    if (parameter_line == 0) whole.fail("has no \"parameters\"");
    if (camera.width == 0 || camera.height == 0) whole.fail("has no \"width\" or no \"height\"");
    check_parameters(camera, {file, parameter_line});
    if (!port_name.empty()) camera.port = port_named(port_name, port_numbers, {file, port_line});
    return camera;
}

/// CAMERA_ID MODEL WIDTH HEIGHT PARAMS... [REFRAC_MODEL PARAMS...]
CalibratedCamera read_colmap_line(const std::vector<std::string_view>& words, const TextPlace& place) {
    if (words.size() < 4)
        place.fail("needs CAMERA_ID MODEL WIDTH HEIGHT PARAMS...: it is no camera of COLMAP's");
    CalibratedCamera camera{.name = std::string(words[0]), .model = &model_named(words[1], place)};
    camera.width = place.size(words[2]);
    camera.height = place.size(words[3]);
    const std::size_t wanted = std::min(parameters_of(*camera.model), words.size() - 4);
    for (std::size_t k = 0; k < wanted; ++k) camera.parameters.push_back(place.number(words[4 + k]));
    check_parameters(camera, place);
    const std::size_t port = 4 + wanted;
    if (port == words.size()) return camera;
    std::vector<double> numbers;
    for (std::size_t k = port + 1; k < words.size(); ++k) numbers.push_back(place.number(words[k]));
    camera.port = port_named(words[port], numbers, place);
    return camera;
}

std::vector<CalibratedCamera> read_colmap(std::string_view text, const std::string& file) {
    std::vector<CalibratedCamera> cameras;
    std::size_t number = 0;
    for (const std::string_view line : lines_of(text)) {
        const TextPlace place{file, ++number};
        std::vector<std::string_view> words = split_words(line.substr(0, line.find('\r')));
        if (words.empty()) continue;
        cameras.push_back(read_colmap_line(words, place));
        const CalibratedCamera &first = cameras.front(), &one = cameras.back();
        if (one.port != first.port)
            place.fail(
                "has another port than the camera before: a scene has one; give each a file of its own");
        if (one.width != first.width || one.height != first.height)
            place.fail("has another size than the camera before: a scene has one film");
    }
    if (cameras.empty()) TextPlace{file, 0}.fail("has no cameras");
    return cameras;
}

Json camera_json(const CalibratedCamera& camera) {
    const std::vector<double>& p = camera.parameters;
    const std::size_t focal = camera.model->focal_lengths;
    std::vector<double> distortion(p.begin() + static_cast<std::ptrdiff_t>(focal + 2), p.end());
    if (!distortion.empty()) distortion.resize(std::max<std::size_t>(distortion.size(), 4), 0.0);
    return {{"name", camera.name},
            {"type", "opencv"},
            {"model", camera.model->fisheye ? "fisheye" : "pinhole"},
            {"fx", p[0]},
            {"fy", p[focal - 1]},
            {"cx", p[focal]},
            {"cy", p[focal + 1]},
            {"distortion", distortion},
            {"lookAt", {{"eye", {0, 0, 0}}, {"at", {0, 0, 1}}, {"up", {0, -1, 0}}}}};
}

Json glassy(const char* name, double ior) {
    return {{"name", name}, {"transmissionFactor", 1}, {"ior", ior}};
}

Json optic(const char* name, const char* material, int priority, Json primitive) {
    return {{"name", name},         {"role", "optic"},  {"material", material},
            {"priority", priority}, {"resolution", 16}, {"primitive", std::move(primitive)}};
}

Json vector_json(const Vec3& v) {
    return {v.x, v.y, v.z};
}

/// Two planes whose fronts look at the camera: glass lies behind the first, water behind the second, where
/// the higher priority is that of the water.
void add_flat_port(const Port& port, Json& scene) {
    const Vec3 normal = normalize(port.at);
    const double side = kPortSides * (port.inside + port.thickness);
    const auto plane = [&](double distance) -> Json {
        return {{"type", "plane"},
                {"center", vector_json(distance * normal)},
                {"normal", vector_json(-normal)},
                {"size", {side, side}}};
    };
    scene["materials"] = {glassy("glass", port.glass / port.air), glassy("water", port.water / port.air)};
    scene["meshes"] = {optic("inside", "glass", 0, plane(port.inside)),
                       optic("outside", "water", 1, plane(port.inside + port.thickness))};
}

void add_dome(const Port& port, Json& scene) {
    const auto ball = [&](double radius) -> Json {
        return {{"type", "sphere"}, {"center", vector_json(port.at)}, {"radius", radius}};
    };
    scene["materials"] = {glassy("air", port.air / port.water), glassy("glass", port.glass / port.water)};
    scene["meshes"] = {optic("inside", "air", 1, ball(port.inside)),
                       optic("outside", "glass", 0, ball(port.inside + port.thickness))};
}

}  // namespace

bool is_housing_name(const std::string& file) {
    const std::string ending = file_ending(file);
    return ending == ".yaml" || ending == ".yml" || ending == ".txt";
}

Json scene_of_housing(const std::string& text, const std::string& file) {
    const std::vector<CalibratedCamera> cameras =
        file_ending(file) == ".txt" ? read_colmap(text, file) : std::vector{read_calibmar(text, file)};
    Json scene{{"version", 1}, {"film", {{"width", cameras[0].width}, {"height", cameras[0].height}}}};
    for (const CalibratedCamera& camera : cameras) scene["cameras"].push_back(camera_json(camera));
    // In at one side of the glass and out at the other.
    scene["render"] = {{"maxDepth", 1}, {"paths", {"refract"}}};
    if (const std::optional<Port>& port = cameras[0].port)
        port->is_dome ? add_dome(*port, scene) : add_flat_port(*port, scene);
    return scene;
}

}  // namespace trilens
