// What the rays of a film's pixels bear witness to, where places of a target are looked for on the film: of
// what they show nothing is lost between the nodes of a lattice.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "base/math/vec.h"
#include "base/util/error.h"
#include "inverse/maps/film_images.h"
#include "inverse/maps/proxy.h"
#include "inverse/maps/sampled_map.h"
#include "inverse/maps/target.h"
#include "render/shoot/shoot.h"

namespace trilens {

struct World;

struct WitnessRequest {
    FilmImagesParams images;    // what is looked for: its `cancel` is not asked
    int width = 1, height = 1;  // of the lattice
    std::function<std::optional<Vec2>(const ShotRay& shot)> place;  // that a ray shows; none: it shows none
};

/// One ray for each pixel of the film, through its middle, on the way that carries most light (beside glass
/// that mirrors, on the mirrored one, too).
class FilmWitness {
  public:
    /// Throws Interrupted once `progress` says so.
    FilmWitness(const World& world, const WitnessRequest& request, const Progress& progress = {});

    /// Refuses patches that lack, to ten times the tolerance, an image which a film pixel shows in them; and
    /// with images.visibility those that have one on a film pixel which shows no place. The witness must live
    /// longer.
    JudgePatch judge(double tolerance) const;

  private:
    struct Seen {
        std::uint32_t cell = 0;   // the pixel of the lattice whose middle is next to the left and above
        std::uint32_t pixel = 0;  // of the film
        float x = 0, y = 0;       // place
    };
    bool shows_all(const CellImages& cell, double limit) const;
    bool shows_nothing_else(const CellImages& cell) const;
    std::uint32_t cell_of(const Vec2& place) const;

    int width_, height_, film_width_, film_height_;
    bool visibility_;
    std::vector<Seen> seen_;             // by cell
    std::vector<unsigned char> hidden_;  // per film pixel: its ray shows no place, and is the only one
};

inline constexpr double kShareOfWitness = 0.2;  // of an unwrap's time, about: the film's rays

/// The place of a target that a ray shows; none where the target's place is not what the ray goes to, as
/// where another object lies between it and the centre of directions.
std::optional<Vec2> witnessed_place(const ShotRay& shot, const Target& target, const Proxy& proxy);

}  // namespace trilens
