// Labels that lie on one another: which of them a picture leaves out.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "render/marks/marks.h"
#include "render/world/world.h"

namespace trilens {
namespace {

/// Boxes on the film by the tiles that they reach into: what meets one is found without asking all.
class TakenBoxes {
  public:
    explicit TakenBoxes(const Film& film) : film_{Vec2(0), Vec2(film.width, film.height)} {}

    bool meets(const FilmBox& whole) const {
        const FilmBox box = whole.common(film_);
        bool found = false;
        for_each_tile(box, [&](const std::pair<int, int>& tile) {
            const auto taken = of_tile_.find(tile);
            if (taken == of_tile_.end()) return;
            found = found || std::any_of(taken->second.begin(), taken->second.end(),
                                         [&box](const FilmBox& other) { return box.meets(other); });
        });
        return found;
    }
    void add(const FilmBox& whole) {
        const FilmBox box = whole.common(film_);
        for_each_tile(box, [&](const std::pair<int, int>& tile) { of_tile_[tile].push_back(box); });
    }

  private:
    template <typename Body>
    static void for_each_tile(const FilmBox& box, const Body& body) {
        if (box.is_empty()) return;
        constexpr double kSide = 64;
        const auto tile = [](double at) { return static_cast<int>(std::floor(at / kSide)); };
        for (int y = tile(box.low.y); y <= tile(box.high.y); ++y)
            for (int x = tile(box.low.x); x <= tile(box.high.x); ++x) body(std::pair(x, y));
    }
    FilmBox film_;
    std::map<std::pair<int, int>, std::vector<FilmBox>> of_tile_;
};

}  // namespace

void leave_out_crowded(const World& world, PlacedMarks& marks) {
    const auto label_of = [&world](const PlacedMark& mark) -> const Label& {
        return world.scene.labels[mark.entry];
    };
    if (std::none_of(marks.marks.begin(), marks.marks.end(),
                     [&](const PlacedMark& mark) { return mark.is_label && label_of(mark).gives_way; }))
        return;
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < marks.marks.size(); ++i)
        if (marks.marks[i].is_label) order.push_back(i);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t k) {
        const PlacedMark &a = marks.marks[i], &b = marks.marks[k];
        const Label &of_a = label_of(a), &of_b = label_of(b);
        if (of_a.gives_way != of_b.gives_way) return of_b.gives_way;
        if (of_a.priority != of_b.priority) return of_a.priority > of_b.priority;
        return a.distance != b.distance ? a.distance < b.distance : a.entry < b.entry;
    });
    TakenBoxes taken(world.scene.film);
    std::vector<char> is_out(marks.marks.size(), 0);
    for (const std::size_t i : order) {
        const std::array<FilmBox, 2> boxes = mark_boxes(world, marks.marks[i]);
        is_out[i] = label_of(marks.marks[i]).gives_way && (taken.meets(boxes[0]) || taken.meets(boxes[1]));
        if (is_out[i]) ++marks.crowded_out;
        if (is_out[i]) continue;
        for (const FilmBox& box : boxes) taken.add(box);
    }
    if (marks.crowded_out == 0) return;
    std::vector<PlacedMark> kept;
    for (std::size_t i = 0; i < marks.marks.size(); ++i)
        if (!is_out[i]) kept.push_back(marks.marks[i]);
    marks.marks = std::move(kept);
}

}  // namespace trilens
