#include "render/project.h"

#include <algorithm>
#include <numeric>

#include "base/halve_points.h"
#include "base/parallel.h"
#include "render/point_projector.h"

namespace trilens {
namespace {

/// Points that are searched for at one go: some pieces of work for each thread, none with more than have much
/// in common.
constexpr std::size_t kPiecesPerThread = 8, kLeastPiece = 16, kMostPiece = 1024;

/// Halves `some` in space down to pieces of at most `most`.
void add_pieces(std::span<const Vec3> points, std::span<std::size_t> some, std::size_t most,
                std::vector<std::span<const std::size_t>>& pieces) {
    if (some.size() <= most) {
        pieces.push_back(some);
        return;
    }
    const std::size_t half = halve_points(points, some);
    add_pieces(points, some.first(half), most, pieces);
    add_pieces(points, some.subspan(half), most, pieces);
}

}  // namespace

std::vector<PointProjection> project_points(const World& world, const ProjectRequest& request,
                                            std::span<const Vec3> points) {
    const PointProjector projector(world, request);
    std::vector<PointProjection> result(points.size());
    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::vector<std::span<const std::size_t>> pieces;
    const std::size_t share = points.size() / (kPiecesPerThread * static_cast<std::size_t>(thread_count()));
    add_pieces(points, order, std::clamp(share, kLeastPiece, kMostPiece), pieces);
    parallel_for(pieces.size(), 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) projector.project(points, pieces[i], result);
    });
    return result;
}

}  // namespace trilens
