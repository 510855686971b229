// Pairs of pixels and world points, from text.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <string_view>

#include "base/util/error.h"
#include "base/util/names.h"
#include "inverse/fit/fit.h"
#include "json/json.h"

namespace trilens {
namespace {

std::vector<std::string> cells_of(std::string_view line) {
    std::vector<std::string> cells;
    while (true) {
        const std::size_t comma = line.find(',');
        std::string_view cell = line.substr(0, comma);
        const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '"'; };
        while (!cell.empty() && is_blank(cell.front())) cell.remove_prefix(1);
        while (!cell.empty() && is_blank(cell.back())) cell.remove_suffix(1);
        cells.emplace_back(cell);
        if (comma == std::string_view::npos) return cells;
        line.remove_prefix(comma + 1);
    }
}

std::optional<double> number_in_cell(std::string_view text) {
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool is_one = error == std::errc() && end == text.data() + text.size();
    return is_one && std::abs(value) <= kLargestCoordinate ? std::optional(value) : std::nullopt;
}

const std::vector<std::string> kPairColumns{"x", "y", "X", "Y", "Z", "sigma", "camera", "path", "image"};

/// Which column each cell of a line is; from a header, or the first five.
class PairColumns {
  public:
    explicit PairColumns(const std::string& name)
        : name_(name), columns_(kPairColumns.begin(), kPairColumns.begin() + 5) {}

    [[noreturn]] void fail(const std::string& message) const {
        throw InputError(name_, "line " + std::to_string(line_), one_line(message));
    }

    /// Takes a line; a pair where it is one.
    std::optional<Correspondence> take(std::string_view text) {
        ++line_;
        if (line_ == 1 && text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
        if (text.find_first_not_of(" \t\r") == std::string_view::npos || text.front() == '#')
            return std::nullopt;
        const std::vector<std::string> cells = cells_of(text);
        const bool is_header = !has_lines_ && !number_in_cell(cells.front());
        has_lines_ = true;
        if (!is_header) return pair_of(cells);
        take_header(cells);
        return std::nullopt;
    }

  private:
    void take_header(const std::vector<std::string>& cells) {
        for (const std::string& cell : cells) {
            if (std::find(kPairColumns.begin(), kPairColumns.end(), cell) == kPairColumns.end())
                fail("there is no column \"" + cell + "\"" + suggestion(cell, kPairColumns));
            if (std::count(cells.begin(), cells.end(), cell) > 1)
                fail("the column \"" + cell + "\" stands twice");
        }
        for (std::size_t k = 0; k < 5; ++k)
            if (std::find(cells.begin(), cells.end(), kPairColumns[k]) == cells.end())
                fail("the header lacks the column \"" + kPairColumns[k] +
                     "\": x, y are the pixel, X, Y, Z the world point");
        columns_ = cells;
    }

    Correspondence pair_of(const std::vector<std::string>& cells) const {
        if (cells.size() != columns_.size())
            fail("has " + std::to_string(cells.size()) + " values, not " + std::to_string(columns_.size()));
        Correspondence pair;
        pair.place = name_ + ": line " + std::to_string(line_);
        const std::map<std::string, double*> numbers{{"x", &pair.pixel.x}, {"y", &pair.pixel.y},
                                                     {"X", &pair.point.x}, {"Y", &pair.point.y},
                                                     {"Z", &pair.point.z}, {"sigma", &pair.sigma}};
        for (std::size_t k = 0; k < cells.size(); ++k) {
            const std::string &column = columns_[k], &cell = cells[k];
            if (column == "camera") {
                pair.camera = cell;
            } else if (column == "path") {
                pair.path = cell;
            } else if (!cell.empty() || (column != "sigma" && column != "image")) {
                const std::optional<double> value = number_in_cell(cell);
                if (!value) fail(column + " needs a number within 1e30, not \"" + cell + "\"");
                if (column == "sigma" && !(*value > 0)) fail("sigma is not above 0: " + cell);
                if (column != "image") {
                    *numbers.at(column) = *value;
                } else {
                    if (!(*value >= 0 && *value <= 1e6) || *value != std::floor(*value))
                        fail("image is no whole number from 0: " + cell);
                    pair.image = static_cast<int>(*value);
                }
            }
        }
        return pair;
    }

    std::string name_;
    std::vector<std::string> columns_;
    std::size_t line_ = 0;
    bool has_lines_ = false;
};

}  // namespace

std::vector<Correspondence> parse_correspondences(const std::string& text, const std::string& name) {
    PairColumns columns(name);
    std::vector<Correspondence> pairs;
    std::string_view rest = text;
    while (!rest.empty()) {
        const std::size_t end = std::min(rest.find('\n'), rest.size());
        if (const std::optional<Correspondence> pair = columns.take(rest.substr(0, end)))
            pairs.push_back(*pair);
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    if (pairs.empty()) throw InputError(name, "", "holds no pairs");
    return pairs;
}

std::vector<Correspondence> read_correspondences(const std::string& file) {
    return parse_correspondences(read_required_file(file), file);
}

}  // namespace trilens
