// The size of the house: what a reader has to look through stays small.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <string>
#include <vector>

#include "support/test.h"

namespace fs = std::filesystem;

namespace {

struct SourceFile {
    std::string name, folder;  // relative to the project
    std::size_t lines = 0;
};

/// The C++ files below these folders of the project.
std::vector<SourceFile> files_below(const std::vector<std::string>& folders) {
    std::vector<SourceFile> files;
    for (const std::string& folder : folders)
        for (const auto& entry :
             fs::recursive_directory_iterator(fs::path(trilens_test::source_dir()) / folder)) {
            const std::string end = entry.path().extension().string();
            if (!entry.is_regular_file() || (end != ".h" && end != ".cpp")) continue;
            std::ifstream in(entry.path());
            SourceFile file;
            file.name = fs::relative(entry.path(), trilens_test::source_dir()).string();
            file.folder = fs::path(file.name).parent_path().string();
            for (std::string line; std::getline(in, line);) ++file.lines;
            files.push_back(file);
        }
    return files;
}

const std::vector<std::string> kProduct{"src", "surfaces", "reflect", "refract"};

}  // namespace

TEST_CASE("no file of the source has more than 400 lines", "[laws][law]") {
    const std::vector<SourceFile> files =
        files_below({"src", "surfaces", "reflect", "refract", "python", "bench", "tests"});
    REQUIRE(files.size() > 500);
    for (const SourceFile& file : files) {
        INFO(file.name << " has " << file.lines << " lines");
        CHECK(file.lines <= 400);
    }
}

TEST_CASE("no folder of the source holds more than 25 files", "[laws][law]") {
    std::map<std::string, std::size_t> count;
    for (const SourceFile& file : files_below(kProduct)) ++count[file.folder];
    for (const auto& [folder, files] : count) {
        INFO(folder << " holds " << files << " files");
        // The public headers stand side by side, as their users have them.
        CHECK(files <= (folder == "src/trilens" ? 26 : 25));
    }
}

/// Of an odd number the middle one, of an even number the larger of the two.
std::size_t median_of(std::vector<std::size_t> lines) {
    std::nth_element(lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(lines.size() / 2),
                     lines.end());
    return lines[lines.size() / 2];
}

TEST_CASE("files are no scraps: half of them have more than 120 lines, of headers with their .cpp over 180",
          "[laws][law]") {
    std::vector<std::size_t> lines, lines_of_units;
    std::map<std::string, std::size_t> units;
    for (const SourceFile& file : files_below(kProduct)) {
        lines.push_back(file.lines);
        units[fs::path(file.name).replace_extension().string()] += file.lines;
    }
    for (const auto& [unit, count] : units) lines_of_units.push_back(count);
    CHECK(median_of(lines) > 120);
    CHECK(median_of(lines_of_units) > 180);
}

TEST_CASE("few headers are installed, each standing alone, and none of the machinery behind them",
          "[laws][law]") {
    const fs::path installed = fs::path(trilens_test::build_dir()) / "include" / "trilens";
    REQUIRE(fs::is_directory(installed));
    std::size_t own = 0;
    for (const auto& entry : fs::recursive_directory_iterator(installed)) {
        if (entry.path().extension() != ".h") continue;
        ++own;
        CHECK(entry.path().parent_path() == installed);
        std::ifstream in(entry.path());
        for (std::string line; std::getline(in, line);) {
            INFO(fs::relative(entry.path(), installed).string() << ": " << line);
            CHECK(line.find("#include \"") == std::string::npos);
            for (const char* machinery : {"struct World {", "struct SampleViews {", "struct Segments {",
                                          "class Tracer {", "nlohmann"})
                CHECK(line.find(machinery) == std::string::npos);
        }
    }
    CHECK(own <= 22);
}

/// The constants (kName = ...) that a declaration's line names.
std::vector<std::string> constants_of(const std::string& line) {
    static const std::regex named(R"(\b(k[A-Z]\w*)(\[[^\]]*\])? ?[={])");
    std::vector<std::string> names;
    for (std::sregex_iterator match(line.begin(), line.end(), named), end; match != end; ++match)
        names.push_back((*match)[1]);
    return names;
}

// One unit of a unity build has many files, in an order that options change: there a function's constant in a
// header would shadow a file's, which Clang warns of.
TEST_CASE("a constant inside of a header's function has no name that a file's constant has", "[laws][law]") {
    std::map<std::string, std::string> of_functions, of_files;  // where it is
    for (const SourceFile& file : files_below(kProduct)) {
        std::ifstream in(fs::path(trilens_test::source_dir()) / file.name);
        for (std::string line; std::getline(in, line);) {
            const bool is_of_file = line.starts_with("constexpr ") || line.starts_with("inline constexpr ");
            const bool is_of_function =
                file.name.ends_with(".h") && std::regex_search(line, std::regex("^ +constexpr "));
            if (is_of_file || is_of_function)
                for (const std::string& name : constants_of(line))
                    (is_of_file ? of_files : of_functions)[name] = file.name;
        }
    }
    CHECK(of_files.size() > 300);
    CHECK(of_functions.size() > 20);
    for (const auto& [name, file] : of_functions) {
        INFO(name << " of " << file);
        CHECK(!of_files.contains(name));
    }
}

// Debian 12 has Catch2's version 2, Debian 13 version 3, whose Contains asks for an element of a range.
TEST_CASE("tests name no matcher that one of Catch2's versions lacks", "[laws]") {
    const std::regex lacking("Catch::Contains|Matchers::Contains\\b");
    std::size_t lines = 0;
    for (const SourceFile& file : files_below({"tests"})) {
        if (file.name == "tests/support/test.h" || file.name == "tests/laws/house_test.cpp") continue;
        std::ifstream in(fs::path(trilens_test::source_dir()) / file.name);
        for (std::string line; std::getline(in, line); ++lines) {
            INFO(file.name << ": " << line);
            if (std::regex_search(line, lacking)) CHECK(line.empty());
        }
    }
    CHECK(lines > 10'000);
}
