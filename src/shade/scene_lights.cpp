// The lights of a scene, whatever their kinds.
#include <algorithm>
#include <utility>

#include "base/util/check.h"
#include "shade/shade.h"

namespace trilens {

namespace {

bool is_same(const Background& a, const Background& b) {
    return a.color == b.color && a.environment == b.environment && a.rotate_cos == b.rotate_cos &&
           a.rotate_sin == b.rotate_sin;
}

}  // namespace

void prepare_lights(ShadeScene& scene) {
    const auto before = std::move(scene.environment_samples);
    scene.environment_samples.assign(scene.lights.size(), nullptr);
    for (std::size_t l = 0; l < scene.lights.size(); ++l) {
        const auto* light = std::get_if<EnvironmentLight>(&scene.lights[l].kind);
        if (!light) continue;
        const auto kept = std::find_if(before.begin(), before.end(), [&](const auto& one) {
            return one && one->count == light->samples && is_same(one->background, scene.background);
        });
        scene.environment_samples[l] = kept != before.end()
                                           ? *kept
                                           : std::make_shared<const EnvironmentSamples>(
                                                 environment_samples(scene.background, light->samples));
    }
}

namespace {

const EnvironmentSamples& environment_of(const ShadeScene& scene, std::size_t light) {
    TRILENS_CHECK(light < scene.environment_samples.size() && scene.environment_samples[light],
                  "an environment's light needs prepare_lights()");
    return *scene.environment_samples[light];
}

}  // namespace

std::size_t sample_count(const ShadeScene& scene, std::size_t light) {
    return std::visit(
        [&](const auto& kind) -> std::size_t {
            using Kind = std::decay_t<decltype(kind)>;
            if constexpr (std::is_same_v<Kind, EnvironmentLight>)
                return environment_of(scene, light).toward.size();
            else if constexpr (std::is_same_v<Kind, DirectionalLight>)
                return kind.angle > 0 ? static_cast<std::size_t>(kind.samples) : 1;
            else if constexpr (requires { kind.samples; })
                return static_cast<std::size_t>(kind.samples);
            else
                return 1;
        },
        scene.lights[light].kind);
}

LightSample light_sample(const ShadeScene& scene, std::size_t light, std::size_t sample, const LitPoint& at) {
    const Light& one = scene.lights[light];
    return std::visit(
        [&](const auto& kind) {
            if constexpr (std::is_same_v<std::decay_t<decltype(kind)>, EnvironmentLight>)
                return sample_environment(environment_of(scene, light), one.intensity, at, sample);
            else
                return sample_light(kind, one.intensity, at, sample);
        },
        one.kind);
}

}  // namespace trilens
