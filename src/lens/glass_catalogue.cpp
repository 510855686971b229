// Schott's glasses, those of the catalogue of 2018 and older ones that prescriptions name, by what the data
// sheets say: n_d, V_d.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include "base/util/error.h"
#include "base/util/names.h"
#include "lens/prescription.h"

namespace trilens {
namespace {

struct KnownGlass {
    const char* name;
    double index, abbe;
};

// clang-format off
constexpr KnownGlass kGlasses[] = {
    {"BAFN6", 1.589, 48.45}, {"BK7", 1.5168, 64.17}, {"BK7G18", 1.51975, 63.58}, {"F2", 1.62004, 36.37},
    {"F2G12", 1.62072, 36.56}, {"F2HT", 1.62004, 36.37}, {"F5", 1.60342, 38.03}, {"FK3", 1.4645, 65.77},
    {"FK5HTI", 1.48748, 70.47}, {"K10", 1.50137, 56.41}, {"K5G20", 1.52344, 56.76}, {"K7", 1.51112, 60.41},
    {"KZFS12", 1.696, 36.29}, {"KZFSN4", 1.6134, 44.29}, {"LAFN7", 1.7495, 34.95},
    {"LAK9G15", 1.69064, 54.76}, {"LAKL12", 1.6779, 54.92}, {"LASF35", 2.02204, 29.06},
    {"LASFN9", 1.85025, 32.17}, {"LF5", 1.58144, 40.85}, {"LF5G15", 1.58397, 40.83},
    {"LF5G19", 1.59655, 39.89}, {"LF5HTI", 1.58144, 40.89}, {"LLF1", 1.54814, 45.75},
    {"LLF1HTI", 1.54815, 45.9}, {"N-BAF10", 1.67003, 47.11}, {"N-BAF3", 1.58272, 46.64},
    {"N-BAF4", 1.60568, 43.72}, {"N-BAF51", 1.65224, 44.96}, {"N-BAF52", 1.60863, 46.6},
    {"N-BAK1", 1.5725, 57.55}, {"N-BAK2", 1.53996, 59.71}, {"N-BAK4", 1.56883, 55.98},
    {"N-BAK4HT", 1.56883, 55.98}, {"N-BALF4", 1.57956, 53.87}, {"N-BALF5", 1.54739, 53.63},
    {"N-BASF2", 1.66446, 36.0}, {"N-BASF64", 1.704, 39.38}, {"N-BK10", 1.49782, 66.95},
    {"N-BK7", 1.5168, 64.17}, {"N-BK7HT", 1.5168, 64.17}, {"N-BK7HTI", 1.5168, 64.17},
    {"N-F2", 1.62005, 36.43}, {"N-FK5", 1.48749, 70.41}, {"N-FK51", 1.48656, 84.47},
    {"N-FK51A", 1.48656, 84.47}, {"N-FK58", 1.456, 90.9}, {"N-K5", 1.52249, 59.48},
    {"N-KF9", 1.52346, 51.54}, {"N-KZFS11", 1.63775, 42.41}, {"N-KZFS2", 1.55836, 54.01},
    {"N-KZFS4", 1.61336, 44.49}, {"N-KZFS4HT", 1.61336, 44.49}, {"N-KZFS5", 1.65412, 39.7},
    {"N-KZFS8", 1.72047, 34.7}, {"N-LAF2", 1.74397, 44.85}, {"N-LAF21", 1.788, 47.49},
    {"N-LAF3", 1.717, 47.96}, {"N-LAF32", 1.79457, 45.53}, {"N-LAF33", 1.78582, 44.05},
    {"N-LAF34", 1.7725, 49.62}, {"N-LAF35", 1.7433, 49.4}, {"N-LAF36", 1.79952, 42.37},
    {"N-LAF7", 1.7495, 34.82}, {"N-LAK10", 1.72003, 50.62}, {"N-LAK12", 1.6779, 55.2},
    {"N-LAK14", 1.6968, 55.41}, {"N-LAK21", 1.64049, 60.1}, {"N-LAK22", 1.65113, 55.89},
    {"N-LAK33A", 1.75393, 52.27}, {"N-LAK33B", 1.755, 52.3}, {"N-LAK34", 1.72916, 54.5},
    {"N-LAK7", 1.6516, 58.52}, {"N-LAK8", 1.713, 53.83}, {"N-LAK9", 1.691, 54.71},
    {"N-LASF31", 1.88067, 41.01}, {"N-LASF31A", 1.883, 40.76}, {"N-LASF40", 1.83404, 37.3},
    {"N-LASF41", 1.83501, 43.13}, {"N-LASF43", 1.8061, 40.61}, {"N-LASF44", 1.8042, 46.5},
    {"N-LASF45", 1.80107, 34.97}, {"N-LASF45HT", 1.80107, 34.97}, {"N-LASF46", 1.90138, 31.64},
    {"N-LASF46A", 1.90366, 31.32}, {"N-LASF46B", 1.90366, 31.32}, {"N-LASF9", 1.85025, 32.17},
    {"N-LASF9HT", 1.85025, 32.17}, {"N-PK51", 1.52855, 76.98}, {"N-PK52A", 1.497, 81.61},
    {"N-PSK3", 1.55232, 63.46}, {"N-PSK53", 1.62014, 63.48}, {"N-PSK53A", 1.618, 63.39},
    {"N-SF1", 1.71736, 29.62}, {"N-SF10", 1.72828, 28.53}, {"N-SF11", 1.78472, 25.68},
    {"N-SF14", 1.76182, 26.53}, {"N-SF15", 1.69892, 30.2}, {"N-SF19", 1.66679, 33.12},
    {"N-SF2", 1.64769, 33.82}, {"N-SF4", 1.75513, 27.38}, {"N-SF5", 1.67271, 32.25},
    {"N-SF56", 1.7847, 26.1}, {"N-SF57", 1.84666, 23.78}, {"N-SF57HT", 1.84666, 23.78},
    {"N-SF57HTULTRA", 1.84666, 23.78}, {"N-SF6", 1.80518, 25.36}, {"N-SF64", 1.70591, 30.23},
    {"N-SF66", 1.92286, 20.88}, {"N-SF6HT", 1.80518, 25.36}, {"N-SF6HTULTRA", 1.80518, 25.36},
    {"N-SF8", 1.68894, 31.31}, {"N-SK10", 1.62278, 56.98}, {"N-SK11", 1.56384, 60.8},
    {"N-SK14", 1.60311, 60.6}, {"N-SK15", 1.62296, 58.02}, {"N-SK16", 1.62041, 60.32},
    {"N-SK2", 1.60738, 56.65}, {"N-SK2HT", 1.60738, 56.65}, {"N-SK4", 1.61272, 58.63},
    {"N-SK5", 1.58913, 61.27}, {"N-SSK2", 1.62229, 53.27}, {"N-SSK5", 1.65844, 50.88},
    {"N-SSK8", 1.61773, 49.83}, {"N-ZK7", 1.50847, 61.19}, {"N-ZK7A", 1.508054, 61.04},
    {"P-BK7", 1.5164, 64.06}, {"P-LAF37", 1.7555, 45.66}, {"P-LAK35", 1.6935, 53.2},
    {"P-LASF47", 1.8061, 40.9}, {"P-LASF50", 1.8086, 40.46}, {"P-LASF51", 1.81, 40.93},
    {"P-PK53", 1.5269, 66.22}, {"P-SF67", 1.9068, 21.4}, {"P-SF68", 2.0052, 21.0},
    {"P-SF69", 1.7225, 29.23}, {"P-SF8", 1.68893, 31.25}, {"P-SK57", 1.587, 59.6},
    {"P-SK57Q1", 1.586, 59.5}, {"P-SK58A", 1.58913, 61.15}, {"P-SK60", 1.61035, 57.9},
    {"SF1", 1.71736, 29.51}, {"SF10", 1.72825, 28.41}, {"SF11", 1.78472, 25.76}, {"SF14", 1.76182, 26.53},
    {"SF15", 1.69895, 30.07}, {"SF2", 1.64769, 33.85}, {"SF4", 1.7552, 27.58}, {"SF5", 1.6727, 32.21},
    {"SF56A", 1.7847, 26.08}, {"SF57", 1.84666, 23.83}, {"SF57HTULTRA", 1.84666, 23.83},
    {"SF6", 1.80518, 25.43}, {"SF66", 1.92286, 20.88}, {"SF6G05", 1.80906, 25.28}, {"SF8", 1.68893, 31.18},
    {"SFL57", 1.84666, 23.62}, {"SFL6", 1.80518, 25.39}, {"SK16", 1.62041, 60.33}, {"SK4", 1.61272, 58.63},
};
// clang-format on

bool is_same_name(std::string_view a, std::string_view b) {
    const auto capital = [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; };
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [&](char one, char other) { return capital(one) == capital(other); });
}

/// The number that the digits are behind so many of them; none where there are others than digits.
std::optional<double> fraction_of(std::string_view digits, int before_point) {
    long long number = 0;
    const char* const end = digits.data() + digits.size();
    const auto [stop, error] = std::from_chars(digits.data(), end, number);
    if (error != std::errc() || stop != end || digits[0] == '-') return std::nullopt;
    return static_cast<double>(number) / std::pow(10, static_cast<double>(digits.size()) - before_point);
}

/// "517642", or "517.642", or with more digits "516800.641700": n_d - 1, then V_d.
std::optional<Glass> glass_of_code(const std::string& name) {
    constexpr std::size_t kLeastDigits = 3, kMostDigits = 9;
    const std::size_t point = name.find('.');
    const bool whole = point == std::string::npos && name.size() == 2 * kLeastDigits;
    if (point == std::string::npos && !whole) return std::nullopt;
    const std::string_view text = name, index = text.substr(0, whole ? kLeastDigits : point),
                           abbe = text.substr(whole ? kLeastDigits : point + 1);
    for (const std::string_view digits : {index, abbe})
        if (digits.size() < kLeastDigits || digits.size() > kMostDigits) return std::nullopt;
    const std::optional<double> over_one = fraction_of(index, 0), number = fraction_of(abbe, 2);
    if (!over_one || !number || !(*number > 0)) return std::nullopt;
    return Glass{name, 1 + *over_one, *number};
}

}  // namespace

Glass find_glass(const std::string& name, const std::string& file, const std::string& place,
                 std::span<const Glass> more) {
    for (const Glass& glass : more) {
        if (!is_same_name(name, glass.name)) continue;
        if (!glass.fault.empty()) throw InputError(file, place, glass.fault);
        return glass;
    }
    for (const KnownGlass& glass : kGlasses)
        if (is_same_name(name, glass.name)) return {glass.name, glass.index, glass.abbe};
    if (const std::optional<Glass> coded = glass_of_code(name)) return *coded;
    // No list of all names where none is near.
    std::vector<std::string> known = glass_names();
    for (const Glass& glass : more) known.push_back(glass.name);
    const std::string near = suggestion(name, known);
    throw InputError(file, place,
                     "unknown glass '" + name + "'" + (near.starts_with("; did") ? near : "") +
                         "; the catalogue has Schott's, and any glass can be given by index and Abbe number");
}

std::vector<std::string> glass_names() {
    std::vector<std::string> names;
    for (const KnownGlass& glass : kGlasses) names.emplace_back(glass.name);
    return names;
}

}  // namespace trilens
