// Numbers of a scene that JSON pointers name, and scenes with other values for them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "scene/data/scene.h"

namespace trilens {

/// One number of a scene's JSON.
struct SceneNumber {
    std::string pointer;  // to the number itself: "/meshes/0/transform/translate/1"
    double value = 0;
};

/// The numbers that pointers into Scene::resolved name, in their order: of an array all that it holds, arrays
/// inside of it too. A mesh's `transform`, and its `translate`, `rotate` and `scale`, may be missing: then
/// they are those of no transform. Throws InputError with the pointer where it names no number.
std::vector<SceneNumber> find_numbers(const Scene& scene, std::span<const std::string> pointers);

/// The scene with other values for some of its numbers, without its textures. Throws InputError where that is
/// no scene.
Scene scene_with(const Scene& scene, std::span<const SceneNumber> numbers);
Scene scene_with(const Scene& scene, const SceneNumber& number);

/// Whether a text, like the scene's own with more of it written out, is the same scene: textures are not
/// looked at. Throws InputError where it is none.
bool is_same_scene(const Scene& scene, const std::string& text);

}  // namespace trilens
