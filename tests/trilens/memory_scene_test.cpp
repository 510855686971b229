// Scenes in memory: swept as files are, known by what they hold, and named in messages.
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "support/test.h"
#include "trilens/trilens.h"

using namespace trilens;
namespace fs = std::filesystem;

namespace {

std::string example_text() {
    return scene_examples()[0].json;
}

const std::vector<SceneOverride> kSmall{{"/film/width", "64"}, {"/film/height", "48"}, {"/film/spp", "1"}};

/// A sweep, and which pictures it drew the last time.
struct CountedSweep {
    SweepRequest request;
    std::map<std::string, int> drawn;  // "render", "trace"
    std::vector<std::string> warnings;

    explicit CountedSweep(const std::string& folder) {
        request.folder = folder;
        request.over = {{"resolution", {"2", "4", "8"}}};
    }
    SweepSummary run() {
        drawn.clear();
        SweepObserver talk;
        talk.progress = [this](const std::string& job) {
            ++drawn[job];
            return Progress();
        };
        talk.warn = [this](const std::string& message) { warnings.push_back(message); };
        return run_sweep(request, talk);
    }
};

}  // namespace

TEST_CASE("a scene in memory is swept as its file is, and either goes on with the other's folder",
          "[trilens][sweep]") {
    const std::string folder = trilens_test::scratch_dir("memory_sweep");
    replace_text_file(folder + "/ball.json", example_text());
    CountedSweep from_file(folder + "/sweep");
    from_file.request.scene = {folder + "/ball.json", kSmall, 0};
    const SweepSummary by_file = from_file.run();
    CHECK((from_file.drawn["render"] == 3 && from_file.drawn["trace"] == 1));

    CountedSweep in_memory(folder + "/memory");
    in_memory.request.loaded = parse_scene(example_text(), folder, kSmall);
    const SweepSummary by_memory = in_memory.run();
    CHECK((in_memory.drawn["render"] == 3 && in_memory.drawn["trace"] == 1));
    CHECK(by_memory.manifest.subject.title == "scene");
    CHECK(by_memory.manifest.subject.scene == "scene");
    REQUIRE(by_memory.fits.size() == by_file.fits.size());
    REQUIRE(!by_file.fits.empty());
    for (std::size_t i = 0; i < by_file.fits.size(); ++i) {
        CHECK(by_memory.fits[i].metric == by_file.fits[i].metric);
        CHECK(by_memory.fits[i].order == by_file.fits[i].order);
    }
    CHECK(in_memory.run().count(RunState::kDone) == 3);
    CHECK((in_memory.drawn["render"] == 0 && in_memory.drawn["trace"] == 0));

    in_memory.request.folder = from_file.request.folder;
    in_memory.request.over = {{"resolution", {"2", "4", "8", "16"}}};
    CHECK(in_memory.run().count(RunState::kDone) == 4);
    CHECK((in_memory.drawn["render"] == 1 && in_memory.drawn["trace"] == 0));
}

TEST_CASE("what is changed in a scene in memory is swept anew, also where its text does not tell",
          "[trilens][sweep]") {
    CountedSweep sweep(trilens_test::scratch_dir("memory_changed"));
    Scene scene = parse_scene(example_text(), "", kSmall);
    sweep.request.loaded = scene;
    const double before = *sweep.run().fits.at(0).constant;
    scene.meshes[0].name = "renamed";
    scene.cameras[0].eye.y += 0.5;
    sweep.request.loaded = scene;
    CHECK_THROWS_AS(sweep.run(), UsageError);  // another sweep's folder

    sweep.request.replace = true;
    scene.label = "my ball";
    sweep.request.loaded = scene;
    const SweepSummary changed = sweep.run();
    CHECK((sweep.drawn["render"] == 3 && sweep.drawn["trace"] == 1));
    CHECK(*changed.fits.at(0).constant != before);
    CHECK(changed.manifest.subject.title == "my ball");

    // A label makes it one scene that is edited.
    sweep.request.replace = false;
    scene.cameras[0].eye.y += 0.5;
    sweep.request.loaded = scene;
    sweep.run();
    CHECK((sweep.drawn["render"] == 3 && sweep.drawn["trace"] == 1));
    std::size_t truths = 0;
    for (const auto& entry : fs::directory_iterator(sweep.request.folder + "/truth"))
        truths += entry.path().extension() == ".exr";
    CHECK(truths == 2);
    sweep.run();
    CHECK((sweep.drawn["render"] == 0 && sweep.drawn["trace"] == 0));
    sweep.request.loaded->label = "your ball";
    sweep.request.loaded->cameras[0].eye.y += 0.5;
    CHECK_THROWS_AS(sweep.run(), UsageError);
}

TEST_CASE("a scene in memory that cannot be swept is named", "[trilens][sweep][bad-input]") {
    CountedSweep sweep(trilens_test::scratch_dir("memory_none"));
    Scene scene = parse_scene(example_text(), "", kSmall);
    std::erase_if(scene.meshes, [](const Mesh& mesh) { return mesh.role == Role::kOptic; });
    scene.label = "dull";
    sweep.request.loaded = scene;
    CHECK_THROWS_WITH(sweep.run(), Catch::Matchers::StartsWith("dull: /meshes: "));
}

TEST_CASE("messages about a scene in memory name it by its label, or as a scene", "[trilens]") {
    const std::vector<SceneOverride> doubtful{{"/meshes/1/name", R"("ball")"}}, broken{{"/film/width", "0"}};
    for (const std::string label : {"", "my ball"}) {
        const std::string start = (label.empty() ? "scene" : label) + ": ";
        INFO(start);
        const Scene scene = parse_scene(example_text(), "", doubtful, label);
        REQUIRE(!scene.warnings.empty());
        for (const std::string& warning : scene.warnings) CHECK(warning.find(start) == 0);
        CHECK(scene.file.empty());
        CHECK_THROWS_WITH(parse_scene(example_text(), "", broken, label), Catch::Matchers::StartsWith(start));
        Scene bad = scene;
        bad.film.spp = 0;
        CHECK_THROWS_WITH(Renderer(bad), Catch::Matchers::StartsWith(start + "/film/spp"));
    }
}
