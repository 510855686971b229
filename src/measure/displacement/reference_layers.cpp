#include "measure/displacement/reference_layers.h"

#include <utility>

#include "base/util/parallel.h"
#include "measure/field/folds.h"

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

}  // namespace trilens
