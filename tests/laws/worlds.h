// Worlds for laws that hold across rooms: shipped scenes, and cages as mirrors in a room.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/image/height_grid.h"
#include "render/world/world.h"
#include "scene/load.h"

namespace trilens_test {

/// The names of the scenes that ship, without folder and ".json".
const std::vector<std::string>& shipped_scenes();

/// A shipped scene on a film of width x height, its optics at resolution n. Empty where a file that the scene
/// needs is not installed (`missing` then says which).
std::unique_ptr<trilens::World> shipped_world(const std::string& name, int n, int width, int height,
                                              std::string* missing = nullptr);

/// A cage of the outside data as a mirror in a coloured room with a model in it; both scaled to fit.
std::unique_ptr<trilens::World> cage_world(const std::string& cage, int n, int width, int height);

/// A cage made in a test as a mirror in the same room, with the shipped model in it.
std::unique_ptr<trilens::World> cage_world(const trilens::Cage& cage, int n, int width, int height);

/// The outside data's cages, "catmark_cube.obj" and so on; empty where the data are missing.
std::vector<std::string> data_cages();

/// A scene of the outside data, "scenes/NAME.json", whose cages are looked for there.
std::unique_ptr<trilens::World> data_world(const std::string& name);

/// A world from JSON text.
std::unique_ptr<trilens::World> world_from(const std::string& name, const std::string& json, int n);

/// The heights of a terrain as an OpenEXR of one channel.
void write_heights(const std::string& file, const trilens::HeightGrid& heights);

}  // namespace trilens_test
