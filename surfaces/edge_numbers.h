// Numbers for edges: the same for every face that runs along the same two ends, in either direction.
#pragma once

#include <algorithm>
#include <cstdint>
#include <unordered_map>

#include "base/raymesh/surface.h"

namespace trilens {

/// Hands out edge ids 0, 1, ... in the order in which edges are first asked for. An edge's own direction is
/// from its smaller to its larger end.
class EdgeNumbers {
  public:
    /// The whole edge as a side that runs from one end to the other; no edge where the ends are the same.
    FaceSide side(Id from, Id to) {
        if (from == to) return {};
        const std::uint64_t key = (std::uint64_t{std::min(from, to)} << 32) | std::max(from, to);
        const Id edge = number_.try_emplace(key, static_cast<Id>(number_.size())).first->second;
        return {edge, FaceSide::Part::kWhole, from > to};
    }
    Id size() const { return static_cast<Id>(number_.size()); }

  private:
    std::unordered_map<std::uint64_t, Id> number_;
};

}  // namespace trilens
