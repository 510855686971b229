#include "inverse/anamorph/paper.h"

#include <array>
#include <utility>
#include <vector>

#include "base/util/error.h"
#include "base/util/names.h"
#include "inverse/maps/number_list.h"

namespace trilens {
namespace {

using NamedPaper = std::pair<const char*, PaperSize>;
constexpr std::array<NamedPaper, 10> kPapers{{{"A0", {841, 1189}},
                                              {"A1", {594, 841}},
                                              {"A2", {420, 594}},
                                              {"A3", {297, 420}},
                                              {"A4", {210, 297}},
                                              {"A5", {148, 210}},
                                              {"A6", {105, 148}},
                                              {"letter", {215.9, 279.4}},
                                              {"legal", {215.9, 355.6}},
                                              {"tabloid", {279.4, 431.8}}}};

using NamedUnit = std::pair<const char*, double>;
constexpr std::array<NamedUnit, 7> kUnits{
    {{"mm", 1e-3}, {"cm", 1e-2}, {"dm", 0.1}, {"m", 1}, {"km", 1e3}, {"in", 0.0254}, {"ft", 0.3048}}};

template <class Table>
std::vector<std::string> names_in(const Table& table) {
    std::vector<std::string> names;
    for (const auto& [name, value] : table) names.emplace_back(name);
    return names;
}

}  // namespace

PaperSize parse_paper(const std::string& text) {
    for (const auto& [name, size] : kPapers)
        if (text == name) return size;
    const std::size_t x = text.find('x');
    if (x != std::string::npos) {
        std::string height = text.substr(x + 1);
        if (height.ends_with("mm")) height.resize(height.size() - 2);
        const auto w = number_list(text.substr(0, x)), h = number_list(height);
        if (w && h && w->size() == 1 && h->size() == 1 && w->front() > 0 && h->front() > 0 &&
            w->front() <= 1e5 && h->front() <= 1e5)
            return {w->front(), h->front()};
    }
    const std::vector<std::string> names = names_in(kPapers);
    throw UsageError("there is no paper \"" + text + "\" (WxH in millimetres is one)" +
                     suggestion(text, names));
}

double parse_unit(const std::string& text) {
    for (const auto& [name, metres] : kUnits)
        if (text == name) return metres;
    const std::vector<std::string> names = names_in(kUnits);
    throw UsageError("there is no unit \"" + text + "\"" + suggestion(text, names));
}

double parse_length(const std::string& text) {
    const std::size_t end = text.find_last_of("0123456789.");
    const auto number = number_list(text.substr(0, end == std::string::npos ? 0 : end + 1));
    const std::string unit = end == std::string::npos ? text : text.substr(end + 1);
    if (!number || number->size() != 1 || number->front() < 0)
        throw UsageError("a length is a number with its unit, as 2mm, not \"" + text + "\"");
    return number->front() * (unit.empty() ? 1 : parse_unit(unit) * 1000);
}

}  // namespace trilens
