// Fuzz targets of files that stand in folders with others: glTF, sweeps, regression tests, run folders.
#include <array>
#include <filesystem>
#include <optional>

#include "fuzz/target.h"
#include "trilens/scene.h"
#include "trilens/suite.h"
#include "trilens/sweep.h"

using namespace trilens;
namespace fs = std::filesystem;

namespace trilens_fuzz {
namespace {

/// The parts of an input, divided by lines of three dashes: files of one folder.
std::vector<std::string_view> parts_of(std::string_view bytes) {
    std::vector<std::string_view> parts;
    constexpr std::string_view kRuler = "\n---\n";
    for (;;) {
        const std::size_t at = bytes.find(kRuler);
        parts.push_back(bytes.substr(0, at));
        if (at == std::string_view::npos) return parts;
        bytes.remove_prefix(at + kRuler.size());
    }
}

}  // namespace

Answer gltf_file(std::string_view bytes) {
    const bool binary = bytes.substr(0, 4) == "glTF";
    const std::string file = put_file(binary ? "fuzzed.glb" : "fuzzed.gltf", bytes);
    return answer([&] {
        SceneRequest request;
        request.file = file;
        request.import.optics = {"mirror*"};
        request.import.time = 0.25;
        const Scene scene = load_scene(request);
        check_scene(scene);
    });
}

Answer sweep_file(std::string_view bytes) {
    const std::string file = put_file("sweep.json", bytes);
    put_file("scene.json", small_scene());
    return answer([&] {
        SweepRequest base;
        base.scene.file = fuzz_folder() + "/scene.json";
        base.folder = fuzz_folder() + "/unused";
        const SweepRequest request = read_sweep_file(file, base);
        why_left_out(request);
        is_whole_sweep(request.shard);
    });
}

Answer test_file(std::string_view bytes) {
    put_file("test/test.json", bytes);
    put_file("test/scene.json", small_scene());
    return answer([&] { read_render_test(fuzz_folder() + "/test"); });
}

Answer run_folder(std::string_view bytes) {
    constexpr std::array kFiles{"manifest.json", "plan.jsonl", "runs/n0001/error.json"};
    fs::remove_all(fuzz_folder() + "/run");
    const std::vector<std::string_view> parts = parts_of(bytes);
    for (std::size_t i = 0; i < parts.size() && i < kFiles.size(); ++i)
        put_file(std::string("run/") + kFiles[i], parts[i]);
    return answer([&] { load_sweep(fuzz_folder() + "/run"); });
}

}  // namespace trilens_fuzz
