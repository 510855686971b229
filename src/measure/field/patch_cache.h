// Patches made of late: neighbouring pixels ask for the same ones again and again.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "measure/field/field_pyramid.h"
#include "measure/field/patch.h"

namespace trilens {

/// One thread's. A patch is the same whether it was kept or is made.
class PatchCache {
  public:
    /// `other`: as make_patch has it. Both must outlive it.
    PatchCache(const FieldPyramid& index, const PositionField& other)
        : index_(index), other_(other), entries_(kEntries) {}

    /// make_patch of the piece that the corner of the cell shows, of its own triangle alone or whole. Stays
    /// until the next call.
    const std::optional<Patch>& get(const PatchPlace& place, bool is_triangle) {
        const std::size_t key =
            (index_.cell_number(place.column, place.row) * 4 + static_cast<std::size_t>(place.corner)) * 2 +
            (is_triangle ? 1 : 0);
        Entry& entry = entries_[(key ^ key >> 9) % kEntries];
        if (entry.key != key + 1) {
            entry.patch = make(place, is_triangle);
            entry.key = key + 1;
        }
        return entry.patch;
    }

  private:
    static constexpr std::size_t kEntries = 2048;
    struct Entry {
        std::size_t key = 0;  // one more than the patch's; 0: none yet
        std::optional<Patch> patch;
    };

    std::optional<Patch> make(const PatchPlace& place, bool is_triangle) const {
        const PositionField& field = index_.field;
        const FieldSample seen =
            field.seen_point(field.index(place.column + place.corner % 2, place.row + place.corner / 2));
        SurfaceId piece{seen.object, seen.optic, std::nullopt};
        if (is_triangle) piece.primitive = seen.primitive;
        return make_patch(field, other_, place, piece);
    }

    const FieldPyramid& index_;
    const PositionField& other_;
    std::vector<Entry> entries_;
};

}  // namespace trilens
