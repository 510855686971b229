// Unwraps photographs of mirrors and lenses: for every pixel of a panorama, plane or object, where the
// photograph shows it, exactly, and the mean of the photograph over what the pixel covers there.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/description/material.h"
#include "base/image/image.h"
#include "base/util/error.h"
#include "base/util/names.h"
#include "inverse/maps/film_map.h"

namespace trilens {

struct World;

/// A photograph of the scene by one of its cameras.
struct UnwrapPhoto {
    std::string name;                        // what messages call it
    std::shared_ptr<const Texture> picture;  // of the film's size
    std::size_t camera = 0;                  // index into Scene::cameras
    double exposure = 1;                     // its values are divided by this
    double white =
        0;  // pixels with a colour from here on are clipped: taken only where nothing else is; 0: none
    std::shared_ptr<const Texture> mask =
        nullptr;  // of the film's size; where it is below 0.5 nothing is taken
};

/// What is taken where a pixel is seen several times. kBest: the image that the photograph resolves best, by
/// the smaller singular value of the derivative (times the root of the exposure, of photographs that differ
/// in it). kBlend: the mean of all, weighted by its fourth power (times the exposure).
enum class UnwrapImages { kBest, kBlend };

template <>
struct EnumNames<UnwrapImages> {
    static constexpr std::array kTable{NamedValue<UnwrapImages>{UnwrapImages::kBest, "best"},
                                       NamedValue<UnwrapImages>{UnwrapImages::kBlend, "blend"}};
};

/// Its source is the photograph, and the frame's camera each photograph's own.
struct UnwrapRequest : TargetRequest {
    UnwrapImages images = UnwrapImages::kBest;
    int rank = 1;               // kBest: of each photograph, the rank-th best
    double min_resolution = 0;  // pixels of the photograph per degree, or per unit: less counts as not seen
    bool divide_weight = true;  // by what mirrors and glass leave of the light (not below kLeastDivisor)
};

inline constexpr double kLeastDivisor = 1.0 / 64;

struct Unwrapped {
    /// R G B, A (1 where the target is seen), res.min, res.max (pixels of the photograph per degree, or per
    /// unit of a plane or object, in the worst and the best resolved direction), src.X, src.Y (place on the
    /// photograph, from its top left; -1 where there is none), image.count (images in all photographs) and,
    /// of several photographs, image.photo (which is taken, or of a blend resolves best).
    Image image;
    double coverage = 0;           // share of the target's solid angle, or area
    double resolution_median = 0;  // of res.min where the target is seen
    std::size_t exact_places = 0;  // that were projected
    double worst_accepted = 0;     // pixels that an interpolated place was found to be off
};

/// Throws UsageError for a request that makes no sense (no photograph, a camera or optic that there is not),
/// InputError for a photograph that is not of the film's size, a target that no photograph shows;
/// Interrupted.
Unwrapped unwrap(const World& world, const UnwrapRequest& request, const std::vector<UnwrapPhoto>& photos,
                 const Progress& progress = {});

}  // namespace trilens
