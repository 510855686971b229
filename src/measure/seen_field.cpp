#include "measure/seen_field.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "measure/comparable.h"

namespace trilens {
namespace {

/// Steps along one line of pixels, row or column.
struct Line {
    const SeenField& field;
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

SeenPoint SeenField::seen_point(std::size_t i) const {
    const std::size_t columns = static_cast<std::size_t>(width);
    return {point(i),
            (*object)[i],
            optic_of(i),
            primitive_of(i),
            static_cast<int>(i % columns),
            static_cast<int>(i / columns)};
}

std::optional<SeenField> make_seen_field(const Image& image, const std::string& layer) {
    const auto channel = [&](const char* name) { return seen_channel(image, layer, name); };
    for (const char* name : {"object", "X", "Y", "Z"})
        if (!image.find(channel(name))) return std::nullopt;
    SeenField field;
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

void link_neighbours(SeenField& field) {
    const std::size_t columns = static_cast<std::size_t>(field.width),
                      rows = static_cast<std::size_t>(field.height);
    std::vector<std::uint8_t> links(columns * rows, 0);
    parallel_for(rows, 16, [&](std::size_t first, std::size_t last) {
        for (std::size_t row = first; row < last; ++row)
            link_line({field, row * columns, 1, field.width}, SeenField::kRight, links);
    });
    parallel_for(columns, 64, [&](std::size_t first, std::size_t last) {
        for (std::size_t column = first; column < last; ++column)
            link_line({field, column, columns, field.height}, SeenField::kDown, links);
    });
    field.links = std::move(links);
}

}  // namespace trilens
