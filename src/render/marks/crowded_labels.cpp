// Labels that lie on one another: which of them a picture leaves out.
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "render/marks/marks.h"
#include "render/world/world.h"

namespace trilens {
namespace {

/// Boxes by the tiles that they reach into: what meets one is found without asking all.
class TakenBoxes {
  public:
    bool meets(const FilmBox& box) const {
        bool found = false;
        for_each_tile(box, [&](const std::pair<int, int>& tile) {
            const auto taken = of_tile_.find(tile);
            if (taken == of_tile_.end()) return;
            found = found || std::any_of(taken->second.begin(), taken->second.end(),
                                         [&box](const FilmBox& other) { return box.meets(other); });
        });
        return found;
    }
    void add(const FilmBox& box) {
        for_each_tile(box, [&](const std::pair<int, int>& tile) { of_tile_[tile].push_back(box); });
    }

  private:
    template <typename Body>
    static void for_each_tile(const FilmBox& box, const Body& body) {
        constexpr double kSide = 64;
        const auto tile = [](double at) { return static_cast<int>(std::floor(at / kSide)); };
        for (int y = tile(box.low.y); y <= tile(box.high.y); ++y)
            for (int x = tile(box.low.x); x <= tile(box.high.x); ++x) body(std::pair(x, y));
    }
    std::map<std::pair<int, int>, std::vector<FilmBox>> of_tile_;
};

}  // namespace

void leave_out_crowded(const World& world, PlacedMarks& marks) {
    const auto label_of = [&world](const PlacedMark& mark) -> const Label& {
        return world.scene.labels[mark.entry];
    };
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
    TakenBoxes taken;
    std::vector<char> is_out(marks.marks.size(), 0);
    for (const std::size_t i : order) {
        const FilmBox box = label_box(world, marks.marks[i]);
        is_out[i] = label_of(marks.marks[i]).gives_way && taken.meets(box);
        if (is_out[i]) ++marks.crowded_out;
        if (!is_out[i]) taken.add(box);
    }
    if (marks.crowded_out == 0) return;
    std::vector<PlacedMark> kept;
    for (std::size_t i = 0; i < marks.marks.size(); ++i)
        if (!is_out[i]) kept.push_back(marks.marks[i]);
    marks.marks = std::move(kept);
}

}  // namespace trilens
