#include "measure/cell_reach.h"

#include <optional>

#include "measure/patch.h"

namespace trilens {

Box reach_of_cell(const SeenField& field, const SeenField& other, int column, int row) {
    Box box;
    for (int corner = 0; corner < 4; ++corner) {
        const int x = column + corner % 2, y = row + corner / 2;
        if (!field.contains(x, y)) continue;
        const SeenPoint seen = field.seen_point(field.index(x, y));
        for (const std::optional<Id> primitive : {std::optional<Id>(seen.primitive), std::optional<Id>()}) {
            const std::optional<Patch> patch =
                make_patch(field, other, {column, row, corner}, {seen.object, seen.optic, primitive});
            if (patch) box.include(reach_of(*patch));
        }
    }
    return box;
}

}  // namespace trilens
