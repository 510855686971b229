// Every seed of the fuzzers, and what once broke, through its target: any compiler's test of what fuzzers
// found.
#include <filesystem>
#include <fstream>
#include <iterator>

#include "fuzz/target.h"
#include "support/test.h"

using namespace trilens_fuzz;
namespace fs = std::filesystem;

namespace {

std::string bytes_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
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

TEST_CASE("what strangers wrote is read or refused, never more", "[fuzz][bad-input][law]") {
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
