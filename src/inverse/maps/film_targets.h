// What places of a film show of a target: the exact rays of the film, followed to their ends.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/util/error.h"
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

/// Shoots one ray through the middle of every pixel of the film, rows from the top, a portion at a time:
/// use(first, shots), where shots.rays[i] is that of pixel first + i. Throws Interrupted once it is
/// cancelled.
void shoot_film(const World& world, const ShootRequest& request, const Progress& progress,
                const std::function<void(std::size_t first, const ShotRays& shots)>& use);

/// What every pixel of a film shows of a target in its middle, rows from the top: the place, in the target's
/// pixels (-1 where there is none), and a number of the path and the object, 0 where there is none.
struct ShownPixels {
    std::vector<float> x, y;
    std::vector<std::uint64_t> history;
};

/// One ray for each pixel: params.with_jacobians is not asked. Throws Interrupted once it is cancelled.
ShownPixels find_shown_pixels(const World& world, const FilmTargetsParams& params, const Target& target,
                              const Proxy& proxy, const Progress& progress = {});

/// The place of the target that a ray's end shows, without derivatives, whatever its path. `shot`: followed
/// to its end.
std::optional<Vec2> target_of(const ShotRay& shot, const Target& target, const Proxy& proxy);

}  // namespace trilens
