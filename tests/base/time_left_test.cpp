// How long work says how far it is: until it is told to stop, and the time that is left of it.
#include <atomic>
#include <cmath>
#include <random>
#include <vector>

#include "base/util/error.h"
#include "support/test.h"

using namespace trilens;

TEST_CASE("the time left is right within a factor of two, however long what is done once took",
          "[base][progress][law]") {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> share(0, 1);
    for (int round = 0; round < 500; ++round) {
        // Work that repeats, at a speed that varies by a factor of 1.5, behind something done once.
        const int steps = 3 + static_cast<int>(random() % 60);
        const double once = std::pow(10, 3 * share(random)), each = std::pow(10, 2 * share(random) - 2);
        std::vector<double> time{once};
        for (int step = 1; step < steps; ++step)
            time.push_back(time.back() + each * (0.8 + 0.4 * share(random)));
        TimeLeft left;
        CHECK_FALSE(left.at(0, 0).has_value());
        for (int step = 1; step <= steps; ++step) {
            const double now = time[static_cast<std::size_t>(step - 1)];
            const auto told = left.at(static_cast<double>(step) / steps, now);
            if (step == 1) {
                CHECK_FALSE(told.has_value());
                continue;
            }
            REQUIRE(told.has_value());
            const double truth = time.back() - now;
            INFO("step " << step << " of " << steps << ": " << *told << " s for " << truth);
            CHECK(*told <= 2 * truth + 1e-12);
            CHECK(*told >= truth / 2 - 1e-12);
        }
    }
    // The same share told twice gives no speed; a job that is done has no time left.
    TimeLeft left;
    CHECK_FALSE(left.at(0.5, 1).has_value());
    CHECK_FALSE(left.at(0.5, 9).has_value());
    CHECK(left.at(0.75, 11).value() == Approx(10));
    CHECK(left.at(1, 12).value() == 0);
}

TEST_CASE("work that was told to stop reports no more", "[base][progress]") {
    std::atomic<bool> stop = false;
    std::vector<double> said;
    const Progress progress{[&](double done) {
                                said.push_back(done);
                                stop = done >= 0.5;
                            },
                            &stop};
    for (const double done : {0.25, 0.5, 0.75, 1.0}) progress(done);
    CHECK(said == std::vector{0.25, 0.5});
    CHECK(progress.cancelled());
}
