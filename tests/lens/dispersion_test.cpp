// Dispersion formulas against the data sheets' indices.
#include <cmath>

#include "base/util/error.h"
#include "lens/dispersion.h"
#include "support/test.h"

using namespace trilens;

namespace {

// Schott's data sheet of N-BK7, and of fused silica (Malitson 1965), terms whose wavelengths are squared.
constexpr SellmeierTerms kBk7{1.03961212, 0.00600069867, 0.231792344, 0.0200179144, 1.01046945, 103.560653};
constexpr SellmeierTerms kSilica{0.6961663, 0.0684043 * 0.0684043, 0.4079426, 0.1162414 * 0.1162414,
                                 0.8974794, 9.896161 * 9.896161};

}  // namespace

TEST_CASE("Sellmeier's terms give the indices of the data sheets at d, C and F", "[lens][oracle]") {
    const Glass crown = sellmeier_glass("N-BK7", kBk7, "", "");
    CHECK(std::fabs(crown.index - 1.51680) < 5e-6);
    CHECK(std::fabs(index_at(crown, SpectralLine::kC) - 1.51432) < 5e-6);
    CHECK(std::fabs(index_at(crown, SpectralLine::kF) - 1.52238) < 5e-6);
    CHECK(std::fabs(crown.abbe - 64.17) < 0.005);
    const Glass silica = sellmeier_glass("silica", kSilica, "", "");
    CHECK(std::fabs(silica.index - 1.45846) < 5e-6);
    CHECK(std::fabs(index_at(silica, SpectralLine::kC) - 1.45637) < 5e-6);
    CHECK(std::fabs(index_at(silica, SpectralLine::kF) - 1.46313) < 5e-6);
    CHECK(std::fabs(silica.abbe - 67.82) < 0.01);
}

TEST_CASE("an index and an Abbe number give C and F nearly as the data sheets", "[lens][oracle]") {
    struct Sheet {
        double d, abbe, c, f, within;
    };
    // N-BK7, K7, N-LAK9, F2, SF2, SF11: by the terms of their sheets.
    for (const Sheet& sheet :
         {Sheet{1.51680, 64.17, 1.51432, 1.52238, 2e-5}, Sheet{1.51112, 60.41, 1.50854, 1.51700, 1e-5},
          Sheet{1.69100, 54.71, 1.68716, 1.69979, 5e-5}, Sheet{1.62004, 36.37, 1.61503, 1.63208, 1e-5},
          Sheet{1.64769, 33.85, 1.64210, 1.66123, 2e-5}, Sheet{1.78472, 25.68, 1.77596, 1.80651, 1e-4}}) {
        Glass glass;
        glass.index = sheet.d, glass.abbe = sheet.abbe;
        const double c = index_at(glass, SpectralLine::kC), f = index_at(glass, SpectralLine::kF);
        INFO("n_d " << sheet.d);
        CHECK(std::fabs(c - sheet.c) < sheet.within);
        CHECK(std::fabs(f - sheet.f) < sheet.within);
        CHECK(f - c == Approx((sheet.d - 1) / sheet.abbe).epsilon(1e-12));
    }
}

TEST_CASE("Schott's older formula gives BK7 as its catalogue of 1980 has it", "[lens][oracle]") {
    const Glass crown = schott_glass(
        "BK7", {2.2718929, -1.0108077e-2, 1.0592509e-2, 2.0816965e-4, -7.6472538e-6, 4.9240991e-7}, "", "");
    CHECK(std::fabs(crown.index - 1.51680) < 1e-5);
    CHECK(std::fabs(crown.abbe - 64.17) < 0.02);
}

TEST_CASE("formulas without an index, or that rise to red, are refused", "[lens][bad-input]") {
    const auto message_of = [](const SellmeierTerms& terms) {
        try {
            sellmeier_glass("X", terms, "a.agf", "line 3");
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    CHECK(message_of({-3, 0, 0, 0, 0, 0}) ==
          "a.agf: line 3: the glass X has no index from 1 to 10 at a visible line");
    CHECK(message_of({1, 0.4, 0, 0, 0, 0}).starts_with("a.agf: line 3: the "));
    CHECK(message_of({1, -1, 0, 0, 0, 0}) ==
          "a.agf: line 3: the index of the glass X does not fall from blue to red");
    CHECK(message_of({1.25, 0, 0, 0, 0, 0}).empty());
    CHECK(sellmeier_glass("flat", {1.25, 0, 0, 0, 0, 0}, "", "").abbe == 0);
}
