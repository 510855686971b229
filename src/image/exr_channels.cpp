#include "image/exr_channels.h"

#include <strings.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <tuple>

namespace trilens {
namespace {

constexpr const char* kColourFirst[] = {"R",    "Red",  "G",  "Green", "B",     "Blue", "Y",
                                        "real", "imag", "A",  "Alpha", "AR",    "RA",   "AG",
                                        "GA",   "AB",   "BA", "Z",     "Depth", "Zback"};
constexpr const char* kWithPlace[] = {"R",  "Red", "G",    "Green", "B",  "Blue",  "X",
                                      "Y",  "Z",   "real", "imag",  "A",  "Alpha", "AR",
                                      "RA", "AG",  "GA",   "AB",    "BA", "Depth", "Zback"};

struct Name {
    std::string layer, last;
};

Name split(const std::string& name) {
    const std::size_t dot = name.rfind('.');
    return dot == std::string::npos ? Name{"", name} : Name{name.substr(0, dot + 1), name.substr(dot + 1)};
}

bool same(const std::string& a, const char* b) {
    return strcasecmp(a.c_str(), b) == 0;
}

std::size_t rank(const std::string& last, std::span<const char* const> usual) {
    for (std::size_t i = 0; i < usual.size(); ++i)
        if (same(last, usual[i])) return i;
    return usual.size();
}

}  // namespace

std::vector<std::string> in_layers(std::vector<std::string> names) {
    const std::vector<std::string> all = names;
    const auto has = [&](const std::string& layer, const char* last) {
        return std::any_of(all.begin(), all.end(), [&](const std::string& name) {
            const Name one = split(name);
            return one.layer == layer && same(one.last, last);
        });
    };
    const auto key = [&](const std::string& name) {
        const Name one = split(name);
        const bool place = has(one.layer, "X") && (has(one.layer, "Y") || has(one.layer, "Z"));
        return std::tuple(one.layer, place ? rank(one.last, kWithPlace) : rank(one.last, kColourFirst),
                          one.last);
    };
    std::sort(names.begin(), names.end(),
              [&](const std::string& a, const std::string& b) { return key(a) < key(b); });
    return names;
}

}  // namespace trilens
