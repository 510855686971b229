// Files that are written beside their name: what another process left there is in nobody's way.
#include "base/files/files.h"

#include <unistd.h>

#include <filesystem>
#include <iterator>
#include <string>
#include <vector>

#include "base/util/error.h"
#include "support/test.h"

using namespace trilens;
namespace fs = std::filesystem;

TEST_CASE("files: names that a killed process left are passed over and stay", "[base][law]") {
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

TEST_CASE("files: a name's ending, in small letters", "[base]") {
    CHECK(file_ending("a/B.EXR") == ".exr");
    CHECK(file_ending("two.dots.Tri") == ".tri");
    CHECK(file_ending("folder.d/none") == "");
    CHECK(file_ending(".exr") == "");
    CHECK(file_ending("") == "");
}

TEST_CASE("files: a new file takes its name when it is whole, else leaves the old file alone", "[base]") {
    const std::string folder = trilens_test::scratch_dir("base_new_file"), file = folder + "/whole.bin";
    const auto bytes = [](const std::string& text) {
        return std::vector<unsigned char>(text.begin(), text.end());
    };
    const auto count = [&] {
        return std::distance(fs::directory_iterator(folder), fs::directory_iterator());
    };
    replace_text_file(file, "old");
    {
        NewFile left(file);
        left.write(0, bytes("new"));
        CHECK(read_whole_file(file) == "old");
    }
    CHECK(count() == 1);
    NewFile made(file);
    made.write(0, bytes("....ef"));
    made.write(6, bytes("gh"));
    made.write(0, bytes("ab"));
    made.write(2, bytes("cd"));
    CHECK(read_whole_file(file) == "old");
    made.commit();
    CHECK(read_whole_file(file) == "abcdefgh");
    CHECK(count() == 1);
    CHECK_THROWS_AS(NewFile(folder + "/none/whole.bin"), OutputError);
}

TEST_CASE("files: of a program that ends at once nothing unfinished is left", "[base]") {
    const std::string folder = trilens_test::scratch_dir("base_unfinished");
    replace_text_file(folder + "/old", "old");
    NewFile done(folder + "/done"), begun(folder + "/begun"), other(folder + "/other");
    begun.write(0, std::vector<unsigned char>(5));
    done.commit();
    CHECK(std::distance(fs::directory_iterator(folder), fs::directory_iterator()) == 4);
    remove_unfinished_files();
    CHECK(std::distance(fs::directory_iterator(folder), fs::directory_iterator()) == 2);
    CHECK(read_whole_file(folder + "/old") == "old");
    CHECK(fs::exists(folder + "/done"));
}

TEST_CASE("files: a new file that cannot have its name says so and leaves nothing", "[base]") {
    const std::string folder = trilens_test::scratch_dir("base_full");
    // A folder that takes the name meanwhile.
    {
        NewFile made(folder + "/name");
        fs::create_directories(folder + "/name/inside");
        made.write(0, std::vector<unsigned char>(5));
        CHECK_THROWS_AS(made.commit(), OutputError);
    }
    CHECK(std::distance(fs::directory_iterator(folder), fs::directory_iterator()) == 1);
}
