// The shape of the program: every library has one door, and rooms see only what CMakeLists.txt says they see.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <vector>

#include "support/test.h"

namespace fs = std::filesystem;

namespace {

struct Include {
    std::string file;  // relative to the project
    std::string target;
    bool angled = false;
};

bool is_source(const fs::path& path) {
    const std::string end = path.extension().string();
    return end == ".h" || end == ".cpp";
}

std::vector<Include> includes_under(const std::string& folder) {
    static const std::regex kLine(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"])");
    std::vector<Include> found;
    for (const auto& entry :
         fs::recursive_directory_iterator(fs::path(trilens_test::source_dir()) / folder)) {
        if (!entry.is_regular_file() || !is_source(entry.path())) continue;
        std::ifstream in(entry.path());
        std::string line;
        std::smatch match;
        while (std::getline(in, line)) {
            if (!std::regex_search(line, match, kLine)) continue;
            found.push_back(
                {fs::relative(entry.path(), trilens_test::source_dir()).string(), match[2], match[1] == "<"});
        }
    }
    return found;
}

struct Room {
    std::string folder;
    std::vector<std::string> folders;  // inside of it, each of which may see those before
    std::set<std::string> sees;
};

/// The rooms and arrows as CMakeLists.txt states them.
std::map<std::string, Room> rooms() {
    std::ifstream in(trilens_test::source_dir() + "/CMakeLists.txt");
    std::stringstream text;
    text << in.rdbuf();
    const std::string all = text.str();
    static const std::regex kRoom(R"(trilens_(?:room|client)\(\s*(\w+)\s+([\w/]+)([^)]*)\))");
    std::map<std::string, Room> result;
    for (std::sregex_iterator it(all.begin(), all.end(), kRoom), end; it != end; ++it) {
        Room room;
        room.folder = (*it)[2];
        room.sees.insert((*it)[1]);
        std::stringstream words((*it)[3].str());
        std::string word, section;
        while (words >> word) {
            if (word == "FOLDERS" || word == "SEES" || word == "DOORS")
                section = word;
            else if (section == "FOLDERS")
                room.folders.push_back(word);
            else if (section == "SEES")
                room.sees.insert(word);
        }
        result[(*it)[1]] = room;
    }
    return result;
}

/// The room in whose folder a path lies, the innermost where rooms stand in rooms; "": none.
std::string room_of(const std::map<std::string, Room>& all, const std::string& path) {
    std::string found;
    std::size_t longest = 0;
    for (const auto& [name, room] : all)
        if (path.rfind(room.folder + "/", 0) == 0 && room.folder.size() > longest) {
            found = name;
            longest = room.folder.size();
        }
    return found;
}

/// The room that an include names: from src/, or from the project's root.
std::string room_of_include(const std::map<std::string, Room>& all, const std::string& target) {
    const std::string inside = room_of(all, "src/" + target);
    return inside.empty() ? room_of(all, target) : inside;
}

/// Prefix of an outside header -> the files that may include it.
const std::map<std::string, std::set<std::string>> kDoors{
    {"glm/", {"src/base/math/vec.h"}},
    {"tbb/", {"src/base/util/parallel.cpp"}},
    {"hwy/",
     {"src/base/math/double_lanes-inl.h", "src/projector/kernel", "src/measure/field/patch_batch.cpp",
      "src/measure/common/weighted_sums.cpp", "src/measure/field/pyramid_query.cpp",
      "src/specular/simd_bounds.cpp", "src/specular/sphere_images.cpp", "src/shade/shade_batch.cpp",
      "src/shade/light_batch.cpp", "src/intersect/local_segments.cpp", "src/intersect/part_tree.cpp",
      "src/caustics/cut_pieces.cpp"}},
    {"oneapi/", {}},
    {"opensubdiv/", {"surfaces/"}},
    {"tiny_obj_loader.h", {}},
    {"tiny_gltf.h", {"src/scene/formats/gltf"}},
    {"nlohmann/", {"src/json/json.h", "src/terminal/libraries.h"}},
    {"OpenImageIO/", {"src/pictures/"}},
    {"OpenEXR/", {"src/image/exr_"}},
    {"Imf", {"src/image/exr_"}},
    {"Iex", {"src/image/exr_"}},
    {"isa-l/", {"src/image/zlib_stream.cpp"}},
    {"png.h", {"src/image/png_file.cpp"}},
    {"embree", {"src/intersect/"}},
    {"CLI/", {"src/terminal/parse.cpp"}},
    {"fmt/", {"src/base/util/format.h", "src/terminal/libraries.h"}},
    {"Imath/", {"src/image/"}},
    {"imgui", {"src/view/window/"}},
    {"GLFW/", {"src/view/window/gl_screen.cpp"}},
    {"ceres/", {"src/trilens/ceres.h"}},
    {"BRep", {"src/cad/cad_"}},
    {"Geom", {"src/cad/cad_"}},
    {"IGESControl", {"src/cad/cad_file.cpp"}},
    {"STEPControl", {"src/cad/cad_file.cpp"}},
    {"Standard_", {"src/cad/cad_"}},
    {"TopExp", {"src/cad/cad_"}},
    {"TopoDS", {"src/cad/cad_"}},
};

bool allowed(const std::set<std::string>& doors, const std::string& file) {
    for (const std::string& door : doors)
        if (file.rfind(door, 0) == 0) return true;
    return false;
}

const std::vector<std::string> kFolders{"src", "reflect", "refract", "surfaces"};

}  // namespace

TEST_CASE("every outside library is included through its one door", "[laws][law]") {
    std::map<std::string, std::set<std::string>> doors_used;
    for (const std::string& folder : kFolders) {
        for (const Include& include : includes_under(folder)) {
            for (const auto& [prefix, doors] : kDoors) {
                if (include.target.rfind(prefix, 0) != 0) continue;
                INFO(include.file << " includes " << include.target);
                CHECK(allowed(doors, include.file));
                doors_used[prefix].insert(include.file);
            }
        }
    }
    // The table would be worth nothing if it matched nothing.
    for (const char* used : {"glm/", "tbb/", "hwy/", "opensubdiv/", "nlohmann/", "OpenImageIO/", "OpenEXR/",
                             "Imf", "embree", "CLI/", "tiny_gltf.h", "STEPControl"})
        CHECK_FALSE(doors_used[used].empty());
    // One file each: whoever wants the library asks that file.
    for (const char* single : {"glm/", "tbb/"}) CHECK(doors_used[single].size() == 1);
}

TEST_CASE("no header of ours brings an outside library with it, but for the vocabulary", "[laws][law]") {
    const std::set<std::string> vocabulary{
        "src/base/math/vec.h",
        "src/projector/kernel/simd-inl.h",  // parts of the .cpp files that include them
        "src/base/math/double_lanes-inl.h",
        "src/base/util/format.h",
        "src/json/json.h",
        "src/terminal/libraries.h",
        "src/intersect/embree_device.h"};  // the last is the door's own, for that room's .cpp files
    for (const std::string& folder : kFolders) {
        for (const Include& include : includes_under(folder)) {
            if (include.file.size() < 2 || include.file.substr(include.file.size() - 2) != ".h") continue;
            for (const auto& [prefix, doors] : kDoors) {
                if (include.target.rfind(prefix, 0) != 0) continue;
                // For programs that have Ceres: the one public header that asks for more than trilens.
                if (include.file == "src/trilens/ceres.h" && prefix == "ceres/") continue;
                INFO(include.file << " includes " << include.target);
                CHECK(vocabulary.count(include.file) == 1);
            }
        }
    }
}

TEST_CASE("rooms include only rooms that they may see", "[laws][law]") {
    const std::map<std::string, Room> all = rooms();
    REQUIRE(all.size() >= 14);
    std::size_t checked = 0;
    for (const auto& [name, room] : all) {
        for (const Include& include : includes_under(room.folder)) {
            if (include.angled || room_of(all, include.file) != name) continue;
            INFO(include.file << " includes " << include.target);
            CHECK(room.sees.count(room_of_include(all, include.target)) == 1);
            ++checked;
        }
    }
    CHECK(checked > 100);
}

TEST_CASE("folders of a room include only those below them", "[laws][law]") {
    const std::map<std::string, Room> all = rooms();
    std::size_t checked = 0;
    for (const auto& [name, room] : all) {
        // How high a file of the room stands: its folder's number, or above all of them.
        const auto height = [&, &room = room](const std::string& file) {
            const std::string inside = file.substr(room.folder.size() + 1);
            const std::size_t slash = inside.find('/');
            if (slash == std::string::npos) return room.folders.size();
            const auto found = std::find(room.folders.begin(), room.folders.end(), inside.substr(0, slash));
            INFO(file << " lies in no folder that CMakeLists.txt names");
            CHECK(found != room.folders.end());
            return static_cast<std::size_t>(found - room.folders.begin());
        };
        for (const Include& include : includes_under(room.folder)) {
            if (include.angled || room_of(all, include.file) != name) continue;
            if (room_of_include(all, include.target) != name) continue;
            const bool from_source =
                fs::exists(fs::path(trilens_test::source_dir()) / "src" / include.target);
            INFO(include.file << " includes " << include.target);
            CHECK(height((from_source ? "src/" : "") + include.target) <= height(include.file));
            ++checked;
        }
    }
    CHECK(checked > 100);
}

TEST_CASE("the arrows between rooms have no way back", "[laws][law]") {
    const std::map<std::string, Room> all = rooms();
    for (const auto& [name, room] : all) {
        // Everything reachable from what the room sees; itself must not be among it.
        std::set<std::string> reached;
        std::vector<std::string> open;
        for (const std::string& next : room.sees)
            if (next != name) open.push_back(next);
        while (!open.empty()) {
            const std::string next = open.back();
            open.pop_back();
            if (!reached.insert(next).second) continue;
            for (const std::string& further : all.at(next).sees)
                if (further != next) open.push_back(further);
        }
        INFO(name);
        CHECK(reached.count(name) == 0);
    }
}
