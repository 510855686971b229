#include "laws/hunt.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iterator>
#include <map>
#include <set>

#include "render/engines/engine.h"
#include "render/world/world.h"
#include "scene/load.h"

using namespace trilens;

namespace trilens_test {
namespace {

constexpr int kHuntWidth = 160, kHuntHeight = 120;
/// Ends that carry less than this share of a pixel's light are not looked for: Projection may leave them out.
constexpr double kMuchLight = 1.0 / 16;

/// Numbers that are the same on every machine (SplitMix64: Steele, Lea and Flood 2014).
class Dice {
  public:
    explicit Dice(std::uint64_t seed) : state_(seed) { state_ = next(); }
    double between(double low, double high) {
        return low + (high - low) * static_cast<double>(next() >> 11) * 0x1p-53;
    }
    double log_between(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }
    int below(int count) { return static_cast<int>(next() % static_cast<std::uint64_t>(count)); }
    bool chance(double share) { return between(0, 1) < share; }

  private:
    std::uint64_t next() {
        std::uint64_t x = state_ += 0x9e3779b97f4a7c15u;
        x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
        x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
        return x ^ (x >> 31);
    }
    std::uint64_t state_;
};

std::string text(const Vec3& v) {
    return fmt::format("[{:.6f}, {:.6f}, {:.6f}]", v.x, v.y, v.z);
}

Vec3 unit_vector(Dice& dice) {
    const double z = dice.between(-1, 1), angle = dice.between(0, 6.283185307179586),
                 r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
}

/// A camera some five units before the origin that sees about 3.6 units of it from top to bottom.
std::string camera(Dice& dice, std::string& what) {
    const Vec3 eye(dice.between(-1.2, 1.2), dice.between(0.2, 1.6), dice.between(4.2, 5.2));
    const std::string look = fmt::format(R"("lookAt": {{ "eye": {}, "at": [0, 0, 0] }})", text(eye));
    const std::array<std::pair<const char*, std::string>, 9> kinds{{
        {"perspective", R"("yfov": 40)"},
        {"perspective", R"("yfov": 40, "shift": [0.1, -0.05])"},
        {"orthographic", R"("ymag": 1.8)"},
        {"oblique", R"("ymag": 1.8, "angle": 40, "scale": 0.4)"},
        {"fisheye", R"("mapping": "equidistant", "fov": 45)"},
        {"cylindrical", R"("hfov": 55, "yfov": 40)"},
        {"spherical", R"("hfov": 55, "vfov": 42)"},
        {"opencv",
         R"("model": "pinhole", "fx": 165, "fy": 165, "cx": 80, "cy": 60, "distortion": [-0.1, 0.02, 0, 0, 0])"},
        {"pushbroom", R"("yfov": 40, "travel": [1.5, 0, 0])"},
    }};
    // Half of all see by perspective, as most scenes do.
    const auto& [type, fields] = kinds[static_cast<std::size_t>(dice.chance(0.4) ? 0 : dice.below(9))];
    what += type;
    return fmt::format(R"({{ "name": "c", "type": "{}", {}, {} }})", type, fields, look);
}

const char* const kHuntCube =
    R"("points": [[-1,-1,1],[1,-1,1],[1,1,1],[-1,1,1],[-1,-1,-1],[1,-1,-1],[1,1,-1],[-1,1,-1]],
  "faceVertexCounts": [4,4,4,4,4,4], "faceVertexIndices": [0,1,2,3, 1,5,6,2, 5,4,7,6, 4,0,3,7, 3,2,6,7, 4,5,1,0])";

std::string mesh(const std::string& name, bool glass, const std::string& shape) {
    return fmt::format(R"({{ "name": "{}", "role": "optic", "material": "{}", {} }})", name,
                       glass            ? "glass"
                       : name == "host" ? "chrome"
                                        : "gold",
                       shape);
}

std::string placed_cube(const Vec3& at, const Vec3& size, const Vec3& axis, double angle) {
    const Vec3 v = std::sin(0.5 * angle) * axis;
    return fmt::format(
        R"({}, "transform": {{ "translate": {}, "rotate": [{:.6f}, {:.6f}, {:.6f}, {:.6f}], "scale": {} }})",
        kHuntCube, text(at), v.x, v.y, v.z, std::cos(0.5 * angle), text(size));
}

/// What the small ones are seen in or through: about two units wide, near the origin.
std::string host(Dice& dice, std::string& what) {
    const bool glass = dice.chance(0.5);
    const Vec3 at(dice.between(-0.3, 0.3), dice.between(-0.3, 0.3), dice.between(-0.5, 0.5));
    const Vec3 tilt = normalize(Vec3(dice.between(-0.5, 0.5), dice.between(-0.3, 0.6), 1));
    what += glass ? ", glass" : ", mirror";
    switch (dice.chance(0.75) ? dice.below(2) : 2 + dice.below(2)) {
        case 0:
            what += " plane";
            return mesh(
                "host", glass,
                fmt::format(
                    R"("primitive": {{ "type": "plane", "center": {}, "normal": {}, "tangent": {}, "size": [3, 2.4] }})",
                    text(at), text(tilt), text(normalize(cross(Vec3(0, 1, 0), tilt)))));
        case 1:
            what += " sphere";
            return mesh("host", glass,
                        fmt::format(R"("primitive": {{ "type": "sphere", "center": {}, "radius": {:.4f} }})",
                                    text(at), dice.between(0.6, 1.2)));
        case 2:
            what += " cube cage";
            return mesh("host", glass,
                        placed_cube(at, Vec3(dice.between(0.8, 1.3)), unit_vector(dice), dice.between(0, 3)));
        default:
            what += " slab";
            return mesh(
                "host", glass,
                placed_cube(at, {1.6, 1.3, dice.between(0.1, 0.4)}, unit_vector(dice), dice.between(0, 0.5)) +
                    R"(, "creaseIndices": [0,1,2,3,0,4,5,6,7,4], "creaseLengths": [5,5], "creaseSharpnesses": [10,10])");
    }
}

/// A ball, a rod or a small cage, a pixel to thirty in radius.
std::string small_optic(Dice& dice, int number, std::string& what) {
    constexpr double kPixel = 3.6 / kHuntHeight;
    const double radius = kPixel * dice.log_between(1, 30);
    const bool glass = dice.chance(0.35);
    const double depth = dice.chance(0.5) ? dice.between(-3, -0.8) : dice.between(-0.6, 2.2);
    const Vec3 at(dice.between(-1.5, 1.5), dice.between(-1.1, 1.1), depth);
    const std::string name = fmt::format("small {}", number);
    what += fmt::format(", {} of {:.1f} px", glass ? "glass" : "gold", radius / kPixel);
    switch (dice.chance(0.85) ? dice.below(2) : 2) {
        case 0:
            what += " ball";
            return mesh(name, glass,
                        fmt::format(R"("primitive": {{ "type": "sphere", "center": {}, "radius": {:.6f} }})",
                                    text(at), radius));
        case 1: {
            what += " rod";
            const Vec3 axis = unit_vector(dice);
            return mesh(
                name, glass,
                fmt::format(
                    R"("primitive": {{ "type": "cylinder", "center": {}, "axis": {}, "radius": {:.6f}, "height": {:.4f} }})",
                    text(at), text(axis), 0.3 * radius, dice.between(0.3, 2)));
        }
        default:
            what += " cage";
            return mesh(name, glass, placed_cube(at, Vec3(radius), unit_vector(dice), dice.between(0, 3)));
    }
}

const char* const kHuntRoom =
    R"({ "name": "floor", "role": "object", "material": "red", "points": [[-6,-2,-6],[6,-2,-6],[6,-2,8],[-6,-2,8]],
    "faceVertexCounts": [4], "faceVertexIndices": [3,2,1,0] },
  { "name": "back", "role": "object", "material": "green", "points": [[-6,-2,-6],[6,-2,-6],[6,4,-6],[-6,4,-6]],
    "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3] },
  { "name": "side", "role": "object", "material": "blue", "points": [[-5,-2,-6],[-5,-2,8],[-5,4,8],[-5,4,-6]],
    "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3] })";

/// One film by one engine.
struct Film {
    int width = 0, height = 0;
    SampleViews views;
    std::vector<std::set<std::vector<std::pair<Id, int>>>>
        histories;  // per sample: of its ends that carry light
};

using History = std::vector<std::pair<Id, int>>;  // optics and events

Film film_of(const World& world, const FrameParams& frame, Engine engine) {
    Film film;
    const std::unique_ptr<Viewer> viewer = make_viewer(world, frame, engine, [](const std::string&) {});
    film.width = world.scene.film.width, film.height = world.scene.film.height;
    viewer->view({0, 0, film.width, film.height, 1}, film.views);
    film.histories.resize(film.views.samples.size());
    for (std::size_t s = 0; s < film.histories.size(); ++s) {
        const SampleView& view = film.views.samples[s];
        if (view.optic == kNone) continue;
        film.histories[s].insert(History{{view.optic, -1}});  // seen, whatever it shows
        for (const PathEnd& end : film.views.ends_of(view)) {
            if (!end.principal && std::max({end.weight.x, end.weight.y, end.weight.z}) < kMuchLight) continue;
            History history;
            for (const Step& step : film.views.steps_of(end))
                history.push_back({step.optic, static_cast<int>(step.event)});
            film.histories[s].insert(std::move(history));
        }
    }
    return film;
}

/// In how many samples each optic is met by some path.
std::vector<std::size_t> count_optics(const Film& film, std::size_t optics) {
    std::vector<std::size_t> counts(optics, 0);
    for (const auto& histories : film.histories) {
        std::set<Id> met;
        for (const History& history : histories)
            for (const auto& [optic, event] : history) met.insert(optic);
        for (const Id optic : met) ++counts[optic];
    }
    return counts;
}

/// The principal path of a sample, of light that is reflected first or refracted first.
History principal(const Film& film, std::size_t sample, Path path) {
    const SampleView& view = film.views.samples[sample];
    History history{{view.optic, -1}};
    if (view.optic == kNone) return history;
    if (const PathEnd* end = film.views.find(view, path))
        for (const Step& step : film.views.steps_of(*end))
            history.push_back({step.optic, static_cast<int>(step.event)});
    return history;
}

/// Samples of `a` whose principal paths no sample of `b` within 1.5 pixels has.
std::set<std::size_t> strangers(const Film& a, const Film& b) {
    std::set<std::size_t> found;
    for (const Path path : {Path::kReflect, Path::kRefract})
        for (int y = 1; y + 1 < a.height; ++y)
            for (int x = 1; x + 1 < a.width; ++x) {
                const auto at = [&](int column, int row) {
                    return static_cast<std::size_t>(row * a.width + column);
                };
                const History own = principal(a, at(x, y), path);
                bool known = false;
                for (int dy = -1; dy <= 1 && !known; ++dy)
                    for (int dx = -1; dx <= 1 && !known; ++dx)
                        known = principal(b, at(x + dx, y + dy), path) == own;
                if (!known) found.insert(at(x, y));
            }
    return found;
}

double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Quarry make_quarry(std::uint64_t seed) {
    Dice dice(seed);
    Quarry quarry;
    quarry.seed = seed;
    const std::string cameras = camera(dice, quarry.what);
    std::string meshes = host(dice, quarry.what);
    const int count = 1 + dice.below(3);
    for (int i = 0; i < count; ++i) meshes += ",\n  " + small_optic(dice, i, quarry.what);
    const int depth = 1 + dice.below(4);
    constexpr std::array<int, 9> kResolutions{1, 2, 3, 4, 6, 8, 12, 16, 32};
    quarry.frame.resolution = kResolutions[static_cast<std::size_t>(dice.below(9))];
    if (dice.chance(0.4)) quarry.frame.max_error = 0.5;
    quarry.what += fmt::format("; n = {}, depth {}{}", quarry.frame.resolution, depth,
                               quarry.frame.max_error ? ", within 0.5 px" : "");
    quarry.json = fmt::format(R"({{ "version": 1, "film": {{ "width": {}, "height": {} }}, "cameras": [ {} ],
  "background": {{ "color": [0.2, 0.3, 0.5] }}, "render": {{ "maxDepth": {} }},
  "materials": [ {{ "name": "glass", "transmissionFactor": 1, "ior": {:.3f} }},
    {{ "name": "chrome", "metallicFactor": 1, "baseColorFactor": [0.9, 0.9, 0.9] }},
    {{ "name": "gold", "metallicFactor": 1, "baseColorFactor": [0.9, 0.6, 0.2] }},
    {{ "name": "red", "unlit": true, "baseColorFactor": [0.8, 0.1, 0.1] }},
    {{ "name": "green", "unlit": true, "baseColorFactor": [0.1, 0.7, 0.2] }},
    {{ "name": "blue", "unlit": true, "baseColorFactor": [0.1, 0.2, 0.8] }} ],
  "meshes": [ {},
  {} ] }})",
                              kHuntWidth, kHuntHeight, cameras, depth, dice.between(1.2, 1.8), meshes, kHuntRoom);
    return quarry;
}

Bag beside_truth(const World& world, const FrameParams& frame) {
    Bag bag;
    const double start = now();
    const Film truth = film_of(world, frame, Engine::kLimitTruth);
    const double middle = now();
    const Film projected = film_of(world, frame, Engine::kExact);
    bag.pixels = truth.histories.size();
    bag.seconds = now() - middle;
    bag.truth_seconds = middle - start;
    for (const SampleView& view : projected.views.samples) {
        bag.traced += view.optic != kNone && view.traced;
        bag.divided += view.optic != kNone && !view.traced && view.level > 0;
    }
    const auto wanted = count_optics(truth, world.optics.size()),
               found = count_optics(projected, world.optics.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        if (found[i] > 0 || wanted[i] == 0) continue;
        if (wanted[i] >= kFew)
            bag.missing.push_back(
                fmt::format("{} ({} pixels)", world.names[world.optics[i].mesh], wanted[i]));
        else
            ++bag.tiny;
    }
    std::set<std::size_t> other = strangers(projected, truth);
    other.merge(strangers(truth, projected));
    bag.other = other.size();
    return bag;
}

Bag hunt(const Quarry& quarry) {
    const auto ignore = [](const std::string&) {};
    const auto world = make_world(
        load_scene_text(quarry.json, SceneSource("seed " + std::to_string(quarry.seed), ""), {}, {}), ignore);
    return beside_truth(*world, quarry.frame);
}

}  // namespace trilens_test
