// Lenses of a scene: their prescriptions, inline or of files.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "json/json.h"
#include "lens/prescription.h"

namespace trilens {

struct Reading;

/// A lens of a scene, but for where it is.
struct ReadLens {
    LensPrescription prescription;
    std::string name;
    int resolution = 8;
    bool dispersion = true;
};

/// One entry of a scene's `lenses`, of a checked document. Throws InputError with its place.
ReadLens read_lens(const Node& lens, std::size_t index, Reading& reading);

/// The bytes of a lens file, by the ending of its name: .zmx, .seq, or .json, as an entry of `lenses`.
/// `glasses` come before those of the catalogue. Throws InputError(file, place in it).
LensPrescription parse_lens(const std::string& bytes, const std::string& file,
                            std::span<const Glass> glasses = {});

/// A side as a primitive of a scene has it. Throws InputError(file, place in it).
LensSide parse_side(const std::string& bytes, const std::string& file);

Json lens_schema();          // of a scene's `lenses`
Json lens_surface_schema();  // of a lens

}  // namespace trilens
