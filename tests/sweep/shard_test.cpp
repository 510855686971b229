// --shard: what is meant is read, all else is refused; shards cover the plan.
#include "sweep/plan/plan.h"

#include <map>
#include <string>
#include <vector>

#include "base/util/error.h"
#include "support/test.h"

using namespace trilens;

namespace {

Environment environment_of(const std::map<std::string, std::string>& variables) {
    return [variables](const char* name) {
        const auto found = variables.find(name);
        return found == variables.end() ? nullptr : found->second.c_str();
    };
}

}  // namespace

TEST_CASE("sweep: shards cover every job exactly once", "[sweep][law]") {
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

TEST_CASE("sweep: shards from a job array's variables", "[sweep]") {
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
