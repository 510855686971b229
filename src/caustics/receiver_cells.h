// A receiver's footprint where the surface under it is no plane, cell by cell.
#pragma once

#include <vector>

#include "caustics/receiver_faces.h"
#include "intersect/tracer.h"
#include "shade/receiver.h"

namespace trilens {

/// What lies under a receiver: the triangles it may lie on, with their faces and a tracer of them.
struct ReceivingSurfaces {
    const TriangleScene& triangles;
    const ReceiverFaces& faces;
    const Tracer& tracer;
};

/// Light over the receiver's footprint is the mean of the light over these, each in the plane of the triangle
/// that the receiver's viewer sees there. Empty where the receiver is right by itself: its footprint lies on
/// one face, or it has none, names no triangle or does not say from where it is seen. Cells beside the
/// receiver's object, or seen edge-on, are left out.
std::vector<Receiver> receiver_cells(const Receiver& receiver, const ReceivingSurfaces& under);

}  // namespace trilens
