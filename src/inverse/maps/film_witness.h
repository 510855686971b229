// Where places of a target lie on a film, with the rays of the film's pixels as witnesses: of what they show
// nothing is lost between the nodes of a lattice.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/math/vec.h"
#include "base/util/error.h"
#include "inverse/maps/film_images.h"
#include "inverse/maps/film_map.h"
#include "inverse/maps/proxy.h"
#include "inverse/maps/sampled_map.h"
#include "inverse/maps/target.h"
#include "render/shoot/shoot.h"

namespace trilens {

struct World;

/// Which places of a lattice are looked for on a film.
struct PlacesOnFilm {
    FilmImagesParams images;  // its `cancel` is not asked by the witnesses
    MapLattice lattice;
    std::function<std::vector<std::optional<WorldPlace>>(std::span<const Vec2> places)> in_world;
    std::function<std::optional<Vec2>(const ShotRay& shot)> shown;  // by a ray; none: it shows none
};

/// Those of a target; the arguments must live longer.
PlacesOnFilm places_on_film(const FilmImagesParams& images, const TargetRequest& request,
                            const Target& target, const Proxy& proxy);

/// Their images. One ray for each pixel of the film, through its middle, bears witness, on the way that
/// carries most light (beside glass that mirrors, on the mirrored one, too): patches that lack, to ten times
/// the tolerance, an image which a film pixel shows in them are divided, and those that have one on a film
/// pixel which shows no place. Throws Interrupted once `progress` says so.
SampledMap map_onto_film(const World& world, const PlacesOnFilm& places, const Progress& progress = {});

}  // namespace trilens
