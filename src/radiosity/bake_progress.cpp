#include "radiosity/bake_progress.h"

#include <algorithm>
#include <cmath>

#include "base/util/parallel.h"

namespace trilens {
namespace {

/// Of a stage: from there on its own speed alone says what is left.
constexpr double kMeasuredShare = 0.1;
/// What is left is never taken to be nothing before it is.
constexpr double kMostShare = 0.99;
/// Guesses: elements that a large one becomes more, before light is known; and what a pass of halving adds,
/// in what the one before it has added.
constexpr double kHalvedTo = 2, kPassGrowth = 1.3, kMostGrowth = 1.6;

double as_double(std::size_t count) {
    return static_cast<double>(count);
}

}  // namespace

void BakeProgress::measure(const FormFactors& factors, const BakeSize& size) {
    size_ = size;
    const std::size_t sides = factors.side_count(),
                      count = std::min(sides, 4 * static_cast<std::size_t>(thread_count()));
    if (!whole_.report || count == 0) return;
    const Stopwatch watch;
    parallel_for(count, 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) factors.row(static_cast<Id>(i * sides / count));
    });
    row_ = corner_ = watch.seconds() / as_double(count);
}

/// Each side's row is made once.
double BakeProgress::exchange_seconds() const {
    return 2 * as_double(size_.patches) * row_;
}

/// Nobody knows yet how many parts patches will be halved into: a guess.
double BakeProgress::corner_seconds() const {
    if (size_.patches == 0) return 0;
    const double halved = as_double(size_.patches) + kHalvedTo * as_double(size_.large),
                 elements = std::min(halved, as_double(std::max(size_.patches, size_.most_elements)));
    return elements / as_double(size_.patches) * as_double(size_.corners) * corner_;
}

void BakeProgress::begin_exchange(std::size_t points) {
    // A corner has one view and one point that is lit.
    corner_ = row_ + watch_.seconds() / as_double(std::max<std::size_t>(1, points));
    begin("exchange", exchange_seconds(), corner_seconds());
}

void BakeProgress::begin_corners() {
    const double first = as_double(size_.corners) * corner_;
    begin("light at corners", first, corner_seconds() - first);
}

void BakeProgress::begin_pass(const HalvingPass& pass, std::size_t corners, std::size_t added) {
    if (added > 0) corner_ = watch_.seconds() / as_double(added);
    // An edge takes two passes to be half as long.
    const double passes = std::max(0.0, std::ceil(2 * std::log2(std::max(1.0, pass.length))) - 1);
    const double room = as_double(size_.most_elements) - as_double(pass.after);
    double next = as_double(pass.after) - as_double(pass.before), sum = 0;
    const double growth = added_ > 0 ? std::clamp(next / added_, 1.0, kMostGrowth) : kPassGrowth;
    added_ = next;
    for (double one = 0; one < passes && sum + next * growth <= room; ++one) sum += next *= growth;
    const double per_element = as_double(corners) / as_double(pass.before) * corner_;
    begin("light at corners", added_ * per_element, sum * per_element);
}

void BakeProgress::begin(const std::string& name, double expected, double later) {
    whole_.stop_if_cancelled();
    expected_ = expected, later_ = later;
    watch_ = {};
    name_ = name;
    whole_.begin_stage(name);
    report(0);
}

Progress BakeProgress::stage() {
    Progress progress;
    progress.cancel = whole_.cancel;
    if (whole_.report) progress.report = [this](double share) { report(share); };
    progress.stage = [this](const std::string& what, double) {
        whole_.begin_stage(what.empty() ? name_ : what);
    };
    return progress;
}

void BakeProgress::report(double share) {
    const double weight = std::min(1.0, share / kMeasuredShare),
                 measured = share > 0 ? watch_.seconds() / share : 0;
    const double left = (1 - share) * ((1 - weight) * expected_ + weight * measured) + later_;
    const double over = all_.seconds();
    if (over + left > 0) told_ = std::max(told_, std::min(kMostShare, over / (over + left)));
    whole_(told_);
}

}  // namespace trilens
