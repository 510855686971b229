// How far a bake is, as the share of its time that is over: what is left is predicted from counts of work and
// from the speed that was measured.
#pragma once

#include <cstddef>
#include <string>

#include "base/util/error.h"
#include "radiosity/form_factors.h"

namespace trilens {

/// How much there is to do, as far as that is known ahead.
struct BakeSize {
    std::size_t patches = 0;
    std::size_t corners = 0;        // of patches
    std::size_t large = 0;          // patches that may be halved
    std::size_t most_elements = 0;  // that halving may come to
};

/// A pass of halving.
struct HalvingPass {
    std::size_t before = 0, after = 0;  // elements
    double length = 1;                  // the longest edge that is halved, in smallest ones
};

/// Stages follow one another; each says how far it is by itself. The share that is told never falls, and
/// reaches 1 where finish() is called. Where work is predicted it is so from measured times: they change what
/// is told alone.
class BakeProgress {
  public:
    /// `whole` must live longer.
    explicit BakeProgress(const Progress& whole) : whole_(whole) {}

    /// Makes some rows, which nobody needs, to know how long one takes.
    void measure(const FormFactors& factors, const BakeSize& size);

    void begin_shadows() { begin("shadows", 0, exchange_seconds() + corner_seconds()); }
    void begin_patches() { begin("light on patches", 0, exchange_seconds() + corner_seconds()); }
    /// After so many points were lit.
    void begin_exchange(std::size_t points);
    /// Where all rows are known.
    void begin_gathering() { begin("exchange", 0, corner_seconds()); }
    void begin_corners();
    /// After so many corners were lit, of which the last pass had `added`.
    void begin_pass(const HalvingPass& pass, std::size_t corners, std::size_t added);
    void begin_check() { begin("check", 0, 0); }

    /// Of the stage that runs: told its share of work that is done, it tells the share of the whole.
    Progress stage();
    void finish() const { whole_(1); }

  private:
    /// `expected`: seconds that this stage may take; `later`: that those behind it may.
    void begin(const std::string& name, double expected, double later);
    void report(double share);
    double exchange_seconds() const;
    double corner_seconds() const;

    const Progress& whole_;
    Stopwatch all_, watch_;
    std::string name_;
    BakeSize size_;
    double row_ = 0, corner_ = 0;  // seconds that one takes, on all threads
    double added_ = 0;             // elements, by the last pass of halving
    double expected_ = 0, later_ = 0;
    double told_ = 0;
};

}  // namespace trilens
