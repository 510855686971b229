#include "measure/field/position_field.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/util/parallel.h"
#include "measure/common/comparable.h"

namespace trilens {
namespace {

/// Steps along one line of pixels, row or column.
struct Line {
    const PositionField& field;
    std::size_t first, stride;
    int count;

    std::size_t at(int i) const { return first + static_cast<std::size_t>(i) * stride; }

    /// The length of the step from pixel i to i + 1, or -1 where there is none within one object and optic.
    double step(int i) const {
        if (i < 0 || i + 1 >= count) return -1;
        const std::size_t a = at(i), b = at(i + 1);
        if (!field.sees(a) || !field.sees(b)) return -1;
        if ((*field.object)[a] != (*field.object)[b] || field.optic_of(a) != field.optic_of(b)) return -1;
        return length(field.point(b) - field.point(a));
    }
};

void link_line(const Line& line, std::uint8_t bit, std::vector<std::uint8_t>& links) {
    double before = -1, here = line.step(0);
    for (int i = 0; i + 1 < line.count; ++i) {
        const double after = line.step(i + 1);
        const double neighbour = std::max(before, after);
        const bool jump = neighbour > 0 && here > kJump * neighbour;
        if (here >= 0 && !jump) links[line.at(i)] |= bit;
        before = here;
        here = after;
    }
}

}  // namespace

FieldSample PositionField::seen_point(std::size_t i) const {
    const std::size_t columns = static_cast<std::size_t>(width);
    return {point(i),
            (*object)[i],
            optic_of(i),
            primitive_of(i),
            static_cast<int>(i % columns),
            static_cast<int>(i / columns)};
}

std::optional<PositionField> make_seen_field(const Image& image, const std::string& layer) {
    const auto channel = [&](const char* name) { return seen_channel(image, layer, name); };
    for (const char* name : {"object", "X", "Y", "Z"})
        if (!image.find(channel(name))) return std::nullopt;
    PositionField field;
    field.width = image.data_width;
    field.height = image.data_height;
    field.object = &id_channel(image, channel("object"));
    field.x = &float_channel(image, channel("X"));
    field.y = &float_channel(image, channel("Y"));
    field.z = &float_channel(image, channel("Z"));
    if (image.find("optic.object")) field.optic = &id_channel(image, "optic.object");
    if (image.find(channel("primitive"))) field.primitive = &id_channel(image, channel("primitive"));
    return field;
}

FieldWindow shown_window(const PositionField& field) {
    const std::size_t rows = static_cast<std::size_t>(field.height);
    // Of each row the first that shows the layer, and the one behind the last.
    std::vector<std::pair<int, int>> shown(rows);
    parallel_for(rows, 16, [&](std::size_t from, std::size_t to) {
        for (std::size_t row = from; row < to; ++row) {
            const std::size_t start = row * static_cast<std::size_t>(field.width);
            const auto shows = [&](int x) { return field.shows_layer(start + static_cast<std::size_t>(x)); };
            int first = 0, last = field.width;
            while (first < last && !shows(first)) ++first;
            while (last > first && !shows(last - 1)) --last;
            shown[row] = {first, last};
        }
    });
    FieldWindow window{field.width, 0, 0, 0};
    for (int row = 0; row < field.height; ++row) {
        const auto [first, last] = shown[static_cast<std::size_t>(row)];
        if (first == last) continue;
        if (window.x1 == 0) window.y0 = row;
        window = {std::min(window.x0, first), window.y0, std::max(window.x1, last), row + 1};
    }
    return window.x1 > 0 ? window : FieldWindow{};
}

void link_neighbours(PositionField& field) {
    link_neighbours(field, {0, 0, field.width, field.height});
}

void link_neighbours(PositionField& field, const FieldWindow& window) {
    const std::size_t columns = static_cast<std::size_t>(field.width),
                      rows = static_cast<std::size_t>(field.height);
    std::vector<std::uint8_t> links(columns * rows, 0);
    const int width = window.x1 - window.x0, height = window.y1 - window.y0;
    parallel_for(static_cast<std::size_t>(height), 16, [&](std::size_t first, std::size_t last) {
        for (int row = static_cast<int>(first); row < static_cast<int>(last); ++row)
            link_line({field, field.index(window.x0, window.y0 + row), 1, width}, PositionField::kRight,
                      links);
    });
    parallel_for(static_cast<std::size_t>(width), 64, [&](std::size_t first, std::size_t last) {
        for (int column = static_cast<int>(first); column < static_cast<int>(last); ++column)
            link_line({field, field.index(window.x0 + column, window.y0), columns, height},
                      PositionField::kDown, links);
    });
    field.links = std::move(links);
}

}  // namespace trilens
