// Finds where a reference image shows what a pixel of another sees, nearest to that pixel.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "base/ids.h"
#include "base/vec.h"
#include "measure/cell_reach.h"
#include "measure/patch.h"
#include "measure/seen_field.h"

namespace trilens {

/// A reference field with a pyramid of bounding boxes over its cells. Holds the fields' views, not their
/// images.
class ImageFinder {
  public:
    /// `test`: the field that points are looked for from, of the same size; it guides the reference beyond
    /// its borders.
    ImageFinder(SeenField reference, SeenField test);

    /// Both with their links.
    const SeenField& reference() const { return field_; }
    const SeenField& test() const { return test_; }

    /// The screen vector from the pixel to the nearest place where the reference shows the point that `test`
    /// sees there; nothing where there is none. A place more than `reach` pixels away need not be found.
    /// Pixels of the point's own triangle are preferred to others of its object. Where the reference shows
    /// nearly the point at the pixel or next to it, but cannot say where, a place farther away than the
    /// slopes there allow is another image of the point (a curved mirror may show it several times) and no
    /// answer.
    std::optional<Vec2> find(const SeenPoint& wanted, double reach) const;

  private:
    struct Box {
        std::array<float, 3> low, high;  // empty: low > high
    };
    struct Level {
        int columns = 0, rows = 0;
        std::vector<Box> boxes;
    };
    struct Best {
        double score = 0;  // pixels; distance and penalties
        std::optional<Vec2> shift;
    };

    Box cell_box(int column, int row) const;
    void build_pyramid();
    void number_ends();
    bool may_show(const Vec3& point, int column, int row) const;
    const Box& box_at(int level, int column, int row) const;
    std::array<int, 2> likely_side(const SeenPoint& wanted) const;
    void try_cell(const SeenPoint& wanted, int column, int row, Best& best) const;
    bool try_pieces(const SeenPoint& wanted, int column, int row, bool same_primitive, Best& best) const;
    void search(const SeenPoint& wanted, Best& best) const;
    bool has_patch(const SeenPoint& wanted) const;
    double farthest(const SeenPoint& wanted) const;

    SeenField field_, test_;
    std::vector<Level>
        levels_;  // the first has one box per cell; cell (column, row) is entry (column + 1, row + 1)
    // Cells where a piece ends have wide boxes there; what their patches show is asked for cell by cell.
    std::vector<Id> end_of_cell_;  // per cell its index into end_reach_, or kNone
    mutable LazyBoxes end_reach_;
};

}  // namespace trilens
