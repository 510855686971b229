// Every seed of the fuzzers, and what once broke, through its target: any compiler's test of what fuzzers
// found.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "fuzz/havoc.h"
#include "fuzz/target.h"
#include "support/test.h"

using namespace trilens_fuzz;
namespace fs = std::filesystem;

namespace {

std::string bytes_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// A seed that must be refused, and a part of what is said of it.
struct Refused {
    std::string target, name, reason;
};

const std::vector<Refused>& refused_seeds() {
    static const std::vector<Refused> seeds{
        {"gltf", "refused-buffer-missing.gltf", "/buffers/0/uri: the buffer 'none.bin' cannot be read"},
        {"gltf", "refused-buffer-too-short.gltf",
         "/buffers/0/byteLength: is 96, but the buffer holds 92 bytes"},
        {"gltf", "refused-cyclic-nodes.gltf", "/nodes/0: is its own ancestor"},
        {"gltf", "refused-nan-in-animation.gltf", "/accessors/3: entry 1 holds a number that is not finite"},
        {"gltf", "refused-nan-in-times.gltf", "/accessors/2: entry 1 holds a number that is not finite"},
        {"gltf", "refused-not-base64.gltf", "/buffers/0/uri: a data URI without ';base64,' is not read"},
        {"gltf", "refused-two-parents.gltf", "/nodes/1: is a child of node 0 and of node 3"},
        {"gltf", "refused-unknown-extension.gltf", "the extension 'EXT_of_tomorrow' is required"},
        {"gltf", "refused-view-beyond-buffer.gltf",
         "/accessors/3: its buffer view reaches beyond its buffer"},
        {"scene", "refused-disk-of-no-area", "/lights/0/radius: 0 is out of range"},
        {"scene", "refused-rectangle-of-no-area", "/lights/0/size/1: 0 is out of range"},
        {"scene", "refused-sphere-of-no-area", "/lights/0/radius: 0 is out of range"},
        {"scene", "refused-tiny-rectangle-of-no-area", "/lights/0/size: has no area"}};
    return seeds;
}

struct Counts {
    int taken = 0, refused = 0;
};

/// Files of the folder, and each cut off and changed in a few places.
Counts replay(const FuzzTarget& target, const fs::path& folder) {
    Counts counts;
    const auto run = [&](const std::string& name, const std::string& bytes) {
        INFO(target.name << ": " << name);
        Answer answer = Answer::kRefused;
        REQUIRE_NOTHROW(answer = target.run(bytes));
        ++(answer == Answer::kTaken ? counts.taken : counts.refused);
    };
    for (const auto& entry : fs::directory_iterator(folder)) {
        const std::string bytes = bytes_of(entry.path()), name = entry.path().filename().string();
        run(name, bytes);
        if (target.makes) continue;
        for (std::size_t k = 1; k < 8; ++k) {
            const std::size_t at = k * bytes.size() / 8;
            run(name + " cut", bytes.substr(0, at));
            std::string changed = bytes;
            if (!changed.empty()) changed[at % changed.size()] ^= static_cast<char>(1u << k);
            run(name + " changed", changed);
        }
    }
    return counts;
}

}  // namespace

TEST_CASE("what strangers wrote is read or refused, never more", "[fuzz][bad-input][law][thorough]") {
    for (const FuzzTarget& target : fuzz_targets()) {
        const fs::path folder = fs::path(trilens_test::source_dir()) / "fuzz/seeds" / target.name;
        INFO(folder);
        REQUIRE(fs::is_directory(folder));
        const Counts counts = replay(target, folder);
        INFO(target.name << ": " << counts.taken << " taken, " << counts.refused << " refused");
        CHECK(counts.taken > 0);
        CHECK((target.makes || counts.refused > 0));
    }
}

TEST_CASE("seeds that are to be refused are refused for what is wrong with them, the others are taken",
          "[fuzz][bad-input]") {
    std::size_t met = 0;
    for (const FuzzTarget& target : fuzz_targets())
        for (const auto& entry :
             fs::directory_iterator(fs::path(trilens_test::source_dir()) / "fuzz/seeds" / target.name)) {
            const std::string name = entry.path().filename().string();
            if (target.makes || name.starts_with("found-")) continue;
            INFO(target.name << ": " << name);
            const Answer answer = target.run(bytes_of(entry.path()));
            if (!name.starts_with("refused-")) {
                CHECK(answer == Answer::kTaken);
                continue;
            }
            ++met;
            REQUIRE(answer == Answer::kRefused);
            const auto of_seed = [&](const Refused& one) {
                return one.target == target.name && one.name == name;
            };
            const auto seed = std::find_if(refused_seeds().begin(), refused_seeds().end(), of_seed);
            REQUIRE(seed != refused_seeds().end());
            INFO(last_refusal());
            CHECK(last_refusal().find(seed->reason) != std::string::npos);
        }
    CHECK(met == refused_seeds().size());
}

TEST_CASE("a file changed at random is the same for the same seed, and nearly always another", "[fuzz]") {
    const std::vector<std::string> files{bytes_of(fs::path(trilens_test::source_dir()) / "scenes/sphere.json"),
                                         "v 0 0 0\nf 1 2 3\n", ""};
    std::set<std::string> met;
    for (std::uint64_t seed = 0; seed < 1000; ++seed) {
        const std::string one = changed_file(files, seed);
        CHECK(one == changed_file(files, seed));
        CHECK(one.size() <= kLongestChanged);
        met.insert(one);
    }
    CHECK(met.size() > 700);
    // What is longer to begin with stays, but for its end.
    const std::vector<std::string> longer{std::string(3 * kLongestChanged, 'x')};
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const std::string one = changed_file(longer, seed);
        CHECK(one.size() <= longer[0].size());
        CHECK(one.size() > 2 * kLongestChanged);
    }
}
