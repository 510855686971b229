// Reads what CODE V's sequences say of their surfaces: commands between semicolons, lines that go on after
// '&'.
#include <algorithm>
#include <string_view>
#include <vector>

#include "base/util/error.h"
#include "scene/formats/lens_file.h"
#include "scene/formats/lens_lines.h"

namespace trilens {
namespace {

/// Commands of surfaces that are not refracting, or not about the axis.
constexpr std::string_view kRefused[] = {"XDE",  "YDE", "ZDE", "ADE", "BDE", "CDE", "DAR", "BEN",
                                         "REFL", "CYL", "YTO", "XTO", "SPS", "GRT", "HOE", "DIF",
                                         "NSS",  "REX", "REY", "ELX", "ELY", "GRX", "ADX", "THG"};

/// Conicoid and asphere: what A, B, ... multiply is r^4, r^6, ...
constexpr std::string_view kTerms = "ABCDEFG";

class SequenceReader : LensLines {
  public:
    SequenceReader(const std::string& text, const std::string& file) : LensLines(file), text_(text) {}

    LensPrescription read() {
        std::string command;
        for (std::size_t at = 0; at < text_.size();) {
            const std::size_t end = std::min(text_.find('\n', at), text_.size());
            ++line_;
            std::string_view line = std::string_view(text_).substr(at, end - at);
            at = end + 1;
            line = line.substr(0, line.find('!'));
            while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
            const bool goes_on = !line.empty() && line.back() == '&';
            if (goes_on) line.remove_suffix(1);
            command += std::string(line) + " ";
            if (goes_on) continue;
            take_all(command);
            command.clear();
        }
        if (!command.empty()) take_all(command);
        if (!ended_)
            throw InputError(lens_.file, "", "has no surfaces from SO to SI: it is no CODE V sequence");
        check_prescription(lens_);
        return std::move(lens_);
    }

  private:
    void take_all(const std::string& commands) {
        for (std::size_t at = 0; at <= commands.size();) {
            const std::size_t end = std::min(commands.find(';', at), commands.size());
            const std::string_view one = std::string_view(commands).substr(at, end - at);
            const std::vector<std::string_view> words = split_words(one);
            if (!words.empty()) take(one, words);
            at = end + 1;
        }
    }

    void take(std::string_view command, const std::vector<std::string_view>& words) {
        const std::string key = in_capitals(words[0]);
        if (key == "TIT" || key == "TITLE") {
            lens_.name = rest_of_line(command, words[0]);
            std::erase(lens_.name, '\'');
        } else if (key == "CUM") {
            by_curvature_ = true;
        } else if (key == "RDM") {
            by_curvature_ = words.size() > 1 && in_capitals(words[1]) == "N";
        } else if (key == "SO" || key == "SI") {
            ended_ = ended_ || key == "SI";
            in_lens_ = false;
        } else if (key == "S" || is_numbered(key)) {
            begin_surface(words);
        } else if (in_lens_) {
            take_of_surface(key, words);
        }
    }

    /// S1, S12: a surface by its number.
    static bool is_numbered(const std::string& key) {
        return key.size() > 1 && key[0] == 'S' && parse_integer(std::string_view(key).substr(1)).has_value();
    }

    void begin_surface(const std::vector<std::string_view>& words) {
        if (ended_) fail("a surface behind the image");
        in_lens_ = true;
        LensRow& row = lens_.rows.emplace_back();
        row.place = place();
        if (words.size() > 1) set_curvature(number(words, 1), by_curvature_);
        if (words.size() > 2) row.thickness = number(words, 2);
        if (words.size() > 3) set_glass(words[3]);
    }

    void set_curvature(double value, bool is_curvature) {
        lens_.rows.back().side.curvature = is_curvature ? value : value == 0 ? 0 : 1 / value;
    }

    /// "NSK16_SCHOTT": the maker's name is left out, and the hyphen behind N or P is not written.
    void set_glass(std::string_view written) {
        std::string name = in_capitals(written.substr(0, written.find('_')));
        if (name == "REFL") fail("is a mirror: lenses of refracting surfaces are read");
        if (name == "AIR") return;
        const std::vector<std::string> known = glass_names();
        const auto is_known = [&](const std::string& one) {
            return std::find(known.begin(), known.end(), one) != known.end();
        };
        const std::string hyphenated =
            name.substr(0, 1) + "-" + name.substr(std::min<std::size_t>(1, name.size()));
        if (!is_known(name) && is_known(hyphenated)) name = hyphenated;
        lens_.rows.back().glass = find_glass(name, lens_.file, place());
    }

    void take_of_surface(const std::string& key, const std::vector<std::string_view>& words) {
        LensRow& row = lens_.rows.back();
        if (key == "RDY")
            set_curvature(number(words, 1), false);
        else if (key == "CUY")
            set_curvature(number(words, 1), true);
        else if (key == "THI")
            row.thickness = number(words, 1);
        else if (key == "GLA" && words.size() > 1)
            set_glass(words[1]);
        else if (key == "CIR")
            row.side.aperture = number(words, words.size() > 2 ? 2 : 1);
        else if (key == "STO")
            row.stop = true;
        else if (key == "K")
            row.side.conic = number(words, 1);
        else if (key.size() == 1 && kTerms.find(key[0]) != std::string_view::npos)
            row.side.coefficients[kTerms.find(key[0]) + 1] = number(words, 1);
        else if ((key == "H" || key == "J") && number(words, 1) != 0)
            fail(key + " is beyond r^16");
        else if (std::find(std::begin(kRefused), std::end(kRefused), key) != std::end(kRefused))
            fail(key + ": refracting surfaces about one axis are read");
    }

    const std::string& text_;
    bool by_curvature_ = false, in_lens_ = false, ended_ = false;
};

}  // namespace

LensPrescription parse_code_v(const std::string& bytes, const std::string& file) {
    return SequenceReader(bytes, file).read();
}

}  // namespace trilens
