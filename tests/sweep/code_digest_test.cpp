// Another engine gives another digest; the same engine, wherever it lies, the same.
#include "sweep/store/machine.h"

#include <algorithm>
#include <string>
#include <vector>

#include "base/description/digest.h"
#include "base/files/files.h"
#include "base/util/error.h"
#include "support/test.h"

using namespace trilens;

TEST_CASE("sweep: this program's own code is among what is loaded, with its build id as the file has it",
          "[sweep]") {
    const std::string digest = code_digest();
    const std::vector<LoadedCode> code = loaded_code();
    const auto is_ours = [](const LoadedCode& one) { return one.is_ours; };
    REQUIRE(std::count_if(code.begin(), code.end(), is_ours) == 1);
    const LoadedCode ours = *std::find_if(code.begin(), code.end(), is_ours);
    const std::string bytes = read_whole_file(ours.file).value();
    // The note in the file: name and type, then the id itself.
    std::string id;
    for (std::size_t i = 0; i + 1 < ours.build_id.size(); i += 2)
        id += static_cast<char>(std::stoi(ours.build_id.substr(i, 2), nullptr, 16));
    CHECK((ours.build_id.empty() || bytes.find(std::string("GNU\0", 4) + id) != std::string::npos));
    CHECK(digest == digest_of_code(code));
    CHECK(code_digest() == digest);
    CHECK(code_digest().size() == 16);
}

TEST_CASE("sweep: the digest follows the build ids of the engine and its libraries, and nothing else",
          "[sweep]") {
    const std::vector<LoadedCode> code = {{"/proc/self/exe", "a1", true},
                                          {"/usr/lib/libembree3.so.3", "b2", false},
                                          {"/usr/lib/libosdCPU.so.3", "c3", false},
                                          {"/usr/lib/libtrilens_pictures-0.2.so", "f6", false},
                                          {"/usr/lib/libcurl.so.4", "d4", false}};
    const std::string digest = digest_of_code(code);
    for (std::size_t i = 0; i < code.size(); ++i) {
        std::vector<LoadedCode> other = code;
        other[i].build_id = "e5";
        INFO(code[i].file);
        CHECK((digest_of_code(other) == digest) == (i >= 3));
        other = code;
        other[i].file = "/opt/" + code[i].file.substr(code[i].file.rfind('/') + 1);
        CHECK(digest_of_code(other) == digest);
    }
    std::vector<LoadedCode> turned(code.rbegin(), code.rend());
    CHECK(digest_of_code(turned) == digest);
}

TEST_CASE("sweep: code without a build id is known by its bytes", "[sweep]") {
    const std::string folder = trilens_test::scratch_dir("code_digest");
    replace_text_file(folder + "/one", "machine code");
    replace_text_file(folder + "/copy", "machine code");
    replace_text_file(folder + "/other", "machine c0de");
    const auto digest = [&](const std::string& name) {
        return digest_of_code({{folder + "/" + name, "", true}});
    };
    CHECK(digest("one") == digest("copy"));
    CHECK(digest("one") != digest("other"));
    CHECK_THROWS_AS(digest("none"), InputError);
}
