#include "render/project/project.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "base/math/spatial_split.h"
#include "base/util/parallel.h"
#include "render/project/point_projector.h"

namespace trilens {
namespace {

/// Points that are searched for at one go: some pieces of work for each thread, none with more than have much
/// in common.
constexpr std::size_t kPiecesPerThread = 8, kLeastPiece = 16, kMostPiece = 1024;

/// Halves `some` in space until each `most` of them, counted from the first, lie together.
void order_in_space(std::span<const Vec3> points, std::span<std::size_t> some, std::size_t most) {
    if (some.size() <= most) return;
    const std::size_t half = spatial_split(points, some, most);
    run_side_by_side({[&] { order_in_space(points, some.first(half), most); },
                      [&] { order_in_space(points, some.subspan(half), most); }});
}

}  // namespace

std::vector<PointProjection> project_points(const World& world, const ProjectRequest& request,
                                            std::span<const Vec3> points) {
    const PointProjector projector(world, request);
    std::vector<PointProjection> result(points.size());
    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const std::size_t share = points.size() / (kPiecesPerThread * static_cast<std::size_t>(thread_count()));
    const std::size_t piece = std::clamp(std::bit_floor(share), kLeastPiece, kMostPiece);
    order_in_space(points, order, piece);
    parallel_for((points.size() + piece - 1) / piece, 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from * piece; i < std::min(to * piece, points.size()); i += piece)
            projector.project(points, std::span(order).subspan(i, std::min(piece, points.size() - i)),
                              result);
    });
    return result;
}

}  // namespace trilens
