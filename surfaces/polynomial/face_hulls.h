// Bounds of faces by the hull of their control points, which nothing has to be prepared for.
#pragma once

#include <optional>

#include "base/math/box.h"
#include "base/util/ids.h"

namespace trilens {

/// What a surface also is whose faces' hulls are known.
class HasHulls {
  public:
    virtual ~HasHulls() = default;
    /// A box that holds the face; none where nothing is known of it.
    virtual std::optional<Box> hull(Id face) const = 0;
};

}  // namespace trilens
