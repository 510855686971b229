#include "trilens/version.h"

#include <algorithm>

#include "base/util/parallel.h"
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
    const int most = std::max(threads, 0);
    set_thread_count(most);
    set_tracer_threads(most);
    set_image_threads(most);
}

int threads() {
    return thread_count();
}

}  // namespace trilens
