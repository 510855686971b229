// Work on threads of its own, also where the system gives fewer than are asked for.
#include "base/util/parallel.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cstddef>
#include <cstdio>

#include "support/test.h"

using namespace trilens;

namespace {

std::size_t address_space() {
    std::size_t pages = 0;
    std::FILE* const file = std::fopen("/proc/self/statm", "r");
    REQUIRE(file != nullptr);
    const int read = std::fscanf(file, "%zu", &pages);
    std::fclose(file);
    REQUIRE(read == 1);
    return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace

TEST_CASE("threads: as many as asked for do the work at once, and all have ended after it", "[base]") {
    std::atomic<int> begun = 0, ended = 0;
    run_on_threads(4, [&] {
        ++begun;
        while (begun < 4) {
        }
        ++ended;
    });
    CHECK(ended == 4);
    std::atomic<int> calls = 0;
    run_on_threads(0, [&] { ++calls; });
    run_on_threads(1, [&] { ++calls; });
    CHECK(calls == 2);
}

TEST_CASE("threads: where the system gives fewer, those that there are do all of it", "[base]") {
    const std::size_t room = address_space() + 200'000'000;  // for some stacks of 8 MB and not for 300
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        const rlimit limit{room, room};
        if (setrlimit(RLIMIT_AS, &limit) != 0) _exit(3);
        std::atomic<int> next = 0, done = 0, threads = 0;
        run_on_threads(300, [&] {
            ++threads;
            while (next++ < 1000) {
                ++done;
                usleep(100);
            }
        });
        _exit(done == 1000 && threads >= 1 && threads < 300 ? 0 : 4);
    }
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    REQUIRE(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 0);
}
