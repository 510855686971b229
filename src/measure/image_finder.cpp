#include "measure/image_finder.h"

#include <algorithm>
#include <array>

#include "measure/image_query.h"
#include "measure/patch_batch.h"

namespace trilens {

const CellReach& ImageFinder::reach_of(int column, int row) const {
    return reaches_.get(reference_.cell_number(column, row),
                        [&] { return reach_of_cell(reference_, test_.field, column, row); });
}

std::vector<std::optional<Vec2>> ImageFinder::find(std::span<const SeenPoint> wanted, double reach) const {
    std::vector<std::optional<Vec2>> found(wanted.size());
    std::array<ImageQuery, kPatchLanes> queries;
    std::array<std::size_t, kPatchLanes> number{};
    PatchBatch batch;
    PatchCache patches(reference_, test_.field);
    std::optional<Vec2> last;
    std::size_t begun = 0;

    // Every query that ends makes room for the next point's; at the end the lanes run empty from the top.
    const auto refill = [&](std::size_t lane) {
        while (begun < wanted.size()) {
            number[lane] = begun++;
            queries[lane].begin(*this, wanted[number[lane]], reach, last);
            if (queries[lane].next(batch, lane, patches)) return true;
            found[number[lane]] = queries[lane].shift();
        }
        return false;
    };
    while (batch.count < kPatchLanes && refill(batch.count)) ++batch.count;
    while (batch.count > 0) {
        invert_patches(batch);
        const std::size_t asked = batch.count;
        for (std::size_t lane = 0; lane < asked; ++lane) queries[lane].take(batch, lane);
        for (std::size_t lane = 0; lane < batch.count;) {
            if (queries[lane].next(batch, lane, patches)) {
                ++lane;
                continue;
            }
            if (queries[lane].shift()) last = queries[lane].shift();
            found[number[lane]] = queries[lane].shift();
            if (refill(lane)) {
                ++lane;
                continue;
            }
            // The last lane's query moves here, and is asked in its turn.
            --batch.count;
            if (lane < batch.count) {
                queries[lane] = queries[batch.count];
                number[lane] = number[batch.count];
            }
        }
    }
    return found;
}

}  // namespace trilens
