// Byte order marks before scene files, OBJ and glTF files: that of UTF-8 is no text, others are refused.
#include <fstream>

#include "json/json.h"
#include "scene/formats/gltf.h"
#include "scene/formats/obj.h"
#include "scene_text.h"

using namespace trilens;
using namespace trilens_test;

namespace {

const std::string kTextMark = "\xEF\xBB\xBF";
const std::string kRefused = "is UTF-16 or UTF-32 text: save it as UTF-8";
const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// ASCII as UTF-16 with its mark.
std::string utf16(const std::string& text, bool big) {
    std::string wide = big ? "\xFE\xFF" : "\xFF\xFE";
    for (const char letter : text) wide += big ? std::string{'\0', letter} : std::string{letter, '\0'};
    return wide;
}

template <class Read>
std::string refusal(Read&& read) {
    try {
        read();
        return "";
    } catch (const InputError& error) {
        return error.what();
    }
}

}  // namespace

TEST_CASE("only a mark at the very start is taken off", "[scene]") {
    CHECK(utf8_text(kTextMark + "a" + kTextMark, "f") == "a" + kTextMark);
    CHECK(utf8_text(kTextMark, "f").empty());
    CHECK(utf8_text("", "f").empty());
    CHECK(utf8_text("\xEF\xBB", "f") == "\xEF\xBB");
    for (const std::string& mark : {std::string("\xFF\xFE"), std::string("\xFE\xFF"),
                                    std::string("\xFF\xFE\0\0", 4), std::string("\0\0\xFE\xFF", 4)})
        CHECK(refusal([&] { utf8_text(mark + "a", "f"); }) == "f: " + kRefused);
}

TEST_CASE("an OBJ keeps its first vertex behind a byte order mark", "[scene]") {
    const ObjFile plain = parse_obj(kTriangle, "a.obj"), marked = parse_obj(kTextMark + kTriangle, "a.obj");
    CHECK(marked.mesh.cage.points == plain.mesh.cage.points);
    CHECK(marked.mesh.cage.face_vertex_indices == plain.mesh.cage.face_vertex_indices);
    CHECK(refusal([] { parse_obj(kTextMark + "v 0 0 x\n", "a.obj"); }) == "a.obj: line 1: 'x' is no number");
    for (const bool big : {false, true})
        CHECK(refusal([&] { parse_obj(utf16(kTriangle, big), "a.obj"); }) == "a.obj: " + kRefused);
}

TEST_CASE("a scene file loads behind a byte order mark, and its errors keep their columns", "[scene]") {
    CHECK(load_text(kTextMark + kRoom).resolved == load_text(kRoom).resolved);
    CHECK(error_of(kTextMark + "{,}") == error_of("{,}"));
    CHECK(error_of(kTextMark) == "room.json: is empty");
    for (const bool big : {false, true}) CHECK(error_of(utf16(kRoom, big)) == "room.json: " + kRefused);
}

TEST_CASE("a glTF file loads behind a byte order mark", "[scene]") {
    const std::string folder = scratch_dir("scene_marks"), file = folder + "/a.gltf";
    const std::string text = R"({"asset":{"version":"2.0"},"nodes":[],"scenes":[{"nodes":[]}]})";
    std::ofstream(file) << kTextMark + text;
    CHECK(read_gltf(file).nodes.empty());
    for (const bool big : {false, true}) {
        std::ofstream(file, std::ios::binary) << utf16(text, big);
        CHECK(refusal([&] { read_gltf(file); }) == file + ": " + kRefused);
    }
}
