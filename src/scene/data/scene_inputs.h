// What a scene is loaded with beside its file: values of its JSON changed from outside, and a reader of
// pixels.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/description/film_move.h"
#include "base/description/marks.h"
#include "base/description/material.h"
#include "base/image/height_grid.h"
#include "base/util/error.h"

namespace trilens {

// One value of a scene's JSON changed from outside.

/// One `--set /json/pointer=VALUE`. VALUE is JSON; what does not parse as JSON is taken as a string.
struct SceneOverride {
    std::string pointer;
    std::string value;
    bool removes = false;  // takes what the pointer names away, whatever the value; later entries move up
    std::string set_by = {};  // what asks for it, for messages: "test.json: /set"; empty: --set
};

/// How glTF files become scenes.
struct ImportOptions {
    /// Of names of meshes, nodes and materials that are optics, as shells match them: "Mirror*".
    std::vector<std::string> optics;
    std::optional<double> time;  // seconds of the animation; none: its start
    std::string animation;       // its name; empty: the first

    bool empty() const { return optics.empty() && !time && animation.empty(); }
};

// How the scene room gets pixels without knowing the image room, and what is seen without knowing cameras.

struct Scene;

/// Whether the bytes, a stream of zlib or gzip, are whole and fill `to`.
using Inflate = std::function<bool(std::string_view packed, std::span<char> to)>;

/// Returns a linear Rec.709 picture, or the numbers of one, or throws an InputError that names the file.
/// from_memory reads a picture held in memory (GLB).
struct TextureReader {
    std::function<std::shared_ptr<const Texture>(const std::string& file)> from_file;
    std::function<std::shared_ptr<const Texture>(std::span<const unsigned char> encoded,
                                                 const std::string& name)>
        from_memory;
    std::function<HeightGrid(const std::string& file)> heights_from_file = {};
    std::function<TextMask(const TextStyle& style)> letters = {};  // none: labels have no letters
    /// Of all cameras of a scene that is read but for terrains with a tolerance, its optics as they are.
    std::function<FilmMoves(const Scene& scene)> film_moves = {};
    Inflate inflate = {};    // none: what is packed is not read
    Progress progress = {};  // of what may take minutes: terrains with a tolerance, one after the other
};

}  // namespace trilens
