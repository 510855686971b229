// unwrap, map and anamorph: what each writes, and the one message for what it cannot use.
#include <filesystem>
#include <string>
#include <vector>

#include "cli/command_line.h"
#include "support/test.h"

using namespace trilens_test;
namespace fs = std::filesystem;

namespace {

struct BadLine {
    std::string arguments;
    int exit_code = 0;
    std::string says;
};

}  // namespace

TEST_CASE("unwrap, map and anamorph say what they cannot use, and leave nothing behind",
          "[cli][inverse][bad-input]") {
    const std::string folder = scratch_dir("cli_inverse_bad"),
                      scene = write_file(folder, "s.json", small_scene());
    const std::string photo = folder + "/p.exr", page = source_dir() + "/scenes/inverse/anamorph-ball.json";
    REQUIRE(run_trilens("trace " + scene + " -q -o " + photo).exit_code == 0);
    const std::string unwrap = "unwrap " + scene + " " + photo + " -o " + folder + "/o.exr ";
    const std::string anamorph = "anamorph " + page + " --picture " + photo + " -o " + folder + "/o.pdf ";
    for (const BadLine& bad : std::vector<BadLine>{
             {unwrap + "--to equirect:64x32 --size 20x20", 3, "32 x 24"},
             {unwrap + "--to nobody", 2, "nobody"},
             {unwrap + "--to equirect:64x32 --images 0", 2, "counted from 1"},
             {unwrap + "--to equirect:64x32 --optic wall", 2, "no optic"},
             {unwrap + "--to equirect:64x32 --proxy cone", 2, "proxy"},
             {unwrap + "--to equirect:64x32 --center far", 2, "--center"},
             {unwrap + "--to equirect:64x32 --path refract", 3, "nothing of the target"},
             {"unwrap " + scene + " " + photo + " --to equirect:64x32 -o " + folder + "/o.tif", 2, ".exr"},
             {"unwrap " + scene + " " + photo + " --to equirect:64x32 -o " + photo, 2, "p.exr"},
             {"map " + scene + " --to equirect:64x32 -o " + folder + "/o.tif", 2, "Bourke"},
             {"map " + scene + " --to equirect:64x32 --mesh 3 -o " + folder + "/o.data", 2, "--mesh"},
             {"map " + scene + " --to equirect:64x32 --path reflect -o " + folder + "/o.data", 2,
              "a path goes"},
             {"map " + scene + " --to equirect:64x32 --word X -o " + folder + "/o.exr", 2, "X"},
             {anamorph + "--page page --unit furlong", 2, "furlong"},
             {anamorph + "--page mirror", 3, "optic"},
             {anamorph + "--page page --window 0,0,10,10", 3, "not seen"},
             {anamorph + "--page page --window 1,2,3", 2, "--window"},
             {anamorph + "--page page --paper A9", 2, "A9"},
             {anamorph + "--page page --bleed long", 2, "long"},
             {anamorph + "--page page --fit --window 1,2,3,4", 2, "--fit"}}) {
        const CommandRun run = run_trilens(bad.arguments + " --progress none");
        INFO(bad.arguments << "\n" << run.err);
        CHECK(run.exit_code == bad.exit_code);
        CHECK(run.out.empty());
        CHECK(run.err.find(bad.says) != std::string::npos);
    }
    std::size_t files = 0;
    for (const auto& entry : fs::directory_iterator(folder)) files += entry.is_regular_file();
    CHECK(files == 2);
}

TEST_CASE("unwrap and map write every format, and answer in JSON", "[cli][inverse]") {
    const std::string folder = scratch_dir("cli_inverse"),
                      scene = write_file(folder, "s.json", small_scene());
    REQUIRE(run_trilens("trace " + scene + " -q -o " + folder + "/p.exr").exit_code == 0);
    const CommandRun run =
        run_trilens("unwrap " + scene + " " + folder +
                    "/p.exr --to equirect:64x32 --json --progress none -o " + folder + "/o.png");
    INFO(run.err);
    CHECK(run.exit_code == 0);
    CHECK(run.out.find("\"coverage\"") != std::string::npos);
    CHECK(bytes_of(folder + "/o.png").rfind("\x89PNG", 0) == 0);
    for (const char* file : {"m.exr", "m.npz", "m.pgm", "m.data", "m.obj"}) {
        const CommandRun made = run_trilens(
            "map " + scene + " --to equirect:64x32 --max-error 20 --progress none -o " + folder + "/" + file);
        INFO(file << made.err);
        CHECK(made.exit_code == 0);
        CHECK(!made.out.empty());
    }
    CHECK(bytes_of(folder + "/m_x.pgm").size() == bytes_of(folder + "/m_y.pgm").size());
    CHECK(bytes_of(folder + "/m.data").rfind("2\n", 0) == 0);
    CHECK(bytes_of(folder + "/m.npz").rfind("PK", 0) == 0);
}
