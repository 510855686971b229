#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/util/format.h"
#include "render/marks/marks.h"
#include "render/project/point_projector.h"
#include "render/world/world.h"

namespace trilens {
namespace {

constexpr std::size_t kPointsAtOnce = 1u << 16;  // whose images are held whole
/// The square of half a pixel: no ellipse is narrower, and where it would be it is that much fainter.
constexpr double kLeastSquare = 0.25;

Spread round_spread(double width) {
    const double half = 0.5 * width;
    return {half * half, 0, half * half};
}

/// Of a ball of that radius.
Spread spread_of(const std::array<Vec3, 2>& derivative, double radius) {
    const double square = radius * radius;
    return {square * dot(derivative[0], derivative[0]), square * dot(derivative[0], derivative[1]),
            square * dot(derivative[1], derivative[1])};
}

/// Its longer axis cut to `most` (square pixels).
Spread cut_to(const Spread& spread, double most) {
    const Vec2 along(std::cos(spread.angle()), std::sin(spread.angle()));
    // The shorter one by the product of both: a difference would be rounding's.
    const double least = std::min(most, std::max(0.0, spread.determinant() / spread.most()));
    return {most * along.x * along.x + least * along.y * along.y, (most - least) * along.x * along.y,
            most * along.y * along.y + least * along.x * along.x};
}

/// Sets the ellipse; narrower than a pixel it becomes as wide as one, and that much fainter.
void set_spread(Spread spread, PlacedMark& mark) {
    if (spread.least() < kLeastSquare) {
        const double more = kLeastSquare - spread.least(), before = std::max(0.0, spread.determinant());
        spread.xx += more, spread.yy += more;
        mark.opacity = std::sqrt(before / spread.determinant());
    }
    mark.spread = spread;
}

/// From the first event, or the eye, to the point.
double way_of(const WorldImage& image) {
    double way = image.length;
    for (std::size_t i = 1; i < image.events.size(); ++i)
        way += length(image.events[i].point - image.events[i - 1].point);
    return way;
}

/// Paths over several optics that disperse are found in green alone: a mark has that share of every colour.
Vec3 weight_of(const World& world, const WorldImage& image) {
    const bool disperses =
        image.steps.size() > 1 && std::any_of(image.steps.begin(), image.steps.end(), [&](const Step& step) {
            return world.scene.materials[world.optics[step.optic].material].dispersion > 0;
        });
    return disperses ? Vec3(image.weight.y) : image.weight;
}

/// What the path hides of the light over its first event: all of it over mirrors and straight through glass,
/// where nearly all light goes the same way; its own share where glass reflects it inside.
double replaced_by(const World& world, const WorldImage& image) {
    for (std::size_t i = 1; i < image.steps.size(); ++i)
        if (image.steps[i].event == Event::kReflect && !world.optics[image.steps[i].optic].mirror)
            return std::min(1.0, std::max({image.weight.x, image.weight.y, image.weight.z}));
    return 1;
}

/// What all places of an entry share.
struct Entry {
    bool is_label = false;
    std::size_t index = 0;
    double radius = 0, size = 0, min_weight = 0;
};

class Placing {
  public:
    Placing(const World& world, const FrameParams& frame)
        : world_(world), projector_(world, request_of(world, frame)) {}

    void add(const Entry& entry, std::span<const Vec3> places, std::span<const Vec3> colors,
             const Progress& progress);
    PlacedMarks take();

  private:
    static ProjectRequest request_of(const World& world, const FrameParams& frame) {
        ProjectRequest request;
        request.frame = frame;
        request.min_weight = 1;
        for (const PointCloud& cloud : world.scene.points) {
            request.derivatives |= cloud.radius > 0;
            request.min_weight = std::min(request.min_weight, cloud.min_weight);
        }
        for (const Label& label : world.scene.labels)
            request.min_weight = std::min(request.min_weight, label.min_weight);
        return request;
    }
    bool add_image(const Entry& entry, const WorldImage& image, const Vec3& color, std::size_t point);

    const World& world_;
    PointProjector projector_;
    PlacedMarks placed_;
};

/// Whether the image is drawn.
bool Placing::add_image(const Entry& entry, const WorldImage& image, const Vec3& color, std::size_t point) {
    const Vec3 weight = weight_of(world_, image);
    if (!image.inside || std::max({weight.x, weight.y, weight.z}) < entry.min_weight) return false;
    if (!image.visible) {
        ++placed_.hidden;
        return false;
    }
    PlacedMark mark;
    mark.is_label = entry.is_label, mark.entry = entry.index, mark.point = point;
    mark.path = image.path, mark.optic = image.path == Path::kDirect ? kNone : image.object;
    mark.steps = image.steps.size(), mark.pixel = image.pixel, mark.distance = way_of(image);
    mark.light = entry.is_label ? color : weight * color;
    mark.replaces = entry.is_label ? 1 : replaced_by(world_, image);
    Spread spread = round_spread(entry.size);
    if (entry.radius > 0) {
        if (image.has_derivative) spread = spread_of(image.derivative, entry.radius);
        placed_.unsized += !image.has_derivative;
        if (spread.most() > kLongestSplat * kLongestSplat) {
            spread = cut_to(spread, kLongestSplat * kLongestSplat);
            ++placed_.cut;
        }
    }
    if (entry.size > 0) set_spread(spread, mark);
    placed_.marks.push_back(mark);
    return true;
}

void Placing::add(const Entry& entry, std::span<const Vec3> places, std::span<const Vec3> colors,
                  const Progress& progress) {
    std::vector<ProjectedPoint> asked;
    for (const Vec3& place : places) asked.push_back({place});
    const std::vector<PointProjection> found = project_each(projector_, asked, progress);
    for (std::size_t p = 0; p < places.size(); ++p) {
        bool is_seen = false;
        for (const WorldImage& image : found[p].images)
            is_seen = add_image(entry, image, colors[colors.size() > 1 ? p : 0], p) || is_seen;
        ++placed_.places;
        placed_.unseen += !is_seen;
    }
}

PlacedMarks Placing::take() {
    std::stable_sort(placed_.marks.begin(), placed_.marks.end(),
                     [](const PlacedMark& a, const PlacedMark& b) {
                         return a.is_label != b.is_label ? b.is_label : a.distance > b.distance;
                     });
    return std::move(placed_);
}

}  // namespace

PlacedMarks place_marks(const World& world, const FrameParams& frame, const Progress& progress) {
    if (world.scene.points.empty() && world.scene.labels.empty()) return {};
    Placing placing(world, frame);
    double done = 0, all = 0;
    for (const PointCloud& cloud : world.scene.points) all += static_cast<double>(cloud.places.size());
    for (std::size_t i = 0; i < world.scene.points.size(); ++i) {
        const PointCloud& cloud = world.scene.points[i];
        const Entry entry{false, i, cloud.radius, cloud.size, cloud.min_weight};
        for (std::size_t from = 0; from < cloud.places.size(); from += kPointsAtOnce) {
            const std::size_t count = std::min(kPointsAtOnce, cloud.places.size() - from);
            placing.add(entry, std::span(cloud.places).subspan(from, count),
                        cloud.colors.empty() ? std::span(&cloud.color, 1)
                                             : std::span(cloud.colors).subspan(from, count),
                        progress.part(done / all, static_cast<double>(count) / all));
            done += static_cast<double>(count);
        }
    }
    for (std::size_t i = 0; i < world.scene.labels.size(); ++i) {
        const Label& label = world.scene.labels[i];
        placing.add({true, i, 0, label.dot, label.min_weight}, std::span(&label.place, 1),
                    std::span(&label.color, 1), {nullptr, progress.cancel});
    }
    PlacedMarks placed = placing.take();
    leave_out_crowded(world, placed);
    return placed;
}

void tell_marks(const World& world, const PlacedMarks& marks, const Warn& warn) {
    if (marks.places == 0) return;
    if (marks.unseen == marks.places)
        warn(fmt::format("none of {} points and labels is seen: they are off the film, or hidden",
                         marks.places));
    if (marks.unsized > 0)
        warn(
            fmt::format("{} images of points are {} as large as their 'size' says: how large their radius is "
                        "there is not known",
                        marks.unsized, marks.unsized == marks.marks.size() ? "all" : "only"));
    if (marks.cut > 0)
        warn(fmt::format("{} images of points lie near folds: they are cut to {} pixels", marks.cut,
                         2 * kLongestSplat));
    if (marks.crowded_out > 0)
        warn(fmt::format("{} images of labels are left out: they would cover other labels",
                         marks.crowded_out));
    if (!world.volumes.empty() || world.blended)
        warn("points and labels are not veiled by volumes and by what blends");
    if (has_rough_optics(world)) warn("points and labels are as sharp in rough optics as in smooth ones");
    if (std::any_of(world.scene.labels.begin(), world.scene.labels.end(),
                    [](const Label& label) { return !label.letters; }))
        warn("labels have no letters here, only their dots");
}

}  // namespace trilens
