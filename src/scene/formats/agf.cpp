// Reads glass catalogues of Zemax: a line NM for each glass, and its coefficients in a line CD.
#include <algorithm>
#include <array>
#include <optional>

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
        if (!has_names_) throw InputError(lens_.file, "", "has no line NM: it is no catalogue of glasses");
        return std::move(glasses_);
    }

  private:
    void take(const std::vector<std::string_view>& words) {
        if (words.empty()) return;
        if (words[0] == "NM") {
            if (words.size() < 2) fail("NM needs a name");
            has_names_ = true;
            name_ = in_capitals(words[1]);
            const double formula = number(words, 2);
            formula_ = formula == 1   ? std::optional(Formula::kSchott)
                       : formula == 2 ? std::optional(Formula::kSellmeier)
                                      : std::nullopt;
            if (!formula_) add_by_abbe(number(words, 4), number(words, 5));
        } else if (words[0] == "CD") {
            if (!has_names_) fail("coefficients before a glass (NM)");
            if (formula_) add(words);
            formula_.reset();
        }
    }

    void add(const std::vector<std::string_view>& words) {
        std::array<double, 6> terms;
        for (std::size_t i = 0; i < terms.size(); ++i) terms[i] = number(words, i + 1);
        const auto glass = *formula_ == Formula::kSchott ? schott_glass : sellmeier_glass;
        glasses_.push_back(glass(name_, terms, lens_.file, place()));
    }

    void add_by_abbe(double index, double abbe) {
        if (!(index >= 1 && index <= 10)) fail("the glass " + name_ + " has no index from 1 to 10");
        glasses_.push_back({name_, index, std::max(abbe, 0.0)});
    }

    const std::string& text_;
    std::string name_;
    std::optional<Formula> formula_;  // of the glass whose coefficients are to come
    bool has_names_ = false;
};

}  // namespace

std::vector<Glass> parse_agf(const std::string& bytes, const std::string& file) {
    const std::string text = text_of(bytes);
    return CatalogueReader(text, file).read();
}

}  // namespace trilens
