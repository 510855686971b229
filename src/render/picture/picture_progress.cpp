#include "render/picture/picture_progress.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>

#include "base/util/check.h"
#include "render/frame/frame.h"

namespace trilens {
namespace {

constexpr int kMostStrips = 16, kRowsPerTimed = 32;
constexpr int kTimesTheRows = 4;       // of the strip that is timed once more
constexpr int kFirstStrips = 3;        // after which it is known about how long all takes
constexpr double kNobodyAsks = 3;      // seconds
constexpr double kLeastOfMean = 1e-3;  // of the mean row: any takes something

/// Strips in an order that is spread over the picture from the beginning: steps by the golden section.
std::vector<int> spread_order(int count) {
    std::vector<int> order;
    std::vector<char> is_taken(static_cast<std::size_t>(count), 0);
    for (int k = 0; static_cast<int>(order.size()) < count; ++k) {
        const double place = std::fmod(0.5 + k * 0.6180339887498949, 1.0);
        const int strip = static_cast<int>(place * count);
        if (is_taken[static_cast<std::size_t>(strip)]) continue;
        is_taken[static_cast<std::size_t>(strip)] = 1;
        order.push_back(strip);
    }
    return order;
}

/// What is known at some rows' middles, between them linear.
double interpolated(const std::vector<double>& middle, const std::vector<double>& value, double at) {
    const auto above = std::upper_bound(middle.begin(), middle.end(), at);
    if (above == middle.begin()) return value.front();
    if (above == middle.end()) return value.back();
    const auto k = static_cast<std::size_t>(above - middle.begin());
    const double t = (at - middle[k - 1]) / (middle[k] - middle[k - 1]);
    return (1 - t) * value[k - 1] + t * value[k];
}

/// What any strip takes, however many rows it has, which bands of many rows hardly notice: by more rows of
/// the strip that takes least.
double seconds_of_any(int y0, int y1, int rows, const std::vector<double>& middle,
                      const std::vector<double>& seconds, const RowShares::TimeRows& time) {
    const auto k =
        static_cast<std::size_t>(std::min_element(seconds.begin(), seconds.end()) - seconds.begin());
    const int more = kTimesTheRows * rows,
              from = std::clamp(static_cast<int>(middle[k]) - more / 2, y0, y1 - more);
    const double of_more = time(from, from + more);
    return std::clamp((kTimesTheRows * seconds[k] - of_more) / (kTimesTheRows - 1), 0.0, seconds[k]);
}

/// Of the job, where lights have caustics that are not known yet: while their beams are made, and gathered on
/// what is seen.
constexpr double kBeamsShare = 0.2, kGatheringShare = 0.3;
/// Of the job, where there are many optics.
constexpr double kOpticsShare = 0.3;
constexpr std::size_t kOpticsTold = 8;
/// Rows of a picture that say which faces are seen, at most, and how far apart they are, at least; what
/// others show beside is gathered while they are drawn.
constexpr int kRowsLookedAt = 16, kRowsApart = 12;

/// The sides of objects' faces that rows of the window show, each once.
std::vector<ReceiverSide> seen_faces(const ReceiverFaces& faces, Viewer& viewer, const LayerRequest& window,
                                     const Progress& progress) {
    std::set<ReceiverSide> seen;
    const auto add = [&](const Hit& hit, const Ray& ray) {
        if (!hit.seen()) return;
        const ReceiverSide side = faces.side_of(hit.triangle, -ray.direction);
        if (side.face != kNone) seen.insert(side);
    };
    SampleViews views;
    const int height = window.y1 - window.y0, rows = std::min(1 + height / kRowsApart, kRowsLookedAt);
    for (int i = 0; i < rows; ++i) {
        progress.stop_if_cancelled();
        const int y = window.y0 + (2 * i + 1) * height / (2 * rows);
        viewer.view({window.x0, y, window.x1, y + 1, 1}, views);
        for (const SampleView& view : views.samples)
            if (view.optic == kNone) add(view.hit, view.ray);
        for (const PathEnd& end : views.ends) add(end.hit, end.ray);
    }
    return {seen.begin(), seen.end()};
}

}  // namespace

RowShares::RowShares(int y0, int y1) : y0_(y0) {
    TRILENS_CHECK(y0 < y1, "a picture has rows");
    for (int y = y0; y <= y1; ++y) before_.push_back(static_cast<double>(y - y0) / (y1 - y0));
}

RowShares RowShares::measured(int y0, int y1, const TimeRows& time) {
    RowShares shares(y0, y1);
    const int height = y1 - y0, strips = std::min(kMostStrips, height / kRowsPerTimed);
    if (strips < kFirstStrips) return shares;
    const int rows = std::max(1, height / (strips * kRowsPerTimed));
    std::vector<double> middle(static_cast<std::size_t>(strips)), seconds(middle.size());
    double total = 0;
    int timed = 0;
    for (const int strip : spread_order(strips)) {
        const int from = y0 + static_cast<int>((strip + 0.5) * height / strips) - rows / 2;
        const auto k = static_cast<std::size_t>(strip);
        middle[k] = from + 0.5 * rows;
        seconds[k] = time(from, from + rows);
        total += seconds[k];
        if (++timed == kFirstStrips && total / (timed * rows) * height < kNobodyAsks) return shares;
    }
    const double of_strip = seconds_of_any(y0, y1, rows, middle, seconds, time);
    total = 0;
    for (double& one : seconds) total += one = std::max(0.0, one - of_strip);
    const double least = kLeastOfMean * total / strips;
    for (int row = 0; row < height; ++row)
        shares.before_[static_cast<std::size_t>(row) + 1] =
            shares.before_[static_cast<std::size_t>(row)] +
            std::max(least, interpolated(middle, seconds, y0 + row + 0.5));
    const double whole = shares.before_.back();
    if (!(whole > 0)) return {y0, y1};
    for (double& before : shares.before_) before /= whole;
    return shares;
}

Progress prepare_many_optics(const World& world, const PictureRequest& request, const Progress& progress) {
    if (world.optics.size() < kOpticsTold) return progress;
    const Engine engine = request.engine.engine;
    OpticNeeds needs;
    needs.resolution = request.frame.resolution;
    needs.facets = engine != Engine::kLimitTruth;
    needs.traced = engine == Engine::kFacetsTruth;
    needs.projected = needs.facets && !needs.traced;
    needs.exact_rays = follows_paths(engine);
    prepare_optics(world, needs, progress.part(0, kOpticsShare));
    progress.begin_stage("");
    return progress.part(kOpticsShare, 1 - kOpticsShare);
}

Progress prepare_caustics(const World& world, bool exact, const Progress& progress) {
    if (!has_caustics(world) || known_caustic_lights(world, exact)) return progress;
    caustic_lights(world, exact, progress.part(0, kBeamsShare));
    progress.begin_stage("");
    return progress.part(kBeamsShare, 1 - kBeamsShare);
}

Progress gather_seen(const World& world, Viewer& viewer, const LayerRequest& window,
                     const Progress& progress) {
    if (!has_caustics(world) || !viewer.has_facets()) return progress;
    const CausticLights& lights = caustic_lights(world, false);
    std::vector<ReceiverSide> faces = seen_faces(*lights.faces, viewer, window, progress);
    const std::vector<const BeamLight*> all = lights.all();
    std::erase_if(faces, [&](const ReceiverSide& face) {
        return std::ranges::all_of(all, [&](const BeamLight* light) { return light->is_gathered(face); });
    });
    if (faces.empty()) return progress;
    gather_light(all, faces, progress.part(0, kGatheringShare));
    progress.begin_stage("");
    return progress.part(kGatheringShare, 1 - kGatheringShare);
}

}  // namespace trilens
