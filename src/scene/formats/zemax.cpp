// Reads what Zemax' sequential files say of their surfaces, line by line.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <vector>

#include "base/util/error.h"
#include "lens/q_asphere.h"
#include "scene/formats/lens_file.h"
#include "scene/formats/lens_lines.h"
#include "scene/formats/utf16.h"

namespace trilens {
namespace {

/// Apertures that are no circles about the vertex, and what stands in the light.
constexpr std::string_view kApertures[] = {"SQAP", "SQOB", "ELAP", "ELOB", "SPID", "UDAP", "UDOB", "USAP"};

/// A file's surface, from object to image.
struct ZemaxSurface {
    LensRow row;
    std::string type = "STANDARD", type_place = {};
    bool far = false;  // what comes next is at infinity
    struct Parameter {
        double index, value;
        std::string written, place;  // "PARM 2", "line 17"
    };
    std::vector<Parameter> parameters, extra;  // PARM, XDAT
    std::string glass_place = {};              // of a mirror, too
    double clear_radius = 0;                   // of a circular aperture; 0: the surface has none but its own
    std::string aperture_fault = {}, aperture_place = {};

    double parameter(int index) const { return value_of(parameters, index); }
    double extra_value(int index) const { return value_of(extra, index); }

    static double value_of(const std::vector<Parameter>& of, int index) {
        for (const Parameter& one : of)
            if (one.index == index) return one.value;
        return 0;
    }
};

/// Of a coordinate break, without its thickness: shifted, then turned, or the other way round.
LensPose break_of(const ZemaxSurface& surface) {
    const auto p = [&](int index) { return surface.parameter(index); };
    const LensPose shift = shifted({p(1), p(2), 0});
    const Vec3 tilt(p(3), p(4), p(5));
    if (p(6) == 0) return shift * tilted(tilt);
    return tilted({0, 0, tilt.z}) * tilted({0, tilt.y, 0}) * tilted({tilt.x, 0, 0}) * shift;
}

class ZemaxReader : LensLines {
  public:
    ZemaxReader(const std::string& text, const std::string& file, std::span<const Glass> glasses)
        : LensLines(file, glasses), text_(text) {}

    LensPrescription read() {
        for (std::size_t at = 0; at < text_.size();) {
            const std::size_t end = std::min(text_.find('\n', at), text_.size());
            ++line_;
            take(std::string_view(text_).substr(at, end - at));
            at = end + 1;
        }
        if (surfaces_.empty()) throw InputError(lens_.file, "", "has no line SURF: it is no Zemax lens file");
        if (!surfaces_.back().glass_place.empty())
            throw InputError(lens_.file, surfaces_.back().glass_place,
                             "the last surface, the image, has glass: the file ends early");
        if (surfaces_.size() < 3) throw InputError(lens_.file, "", "has no surface between object and image");
        for (std::size_t i = 1; i + 1 < surfaces_.size(); ++i) add(surfaces_[i], i + 2 == surfaces_.size());
        lens_.image = bend_;
        check_prescription(lens_);
        return std::move(lens_);
    }

  private:
    void take(std::string_view line) {
        const std::vector<std::string_view> words = split_words(line);
        if (words.empty()) return;
        const std::string_view key = words[0];
        if (key == "MODE" && words.size() > 1 && words[1] != "SEQ")
            fail("is a system of mode " + std::string(words[1]) + ": sequential ones (SEQ) are read");
        if (key == "NAME") lens_.name = rest_of_line(line, key);
        if (key == "SURF") {
            if (number(words, 1) != static_cast<double>(surfaces_.size()))
                fail("surfaces do not follow each other");
            surfaces_.emplace_back();
            surfaces_.back().row.place = place();
        } else if (!surfaces_.empty()) {
            take_of_surface(words, surfaces_.back());
        }
    }

    void take_of_surface(const std::vector<std::string_view>& words, ZemaxSurface& surface) {
        const std::string_view key = words[0];
        LensRow& row = surface.row;
        if (key == "TYPE" && words.size() > 1) {
            surface.type = words[1];
            surface.type_place = place();
        } else if (key == "STOP") {
            row.stop = true;
        } else if (key == "CURV") {
            row.side.curvature = number(words, 1);
        } else if (key == "CONI") {
            row.side.conic = number(words, 1);
        } else if (key == "DIAM") {
            row.side.aperture = number(words, 1);
            if (row.side.aperture < 0) fail("DIAM is negative");
        } else if (key == "DISZ") {
            surface.far = words.size() > 1 && words[1] == "INFINITY";
            if (!surface.far) row.thickness = number(words, 1);
        } else if (key == "CLAP") {
            row.hole = number(words, 1);
            surface.clear_radius = number(words, 2);
            if (!(row.hole >= 0 && surface.clear_radius > row.hole))
                fail("CLAP has its inner radius, 0 or more, then a larger one");
        } else if (key == "OBSC") {
            row.obscuration = number(words, 2);
            if (number(words, 1) != 0 || !(row.obscuration >= 0))
                fail("OBSC: its inner radius must be 0, its outer one not negative");
        } else if (changes_aperture(words)) {
            surface.aperture_fault =
                std::string(key) + ": circular apertures about the vertex (DIAM, CLAP) are read";
            surface.aperture_place = place();
        } else if (key == "PARM" || key == "XDAT") {
            take_parameter(words, key == "PARM" ? surface.parameters : surface.extra);
        } else if (key == "GLAS") {
            surface.glass_place = place();
            row.mirror = words.size() > 1 && words[1] == "MIRROR";
            row.glass = row.mirror ? Glass() : glass(words);
        }
    }

    void take_parameter(const std::vector<std::string_view>& words,
                        std::vector<ZemaxSurface::Parameter>& parameters) const {
        const double index = number(words, 1), value = number(words, 2);
        const std::string written = std::string(words[0]) + " " + std::string(words[1]);
        for (const ZemaxSurface::Parameter& one : parameters)
            if (one.index == index) fail(written + ": the surface has it already, in " + one.place);
        parameters.push_back({index, value, written, place()});
    }

    bool changes_aperture(const std::vector<std::string_view>& words) const {
        if (words[0] == "OBDC") return number(words, 1) != 0 || number(words, 2) != 0;
        return std::find(std::begin(kApertures), std::end(kApertures), words[0]) != std::end(kApertures);
    }

    /// Those that are read have the numbers 1 to `last`.
    void refuse_others(const ZemaxSurface& surface, const std::vector<ZemaxSurface::Parameter>& parameters,
                       double last) const {
        for (const ZemaxSurface::Parameter& one : parameters)
            if (one.value != 0 &&
                !(one.index >= 1 && one.index <= last && one.index == std::floor(one.index)))
                throw InputError(lens_.file, one.place,
                                 one.written + " is not read of surfaces of type " + surface.type);
    }

    /// `count` terms from PARM `first` on; none has a number behind them.
    void set_coefficients(const ZemaxSurface& surface, int first, int count, LensSide& side) const {
        refuse_others(surface, surface.parameters, first + count - 1);
        for (int i = 0; i < count; ++i)
            side.coefficients[static_cast<std::size_t>(i)] = surface.parameter(first + i);
    }

    /// What a surface of its type has beside radius and conic constant.
    void set_form(const ZemaxSurface& surface, LensSide& side) const {
        const auto curvature = [](double radius) { return radius == 0 ? 0 : 1 / radius; };
        if (surface.type == "EVENASPH") {
            set_coefficients(surface, 1, static_cast<int>(kAsphereTerms), side);
        } else if (surface.type == "BICONICX") {
            refuse_others(surface, surface.parameters, 2);
            side.form = SideForm::kBiconic;
            side.across_curvature = curvature(surface.parameter(1));
            side.across_conic = surface.parameter(2);
        } else if (surface.type == "TOROIDAL") {
            set_coefficients(surface, 2, static_cast<int>(kAsphereTerms) - 1, side);
            side.form = SideForm::kToricY;
            side.across_curvature = curvature(surface.parameter(1));
        } else if (surface.type == "QED_TYPE") {
            set_q_terms(surface, side);
        } else if (surface.type != "STANDARD") {
            throw InputError(lens_.file, surface.type_place,
                             "a surface of type " + surface.type +
                                 ": STANDARD, EVENASPH, BICONICX, TOROIDAL, " +
                                 "QED_TYPE and COORDBRK are read");
        }
        if (surface.type == "QED_TYPE" || surface.type == "STANDARD") return;
        refuse_others(surface, surface.extra, 0);
    }

    /// XDAT 1: 0 for Qbfs, 1 for Qcon; 2: how many terms; 3: the normalization radius; from 4 on A0, A1, ...
    void set_q_terms(const ZemaxSurface& surface, LensSide& side) const {
        const auto fail_at_type = [&](const std::string& why) {
            throw InputError(lens_.file, surface.type_place, "a Q-type asphere " + why);
        };
        const double kind = surface.extra_value(1), count = surface.extra_value(2),
                     radius = surface.extra_value(3);
        if (kind != 0 && kind != 1) fail_at_type("of a kind (XDAT 1) that is neither 0, Qbfs, nor 1, Qcon");
        if (!(count >= 0) || count != std::floor(count))
            fail_at_type("whose number of terms (XDAT 2) is no whole number");
        if (count > 0 && !(radius > 0)) fail_at_type("without a normalization radius (XDAT 3)");
        refuse_others(surface, surface.parameters, 0);
        refuse_others(surface, surface.extra, std::numeric_limits<double>::infinity());
        std::vector<double> terms;
        for (const ZemaxSurface::Parameter& one : surface.extra) {
            const double term = one.index - 4;
            if (term < 0 || one.value == 0) continue;
            if (!(term < count))
                throw InputError(lens_.file, one.place,
                                 one.written + " is beyond the number of terms (XDAT 2)");
            if (!(term < static_cast<double>(kQTerms)))
                throw InputError(lens_.file, one.place, one.written + " is beyond r^16");
            terms.resize(std::max(terms.size(), static_cast<std::size_t>(term) + 1));
            terms[static_cast<std::size_t>(term)] = one.value;
        }
        if (terms.empty()) return;
        if (kind == 0 && side.conic != 0)
            fail_at_type("of the kind Qbfs departs from a sphere: CONI must be 0");
        side.terms_radius = radius;
        if (kind == 0)
            side.normal_departures = qbfs_departures(terms, radius);
        else
            side.coefficients = qcon_coefficients(terms, radius);
    }

    /// By name; a model glass has its index and Abbe number in the line.
    Glass glass(const std::vector<std::string_view>& words) const {
        if (words.size() < 2) fail("GLAS needs a name");
        const std::string name(words[1]);
        if (name == "___BLANK") return {"model", number(words, 4), number(words, 5)};
        return find_glass(name, lens_.file, place(), glasses_);
    }

    void add(const ZemaxSurface& surface, bool is_last) {
        if (surface.far && !is_last)
            throw InputError(lens_.file, surface.row.place, "what follows is at infinity");
        if (!surface.aperture_fault.empty())
            throw InputError(lens_.file, surface.aperture_place, surface.aperture_fault);
        if (surface.type == "COORDBRK") {
            add_break(surface);
            return;
        }
        LensRow& row = lens_.rows.emplace_back(surface.row);
        set_form(surface, row.side);
        double& rim = row.side.aperture;
        if (surface.clear_radius > 0)
            rim = rim > 0 ? std::min(rim, surface.clear_radius) : surface.clear_radius;
        row.before = bend_;
        bend_ = {};
    }

    /// The row before becomes as much longer; what the break does else comes behind that. In front of the
    /// first row its thickness moves the lens as a whole.
    void add_break(const ZemaxSurface& surface) {
        refuse_others(surface, surface.parameters, 6);
        const double thickness = surface.row.thickness;
        if (!lens_.rows.empty()) lens_.rows.back().thickness += thickness;
        bend_ = along_axis(-thickness) * bend_ * break_of(surface) * along_axis(thickness);
    }

    const std::string& text_;
    std::vector<ZemaxSurface> surfaces_;
    LensPose bend_;  // of breaks since the last row, behind its thickness
};

}  // namespace

LensPrescription parse_zemax(const std::string& bytes, const std::string& file,
                             std::span<const Glass> glasses) {
    const std::string text = text_of(bytes);
    return ZemaxReader(text, file, glasses).read();
}

}  // namespace trilens
