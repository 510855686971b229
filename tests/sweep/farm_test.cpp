// Sweeps of several machines: merged folders, scripts for batch systems; sweeps kept as files.
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "base/files/files.h"
#include "base/util/error.h"
#include "json/json.h"
#include "support/test.h"
#include "sweep/fake_scene.h"
#include "sweep/plan/plan.h"
#include "sweep/run/farm_scripts.h"
#include "sweep/run/sweep.h"

using namespace trilens;
using trilens_test::FakeSweep;
namespace fs = std::filesystem;

namespace {

/// summary.json without what tells of the machine.
std::string comparable(const std::string& folder) {
    Json json = Json::parse(read_whole_file(folder + "/summary.json").value());
    for (Json& run : json["runs"]) {
        Json& metrics = run["metrics"];
        Json kept;
        for (const auto& [name, value] : metrics.items())
            if (name.rfind("t_", 0) != 0 && name.rfind("peak_", 0) != 0 && name.rfind("machine_", 0) != 0)
                kept[name] = value;
        metrics = kept;
    }
    return json.dump();
}

}  // namespace

TEST_CASE("sweep: shards in folders of their own merge into what one machine gives", "[sweep]") {
    const std::string home = trilens_test::scratch_dir("farm_merge");
    FakeSweep whole(home + "/whole", {1, 2, 4, 8, 16});
    whole.run();
    std::vector<std::string> parts;
    for (int i = 0; i < 3; ++i) {
        parts.push_back(home + "/part" + std::to_string(i));
        FakeSweep part(parts.back(), {1, 2, 4, 8, 16});
        part.params.shard = {i, 3};
        part.run();
    }
    CHECK(merge_folders(parts, home + "/all") == 5);
    report_sweep(home + "/all");
    CHECK(comparable(home + "/all") == comparable(home + "/whole"));
    // Again: nothing to do. What is merged can go on.
    CHECK(merge_folders(parts, home + "/all") == 0);
    FakeSweep more(home + "/all", {1, 2, 4, 8, 16, 32});
    more.run();
    CHECK((more.renders == 1 && more.traces == 0));
}

TEST_CASE("sweep: only parts of one sweep and one build merge; what is damaged counts as missing",
          "[sweep][bad-input]") {
    const std::string home = trilens_test::scratch_dir("farm_refused");
    FakeSweep one(home + "/one", {1, 2}), camera(home + "/camera", {1, 2}), build(home + "/build", {1, 2});
    one.run();
    camera.params.subject.camera = "side";
    camera.run();
    build.job_key = "another build";
    build.run();
    for (const char* other : {"/camera", "/build"}) {
        INFO(other);
        CHECK_THROWS_AS(merge_folders({home + "/one", home + other}, home + "/all"), InputError);
        CHECK(!fs::exists(home + "/all/runs"));
    }
    CHECK_THROWS_AS(merge_folders({home + "/none"}, home + "/all"), InputError);
    std::string bytes = read_whole_file(home + "/one/runs/n0002/image.exr").value();
    replace_text_file(home + "/one/runs/n0002/image.exr", bytes.substr(0, bytes.size() / 2));
    CHECK(merge_folders({home + "/one"}, home + "/all") == 1);
    CHECK(load_sweep(home + "/all").count(RunState::kMissing) == 1);
}

TEST_CASE("sweep: scripts name every part once and quote what shells would read", "[sweep]") {
    FarmRequest request;
    request.parts = 200;
    request.title = "it's a test";
    request.folder = "/results/a b";
    request.command = {"/usr/bin/trilens", "sweep", "run", "a b.json", "--over", "engine=exact,classic"};
    request.report = {"/usr/bin/trilens", "sweep", "report", "/results/a b"};
    for (const std::string& system : farm_systems()) {
        request.system = system;
        const std::string script = farm_script(request);
        INFO(script);
        CHECK(script.find("a b.json") != std::string::npos);
        if (system == "htcondor") {
            CHECK(script.find("\nqueue 200\n") != std::string::npos);
            continue;
        }
        const std::string file = trilens_test::scratch_dir("farm_script") + "/script";
        replace_text_file(file, script);
        CHECK(std::system(("bash -n " + file).c_str()) == 0);
    }
    request.system = "slurmm";
    CHECK_THROWS_AS(farm_script(request), UsageError);
    request.system = "slurm", request.parts = 0;
    CHECK_THROWS_AS(farm_script(request), UsageError);
    CHECK(shell_quoted("a'b c") == "'a'\\''b c'");
    CHECK(shell_quoted("/materials/0/ior=1.3,1.5") == "/materials/0/ior=1.3,1.5");
}

TEST_CASE("sweep: folders with blanks, quotes, % and $ come back from the scripts as they are", "[sweep]") {
    const std::string home = trilens_test::scratch_dir("farm_names");
    FarmRequest request;
    request.parts = 2;
    request.title = "test";
    request.folder = home + "/it's 50% of $HOME # \"all\"";
    request.command = {"trilens", "sweep", "run", "a.json", "-o", request.folder};
    request.report = {"trilens", "sweep", "report", request.folder};
    const auto text = [&](const char* system) {
        request.system = system;
        return farm_script(request);
    };
    std::string script = text("slurm");
    INFO(script);
    const std::string pattern = home + "/it's 50%% of $HOME # \\\"all\\\"";
    CHECK(script.find("#SBATCH --output=\"" + pattern + "/slurm-%a.log\"\n") != std::string::npos);

    // The shell's part, run with an sbatch and a trilens that write down their words.
    fs::create_directories(home + "/bin");
    for (const char* program : {"sbatch", "trilens"}) {
        const std::string file = home + "/bin/" + program;
        replace_text_file(
            file, "#!/bin/sh\nfor word; do echo \"$word\"; done >>'" + home + "/" + program + ".log'\n");
        fs::permissions(file, fs::perms::owner_all);
    }
    replace_text_file(home + "/script", script);
    const std::string run = "PATH='" + home +
                            "/bin':\"$PATH\" SLURM_ARRAY_TASK_ID=0 SLURM_ARRAY_JOB_ID=7 bash '" + home +
                            "/script'";
    REQUIRE(std::system(run.c_str()) == 0);
    const std::string words = read_whole_file(home + "/sbatch.log").value();
    INFO(words);
    CHECK(words.find("\n--output=" + home + "/it's 50%% of $HOME # \"all\"/slurm-report.log\n") !=
          std::string::npos);
    CHECK(read_whole_file(home + "/trilens.log").value().find("\n" + request.folder + "\n") !=
          std::string::npos);

    script = text("htcondor");
    CHECK(script.find("\noutput = " + home +
                      "/it's 50% of $(DOLLAR)HOME # \"all\"/condor-$(Process).out\n") != std::string::npos);
    CHECK(script.find("of $(DOLLAR)HOME # \"\"all\"\"' '--threads'") != std::string::npos);
    CHECK_NOTHROW(text("parallel"));

    request.folder = request.command.back() = "/a\\b";
    CHECK_THROWS_AS(text("slurm"), UsageError);
    request.folder = request.command.back() = "/a{}b";
    CHECK_THROWS_AS(text("parallel"), UsageError);
    CHECK_NOTHROW(text("slurm"));
    request.folder = request.command.back() = "/a\nb";
    for (const std::string& system : farm_systems()) CHECK_THROWS_AS(text(system.c_str()), UsageError);
}

TEST_CASE("sweep: a sweep file says scenes, axes and truth; what it may not say is refused with its place",
          "[sweep][bad-input]") {
    const std::string folder = trilens_test::scratch_dir("farm_file"), file = folder + "/sweep.json";
    replace_text_file(file, R"({ "scenes": ["a.json"], "truth": "facets", "zip": true, // a remark
        "over": [ {"axis": "resolution", "values": [1, 2, "4..8:x2"]}, {"axis": "/materials/0/ior", "values": "1..4:+1"},
                  {"axis": "/cameras/0/lookAt/eye", "values": [[0, 1, 4]]} ],
        "set": {"/film/width": 96} })");
    CHECK(is_sweep_file(file));
    const SweepFile sweep = read_sweep_file(file);
    CHECK(sweep.scenes == std::vector<std::string>{"a.json"});
    CHECK(sweep.over.at(0).values == std::vector<std::string>{"1", "2", "4..8:x2"});
    CHECK(sweep.over.at(1).values == std::vector<std::string>{"1..4:+1"});
    CHECK(sweep.over.at(2).values == std::vector<std::string>{"[0,1,4]"});
    CHECK((sweep.zip && sweep.truth == "facets"));
    CHECK(sweep.set.at(0) == std::pair<std::string, std::string>("/film/width", "96"));

    const std::vector<std::pair<std::string, std::string>> bad = {
        {"", "is empty"},
        {"{\"over\"", "line 1"},
        {"{\"over\": []}", "/over"},
        {"{\"scenes\": [\"a\"]}", "over"},
        {"{\"over\": [{\"axis\": \"resolution\"}]}", "/over/0"},
        {"{\"over\": [{\"axis\": \"resolution\", \"values\": []}]}", "/over/0/values"},
        {"{\"over\": [{\"axis\": 3, \"values\": [1]}]}", "/over/0/axis"},
        {"{\"over\": [{\"axis\": \"a\", \"values\": [1]}], \"zipp\": true}", "zip"},
        {"{\"over\": [{\"axis\": \"a\", \"values\": [1]}], \"repeats\": 0}", "/repeats"},
        {"[1]", "expected an object"}};
    for (const auto& [text, named] : bad) {
        INFO(text);
        replace_text_file(file, text);
        try {
            read_sweep_file(file);
            FAIL("was read");
        } catch (const InputError& error) {
            INFO(error.what());
            CHECK(std::string(error.what()).find(named) != std::string::npos);
            CHECK(std::string(error.what()).find("sweep.json") != std::string::npos);
        }
    }
}
