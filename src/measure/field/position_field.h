// What an image sees through its optics as a field on the screen: a point per pixel, in connected pieces.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/image/image.h"
#include "base/math/vec.h"
#include "base/util/ids.h"

namespace trilens {

/// What belongs together: an object seen through an optic, or only one triangle of it. Object kNone is the
/// environment.
struct SurfaceId {
    Id object = kNone, optic = 0;
    std::optional<Id> primitive;
};

/// What a pixel sees.
struct FieldSample {
    Vec3 point{0};  // world frame; of the environment its direction
    Id object = kNone, optic = 0, primitive = 0;
    int column = 0, row = 0;  // of the data window
};

/// Views into an image's channels (the image must outlive it) and which neighbours belong to one piece of
/// surface. Where no object is seen but a direction is given, the environment is seen there: the points are
/// then places on the sphere of directions, a surface like any other.
struct PositionField {
    int width = 0, height = 0;  // the data window
    // Seen points, world frame; of the environment the unit direction; zero where nothing is seen.
    const std::vector<float>*x = nullptr, *y = nullptr, *z = nullptr;
    const std::vector<Id>* object = nullptr;
    const std::vector<Id>* optic = nullptr;      // null: the image does not say which optic a pixel shows
    const std::vector<Id>* primitive = nullptr;  // null: the image does not say which triangle is seen
    std::vector<std::uint8_t> links;             // per pixel kRight | kDown: linked with the neighbour there

    static constexpr std::uint8_t kRight = 1, kDown = 2;

    bool contains(int column, int row) const {
        return column >= 0 && row >= 0 && column < width && row < height;
    }
    std::size_t index(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(column);
    }
    Vec3 point(std::size_t i) const { return {(*x)[i], (*y)[i], (*z)[i]}; }
    Id optic_of(std::size_t i) const { return optic ? (*optic)[i] : 0; }
    Id primitive_of(std::size_t i) const { return primitive ? (*primitive)[i] : 0; }

    /// Whether the pixel shows the layer: an object, or the environment through an optic. Its point may be no
    /// number.
    bool shows_layer(std::size_t i) const {
        if ((*object)[i] != kNone) return true;
        return optic_of(i) != kNone && ((*x)[i] != 0 || (*y)[i] != 0 || (*z)[i] != 0);
    }
    /// Whether the pixel shows the layer at a finite place.
    bool sees(std::size_t i) const {
        return shows_layer(i) && std::isfinite((*x)[i]) && std::isfinite((*y)[i]) && std::isfinite((*z)[i]);
    }
    FieldSample seen_point(std::size_t i) const;
    /// Whether the pixel sees that piece at a finite place.
    bool shows(std::size_t i, const SurfaceId& piece) const {
        return (*object)[i] == piece.object && optic_of(i) == piece.optic &&
               (!piece.primitive || primitive_of(i) == *piece.primitive) && sees(i);
    }
    /// The same, with links: what is linked is seen at a finite place.
    bool shows_linked(std::size_t i, const SurfaceId& piece) const {
        return (*object)[i] == piece.object && optic_of(i) == piece.optic &&
               (!piece.primitive || primitive_of(i) == *piece.primitive) && (links[i] != 0 || sees(i));
    }
};

/// The field of `layer` ("reflect", "refract") without links; nothing where the image lacks the layer's
/// objects or places (see seen_channel).
std::optional<PositionField> make_seen_field(const Image& image, const std::string& layer);

/// Columns x0 .. x1 - 1 and rows y0 .. y1 - 1.
struct FieldWindow {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// Holds every pixel that shows the layer; empty where none does.
FieldWindow shown_window(const PositionField& field);

/// Fills `links`: two neighbours are linked where they see the same object in the same optic, and the step
/// between their points is no jump: not more than kJump times the longer of the steps before and after it on
/// its line (where there is one, and it is not zero).
void link_neighbours(PositionField& field);
/// The same, where `window` holds every pixel that shows the layer.
void link_neighbours(PositionField& field, const FieldWindow& window);

/// Along a smooth field steps change slowly; even next to a horizon, where points recede like 1 / distance,
/// the first two differ by less than 8 for three pixels in four. A longer step means that two pieces of the
/// object meet by occlusion.
inline constexpr double kJump = 8;

// Fold curves of a position field: where its map from the screen turns over (singularities, Whitney folds).

/// One entry per pixel of the data window of `field` (with its links): 1 within kFoldReach pixels of a fold,
/// else 0. A fold is where the map from the screen to what is seen turns over: cells of four pixels on either
/// side of it cover one object side by side with opposite orientations. In a mirror it is where a caustic of
/// the eye's rays touches the scene; there a small error of the surface moves an image by its square root, so
/// that a mean over the displacements d of many pixels falls like d log(1 / d), not like d. Creases where an
/// object's normal turns by less than 120 degrees are no folds. Depends on this field alone, hence the same
/// pixels for every test of one reference.
std::vector<std::uint8_t> near_folds(const PositionField& field);

inline constexpr int kFoldReach = 4;

}  // namespace trilens
