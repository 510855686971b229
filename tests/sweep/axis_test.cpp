// --over and --shard: what is meant is read, all else is refused with its reason.
#include "sweep/axis.h"

#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "support/test.h"

using namespace trilens;

TEST_CASE("sweep: axes") {
    using Values = std::vector<int>;
    CHECK(parse_axis("resolution=1,2,4,8").name == "resolution");
    CHECK(parse_axis("resolution=1,2,4,8").values == Values{1, 2, 4, 8});
    CHECK(parse_axis("resolution=8,1,4").values == Values{1, 4, 8});
    CHECK(parse_axis("resolution=7").values == Values{7});
    CHECK(parse_axis("resolution=1..64:x2").values == Values{1, 2, 4, 8, 16, 32, 64});
    CHECK(parse_axis("resolution=3..50:x3").values == Values{3, 9, 27});
    CHECK(parse_axis("resolution=8..32:+8").values == Values{8, 16, 24, 32});
    CHECK(parse_axis("resolution=8..31:+8").values == Values{8, 16, 24});
    CHECK(parse_axis("resolution=5..5:x2").values == Values{5});
    CHECK(parse_axis("resolution=1,2,4..16:+4,100").values == Values{1, 2, 4, 8, 12, 16, 100});
    CHECK(parse_axis("resolution=1..1024:x1024").values == Values{1, 1024});
    CHECK(parse_axis("resolution=1..1000:+1").values.size() == 1000);
}

TEST_CASE("sweep: axes that make no sense are refused, and the text is quoted") {
    const std::vector<std::string> bad = {"",
                                          "resolution",
                                          "resolution=",
                                          "resolution=,",
                                          "resolution=1,",
                                          "resolution=1,,2",
                                          "resolution=1;2",
                                          "resolution=one",
                                          "resolution=1.5",
                                          "resolution= 1",
                                          "resolution=0",
                                          "resolution=-4",
                                          "resolution=1025",
                                          "resolution=99999999999",
                                          "resolution=1,2,1",
                                          "resolution=1..8",
                                          "resolution=1..8:",
                                          "resolution=1..8:x",
                                          "resolution=1..8:2",
                                          "resolution=1..8:x1",
                                          "resolution=1..8:x0",
                                          "resolution=1..8:+0",
                                          "resolution=1..8:-1",
                                          "resolution=8..1:x2",
                                          "resolution=..8:x2",
                                          "resolution=1..:x2",
                                          "resolution=1...8:x2",
                                          "resolution=1..8:x2:x2",
                                          "resolution=1..1025:+1",
                                          "resolution=1..65536:+1",
                                          "spp=1,2",
                                          "=1"};
    for (const std::string& text : bad) {
        INFO(text);
        REQUIRE_THROWS_AS(parse_axis(text), UsageError);
        try {
            parse_axis(text);
        } catch (const UsageError& error) {
            CHECK(std::string(error.what()).find("--over " + text) == 0);
            CHECK(error.code() == ExitCode::kUsage);
        }
    }
}

namespace {

Environment environment_of(const std::map<std::string, std::string>& variables) {
    return [variables](const char* name) {
        const auto found = variables.find(name);
        return found == variables.end() ? nullptr : found->second.c_str();
    };
}

}  // namespace

TEST_CASE("sweep: shards cover every job exactly once") {
    const Environment none = environment_of({});
    for (const int count : {1, 2, 3, 7}) {
        std::vector<int> owners(20, 0);
        for (int i = 0; i < count; ++i) {
            const Shard shard = parse_shard(std::to_string(i) + "/" + std::to_string(count), none);
            for (std::size_t job = 0; job < owners.size(); ++job) owners[job] += shard.has(job);
        }
        CHECK(owners == std::vector<int>(20, 1));
    }
    for (const char* bad : {"", "1", "/", "1/", "/2", "2/2", "-1/2", "0/0", "a/b", "0/2x"})
        CHECK_THROWS_AS(parse_shard(bad, none), UsageError);
}

TEST_CASE("sweep: shards from a job array's variables") {
    const auto read = [](const std::map<std::string, std::string>& variables) {
        const Shard shard = parse_shard("auto", environment_of(variables));
        return std::vector<int>{shard.index, shard.count};
    };
    using Pair = std::vector<int>;
    CHECK(read({{"SLURM_ARRAY_TASK_ID", "3"},
                {"SLURM_ARRAY_TASK_MIN", "1"},
                {"SLURM_ARRAY_TASK_COUNT", "8"}}) == Pair{2, 8});
    CHECK(read({{"SLURM_ARRAY_TASK_ID", "6"},
                {"SLURM_ARRAY_TASK_MIN", "0"},
                {"SLURM_ARRAY_TASK_STEP", "2"},
                {"SLURM_ARRAY_TASK_COUNT", "4"}}) == Pair{3, 4});
    CHECK(read({{"SGE_TASK_ID", "4"},
                {"SGE_TASK_FIRST", "1"},
                {"SGE_TASK_LAST", "4"},
                {"SGE_TASK_STEPSIZE", "1"}}) == Pair{3, 4});
    CHECK(read({{"SGE_TASK_ID", "undefined"}, {"LSB_JOBINDEX", "1"}, {"LSB_JOBINDEX_END", "5"}}) ==
          Pair{0, 5});
    CHECK(read({{"GTEST_SHARD_INDEX", "1"}, {"GTEST_TOTAL_SHARDS", "2"}}) == Pair{1, 2});
    CHECK_THROWS_AS(read({}), UsageError);
    CHECK_THROWS_AS(read({{"SLURM_ARRAY_TASK_ID", "9"}, {"SLURM_ARRAY_TASK_COUNT", "8"}}), UsageError);
    CHECK_THROWS_AS(read({{"LSB_JOBINDEX", "0"}, {"LSB_JOBINDEX_END", "0"}}), UsageError);
}
