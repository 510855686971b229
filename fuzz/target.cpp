// The list of fuzz targets, and where they put files.
#include "fuzz/target.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace fs = std::filesystem;

namespace trilens_fuzz {
namespace {

constexpr std::array kTargets{
    FuzzTarget{"animation", "a scene with keyframes, at a frame", scene_animation},
    FuzzTarget{"caustics", "random scenes, their lights followed over optics", random_caustics, true},
    FuzzTarget{"exr", "a picture that is measured and written again", exr_file},
    FuzzTarget{"fit", "random scenes, their numbers fitted to exact pairs", random_fit, true},
    FuzzTarget{"gltf", "glTF, text or binary, as a scene", gltf_file},
    FuzzTarget{"laws", "random scenes, drawn and held against the laws", random_scene, true},
    FuzzTarget{"lens", "a lens file of an optics program", lens_text},
    FuzzTarget{"maps", "random scenes, their films mapped onto panoramas and objects", random_maps, true},
    FuzzTarget{"mtl", "materials of an OBJ", mtl_text},
    FuzzTarget{"nrrd", "a volume on a regular grid", nrrd_text},
    FuzzTarget{"obj", "a cage or model", obj_text},
    FuzzTarget{"pairs", "pairs of pixels and points", pairs_text},
    FuzzTarget{"png", "a texture", png_file},
    FuzzTarget{"points", "points as text or PLY", points_text},
    FuzzTarget{"radiosity", "random scenes, their light baked", random_radiosity, true},
    FuzzTarget{"report", "names, put into a sweep's report", sweep_report, true},
    FuzzTarget{"run", "a sweep's folder: manifest, plan, a run", run_folder},
    FuzzTarget{"scene", "a scene file", scene_text},
    FuzzTarget{"suite", "random scenes as regression tests", random_suite, true},
    FuzzTarget{"sweep", "a sweep file", sweep_file},
    FuzzTarget{"terrain", "random heights, as triangles", random_terrain, true},
    FuzzTarget{"test", "a regression test's test.json", test_file},
    FuzzTarget{"vtk", "a volume in cells", vtk_text},
    FuzzTarget{"wish", "the wish of a freeform mirror", wish_text},
};

constexpr const char* kSmallScene = R"({ "version": 1, "film": { "width": 8, "height": 6 },
  "cameras": [ { "name": "c", "type": "perspective", "yfov": 40, "lookAt": { "eye": [0, 0, 4], "at": [0, 0, 0] } } ],
  "materials": [ { "name": "chrome", "metallicFactor": 1 }, { "name": "white", "unlit": true } ],
  "meshes": [ { "name": "a", "role": "optic", "material": "chrome", "primitive": { "type": "sphere" } },
              { "name": "b", "role": "optic", "material": "chrome",
                "primitive": { "type": "sphere", "center": [1.5, 0, 0], "radius": 0.5 } },
              { "name": "wall", "role": "object", "material": "white", "points": [[-9,-9,9],[9,-9,9],[9,9,9],[-9,9,9]],
                "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3] } ] })";

/// Made when first asked for, and taken away when the process ends.
struct OwnFolder {
    OwnFolder() {
        const fs::path root = fs::is_directory("/dev/shm") ? "/dev/shm" : fs::temp_directory_path();
        path = (root / ("trilens-fuzz-" + std::to_string(::getpid()))).string();
        fs::create_directories(path);
    }
    ~OwnFolder() {
        std::error_code unheard;
        fs::remove_all(path, unheard);
    }
    std::string path;
};

}  // namespace

std::span<const FuzzTarget> fuzz_targets() {
    return kTargets;
}

const FuzzTarget* find_target(std::string_view name) {
    const auto found = std::ranges::find(kTargets, name, &FuzzTarget::name);
    return found == kTargets.end() ? nullptr : &*found;
}

const char* small_scene() {
    return kSmallScene;
}

const std::string& fuzz_folder() {
    static const OwnFolder folder;
    return folder.path;
}

std::string put_file(const std::string& name, std::string_view bytes) {
    const fs::path file = fs::path(fuzz_folder()) / name;
    fs::create_directories(file.parent_path());
    std::ofstream out(file, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    require(out.good(), "the fuzzer cannot write " + file.string());
    return file.string();
}

std::string file_text(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace trilens_fuzz
