// Reads what Zemax' sequential files say of their surfaces, line by line.
#include <cmath>
#include <vector>

#include "base/util/error.h"
#include "scene/formats/lens_file.h"
#include "scene/formats/lens_lines.h"

namespace trilens {
namespace {

/// A file's surface, from object to image.
struct ZemaxSurface {
    LensRow row;
    std::string type = "STANDARD", type_place = {};
    bool far = false;  // what comes next is at infinity
};

bool is_utf16(const std::string& bytes) {
    return bytes.size() >= 2 &&
           ((bytes[0] == '\xff' && bytes[1] == '\xfe') || (bytes[0] == '\xfe' && bytes[1] == '\xff'));
}

/// UTF-16 with its byte order mark as UTF-8; halves of pairs become '?'.
std::string utf8_of_utf16(const std::string& bytes) {
    const bool little = bytes[0] == '\xff';
    std::string text;
    for (std::size_t i = 2; i + 1 < bytes.size(); i += 2) {
        const auto low = static_cast<unsigned char>(bytes[little ? i : i + 1]);
        const auto high = static_cast<unsigned char>(bytes[little ? i + 1 : i]);
        const unsigned unit = high * 256u + low;
        if (unit < 0x80) {
            text += static_cast<char>(unit);
        } else if (unit < 0x800) {
            text += static_cast<char>(0xc0 | (unit >> 6));
            text += static_cast<char>(0x80 | (unit & 0x3f));
        } else if (unit >= 0xd800 && unit < 0xe000) {
            text += '?';
        } else {
            text += static_cast<char>(0xe0 | (unit >> 12));
            text += static_cast<char>(0x80 | ((unit >> 6) & 0x3f));
            text += static_cast<char>(0x80 | (unit & 0x3f));
        }
    }
    return text;
}

class ZemaxReader : LensLines {
  public:
    ZemaxReader(const std::string& text, const std::string& file) : LensLines(file), text_(text) {}

    LensPrescription read() {
        for (std::size_t at = 0; at < text_.size();) {
            const std::size_t end = std::min(text_.find('\n', at), text_.size());
            ++line_;
            take(std::string_view(text_).substr(at, end - at));
            at = end + 1;
        }
        if (surfaces_.empty()) throw InputError(lens_.file, "", "has no line SURF: it is no Zemax lens file");
        if (surfaces_.size() < 3) throw InputError(lens_.file, "", "has no surface between object and image");
        for (std::size_t i = 1; i + 1 < surfaces_.size(); ++i) add(surfaces_[i], i + 2 == surfaces_.size());
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
        } else if (key == "PARM") {
            take_parameter(words, row.side);
        } else if (key == "GLAS") {
            row.glass = glass(words);
        }
    }

    /// Of even aspheres; surfaces of other types that are read have none.
    void take_parameter(const std::vector<std::string_view>& words, LensSide& side) const {
        const double index = number(words, 1), value = number(words, 2);
        if (index >= 1 && index <= static_cast<double>(kAsphereTerms) && index == std::floor(index))
            side.coefficients[static_cast<std::size_t>(index) - 1] = value;
        else if (value != 0)
            fail("PARM " + std::string(words[1]) + " is not of an even asphere");
    }

    /// By name; a model glass has its index and Abbe number in the line.
    Glass glass(const std::vector<std::string_view>& words) const {
        if (words.size() < 2) fail("GLAS needs a name");
        const std::string name(words[1]);
        if (name == "MIRROR") fail("is a mirror: lenses of refracting surfaces are read");
        if (name == "___BLANK") return {"model", number(words, 4), number(words, 5)};
        return find_glass(name, lens_.file, place());
    }

    void add(const ZemaxSurface& surface, bool is_last) {
        const bool is_asphere = surface.type == "EVENASPH";
        if (!is_asphere && surface.type != "STANDARD")
            throw InputError(lens_.file, surface.type_place,
                             "a surface of type " + surface.type + ": STANDARD and EVENASPH are read");
        if (surface.far && !is_last)
            throw InputError(lens_.file, surface.row.place, "what follows is at infinity");
        lens_.rows.push_back(surface.row);
        if (!is_asphere) lens_.rows.back().side.coefficients = {};
    }

    const std::string& text_;
    std::vector<ZemaxSurface> surfaces_;
};

}  // namespace

LensPrescription parse_zemax(const std::string& bytes, const std::string& file) {
    const std::string text = is_utf16(bytes) ? utf8_of_utf16(bytes) : bytes;
    return ZemaxReader(text, file).read();
}

}  // namespace trilens
