#include "trilens/version.h"

#include "base/parallel.h"
#include "image/image_io.h"
#include "intersect/tracer.h"
#include "surfaces/surfaces.h"

namespace trilens {

std::string version() {
    return kVersion;
}

std::vector<std::string> library_versions() {
    return {tracer_library_version(), surface_library_version(), image_library_version()};
}

void set_threads(int threads) {
    set_thread_count(threads);
    set_tracer_threads(threads);
    set_image_threads(threads);
}

int threads() {
    return thread_count();
}

}  // namespace trilens
