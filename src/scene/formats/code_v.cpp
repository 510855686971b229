// Reads what CODE V's sequences say of their surfaces: commands between semicolons, lines that go on after
// '&'.
#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include "base/util/error.h"
#include "lens/dispersion.h"
#include "scene/formats/code_v_form.h"
#include "scene/formats/lens_file.h"
#include "scene/formats/lens_lines.h"

namespace trilens {
namespace {

/// Commands of a surface that are read, but for its terms (A to J) and tilts.
constexpr std::string_view kSurfaceWords[] = {"RDY", "CUY", "THI", "GLA", "RMD", "CIR", "STO", "K",
                                              "DAR", "BEN", "REV", "YTO", "XTO", "AAS", "RDX", "CUX",
                                              "KX",  "KY",  "SPH", "CON", "ASP", "CYL", "SPS", "SCO"};

/// What an anamorphic asphere has beyond its two conic sections.
constexpr std::string_view kAnamorphicTerms[] = {"AR", "BR", "CR", "DR", "AP", "BP", "CP", "DP"};

/// Commands of surfaces of other kinds, that neither refract nor reflect, or whose tilts are not
/// about their own vertex.
constexpr std::string_view kRefused[] = {"REFL", "GRT", "HOE", "DIF", "NSS", "REX", "REY", "ELX", "ELY",
                                         "GRX",  "ADX", "ADY", "THG", "XOD", "YOD", "ZOD", "GLB", "RET"};
/// Those of them that say where a surface is.
constexpr std::string_view kPlacing[] = {"THG", "XOD", "YOD", "ZOD", "GLB", "RET"};

/// And those of rims that are not round.
constexpr std::string_view kRims[] = {"REX", "REY", "ELX", "ELY", "GRX", "ADX", "ADY"};
constexpr std::string_view kPlacingRead =
    ": places are read as thicknesses and as XDE to CDE, DAR, BEN and REV";
constexpr std::string_view kRimsRead = ": round apertures around the vertex (CIR) are read";
constexpr std::string_view kFormsRead =
    ": conicoids, even aspheres, cylinders (CYL), toric (YTO, XTO), biconic (AAS) and Q-type "
    "(SPS QBF, SPS QCN) surfaces are read";

/// Commands that change surfaces which were read before, or tie them to each other.
constexpr std::string_view kEditing[] = {"SCA", "FLY", "DEL", "INS", "COP", "PIK"};

/// Commands of which one number is read.
constexpr std::string_view kOneNumber[] = {"RDY", "CUY", "THI", "RDX", "CUX", "K", "KX", "KY"};

/// Shifts along x, y, z and tilts about them.
constexpr std::string_view kTilts[] = {"XDE", "YDE", "ZDE", "ADE", "BDE", "CDE"};

/// As it is written: angles about x and y are left-handed.
struct WrittenTilt {
    LensTilt tilt;
    std::string place = {};  // of the last command that says something
};

template <std::size_t kCount>
bool is_among(const std::string_view (&words)[kCount], std::string_view word) {
    return std::find(std::begin(words), std::end(words), word) != std::end(words);
}

/// S1, S2..4, SO, SI, SA (all), SS (the stop), S'LABEL': surfaces by their names.
bool names_surface(std::string_view written) {
    const std::string word = in_capitals(written);
    if (word.size() < 2 || word[0] != 'S') return false;
    if (word[1] == '\'' || (word[1] >= '0' && word[1] <= '9')) return true;
    return word == "SO" || word == "SI" || word == "SA" || word == "SS";
}

class SequenceReader : LensLines {
  public:
    SequenceReader(const std::string& text, const std::string& file, std::span<const Glass> glasses)
        : LensLines(file, glasses), text_(text) {}

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
        for (std::size_t i = 0; i < lens_.rows.size(); ++i) {
            bend(lens_.rows[i], tilts_[i]);
            forms_[i].shape(lens_.rows[i].side, lens_.file);
        }
        if (object_tilt_.tilt.decentre != Vec3(0) || object_tilt_.tilt.degrees != Vec3(0))
            throw InputError(lens_.file, object_tilt_.place,
                             "the object (SO) is tilted or decentred: that is not read");
        LensRow image;
        bend(image, image_tilt_);
        lens_.image = image.before;
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
        if (in_private_) {
            take_private(key, words);
        } else if (key == "PRV") {
            in_private_ = true;
        } else if (key == "TIT" || key == "TITLE") {
            lens_.name = rest_of_line(command, words[0]);
            std::erase_if(lens_.name, [](char letter) { return letter == '\'' || letter == '"'; });
        } else if (key == "CUM") {
            by_curvature_ = true;
        } else if (key == "RDM") {
            by_curvature_ = words.size() > 1 && in_capitals(words[1]) == "N";
        } else if (key == "SO" || key == "SI") {
            ended_ = ended_ || key == "SI";
            part_ = key == "SI" ? Part::kImage : Part::kObject;
        } else if (key == "S" || is_numbered(key)) {
            begin_surface(words);
        } else {
            check_command(key, words);
            take_of_part(key, words);
        }
    }

    /// S1, S12: a surface by its number.
    static bool is_numbered(const std::string& key) {
        return key.size() > 1 && key[0] == 'S' && parse_integer(std::string_view(key).substr(1)).has_value();
    }

    void begin_surface(const std::vector<std::string_view>& words) {
        if (ended_) fail("a surface behind the image");
        part_ = Part::kLens;
        LensRow& row = lens_.rows.emplace_back();
        row.place = place();
        tilts_.emplace_back();
        forms_.emplace_back();
        if (words.size() > 1) set_curvature(number(words, 1), by_curvature_);
        if (words.size() > 2) row.thickness = number(words, 2);
        if (words.size() > 3) set_glass(words[3]);
        if (words.size() > 4) set_mode(words[4]);
        check_length(words, 5);
    }

    /// Commands follow each other behind semicolons: what stands behind a command's last word would be lost.
    void check_length(const std::vector<std::string_view>& words, std::size_t most) const {
        if (words.size() > most)
            fail("\"" + std::string(words[most]) + "\" behind " + std::string(words[most - 1]) +
                 ": the next command stands behind a semicolon");
    }

    /// Whether a surface refracts or reflects.
    void set_mode(std::string_view written) {
        const std::string mode = in_capitals(written);
        if (mode == "REFL") {
            lens_.rows.back().mirror = true;
            lens_.rows.back().glass = {};
        } else if (mode != "REFR") {
            fail("a surface of mode " + mode + ": REFR and REFL are read");
        }
    }

    void set_curvature(double value, bool is_curvature) {
        lens_.rows.back().side.curvature = is_curvature ? value : value == 0 ? 0 : 1 / value;
    }

    /// "SPS QBF": special surfaces have their kind in the second word.
    bool take_form(const std::string& key, const std::vector<std::string_view>& words) {
        const std::string kind = words.size() > 1 ? in_capitals(words[1]) : "";
        const std::string name = key == "SPS" && !kind.empty() ? key + " " + kind : key;
        if (forms_.back().take_form(name, lens_.file, place())) return true;
        if (key == "SPS") fail(name + ": of special surfaces Q-type ones (SPS QBF, SPS QCN) are read");
        return false;
    }

    void take_coefficient(const std::vector<std::string_view>& words) {
        if (words.size() < 2) fail("SCO needs a coefficient");
        check_length(words, 3);
        forms_.back().take_coefficient(in_capitals(words[1]), {number(words, 2), place()}, lens_.file);
    }

    /// "NSK16_SCHOTT", "'MINE'": quotes and the maker's name are left out, and the hyphen behind N or P is
    /// not written.
    void set_glass(std::string_view written) {
        std::string name = in_capitals(written);
        std::erase(name, '\'');
        const auto is_mine = [&](const Glass& glass) { return in_capitals(glass.name) == name; };
        if (std::none_of(glasses_.begin(), glasses_.end(), is_mine)) name = name.substr(0, name.find('_'));
        if (name == "REFL") return set_mode(name);
        if (name == "AIR") return;
        std::vector<std::string> known = glass_names();
        for (const Glass& glass : glasses_) known.push_back(in_capitals(glass.name));
        const auto is_known = [&](const std::string& one) {
            return std::find(known.begin(), known.end(), one) != known.end();
        };
        const std::string hyphenated =
            name.substr(0, 1) + "-" + name.substr(std::min<std::size_t>(1, name.size()));
        if (!is_known(name) && is_known(hyphenated)) name = hyphenated;
        lens_.rows.back().glass = find_glass(name, lens_.file, place(), glasses_);
    }

    /// Fails where a command says something of a surface that the lens would lack.
    void check_command(const std::string& key, const std::vector<std::string_view>& words) const {
        const bool is_named = words.size() > 1 && names_surface(words[1]);
        if (is_among(kRefused, key) &&
            (part_ == Part::kLens || is_named || (part_ != Part::kNone && is_among(kPlacing, key))))
            fail(key + std::string(is_among(kPlacing, key) ? kPlacingRead
                                   : is_among(kRims, key)  ? kRimsRead
                                                           : kFormsRead));
        if (is_among(kEditing, key) && (part_ == Part::kLens || is_named))
            fail(key + ": surfaces are read as they are written; what changes or ties them is not done");
        const bool is_term = key.size() == 1 && key[0] >= 'A' && key[0] <= 'J' && key != "I";
        if (part_ == Part::kLens && !is_named && is_among(kAnamorphicTerms, key) && number(words, 1) != 0)
            fail(key + ": of an anamorphic asphere (AAS) its conic sections are read");
        if (part_ == Part::kLens && (is_term || is_among(kOneNumber, key) || is_among(kTilts, key)))
            check_length(words, is_named ? 3 : 2);
        if (is_named && (is_term || is_among(kSurfaceWords, key) || is_among(kTilts, key)))
            fail(key + " " + std::string(words[1]) +
                 ": commands of a surface are read behind it, without its name");
    }

    /// Of object and image, where they are; of a surface all.
    void take_of_part(const std::string& key, const std::vector<std::string_view>& words) {
        if (part_ == Part::kNone) return;
        WrittenTilt& tilt = part_ == Part::kObject  ? object_tilt_
                            : part_ == Part::kImage ? image_tilt_
                                                    : tilts_.back();
        if (!take_tilt(key, words, tilt) && part_ == Part::kLens) take_of_surface(key, words);
    }

    void take_of_surface(const std::string& key, const std::vector<std::string_view>& words) {
        if (take_form(key, words)) return;
        LensRow& row = lens_.rows.back();
        if (key == "RDY")
            set_curvature(number(words, 1), false);
        else if (key == "CUY")
            set_curvature(number(words, 1), true);
        else if (key == "THI")
            row.thickness = number(words, 1);
        else if (key == "GLA" && words.size() > 1)
            set_glass(words[1]);
        else if (key == "RMD" && words.size() > 1)
            set_mode(words[1]);
        else if (key == "CIR")
            set_aperture(words);
        else if (key == "STO")
            row.stop = true;
        else if (key == "SCO")
            take_coefficient(words);
        else if (CodeVForm::has_number(key))
            forms_.back().take_number(key, {number(words, 1), place()});
        else if ((key == "H" || key == "J") && number(words, 1) != 0)
            fail(key + " is beyond r^16");
    }

    /// "CIR 10", "CIR EDG 10", "CIR CLR 10": the rim; "CIR HOL 2": a hole in the middle. What obscures stops
    /// light, where a hole of a mirror lets it by.
    void set_aperture(const std::vector<std::string_view>& words) {
        LensRow& row = lens_.rows.back();
        const std::string of = words.size() > 2 ? in_capitals(words[1]) : "";
        if (!of.empty() && of != "EDG" && of != "CLR" && of != "HOL" && of != "OBS")
            fail("CIR " + of + ": rims (CIR, CLR, EDG), holes (HOL) and obscurations (OBS) are read");
        const double radius = number(words, of.empty() ? 1 : 2);
        if (radius < 0) fail("CIR is negative");
        check_length(words, of.empty() ? 2 : 3);
        (of == "HOL" ? row.hole : of == "OBS" ? row.obscuration : row.side.aperture) = radius;
    }

    bool take_tilt(const std::string& key, const std::vector<std::string_view>& words, WrittenTilt& written) {
        LensTilt& tilt = written.tilt;
        const auto* const found = std::find(std::begin(kTilts), std::end(kTilts), key);
        if (found != std::end(kTilts)) {
            const auto k = static_cast<int>(found - std::begin(kTilts));
            (k < 3 ? tilt.decentre : tilt.degrees)[k % 3] = number(words, 1);
        } else if (key == "DAR") {
            tilt.behind = AxisBehind::kReturns;
        } else if (key == "BEN") {
            tilt.behind = AxisBehind::kBends;
        } else if (key == "REV") {
            tilt.behind = AxisBehind::kReverses;
        } else {
            return false;
        }
        written.place = place();
        return true;
    }

    /// Where an axis that bends about two axes has its own x is not known here.
    void bend(LensRow& row, const WrittenTilt& written) const {
        LensTilt tilt = written.tilt;
        if (tilt.behind == AxisBehind::kBends) {
            if (!row.mirror)
                throw InputError(lens_.file, written.place, "BEN of a surface that is no mirror");
            if (tilt.degrees.z != 0 || (tilt.degrees.x != 0 && tilt.degrees.y != 0))
                throw InputError(lens_.file, written.place, "BEN is read with one of ADE and BDE alone");
        }
        tilt.degrees *= Vec3(-1, -1, 1);
        tilt_row(row, tilt);
    }

    /// "PWL 656.3 587.6 486.1" and "'GLASS' n n n": indices at wavelengths in nanometres, to END.
    void take_private(const std::string& key, const std::vector<std::string_view>& words) {
        if (key == "END") {
            in_private_ = false;
            return;
        }
        std::vector<double> numbers;
        for (std::size_t i = 1; i < words.size(); ++i) numbers.push_back(number(words, i));
        if (key == "PWL") {
            wavelengths_ = std::move(numbers);
            return;
        }
        if (wavelengths_.empty()) fail("a private glass before its wavelengths (PWL)");
        if (numbers.size() != wavelengths_.size())
            fail("has " + std::to_string(numbers.size()) + " indices for " +
                 std::to_string(wavelengths_.size()) + " wavelengths");
        const auto at = [&](SpectralLine line, const char* name) {
            constexpr double kNearEnough = 0.15;  // nanometres
            for (std::size_t i = 0; i < numbers.size(); ++i)
                if (std::fabs(wavelengths_[i] - 1000 * wavelength_of(line)) < kNearEnough) return numbers[i];
            fail(std::string("the line ") + name + " is not among the wavelengths (PWL)");
        };
        std::string name = key;
        std::erase(name, '\'');
        glasses_.push_back(glass_of_lines(
            name, {at(SpectralLine::kD, "d"), at(SpectralLine::kC, "C"), at(SpectralLine::kF, "F")},
            lens_.file, place()));
    }

    const std::string& text_;
    enum class Part { kNone, kObject, kLens, kImage };  // whose commands are read

    WrittenTilt object_tilt_, image_tilt_;
    std::vector<WrittenTilt> tilts_;   // of the rows
    std::vector<CodeVForm> forms_;     // of the rows
    std::vector<double> wavelengths_;  // of private glasses
    Part part_ = Part::kNone;
    bool by_curvature_ = false, ended_ = false, in_private_ = false;
};

}  // namespace

LensPrescription parse_code_v(const std::string& bytes, const std::string& file,
                              std::span<const Glass> glasses) {
    return SequenceReader(bytes, file, glasses).read();
}

}  // namespace trilens
