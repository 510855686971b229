// Whether all rays of a facet have one history: beams against the patches of all optics, conservatively.
#pragma once

#include <functional>

#include "paths/facets/divide_facet.h"

namespace trilens {

/// What is asked about a part of a facet.
struct HistoryProof {
    const ProbeContext& context;
    const FacetPart& part;  // projected: with its histories, corners and what was probed inside
    /// Whether an optic that the first reflection may meet is drawn over it, wherever it is met. Unset: none
    /// is.
    std::function<bool(Id optic)> drawn_over = {};
    /// Whether the camera's own rays are to be proven to meet the optic too, in one sheet: facets on the
    /// film.
    bool from_camera = false;
};

/// Proof that every ray between those that were probed has the part's histories: between one optic and the
/// next each beam, from the hull of its rays, touches no patch of any optic but those where it starts and
/// where its history has it arrive; there it crosses no silhouette (the cone of normals against that of
/// directions), no crease and no border; and no refraction passes the critical angle. False where that cannot
/// be shown.
///
/// Optics without patches (PathOptic::patches) are not asked. What is proven is proven for rays that change
/// between the samples as Beam allows. Paths too faint to be matched are not asked either.
bool has_one_history(const HistoryProof& proof);

/// Whether all rays of a part that were probed come, after its history h, to where an optic lies on an
/// object: that is what they see, whatever follows. False where its centre was not probed.
bool rests_on_object(const FacetPart& part, std::size_t h);

}  // namespace trilens
