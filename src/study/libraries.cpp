#include "study/libraries.h"

#include "image/image_io.h"
#include "intersect/tracer.h"
#include "surfaces/surfaces.h"

namespace trilens {

std::vector<std::string> versions_underneath() {
    return {tracer_library_version(), surface_library_version(), image_library_version()};
}

}  // namespace trilens
