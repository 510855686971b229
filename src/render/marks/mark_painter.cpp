#include <algorithm>
#include <cmath>

#include "base/math/luminance.h"
#include "render/marks/marks.h"
#include "render/world/world.h"

namespace trilens {
namespace {

constexpr int kTile = 8;          // pixels along a side
constexpr int kCoverageSide = 4;  // places along a pixel's side that are asked whether a splat covers them
constexpr int kHalo = 2;          // pixels around letters
constexpr double kHaloOpacity = 0.75;

struct PixelBox {
    int x0 = 0, y0 = 0, x1 = -1, y1 = -1;  // with both ends
};

const TextMask* letters_of(const World& world, const PlacedMark& mark) {
    return mark.is_label ? world.scene.labels[mark.entry].letters.get() : nullptr;
}

/// All that a mark may cover.
PixelBox box_of(const World& world, const PlacedMark& mark) {
    const std::array<FilmBox, 2> boxes = mark_boxes(world, mark);
    const Vec2 low = glm::min(boxes[0].low, boxes[1].low), high = glm::max(boxes[0].high, boxes[1].high);
    const Film& film = world.scene.film;
    const auto whole = [](double at, int most) {
        return static_cast<int>(std::floor(std::clamp(at, -1.0, static_cast<double>(most))));
    };
    return {std::max(0, whole(low.x, film.width)), std::max(0, whole(low.y, film.height)),
            std::min(film.width - 1, whole(high.x, film.width)),
            std::min(film.height - 1, whole(high.y, film.height))};
}

/// The share of the pixel at x, y that the mark's ellipse covers.
double covered(const PlacedMark& mark, int x, int y) {
    const Spread& s = mark.spread;
    const double determinant = s.determinant();
    if (!(determinant > 0)) return 0;
    int inside = 0;
    for (int j = 0; j < kCoverageSide; ++j)
        for (int i = 0; i < kCoverageSide; ++i) {
            const Vec2 d = Vec2(x + (i + 0.5) / kCoverageSide, y + (j + 0.5) / kCoverageSide) - mark.pixel;
            inside += s.yy * d.x * d.x - 2 * s.xy * d.x * d.y + s.xx * d.y * d.y <= determinant;
        }
    return static_cast<double>(inside) / (kCoverageSide * kCoverageSide);
}

/// A mask's value at a place from its corner, linear between the centres of its pixels.
double mask_at(const TextMask& mask, const Vec2& place) {
    const auto value = [&](int x, int y) {
        if (x < 0 || y < 0 || x >= mask.width || y >= mask.height) return 0.0;
        return static_cast<double>(
            mask.coverage[static_cast<std::size_t>(y) * static_cast<std::size_t>(mask.width) +
                          static_cast<std::size_t>(x)]);
    };
    const double fx = std::floor(place.x - 0.5), fy = std::floor(place.y - 0.5);
    const double u = place.x - 0.5 - fx, v = place.y - 0.5 - fy;
    const int x = static_cast<int>(fx), y = static_cast<int>(fy);
    return (1 - v) * ((1 - u) * value(x, y) + u * value(x + 1, y)) +
           v * ((1 - u) * value(x, y + 1) + u * value(x + 1, y + 1));
}

/// The most that letters cover within kHalo of a place.
double halo_at(const TextMask& mask, const Vec2& place) {
    double most = 0;
    for (int dy = -kHalo; dy <= kHalo; ++dy)
        for (int dx = -kHalo; dx <= kHalo; ++dx)
            if (dx * dx + dy * dy <= kHalo * kHalo)
                most = std::max(most, mask_at(mask, place + Vec2(dx, dy)));
    return most;
}

}  // namespace

Vec3 contrast_of(const Vec3& color) {
    return Vec3(luminance(color) > 0.2 ? 0 : 1);
}

Vec2 MarkPainter::text_corner(const World& world, const PlacedMark& mark) {
    const Label& label = world.scene.labels[mark.entry];
    const Vec2 left = mark.pixel + label.offset;
    // Whole pixels, so that letters are as sharp as they were drawn.
    return Vec2(std::round(left.x), std::round(left.y - 0.5 * (label.letters ? label.letters->height : 0)));
}

MarkPainter::MarkPainter(const World& world, const PlacedMarks& marks,
                         const std::function<Vec3(const Vec3& light)>& shown)
    : world_(world), marks_(marks), shown_(shown) {
    const Film& film = world.scene.film;
    columns_ = (film.width + kTile - 1) / kTile;
    const int rows = (film.height + kTile - 1) / kTile;
    const auto for_each_tile = [&](const PlacedMark& mark, const auto& body) {
        const PixelBox box = box_of(world, mark);
        for (int y = box.y0 / kTile; box.y1 >= box.y0 && y <= box.y1 / kTile; ++y)
            for (int x = box.x0 / kTile; box.x1 >= box.x0 && x <= box.x1 / kTile; ++x)
                body(static_cast<std::size_t>(y * columns_ + x));
    };
    first_.assign(static_cast<std::size_t>(columns_ * rows) + 1, 0);
    for (const PlacedMark& mark : marks.marks)
        for_each_tile(mark, [&](std::size_t tile) { ++first_[tile + 1]; });
    for (std::size_t tile = 1; tile < first_.size(); ++tile) first_[tile] += first_[tile - 1];
    of_tile_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < marks.marks.size(); ++i)
        for_each_tile(marks.marks[i], [&](std::size_t tile) { of_tile_[next[tile]++] = static_cast<Id>(i); });
}

void MarkPainter::cover(const Paint& paint, double share, SampleColour& colour) {
    const double stays = 1 - share * paint.replaces;
    if (paint.path == Path::kDirect) {
        colour.direct = stays * colour.direct + share * paint.light;
        colour.reflect *= stays;
        colour.refract *= stays;
    } else {
        Vec3& part = paint.path == Path::kReflect ? colour.reflect : colour.refract;
        part = stays * part + share * paint.light;
    }
    colour.coverage = 1 - (1 - share) * (1 - colour.coverage);
}

/// Letters on a halo that is as far from their colour as it can be.
void MarkPainter::paint_text(const PlacedMark& mark, const Vec2& pixel, SampleColour& colour) const {
    const TextMask& letters = *letters_of(world_, mark);
    const Vec2 place = pixel + Vec2(0.5) - text_corner(world_, mark);
    const Vec3 around = contrast_of(mark.light);
    if (const double halo = halo_at(letters, place); halo > 0)
        cover({shown_ ? shown_(around) : around}, kHaloOpacity * halo, colour);
    if (const double ink = mask_at(letters, place); ink > 0)
        cover({shown_ ? shown_(mark.light) : mark.light}, ink, colour);
}

void MarkPainter::paint(int x, int y, Id shown, SampleColour& colour) const {
    const std::size_t tile = static_cast<std::size_t>(y / kTile * columns_ + x / kTile);
    for (std::size_t i = first_[tile]; i < first_[tile + 1]; ++i) {
        const PlacedMark& mark = marks_.marks[of_tile_[i]];
        // A label is no part of the scene's light: it hides all that is there. A splat does not reach over
        // the rim of the optic that shows it.
        const bool is_over = mark.is_label || mark.path == Path::kDirect;
        if (is_over || mark.optic == shown)
            if (const double share = mark.opacity * covered(mark, x, y); share > 0)
                cover({shown_ ? shown_(mark.light) : mark.light, mark.replaces,
                       is_over ? Path::kDirect : mark.path},
                      share, colour);
        if (letters_of(world_, mark)) paint_text(mark, Vec2(x, y), colour);
    }
}

std::array<FilmBox, 2> mark_boxes(const World& world, const PlacedMark& mark) {
    const Vec2 half(std::sqrt(mark.spread.xx), std::sqrt(mark.spread.yy));
    const FilmBox dot{mark.pixel - half, mark.pixel + half};
    const TextMask* letters = letters_of(world, mark);
    if (!letters) return {dot, FilmBox{mark.pixel, mark.pixel}};
    const Vec2 corner = MarkPainter::text_corner(world, mark);
    return {dot,
            FilmBox{corner - Vec2(kHalo), corner + Vec2(letters->width + kHalo, letters->height + kHalo)}};
}

}  // namespace trilens
