// Numbers of a scene named by JSON pointers, as unknowns of a fit.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/math/vec.h"
#include "json/json.h"
#include "scene/data/scene.h"

namespace trilens {

/// The parts of a scene whose numbers a picture's geometry depends on.
enum class ScenePart { kCamera, kMesh, kMaterial };

/// One unknown: a number of the scene's JSON, or a turn of a mesh about a world axis.
struct FitParameter {
    std::string name;  // its pointer; of a turn with the axis: "/meshes/0/transform/rotate/x"
    ScenePart part = ScenePart::kMesh;
    std::size_t index = 0;  // of the part in its array
    std::string inside;     // JSON pointer inside of the part
    bool is_turn = false;   // of a quaternion: about `axis`, degrees, counted from where the fit begins
    Vec3 axis{0};
    double scale = 1;  // a large step, in the parameter's unit
};

/// The unknowns that pointers name, each once: a number, an array of numbers (all of its entries), or a
/// mesh's quaternion `transform/rotate` (three turns about the world's axes). Entries of arrays are named by
/// place or by name; a key that is missing in `document` but has a default in the schema is added to it.
/// `extent`: the scene's size, a large step of lengths. Throws InputError with the pointer where it names no
/// number, or none of a camera, an optic or a material.
std::vector<FitParameter> find_parameters(Json& document, std::span<const std::string> pointers,
                                          const std::string& file, double extent);

/// The part's JSON in the document.
Json& part_of(Json& document, const FitParameter& parameter);
const Json& part_of(const Json& document, const FitParameter& parameter);

/// Moves the parameter by `amount` of its unit; `part`: the JSON that it stands in.
void move_parameter(Json& part, const FitParameter& parameter, double amount);

/// Its number; of a turn the component of the rotation vector from `start` to `document`, degrees.
double parameter_value(const Json& document, const FitParameter& parameter, const Json& start);

/// What a null vector moves, in words: "turning /meshes/0 about the axis (0, 1, 0)", "/meshes/0/primitive/
/// radius with /cameras/0/yfov".
std::string describe_motion(std::span<const FitParameter> parameters, std::span<const double> motion);

}  // namespace trilens
