// Edit distance with swaps of neighbours (Damerau 1964, optimal string alignment), over lower-case letters.
#include "base/util/names.h"

#include <algorithm>
#include <cctype>
#include <vector>

namespace trilens {
namespace {

constexpr std::size_t kLongestName = 64;  // longer ones are no typing mistakes
constexpr std::size_t kMostListed = 24;

std::string lower(std::string text) {
    for (char& letter : text) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    return text;
}

std::size_t edit_distance(const std::string& a, const std::string& b) {
    std::vector<std::vector<std::size_t>> cost(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) cost[i][0] = i;
    for (std::size_t j = 0; j <= b.size(); ++j) cost[0][j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = cost[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            cost[i][j] = std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1, replaced});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
        }
    }
    return cost[a.size()][b.size()];
}

}  // namespace

std::string suggestion(const std::string& unknown, std::span<const std::string> known) {
    if (known.empty()) return "; there are none";
    const std::string* nearest = nullptr;
    std::size_t smallest = kLongestName;
    for (const std::string& name : known) {
        if (unknown.size() > kLongestName || name.size() > kLongestName) continue;
        const std::size_t distance = edit_distance(lower(unknown), lower(name));
        const std::size_t allowed = (std::max(unknown.size(), name.size()) + 2) / 3;
        if (distance > allowed || distance >= smallest) continue;
        smallest = distance;
        nearest = &name;
    }
    if (nearest) return "; did you mean '" + *nearest + "'?";
    std::string list = "; known: ";
    for (std::size_t i = 0; i < std::min(known.size(), kMostListed); ++i)
        list += (i == 0 ? "" : ", ") + known[i];
    return known.size() > kMostListed ? list + ", ..." : list;
}

}  // namespace trilens
