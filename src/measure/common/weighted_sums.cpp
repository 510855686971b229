#include "measure/common/weighted_sums.h"

#include "base/util/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "measure/common/weighted_sums.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace trilens::sums {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Sums and products one by one, never fused, so that every instruction set rounds alike.

void weighted_sums_here(std::span<const double> weights, const double* const* rows, std::span<double> sums) {
    constexpr hn::ScalableTag<double> kTag;
    const std::size_t lanes = hn::Lanes(kTag);
    std::size_t i = 0;
    // A few sums at a time stay in registers.
    for (; i + 4 * lanes <= sums.size(); i += 4 * lanes) {
        auto a = hn::Zero(kTag), b = a, c = a, d = a;
        for (std::size_t k = 0; k < weights.size(); ++k) {
            const auto weight = hn::Set(kTag, weights[k]);
            const double* const from = rows[k] + i;
            a = hn::Add(a, hn::Mul(weight, hn::LoadU(kTag, from)));
            b = hn::Add(b, hn::Mul(weight, hn::LoadU(kTag, from + lanes)));
            c = hn::Add(c, hn::Mul(weight, hn::LoadU(kTag, from + 2 * lanes)));
            d = hn::Add(d, hn::Mul(weight, hn::LoadU(kTag, from + 3 * lanes)));
        }
        hn::StoreU(a, kTag, &sums[i]);
        hn::StoreU(b, kTag, &sums[i + lanes]);
        hn::StoreU(c, kTag, &sums[i + 2 * lanes]);
        hn::StoreU(d, kTag, &sums[i + 3 * lanes]);
    }
    for (; i < sums.size(); ++i) {
        double sum = 0;
        for (std::size_t k = 0; k < weights.size(); ++k) sum += weights[k] * rows[k][i];
        sums[i] = sum;
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens::sums
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace trilens {
namespace sums {
HWY_EXPORT(weighted_sums_here);
}

void weighted_sums(std::span<const double> weights, std::span<const double* const> rows,
                   std::span<double> sums) {
    using namespace sums;
    TRILENS_CHECK(rows.size() == weights.size(), "one row for each weight");
    HWY_DYNAMIC_DISPATCH(weighted_sums_here)(weights, rows.data(), sums);
}

}  // namespace trilens
#endif
