// Images as Python holds them.
#pragma once

#include "arrays.h"

namespace trilens::python {

/// An image and what is known of its making. Held by Python objects alone: views of channels keep those
/// alive.
struct HeldImage {
    Image image;
    py::dict statistics;  // empty where the image was not drawn here
};

}  // namespace trilens::python
