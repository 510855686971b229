// Files that are written beside their name: what another process left there is in nobody's way.
#include "base/file_bytes.h"

#include <unistd.h>

#include <filesystem>
#include <string>

#include "base/error.h"
#include "base/files.h"
#include "support/test.h"

using namespace trilens;
namespace fs = std::filesystem;

TEST_CASE("files: names that a killed process left are passed over and stay", "[base]") {
    const std::string folder = trilens_test::scratch_dir("base_left_parts"), file = folder + "/s.exr";
    // Ids of processes come back: those of a process with this one's id, which had written some files.
    const int left = 2000;
    const auto part = [&](int counter) {
        return file + "." + std::to_string(getpid()) + "-" + std::to_string(counter) + ".part";
    };
    std::vector<std::string> parts;
    const bool are_too_many = GENERATE(false, true);
    for (int counter = 0; counter < (are_too_many ? 100 * left : 20); ++counter) {
        if (are_too_many && counter % 100 != 0 && counter > left) continue;
        parts.push_back(part(counter));
        fs::create_symlink("another's", parts.back());
    }
    if (are_too_many)
        CHECK_THROWS_AS(replace_text_file(file, "mine"), OutputError);
    else
        CHECK_NOTHROW(replace_text_file(file, "mine"));
    CHECK(read_whole_file(file).value_or("none") == (are_too_many ? "none" : "mine"));
    for (const std::string& one : parts) CHECK(fs::is_symlink(one));
    std::size_t files = 0;
    for (const auto& entry : fs::directory_iterator(folder)) files += !entry.path().empty();
    CHECK(files == parts.size() + (are_too_many ? 0 : 1));
}
