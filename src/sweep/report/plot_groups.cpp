#include "sweep/report/plot_groups.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <map>
#include <set>

namespace trilens {
namespace {

constexpr std::size_t kMostLines = 8;

/// A word speaks for itself, a number needs its axis.
std::string words_of(const Coordinates& point) {
    std::string text;
    for (const Coordinate& one : point)
        text += (text.empty() ? "" : ", ") + (one.value.number ? point_text({one}) : one.value.text);
    return text;
}

/// The names of the axes, from the last on, whose combinations are few enough for one plot; an axis with too
/// many values is passed over.
std::set<std::string> line_axes(const std::vector<RunGroup>& groups) {
    std::set<std::string> lines;
    if (groups.empty()) return lines;
    const Coordinates& pattern = groups[0].at;
    for (std::size_t i = pattern.size(); i-- > 0;) {
        std::set<std::string> longer = lines;
        longer.insert(pattern[i].axis);
        std::map<std::string, std::set<std::string>> by_plot;
        for (const RunGroup& group : groups) {
            Coordinates inner = group.at, outer = group.at;
            std::erase_if(inner, [&](const Coordinate& one) { return longer.count(one.axis) == 0; });
            std::erase_if(outer, [&](const Coordinate& one) { return longer.count(one.axis) > 0; });
            by_plot[point_text(outer)].insert(point_text(inner));
        }
        const bool is_few =
            std::ranges::all_of(by_plot, [](const auto& plot) { return plot.second.size() <= kMostLines; });
        if (is_few) lines = longer;
    }
    return lines;
}

std::string file_end(const Coordinates& outer) {
    std::string name;
    for (const Coordinate& one : outer)
        for (const char c : "_" + one.value.text)
            name += std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.' ? c : '-';
    return name;
}

}  // namespace

std::vector<PlotGroups> plot_groups(const std::vector<RunGroup>& groups) {
    const std::set<std::string> lines = line_axes(groups);
    std::vector<PlotGroups> plots;
    std::map<std::string, std::size_t> known;
    for (const RunGroup& group : groups) {
        Coordinates inner = group.at, outer = group.at;
        std::erase_if(inner, [&](const Coordinate& one) { return lines.count(one.axis) == 0; });
        std::erase_if(outer, [&](const Coordinate& one) { return lines.count(one.axis) > 0; });
        const auto [place, is_new] = known.emplace(point_text(outer), plots.size());
        if (is_new) plots.push_back({words_of(outer), file_end(outer), {}});
        const std::string name = words_of(inner);
        plots[place->second].groups.push_back({name.empty() ? "all" : name, group.at, group.runs});
    }
    // Two plots of one file's name: told apart by number.
    std::map<std::string, int> uses;
    for (PlotGroups& plot : plots)
        if (const int use = uses[plot.file]++; use > 0) plot.file += "-" + std::to_string(use + 1);
    return plots;
}

const MetricValues* find_displacement(const RunRecord& run, const std::string& layer,
                                      const std::string& optic) {
    for (const OpticDisplacement& one : run.displacement)
        if (one.layer == layer && one.optic == optic) return &one.metrics;
    return nullptr;
}

}  // namespace trilens
