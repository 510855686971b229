#include "trilens/surface.h"

#include "base/util/error.h"
#include "base/util/format.h"
#include "surfaces/surfaces.h"

namespace trilens {

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
