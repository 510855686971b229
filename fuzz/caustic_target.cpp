// Fuzz target of caustics: random scenes whose lights are followed over their optics; light is neither made
// nor given to two, an optic that stands twice gives the light of one, and the picture is the same with any
// number of threads.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "fuzz/random_scene.h"
#include "fuzz/target.h"
#include "trilens/image.h"
#include "trilens/maps.h"
#include "trilens/render.h"
#include "trilens/scene.h"

using namespace trilens;

namespace trilens_fuzz {
namespace {

/// Small, so that one takes tenths of a second: few facets, few pixels, short paths.
Scene made_small(Scene scene) {
    scene.film.width = 8, scene.film.height = 6, scene.film.spp = 1;
    scene.render.max_depth = std::min(scene.render.max_depth, 2);
    bool has_optic = false;
    std::erase_if(scene.meshes, [&](const Mesh& mesh) {
        return mesh.role == Role::kOptic && std::exchange(has_optic, true);
    });
    for (Mesh& mesh : scene.meshes) mesh.resolution = std::min(mesh.resolution, 4);
    for (Light& light : scene.lights) {
        light.caustics = !is_dome(light);
    }
    return scene;
}

void require_picture(const Renderer& renderer) {
    const auto drawn = [&] { return renderer.draw({}).image; };
    const Image one = on_threads(1, drawn);
    require(encode_image(on_threads(3, drawn)) == encode_image(one),
            "a picture with caustics depends on the number of threads");
    for (const char* name : {"R", "G", "B"})
        for (const float value : one.find(name)->floats())
            require(std::isfinite(value) && value >= 0, "a pixel with caustics that is no light");
}

/// What beams that end at borders of histories may count twice.
constexpr double kBorder = 0.02;

/// What glass absorbs is interpolated along beams: a map that cuts them finer than the ends' sum does may
/// have so much more light.
double by_absorption(const Scene& scene) {
    const bool absorbs = std::ranges::any_of(scene.meshes, [&](const Mesh& mesh) {
        return mesh.role == Role::kOptic && scene.materials[mesh.material].attenuation_distance > 0;
    });
    return absorbs ? kBorder : 1e-6;
}

/// Of each colour: what comes to the optics is not less than what leaves them, nor that less than what a map
/// gets, but for that share.
void require_balance(const CausticMap& map, double more) {
    for (int c = 0; c < 3; ++c) {
        const double in = map.flux_in[c], out = map.flux_on_objects[c] + map.flux_away[c],
                     got = map.flux_received[c];
        require(
            std::isfinite(in) && std::isfinite(out) && std::isfinite(got) && in >= 0 && out >= 0 && got >= 0,
            "a flux that is none");
        require(out <= in * (1 + kBorder), fmt::format("optics make light: {} of {}", out, in));
        require(got <= map.flux_on_objects[c] * (1 + more) + 1e-9 * in,
                fmt::format("a map receives {} of {} on objects, {} in", got, map.flux_on_objects[c], in));
    }
    for (const Vec3& light : map.irradiance)
        for (int c = 0; c < 3; ++c)
            require(std::isfinite(light[c]) && light[c] >= 0, "an irradiance that is none");
}

void require_maps(const Renderer& renderer, const Scene& scene) {
    const auto object = std::ranges::find(scene.meshes, Role::kObject, &Mesh::role);
    if (object == scene.meshes.end()) return;
    CausticMapRequest request;
    request.target.kind = TargetKind::kObject;
    request.target.object = static_cast<Id>(object - scene.meshes.begin());
    request.target.width = request.target.height = 8;
    request.tolerance = 0.02;
    for (std::size_t i = 0; i < scene.lights.size(); ++i) {
        if (is_dome(scene.lights[i])) continue;
        request.light = i;
        for (const bool exact : {false, true}) {
            request.exact = exact;
            // Objects without a map of their surface are refused.
            answer([&] { require_balance(make_caustic_map(renderer, request), by_absorption(scene)); });
        }
    }
}

/// How much of a map's light an optic's twin may move: its beams have other histories.
constexpr double kByTwin = 0.05;

/// The first light's map, as the optic has it alone and with its twin at the same place.
void require_same_by_twins(const Renderer& renderer, Scene scene) {
    const auto optic = std::ranges::find(scene.meshes, Role::kOptic, &Mesh::role);
    const auto object = std::ranges::find(scene.meshes, Role::kObject, &Mesh::role);
    if (optic == scene.meshes.end() || object == scene.meshes.end()) return;
    CausticMapRequest request;
    request.target.kind = TargetKind::kObject;
    request.target.object = static_cast<Id>(object - scene.meshes.begin());
    request.target.width = request.target.height = 8;
    request.tolerance = 0.02;
    Mesh twin = *optic;
    twin.name += " twin";
    scene.meshes.push_back(std::move(twin));
    const Renderer twins(scene);
    for (std::size_t i = 0; i < scene.lights.size(); ++i) {
        if (is_dome(scene.lights[i])) continue;
        request.light = i;
        answer([&] {
            const CausticMap one = make_caustic_map(renderer, request),
                             two = make_caustic_map(twins, request);
            for (int c = 0; c < 3; ++c) {
                const double off = std::fabs(two.flux_received[c] - one.flux_received[c]);
                require(off <= kByTwin * one.flux_in[c],
                        fmt::format("light of twins: {} of {}, alone {}", two.flux_received[c],
                                    one.flux_in[c], one.flux_received[c]));
            }
        });
        return;
    }
}

}  // namespace

Answer random_caustics(std::string_view bytes) {
    const RandomScene random = make_random_scene(bytes);
    if (random.is_unlit) return Answer::kTaken;
    return answer([&] {
        try {
            const Scene scene = made_small(parse_scene(random.json));
            const Renderer renderer(scene);
            require_picture(renderer);
            require_maps(renderer, scene);
            require_same_by_twins(renderer, scene);
        } catch (const ComputationError& error) {  // a legal scene has a picture
            throw Defect(std::string("a scene that was read is not drawn: ") + error.what());
        }
    });
}

}  // namespace trilens_fuzz
