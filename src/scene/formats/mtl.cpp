// Materials of OBJ files: what is drawn of them, and the names of what is not.
// Based on: Alias|Wavefront, MTL Material Format (the options of texture maps and their values).
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/util/error.h"
#include "json/json.h"
#include "scene/formats/line_scanner.h"
#include "scene/formats/obj.h"

namespace trilens {
namespace {

constexpr double kDiffuseOfTexture = 0.6;  // what tinyobjloader takes where a map_Kd has no Kd

/// An option of a map: how many values may follow it; the first must, and where there may be three, numbers.
struct MapOption {
    std::string_view name;
    std::size_t most_values;
};
constexpr MapOption kMapOptions[] = {{"-blendu", 1}, {"-blendv", 1}, {"-bm", 1},         {"-boost", 1},
                                     {"-cc", 1},     {"-clamp", 1},  {"-colorspace", 1}, {"-imfchan", 1},
                                     {"-mm", 2},     {"-o", 3},      {"-s", 3},          {"-t", 3},
                                     {"-texres", 1}, {"-type", 1}};

class MtlReader {
  public:
    explicit MtlReader(const std::string& file) : file_(file) {}

    void read_line(std::string_view line, std::size_t number) {
        line_ = number;
        const std::vector<std::string_view> words = split_words(line);
        if (words.empty()) return;
        if (words[0] == "newmtl") {
            finish_material();
            material_ = MtlMaterial();
            material_->name = rest_of_line(line, words[0]);
        } else if (!material_) {
            ignore(std::string(words[0]) + " before the first newmtl");
        } else if (words[0] == "Kd") {
            material_->diffuse = read_colour(words);
            has_diffuse_ = true;
        } else if (words[0] == "Ks") {
            material_->specular = read_colour(words);
        } else if (words[0] == "Ns") {
            material_->exponent = read_exponent(words);
        } else if (words[0] == "map_Kd") {
            material_->texture = read_map(line, words);
        } else if (words[0] == "map_Bump" || words[0] == "map_bump" || words[0] == "bump" ||
                   words[0] == "norm") {
            material_->bump_scale = 1;
            material_->bump = read_map(line, words);
            material_->is_normals = words[0] == "norm";
        } else if (words[0] == "disp") {
            material_->displacement_base = 0, material_->displacement_gain = 1;
            material_->displacement = read_map(line, words);
        } else if (words[0] == "illum" && words.size() == 2 && words[1].size() == 1 && words[1] <= "2") {
            has_highlight_ = words[1] == "2";
        } else if (!is_opaque(words)) {
            ignore(std::string(words[0]));
        }
    }

    MtlFile finish() {
        finish_material();
        std::string list;
        for (const Ignored& key : ignored_)
            list += (list.empty() ? "" : ", ") + key.name + " (line " + std::to_string(key.line) + ")";
        if (!list.empty()) result_.warnings.push_back("ignored: " + list);
        return std::move(result_);
    }

  private:
    struct Ignored {
        std::string name;
        std::size_t line;
    };

    [[noreturn]] void fail(const std::string& message) const {
        throw InputError(file_, "line " + std::to_string(line_), message);
    }

    void ignore(const std::string& name) {
        const auto same = [&](const Ignored& key) { return key.name == name; };
        if (std::none_of(ignored_.begin(), ignored_.end(), same)) ignored_.push_back({name, line_});
    }

    void finish_material() {
        if (!material_) return;
        if (!material_->texture.empty() && !has_diffuse_) material_->diffuse = Vec3(kDiffuseOfTexture);
        if (!has_highlight_) material_->specular = Vec3(0);
        result_.materials.push_back(std::move(*material_));
        has_diffuse_ = false;
        has_highlight_ = true;
    }

    /// Whether the line says that the material is opaque, as everything is.
    static bool is_opaque(const std::vector<std::string_view>& words) {
        if (words.size() != 2) return false;
        return (words[0] == "d" && parse_number(words[1]) == 1.0) ||
               (words[0] == "Tr" && parse_number(words[1]) == 0.0);
    }

    Vec3 read_colour(const std::vector<std::string_view>& words) const {
        const std::string key(words[0]);
        if (words.size() != 2 && words.size() < 4)
            fail("'" + key + "' needs 3 numbers, found " + std::to_string(words.size() - 1));
        Vec3 colour;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::string_view word = words[words.size() == 2 ? 1 : k + 1];
            const std::optional<double> value = parse_number(word);
            if (!value)
                fail("the " + key + " of material '" + material_->name + "': '" + std::string(word) +
                     "' is no number");
            if (!(*value >= 0 && *value <= kLargestCoordinate))
                fail("the " + key + " of material '" + material_->name + "' is no colour");
            colour[static_cast<int>(k)] = *value;
        }
        return colour;
    }

    double read_exponent(const std::vector<std::string_view>& words) const {
        const std::optional<double> value = words.size() > 1 ? parse_number(words[1]) : std::nullopt;
        if (!value || !(*value >= 0 && *value <= kLargestCoordinate))
            fail("the Ns of material '" + material_->name + "' is no exponent");
        return *value;
    }

    /// Takes -bm of a bump map and -mm of a displacement map, and steps over other options; the rest of the
    /// line is the picture, whose name may hold spaces.
    std::string read_map(std::string_view line, const std::vector<std::string_view>& words) {
        const std::string key(words[0]);
        std::size_t last = 0;  // word before the picture's name
        while (last + 1 < words.size()) {
            const std::string_view word = words[last + 1];
            const auto* option = std::find_if(std::begin(kMapOptions), std::end(kMapOptions),
                                              [&](const MapOption& known) { return known.name == word; });
            if (option == std::end(kMapOptions)) break;
            if (last + 2 >= words.size()) fail("'" + std::string(word) + "' of " + key + " needs a value");
            if (word == "-bm" && key != "map_Kd" && key != "disp")
                material_->bump_scale = read_number_of(word, words[last + 2]);
            else if (word == "-mm" && key == "disp")
                read_base_and_gain(words, last + 2);
            else
                ignore(key + " " + std::string(word));
            last += 2;
            for (std::size_t k = 1; k < option->most_values && last + 1 < words.size(); ++k)
                if (parse_number(words[last + 1]))
                    ++last;
                else
                    break;
        }
        std::string picture = rest_of_line(line, words[last]);
        if (picture.empty()) ignore(key + " without a picture");
        return picture;
    }

    double read_number_of(std::string_view option, std::string_view word) const {
        const std::optional<double> value = parse_number(word);
        if (!value || !(std::fabs(*value) <= kLargestCoordinate))
            fail("the " + std::string(option) + " of material '" + material_->name + "': '" +
                 std::string(word) + "' is no number");
        return *value;
    }

    void read_base_and_gain(const std::vector<std::string_view>& words, std::size_t first) {
        material_->displacement_base = read_number_of("-mm", words[first]);
        if (first + 1 < words.size() && parse_number(words[first + 1]))
            material_->displacement_gain = read_number_of("-mm", words[first + 1]);
    }

    const std::string& file_;
    std::size_t line_ = 0;
    std::optional<MtlMaterial> material_;
    bool has_diffuse_ = false;
    bool has_highlight_ = true;
    std::vector<Ignored> ignored_;
    MtlFile result_;
};

}  // namespace

MtlFile parse_mtl(const std::string& bytes, const std::string& file) {
    MtlReader reader(file);
    std::string_view rest = utf8_text(bytes, file);
    for (std::size_t line = 1; !rest.empty(); ++line) {
        const std::size_t end = std::min(rest.find('\n'), rest.size());
        reader.read_line(rest.substr(0, end), line);
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return reader.finish();
}

}  // namespace trilens
