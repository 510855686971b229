#include "trilens/version.h"

#include <algorithm>

#include "base/util/parallel.h"
#include "image/image_io.h"
#include "intersect/tracer.h"
#include "study/libraries.h"

namespace trilens {

std::string version() {
    return kVersion;
}

std::vector<std::string> library_versions() {
    return versions_underneath();
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
