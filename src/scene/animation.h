// A scene that moves: keyed values of its JSON, and the scene as it is at one frame.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scene/data/scene.h"
#include "scene/data/scene_inputs.h"

namespace trilens {

/// What a scene's `animation` says of time.
struct AnimationInfo {
    double first = 0, last = 0;  // the first and last frames that have keys
    double fps = 24;
    std::size_t tracks = 0;
};

/// None where the scene has no animation, or was built in memory. Throws InputError where Scene::resolved is
/// no scene's JSON.
std::optional<AnimationInfo> find_animation(const Scene& scene);

/// The scene at a frame, which may lie between whole ones: every animated value as its keys have it, held
/// before the first key and after the last, `changes` on top, and no animation any more. Linear from key to
/// key; rotations (a mesh's /transform/rotate) by the shorter great arc at even speed [Shoemake, Animating
/// Rotation with Quaternion Curves, 1985]; "smooth" eases in and out by 3 s^2 - 2 s^3; "step" holds. Equal to
/// the scene read from a file with those values. Where no mesh, material or background differs they are
/// copied and no file is read again. Throws InputError as load_scene does, and UsageError for a scene built
/// in memory.
Scene load_frame(const Scene& scene, double frame, std::span<const SceneOverride> changes,
                 const TextureReader& textures);

/// What turns a camera about its lookAt's `at` and up axis by 360 * frame / frames degrees, counterclockwise
/// seen against the axis. Throws UsageError for a camera that there is not or whose rays do not all go with
/// its lookAt, and for less than one frame.
std::vector<SceneOverride> turntable(const Scene& scene, std::size_t camera, int frame, int frames);

inline constexpr int kMostFrames = 100'000;

/// The frames of "A..B" or "A", ascending or descending as they are named. Throws UsageError for a text that
/// names none, or more than kMostFrames.
std::vector<int> parse_frames(const std::string& text);

/// The output's name for a frame: its run of # becomes the number, with zeros before it. Throws UsageError
/// where the name has no #, or several runs of them.
std::string frame_file(const std::string& output, int frame);

}  // namespace trilens
