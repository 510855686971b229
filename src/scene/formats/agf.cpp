// Reads glass catalogues of Zemax: a line NM for each glass, its coefficients in a line CD, and the
// wavelengths for which they are meant in a line LD.
#include <algorithm>
#include <array>
#include <optional>

#include "base/util/format.h"
#include "lens/dispersion.h"
#include "scene/formats/lens_file.h"
#include "scene/formats/lens_lines.h"
#include "scene/formats/utf16.h"

namespace trilens {
namespace {

enum class Formula { kSchott = 1, kSellmeier = 2 };

class CatalogueReader : LensLines {
  public:
    CatalogueReader(const std::string& text, const std::string& file) : LensLines(file, {}), text_(text) {}

    std::vector<Glass> read() {
        for (std::size_t at = 0; at < text_.size();) {
            const std::size_t end = std::min(text_.find('\n', at), text_.size());
            ++line_;
            take(split_words(std::string_view(text_).substr(at, end - at)));
            at = end + 1;
        }
        if (glasses_.empty())
            throw InputError(lens_.file, "", "has no line NM: it is no catalogue of glasses");
        return std::move(glasses_);
    }

  private:
    void take(const std::vector<std::string_view>& words) {
        if (words.empty()) return;
        if (words[0] == "NM") {
            if (words.size() < 2) fail("NM needs a name");
            const double formula = number(words, 2);
            formula_ = formula == 1   ? std::optional(Formula::kSchott)
                       : formula == 2 ? std::optional(Formula::kSellmeier)
                                      : std::nullopt;
            glasses_.push_back({.name = in_capitals(words[1])});
            if (formula_)
                set_fault("has no coefficients (CD)");
            else
                set_by_abbe(number(words, 4), number(words, 5));
        } else if (words[0] == "CD") {
            if (glasses_.empty()) fail("coefficients before a glass (NM)");
            if (formula_) set(words);
            formula_.reset();
        } else if (words[0] == "LD" && has_formula()) {
            check_range(number(words, 1), number(words, 2));
        }
    }

    /// Whether the last glass has its indices by a formula.
    bool has_formula() const {
        return !glasses_.empty() && glasses_.back().fault.empty() && glasses_.back().index_c > 0;
    }

    /// Beyond the wavelengths from one to the other, in micrometres, a formula's index is none that was
    /// measured.
    void check_range(double from, double to) {
        constexpr double kRounding = 1e-3;
        const double least = wavelength_of(SpectralLine::kF) + kRounding,
                     most = wavelength_of(SpectralLine::kC) - kRounding;
        if (from < to && !(from <= least && to >= most))
            set_fault(fmt::format("has an index from {} to {} micrometres, not at F, d and C", from, to));
    }

    void set(const std::vector<std::string_view>& words) {
        std::array<double, 6> terms;
        for (std::size_t i = 0; i < terms.size(); ++i) terms[i] = number(words, i + 1);
        Glass& glass = glasses_.back();
        const auto by_formula = *formula_ == Formula::kSchott ? schott_glass : sellmeier_glass;
        try {
            glass = by_formula(glass.name, terms, lens_.file, place());
        } catch (const InputError& error) {
            glass.fault = error.what();
        }
    }

    void set_by_abbe(double index, double abbe) {
        glasses_.back().index = index;
        glasses_.back().abbe = std::max(abbe, 0.0);
        // Catalogues have an index of 1 where there is none.
        if (!(index > 1 && index <= 10)) set_fault("has no index at d above 1 and up to 10");
    }

    /// Of the last glass. Infrared materials have no index in the visible, and most lenses do not ask.
    void set_fault(const std::string& what) {
        Glass& glass = glasses_.back();
        glass.fault = InputError(lens_.file, place(), "the glass " + glass.name + " " + what).what();
    }

    const std::string& text_;
    std::optional<Formula> formula_;  // of the last glass, whose coefficients are to come
};

}  // namespace

std::vector<Glass> parse_agf(const std::string& bytes, const std::string& file) {
    const std::string text = text_of(bytes);
    return CatalogueReader(text, file).read();
}

}  // namespace trilens
