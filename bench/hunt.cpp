// The hunt for what vanishes, over many seeds: bench_hunt FIRST COUNT [--json]; one line for each scene that
// shows less than the truth, and a sum. With --json SEED's scene alone is printed, as trilens render takes
// it.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>

#include "laws/hunt.h"

int main(int count, char** arguments) {
    using namespace trilens_test;
    if (count < 3) {
        std::fprintf(stderr, "bench_hunt FIRST COUNT [--json]\n");
        return 2;
    }
    const auto first = static_cast<std::uint64_t>(std::atoll(arguments[1]));
    const auto scenes = static_cast<std::uint64_t>(std::atoll(arguments[2]));
    if (count > 3 && std::strcmp(arguments[3], "--json") == 0) {
        std::printf("%s\n", make_quarry(first).json.c_str());
        return 0;
    }
    std::size_t missing = 0, tiny = 0, bad = 0, other = 0, with_error = 0, failed = 0;
    double seconds = 0, truth = 0;
    for (std::uint64_t seed = first; seed < first + scenes; ++seed) {
        const Quarry quarry = make_quarry(seed);
        try {
            const Bag bag = hunt(quarry);
            missing += bag.missing.size();
            tiny += bag.tiny;
            seconds += bag.seconds;
            truth += bag.truth_seconds;
            const bool judged = quarry.frame.max_error.has_value();
            with_error += judged;
            if (judged) other += bag.other;
            bad += judged && bag.other > 0;
            if (bag.missing.empty() && !(judged && bag.other > 0)) continue;
            std::printf("seed %llu: other %zu, traced %zu, divided %zu, missing %zu",
                        static_cast<unsigned long long>(seed), bag.other, bag.traced, bag.divided,
                        bag.missing.size());
            for (const std::string& one : bag.missing) std::printf(" [%s]", one.c_str());
            std::printf("; %s\n", quarry.what.c_str());
        } catch (const std::exception& error) {
            ++failed;
            std::printf("seed %llu: %s; %s\n", static_cast<unsigned long long>(seed), error.what(),
                        quarry.what.c_str());
        }
        std::fflush(stdout);
    }
    std::printf(
        "%llu scenes: %zu optics missing, %zu of under %zu pixels, %zu failed; of %zu with an error %zu have "
        "%zu pixels of "
        "another path; %.1f s projected, %.1f s traced\n",
        static_cast<unsigned long long>(scenes), missing, tiny, kFew, failed, with_error, bad, other, seconds,
        truth);
    return missing > 0 || failed > 0;
}
