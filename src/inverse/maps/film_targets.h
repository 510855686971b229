// What places of a film show of a target: the exact rays of the film, followed to their ends.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "inverse/maps/proxy.h"
#include "inverse/maps/sampled_map.h"
#include "inverse/maps/target.h"
#include "render/shoot/shoot.h"

namespace trilens {

struct FilmTargetsParams {
    ShootRequest shoot;
    std::optional<std::size_t> optic;  // index into World::optics: the first on the way; none: any
    bool over_optics = true;           // places that show no optic have no value; else they have, too
    bool with_jacobians = true;        // else derivatives are zero, and a place costs a fifth
};

/// images[i] gets the one place of the target, in its pixels, that film place places[i] shows, none where it
/// shows another thing. Derivatives are central differences over 1/50 of a film pixel; zero where the film
/// shows another thing so near. For targets of directions the proxy says how far things are.
void find_film_targets(const World& world, const FilmTargetsParams& params, const Target& target,
                       const Proxy& proxy, std::span<const Vec2> places, std::span<MapImages> images);

/// The same without derivatives: position and history alone. `shot`: its last ray and end.
std::optional<Vec2> target_of(const ShotRay& shot, const Target& target, const Proxy& proxy);

}  // namespace trilens
