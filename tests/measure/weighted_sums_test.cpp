// The sums of lanes against plain ones.
#include "measure/common/weighted_sums.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "support/test.h"

using namespace trilens;

TEST_CASE("weighted sums are the plain ones, to the last bit", "[measure][law]") {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> share(-1, 1);
    const auto value = [&] {
        const unsigned kind = random() % 40;
        if (kind == 0) return std::numeric_limits<double>::infinity();
        if (kind == 1) return -0.0;
        return share(random) * (kind == 2 ? 1e300 : kind == 3 ? 1e-310 : 1);
    };
    for (std::size_t count = 0; count < 140; ++count) {
        const std::size_t taps = count % 5 == 0 ? 1 : 1 + random() % 24;
        std::vector<double> weights(taps), sums(count, 7), plain(count);
        std::vector<std::vector<double>> values(taps, std::vector<double>(count));
        std::vector<const double*> rows;
        for (std::size_t k = 0; k < taps; ++k) {
            weights[k] = share(random);
            for (double& one : values[k]) one = value();
            rows.push_back(values[k].data());
        }
        for (std::size_t i = 0; i < count; ++i) {
            volatile double sum = 0;
            for (std::size_t k = 0; k < taps; ++k) sum = sum + weights[k] * rows[k][i];
            plain[i] = sum;
        }
        weighted_sums(weights, rows, sums);
        for (std::size_t i = 0; i < count; ++i)
            CHECK((std::memcmp(&sums[i], &plain[i], sizeof plain[i]) == 0 ||
                   (std::isnan(sums[i]) && std::isnan(plain[i]))));
    }
}
