#include "render/world/world.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/math/box.h"
#include "base/util/error.h"
#include "base/util/format.h"
#include "caustics/receiver_cells.h"
#include "paths/trace/path_world.h"
#include "render/world/blended_surfaces.h"
#include "shade/lights/light_sample.h"
#include "surfaces/surfaces.h"

namespace trilens {
namespace {

/// Optics' outlines come from grids of about so many facets.
constexpr double kOutlineFacets = 4000;
/// Less light than this share that is left out is not worth a word.
constexpr double kSilentLoss = 0.01;

std::vector<Vec3> outline_points(const Surface& surface) {
    const double per_face =
        kOutlineFacets / (2.0 * static_cast<double>(std::max<std::size_t>(1, surface.face_count())));
    return make_grid(surface, std::clamp(static_cast<int>(std::sqrt(per_face)), 2, 24)).points;
}

/// The box of what stops light and what sends it on.
Box box_of(const World& world, const std::vector<std::vector<Vec3>>& outlines) {
    Box box;
    for (const Vec3& point : world.objects.points) box.include(point);
    for (const auto& outline : outlines)
        for (const Vec3& point : outline) box.include(point);
    return box;
}

std::string count_text(std::size_t count, const std::string& what) {
    return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

}  // namespace

namespace {

/// One of a light's samples as a source of rays.
template <typename Kind>
BeamSource sample_source(const Light& light, const Kind& kind, std::size_t sample) {
    const auto at = [kind, sample, intensity = light.intensity](const Vec3& place) {
        return sample_light(kind, intensity, {.position = place}, sample);
    };
    BeamSource source;
    if constexpr (std::is_same_v<Kind, DirectionalLight>) {
        const LightSample there = at(Vec3(0));
        source.is_parallel = true;
        source.direction = -there.toward;
        source.strength = [strength = there.irradiance * light.color](const Vec3&) { return strength; };
    } else {
        // Irradiance at distance 1, where it is the radiant intensity.
        source.position = kind.position;
        source.strength = [at, color = light.color, from = source.position](const Vec3& direction) {
            return at(from + direction).irradiance * color;
        };
    }
    return source;
}

}  // namespace

namespace {

/// A part of a sphere light around a point of it, which shines outward as a flat one does: points of equal
/// areas on a spiral. Source: Gonzalez, Measurement of Areas on a Sphere Using Fibonacci and
/// Latitude-Longitude Lattices, 2010.
BeamSource sphere_part(const Light& light, const SphereLight& sphere, std::size_t part) {
    constexpr double kPi = std::numbers::pi;
    const double golden_angle = kPi * (3 - std::sqrt(5.0));
    const double height = 1 - (2 * static_cast<double>(part) + 1) / sphere.samples;
    const double across = std::sqrt(1 - height * height), turn = golden_angle * static_cast<double>(part);
    const Vec3 outward(across * std::cos(turn), height, across * std::sin(turn));
    const double area = 4 * kPi * sphere.radius * sphere.radius / sphere.samples;
    BeamSource source;
    source.position = sphere.position + sphere.radius * outward;
    source.strength = [outward, light = area * light.intensity * light.color](const Vec3& direction) {
        return std::max(0.0, dot(outward, direction)) * light;
    };
    return source;
}

/// One sample's part of a rectangle or a disk: its rays start before the light, which is an object, too.
template <typename Kind>
BeamSource flat_part(const Light& light, const Kind& kind, std::size_t sample, double scene_size) {
    const FlatPart part = part_of(kind, light.intensity, sample);
    BeamSource source;
    source.position = before_flat_light(part, scene_size);
    source.strength = [normal = part.normal, light = part.area * part.radiance * light.color](
                          const Vec3& direction) { return std::max(0.0, dot(normal, direction)) * light; };
    return source;
}

std::vector<BeamSource> background_sources(const Light& light, const EnvironmentSamples& samples) {
    std::vector<BeamSource> sources;
    for (std::size_t i = 0; i < samples.toward.size(); ++i) {
        BeamSource source;
        source.is_parallel = true;
        source.direction = -samples.toward[i];
        source.strength = [strength = light.intensity * samples.irradiance[i] * light.color](const Vec3&) {
            return strength;
        };
        sources.push_back(std::move(source));
    }
    return sources;
}

/// What sources are of, beside their light.
struct SourceScene {
    const Background& background;
    double size = 1;
};

std::vector<BeamSource> sources_of(const Light& light, const SourceScene&, const DirectionalLight& kind) {
    std::vector<BeamSource> sources;
    const int count = kind.angle > 0 ? kind.samples : 1;
    for (int k = 0; k < count; ++k)
        sources.push_back(sample_source(light, kind, static_cast<std::size_t>(k)));
    return sources;
}
template <typename Kind>
std::vector<BeamSource> sources_of(const Light& light, const SourceScene& scene, const Kind& kind) {
    std::vector<BeamSource> sources;
    if constexpr (requires { kind.samples; }) {
        for (int k = 0; k < kind.samples; ++k)
            sources.push_back(flat_part(light, kind, static_cast<std::size_t>(k), scene.size));
    } else {
        sources.push_back(sample_source(light, kind, 0));
    }
    return sources;
}
std::vector<BeamSource> sources_of(const Light& light, const SourceScene&, const SphereLight& kind) {
    std::vector<BeamSource> sources;
    for (int k = 0; k < kind.samples; ++k)
        sources.push_back(sphere_part(light, kind, static_cast<std::size_t>(k)));
    return sources;
}
std::vector<BeamSource> sources_of(const Light& light, const SourceScene& scene,
                                   const EnvironmentLight& kind) {
    return background_sources(light, environment_samples(scene.background, kind.samples));
}
std::vector<BeamSource> sources_of(const Light&, const SourceScene&, const AmbientLight&) {
    return {};
}

}  // namespace

std::vector<BeamSource> beam_sources(const Light& light, const Background& background, double scene_size) {
    const SourceScene scene{background, scene_size};
    return std::visit([&](const auto& kind) { return sources_of(light, scene, kind); }, light.kind);
}

bool has_caustics(const World& world) {
    return std::any_of(world.scene.lights.begin(), world.scene.lights.end(), has_followed_light);
}

PathWorld optics_for_lights(const World& world) {
    PathWorld optics = path_world(world);
    optics.reflect = optics.refract = true;
    return optics;
}

std::vector<std::unique_ptr<BeamLight>> make_beam_lights(const World& world, const PathWorld& optics,
                                                         std::size_t light, const BeamGridParams& params,
                                                         const Progress& progress) {
    const std::vector<BeamSource> sources =
        beam_sources(world.scene.lights[light], world.scene.background, world.shading.size);
    if (sources.empty())
        throw UsageError("light " + std::to_string(light) + " is " + kind_name(world.scene.lights[light]) +
                         ", which has no caustics");
    progress.begin_stage("beams of light " + std::to_string(light) +
                         (sources.size() > 1 ? ", " + count_text(sources.size(), "sample") : ""));
    std::vector<std::vector<Vec3>> outlines;
    std::vector<Id> bodies;
    for (std::size_t i = 0; i < world.optics.size(); ++i) {
        outlines.push_back(outline_points(*world.optics[i].surface));
        if (!world.optics[i].mirror) bodies.push_back(static_cast<Id>(i));
    }
    LightSpace space;
    space.optics = &optics;
    space.objects = &object_tracer(world);
    Box box = box_of(world, outlines);
    space.size = space.reach = length(box.size());
    if (world.blended) {
        space.veil = [&blended = *world.blended](const Ray& segment) { return blended.veil(segment); };
        for (const Vec3& point : world.blended->triangles().points) box.include(point);
        space.reach = length(box.size());
    }
    std::vector<std::unique_ptr<BeamLight>> lights;
    for (const BeamSource& source : sources) {
        space.around = {};
        if (!source.is_parallel) {
            const Media around = enclosing_bodies(optics, bodies, source.position).media;
            space.around = [around](const Ray&) { return around; };
        }
        const double share = 1.0 / static_cast<double>(sources.size());
        lights.push_back(
            std::make_unique<BeamLight>(space, source, params, outlines,
                                        progress.part(static_cast<double>(lights.size()) * share, share)));
    }
    return lights;
}

Vec3 irradiance(const std::vector<std::unique_ptr<BeamLight>>& lights, const Receiver& receiver) {
    Vec3 sum(0);
    for (const auto& light : lights) sum += light->irradiance(receiver);
    return sum;
}

Vec3 irradiance_on_surface(const World& world, std::size_t light, const Receiver& receiver) {
    const CausticLights& lights = caustic_lights(world, receiver.exact);
    const std::vector<Receiver> cells =
        receiver_cells(receiver, {world.objects, *lights.faces, object_tracer(world)});
    if (cells.empty()) return irradiance(lights.by_light[light], receiver);
    Vec3 sum(0);
    for (const Receiver& cell : cells) sum += irradiance(lights.by_light[light], cell);
    return sum / static_cast<double>(cells.size());
}

std::unique_ptr<CausticLights> make_caustic_lights(const World& world, const BeamGridParams& params,
                                                   const Progress& progress) {
    auto lights = std::make_unique<CausticLights>();
    lights->optics = optics_for_lights(world);
    lights->faces = std::make_shared<ReceiverFaces>(world.objects);
    const std::vector<Light>& all = world.scene.lights;
    std::vector<std::size_t> samples;  // by light, of those that are followed
    for (const Light& light : all)
        samples.push_back(has_followed_light(light)
                              ? beam_sources(light, world.scene.background, world.shading.size).size()
                              : 0);
    const auto count = std::accumulate(samples.begin(), samples.end(), 0.0);
    double done = 0;
    for (std::size_t l = 0; l < all.size(); ++l) {
        auto& of_light = lights->by_light.emplace_back();
        if (!has_followed_light(all[l])) continue;
        const double share = static_cast<double>(samples[l]) / count;
        of_light = make_beam_lights(world, lights->optics, l, params, progress.part(done, share));
        for (const auto& light : of_light) light->receive_on(lights->faces);
        done += share;
    }
    return lights;
}

std::vector<const BeamLight*> CausticLights::all() const {
    std::vector<const BeamLight*> lights;
    for (const auto& of_light : by_light)
        for (const auto& light : of_light) lights.push_back(light.get());
    return lights;
}

void gather_light(std::span<const BeamLight* const> lights, std::span<const ReceiverSide> faces,
                  const Progress& progress) {
    progress.begin_stage("light on " + count_text(faces.size(), "face") +
                         (lights.size() > 1 ? " of " + count_text(lights.size(), "sample") : ""));
    struct Task {
        const BeamLight* light;
        ReceiverSide on;
        double beams;
    };
    std::vector<Task> tasks;
    double all = 0;
    for (const ReceiverSide& face : faces)
        for (const BeamLight* light : lights) {
            tasks.push_back({light, face, static_cast<double>(light->count_near(face))});
            all += tasks.back().beams;
        }
    double done = 0;
    for (const Task& task : tasks) {
        const double share = all > 0 ? task.beams / all : 0;
        task.light->gather(task.on, progress.part(done, share));
        done += share;
    }
    progress(1);
}

std::vector<std::string> lost_light(const World& world, std::size_t light,
                                    std::span<const std::unique_ptr<BeamLight>> beams) {
    CutPaths cut;
    for (const auto& source : beams) cut = most_cut(cut, source->losses().most);
    const double deep = of_worst_colour(cut.too_deep), lost = of_worst_colour(cut.lost);
    const auto percent = [](double share) { return fmt::format("{:.0f} %", 100 * share); };
    const std::string name = "light " + std::to_string(light);
    std::vector<std::string> said;
    if (deep > kSilentLoss)
        said.push_back(name + ": its rays would meet optics after maxDepth " +
                       std::to_string(world.scene.render.max_depth) + " with up to " + percent(deep) +
                       " of their light, which stops there");
    if (lost > kSilentLoss)
        said.push_back(name + ": up to " + percent(lost) +
                       " of a ray's light is inside of more bodies of glass than can be told, and left out");
    return said;
}

void warn_of_lost_light(const World& world, const CausticLights& lights, const Warn& warn) {
    if (!warn) return;
    for (std::size_t l = 0; l < lights.by_light.size(); ++l)
        for (const std::string& message : lost_light(world, l, lights.by_light[l])) warn(message);
}

}  // namespace trilens
