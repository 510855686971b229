// Which samples of a block see a triangle (mathematics, section 2).
#pragma once

#include <array>

#include "projector/blocks/block_rays.h"
#include "projector/exact/first_hits.h"

namespace trilens {

/// A triangle as a block sees it.
struct LocalTriangle {
    std::array<Vec3, 3> corner{};  // from the block's centre
    Id index = 0;                  // into PreparedScene::Data
    Id rank = 0;
};

/// Offers the triangle to every sample whose ray's line meets it, as decide() says. Most of those that miss
/// are told by the edges' conics.
void draw_triangle(const BlockRays& block, const LocalTriangle& triangle, FirstHits& hits);

}  // namespace trilens
