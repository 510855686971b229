#include "measure/displacement/image_finder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "base/util/parallel.h"
#include "measure/displacement/image_query.h"
#include "measure/field/field_pyramid.h"
#include "measure/field/patch.h"
#include "measure/field/position_field.h"

namespace trilens {

std::shared_ptr<const ReferenceLayers::Layer> ReferenceLayers::get(const std::string& layer) const {
    const std::lock_guard guard(mutex_);
    const auto known = layers_.find(layer);
    if (known != layers_.end()) return known->second;
    std::shared_ptr<const Layer> made;
    // Others wait meanwhile: the loops in here must not take up their work.
    run_isolated([&] {
        std::optional<PositionField> field = make_seen_field(image_, layer);
        if (!field) return;
        FieldPyramid index(std::move(*field));
        std::vector<std::uint8_t> folds = near_folds(index.field);
        auto reaches = std::make_unique<LazyValues<FieldCellBounds>>(index.cell_count());
        made = std::make_shared<const Layer>(Layer{std::move(index), std::move(folds), std::move(reaches)});
    });
    layers_.emplace(layer, made);
    return made;
}

namespace {

/// Asks the queries that `next` names, one after the other until there is none, as many at a time as a batch
/// has lanes, and tells each the answers to its patches. `ended`: called with each that asks no more.
template <typename Next, typename Ended>
void answer(PatchCache& patches, Next&& next, Ended&& ended) {
    std::array<ImageQuery*, kPatchLanes> asking{};
    PatchBatch batch;
    // Every query that ends makes room for the next; at the end the lanes run empty from the top.
    const auto refill = [&](std::size_t lane) {
        while ((asking[lane] = next())) {
            if (asking[lane]->next(batch, lane, patches)) return true;
            ended(*asking[lane]);
        }
        return false;
    };
    while (batch.count < kPatchLanes && refill(batch.count)) ++batch.count;
    while (batch.count > 0) {
        invert_patches(batch);
        const std::size_t asked = batch.count;
        for (std::size_t lane = 0; lane < asked; ++lane) asking[lane]->take(batch, lane);
        for (std::size_t lane = 0; lane < batch.count;) {
            if (asking[lane]->next(batch, lane, patches)) {
                ++lane;
                continue;
            }
            ended(*asking[lane]);
            if (refill(lane)) {
                ++lane;
                continue;
            }
            // The last lane's query moves here, and is asked in its turn.
            --batch.count;
            if (lane < batch.count) asking[lane] = asking[batch.count];
        }
    }
}

/// The candidates of some queries.
struct Candidates {
    std::vector<CandidateCell> cells;
    std::vector<std::size_t> first;  // of each query, and behind the last
};

/// Of queries that wait, many at a time.
class CandidateSearch {
  public:
    explicit CandidateSearch(const ImageFinder& finder) : finder_(finder) {}

    void add_all(std::span<ImageQuery* const> waiting, Candidates& candidates) {
        for (std::size_t first = 0; first < waiting.size(); first += FieldPointPacket::kPoints)
            add(waiting.subspan(first, std::min(FieldPointPacket::kPoints, waiting.size() - first)),
                candidates);
        candidates.first.push_back(candidates.cells.size());
    }

  private:
    void add(std::span<ImageQuery* const> waiting, Candidates& candidates) {
        packet_.clear();
        for (const ImageQuery* query : waiting) packet_.add(query->wanted(), query->squared_reach());
        cells_.clear();
        find_cells(finder_.reference(), packet_, cells_);
        for (const CellOfMany& cell : cells_) {
            const FieldCellBounds& reach = finder_.reach_of(cell.column, cell.row);
            for (std::uint64_t left = held_by(reach, packet_, cell.points); left; left &= left - 1) {
                const std::size_t point = static_cast<std::size_t>(std::countr_zero(left));
                if (const auto candidate = waiting[point]->candidate(cell.column, cell.row))
                    found_[point].push_back(*candidate);
            }
        }
        for (std::size_t point = 0; point < waiting.size(); ++point) {
            std::vector<CandidateCell>& mine = found_[point];
            std::ranges::sort(mine, {}, &CandidateCell::distance);
            candidates.first.push_back(candidates.cells.size());
            candidates.cells.insert(candidates.cells.end(), mine.begin(), mine.end());
            mine.clear();
        }
    }

    const ImageFinder& finder_;
    FieldPointPacket packet_;
    std::vector<CellOfMany> cells_;
    std::array<std::vector<CandidateCell>, FieldPointPacket::kPoints> found_;
};

}  // namespace

const FieldCellBounds& ImageFinder::reach_of(int column, int row) const {
    constexpr std::uint8_t kNeedsNoOther = FieldPyramid::kWhole | FieldPyramid::kWholeTriangle;
    const bool is_kept = kept_ && reference_.wholeness(column, row) == kNeedsNoOther;
    return (is_kept ? *kept_ : reaches_).get(reference_.cell_number(column, row), [&] {
        return reach_of_cell(reference_, test_.field, column, row);
    });
}

std::vector<std::optional<Vec2>> ImageFinder::find(std::span<const FieldSample> wanted, double reach) const {
    std::vector<ImageQuery> queries(wanted.size());
    PatchCache patches(reference_, test_.field);

    // What lies next to the pixels, and where the points before were.
    std::optional<Vec2> last;
    std::size_t begun = 0;
    const auto begin_next = [&]() -> ImageQuery* {
        if (begun == wanted.size()) return nullptr;
        queries[begun].begin(*this, wanted[begun], reach, last);
        return &queries[begun++];
    };
    std::vector<ImageQuery*> waiting;
    answer(patches, begin_next, [&](ImageQuery& query) {
        if (query.shift()) last = query.shift();
    });
    for (ImageQuery& query : queries)
        if (query.waits_for_cells()) waiting.push_back(&query);

    Candidates candidates;
    CandidateSearch(*this).add_all(waiting, candidates);
    std::size_t asked = 0;
    const auto next_waiting = [&]() -> ImageQuery* {
        if (asked == waiting.size()) return nullptr;
        const std::size_t first = candidates.first[asked];
        waiting[asked]->give(std::span(candidates.cells).subspan(first, candidates.first[asked + 1] - first));
        return waiting[asked++];
    };
    answer(patches, next_waiting, [](ImageQuery&) {});

    std::vector<std::optional<Vec2>> found(wanted.size());
    for (std::size_t i = 0; i < found.size(); ++i) found[i] = queries[i].shift();
    return found;
}

}  // namespace trilens
