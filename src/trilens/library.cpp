// The library as callers ask it: which one it is, how many threads it uses, a surface by itself.
#include <algorithm>

#include "base/util/error.h"
#include "base/util/format.h"
#include "base/util/parallel.h"
#include "image/image_io.h"
#include "intersect/tracer.h"
#include "study/libraries.h"
#include "surfaces/surfaces.h"
#include "trilens/surface.h"
#include "trilens/version.h"

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

constexpr int kMostSteps = 1024;

std::unique_ptr<Surface> make_surface(const Cage& cage, const std::string& name, const Warn& warn) {
    return make_limit_surface(cage, name, warn);
}

std::unique_ptr<Surface> make_surface(const Primitive& primitive) {
    return make_primitive_surface(primitive);
}

SurfaceGrid make_surface_grid(const Surface& surface, int n) {
    if (n < 1 || n > kMostSteps)
        throw InputError("", "n", fmt::format("a grid has 1 to {} steps, not {}", kMostSteps, n));
    return make_grid(surface, n);
}

}  // namespace trilens
