#include "render/project/project.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "base/math/box.h"
#include "base/util/error.h"
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

std::vector<PointProjection> project_each(const PointProjector& projector,
                                          std::span<const ProjectedPoint> points, const Progress& progress) {
    std::vector<PointProjection> result(points.size());
    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const std::size_t share = points.size() / (kPiecesPerThread * static_cast<std::size_t>(thread_count()));
    const std::size_t piece = std::clamp(std::bit_floor(share), kLeastPiece, kMostPiece);
    std::vector<Vec3> places;
    for (const ProjectedPoint& point : points) places.push_back(point.place);
    order_in_space(places, order, piece);
    LoopProgress done(progress, static_cast<double>(points.size()));
    parallel_for((points.size() + piece - 1) / piece, 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from * piece; i < std::min(to * piece, points.size()); i += piece) {
            done.stop_if_cancelled();
            const auto some = std::span(order).subspan(i, std::min(piece, points.size() - i));
            projector.project(points, some, result);
            done.add(static_cast<double>(some.size()));
        }
    });
    return result;
}

std::vector<PointProjection> project_points(const World& world, const ProjectRequest& request,
                                            std::span<const Vec3> points, const Progress& progress) {
    std::vector<ProjectedPoint> asked;
    for (const Vec3& point : points) asked.push_back({point});
    return project_each(PointProjector(world, request), asked, progress);
}

std::vector<PointProjection> project_directions(const World& world, const ProjectRequest& request,
                                                std::span<const Vec3> directions, const Progress& progress) {
    std::vector<ProjectedPoint> asked;
    for (const Vec3& direction : directions) asked.push_back({normalize_or_zero(direction), true});
    return project_each(PointProjector(world, request), asked, progress);
}

}  // namespace trilens
