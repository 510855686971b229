// Several views in one picture, each in its window; between neighbours rays pass from one to the next.
#include <algorithm>
#include <cmath>

#include "camera/model/models.h"
#include "camera/model/ray_slopes.h"

namespace trilens {
namespace {

constexpr int kBlendSteps = 15;
constexpr double kBlendAtRest = 1e-10;   // share of the film
constexpr int kStartsAcross = 24;        // places across the film from which images are looked for
constexpr int kBlendStrips = 8;          // patches across a blend: there a point may be seen several times
constexpr double kSame = 1e-7;           // share of the film: images nearer to each other are one
constexpr double kCurvatureStep = 2e-4;  // share of the film, for second differences
constexpr double kBeyondPatch = 3;       // a patch of a blend goes on by so many of its sizes
constexpr double kSlopeStep = 1e-5;      // share of the film, for first differences

struct View {
    ModelPointer model;
    Vec2 low{0}, high{0};  // its window, pixels
};

/// How a view's weight runs along one axis inside one patch of the film.
enum class Ramp { kNone, kWhole, kRising, kFalling };

/// The film is cut into patches by the windows' borders and the blends along them: inside a patch each view's
/// weight is a product of two linear functions. A patch is a branch.
class MultiPerspective final : public CameraModel {
  public:
    MultiPerspective(const MultiPerspectiveCamera& kind, const ModelSource& source);
    std::optional<Ray> ray(const Vec2& at) const override { return ray_of_patch(patch_at(at), at); }
    std::size_t branch_count() const override { return patches_.size(); }
    std::optional<FilmImage> place(const Vec3& point, std::size_t patch) const override;
    std::vector<FilmImage> places(const Vec3& point, std::size_t patch) const override;
    bool shows(std::size_t patch, const Vec2& at) const override { return patch_at(at) == patch; }
    std::vector<double> breaks_x() const override { return breaks_[0]; }
    std::vector<double> breaks_y() const override { return breaks_[1]; }
    double focus() const override { return focus_; }

  private:
    struct Share {
        std::size_t view = 0;
        Ramp x = Ramp::kWhole, y = Ramp::kWhole;
    };
    struct Patch {
        std::vector<Share> shares;
        Vec2 middle{0}, half{0};
    };

    void make_views(const std::vector<WindowedCamera>& views, const ModelSource& source);
    void make_cuts(int axis);
    void make_patches();
    Ramp ramp_at(int axis, const View& view, double at) const;
    double ramp(Ramp kind, int axis, const View& view, double at) const;
    double ramp_slope(Ramp kind, int axis) const;
    std::size_t patch_at(const Vec2& at) const;
    std::optional<Ray> ray_of_patch(std::size_t patch, const Vec2& at) const;
    std::optional<RaySlopes> slopes_of_patch(std::size_t patch, const Vec2& at) const;
    template <class Found>
    void search(const Vec3& point, std::size_t patch, int across, const Found& found) const;
    std::optional<Vec3> miss(const Vec3& point, std::size_t patch, const Vec2& at) const;
    std::optional<Vec2> beyond_fold(const Vec3& point, std::size_t patch, const Vec2& at) const;
    std::optional<FilmImage> solve(const Vec3& point, std::size_t patch, Vec2 at) const;

    FilmSize film_;
    double focus_;
    Vec2 blend_{0};  // pixels
    std::vector<View> views_;
    std::array<std::vector<double>, 2> breaks_;  // where weights bend, ascending, inside the film
    std::array<std::vector<double>, 2> cuts_;    // they, and the strips of blends
    std::vector<Patch> patches_;                 // rows of columns
};

MultiPerspective::MultiPerspective(const MultiPerspectiveCamera& kind, const ModelSource& source)
    : film_(source.film), focus_(1) {
    if (!(kind.blend >= 0 && kind.blend <= 1)) source.site.reject("blend", "is a share of the film: 0 to 1");
    blend_ = kind.blend * Vec2(film_.width, film_.height);
    make_views(kind.views, source);
    make_patches();
}

void MultiPerspective::make_views(const std::vector<WindowedCamera>& views, const ModelSource& source) {
    if (views.empty()) source.site.reject("views", "there must be at least one");
    double focus = 0;
    for (std::size_t i = 0; i < views.size(); ++i) {
        const WindowedCamera& from = views[i];
        const std::string field = "views/" + std::to_string(i);
        const auto& [x0, y0, x1, y1] = from.window;
        if (!(0 <= x0 && x0 < x1 && x1 <= 1 && 0 <= y0 && y0 < y1 && y1 <= 1))
            source.site.reject(field + "/window", "is no window of the film: it is x0, y0, x1, y1 in 0..1");
        if (std::holds_alternative<RayMeshCamera>(from.camera.kind) ||
            std::holds_alternative<MultiPerspectiveCamera>(from.camera.kind))
            source.site.reject(field + "/type", "a view is a camera of one perspective");
        View view;
        view.low = Vec2(x0 * film_.width, y0 * film_.height);
        view.high = Vec2(x1 * film_.width, y1 * film_.height);
        for (std::size_t j = 0; j < views_.size(); ++j) {
            const Vec2 both = glm::min(view.high, views_[j].high) - glm::max(view.low, views_[j].low);
            if (both.x > 1e-9 * film_.width && both.y > 1e-9 * film_.height)
                source.site.reject(field + "/window", "overlaps the window of view " + std::to_string(j));
        }
        const FilmSize size{view.high.x - view.low.x, view.high.y - view.low.y};
        view.model = make_model({from.camera, size, {source.site.file, source.site.place + "/" + field}});
        focus = std::max(focus, view.model->focus());
        views_.push_back(std::move(view));
    }
    if (focus > 0) focus_ = focus;
}

Ramp MultiPerspective::ramp_at(int axis, const View& view, double at) const {
    const double size = axis == 0 ? film_.width : film_.height, half = 0.5 * blend_[axis];
    const double low = view.low[axis], high = view.high[axis];
    const bool opens = low > 1e-9 * size, closes = high < (1 - 1e-9) * size;
    if ((opens && at < low - half) || (closes && at > high + half)) return Ramp::kNone;
    if (opens && at < low + half) return Ramp::kRising;
    if (closes && at > high - half) return Ramp::kFalling;
    return Ramp::kWhole;
}

double MultiPerspective::ramp(Ramp kind, int axis, const View& view, double at) const {
    if (kind == Ramp::kRising) return (at - view.low[axis]) / blend_[axis] + 0.5;
    if (kind == Ramp::kFalling) return (view.high[axis] - at) / blend_[axis] + 0.5;
    return kind == Ramp::kWhole ? 1 : 0;
}

double MultiPerspective::ramp_slope(Ramp kind, int axis) const {
    if (kind == Ramp::kRising) return 1 / blend_[axis];
    return kind == Ramp::kFalling ? -1 / blend_[axis] : 0;
}

void MultiPerspective::make_cuts(int axis) {
    const double size = axis == 0 ? film_.width : film_.height, step = blend_[axis] / kBlendStrips;
    std::vector<double> breaks, cuts;
    for (const View& view : views_)
        for (const double border : {view.low[axis], view.high[axis]}) {
            if (!(border > 1e-9 * size && border < (1 - 1e-9) * size)) continue;
            for (int k = 0; k <= kBlendStrips; ++k) {
                const double at = border + (k - 0.5 * kBlendStrips) * step;
                if (!(at > 0 && at < size)) continue;
                cuts.push_back(at);
                if (k == 0 || k == kBlendStrips) breaks.push_back(at);
            }
        }
    for (std::vector<double>* list : {&breaks, &cuts}) {
        std::sort(list->begin(), list->end());
        const auto same = [size](double one, double next) { return next - one <= 1e-9 * size; };
        list->erase(std::unique(list->begin(), list->end(), same), list->end());
    }
    breaks_[static_cast<std::size_t>(axis)] = std::move(breaks);
    cuts_[static_cast<std::size_t>(axis)] = std::move(cuts);
}

void MultiPerspective::make_patches() {
    make_cuts(0);
    make_cuts(1);
    const auto span_of = [](const std::vector<double>& cuts, std::size_t i, double size) {
        return Vec2(i == 0 ? 0 : cuts[i - 1], i == cuts.size() ? size : cuts[i]);
    };
    for (std::size_t j = 0; j <= cuts_[1].size(); ++j)
        for (std::size_t i = 0; i <= cuts_[0].size(); ++i) {
            Patch patch;
            const Vec2 x = span_of(cuts_[0], i, film_.width), y = span_of(cuts_[1], j, film_.height);
            patch.middle = 0.5 * Vec2(x.x + x.y, y.x + y.y);
            patch.half = 0.5 * Vec2(x.y - x.x, y.y - y.x);
            for (std::size_t v = 0; v < views_.size(); ++v) {
                const Share share{v, ramp_at(0, views_[v], patch.middle.x),
                                  ramp_at(1, views_[v], patch.middle.y)};
                if (share.x != Ramp::kNone && share.y != Ramp::kNone) patch.shares.push_back(share);
            }
            patches_.push_back(std::move(patch));
        }
}

std::size_t MultiPerspective::patch_at(const Vec2& at) const {
    const auto index = [](const std::vector<double>& cuts, double x) {
        return static_cast<std::size_t>(std::upper_bound(cuts.begin(), cuts.end(), x) - cuts.begin());
    };
    return index(cuts_[1], at.y) * (cuts_[0].size() + 1) + index(cuts_[0], at.x);
}

/// The patch's rays, also beyond its border.
std::optional<Ray> MultiPerspective::ray_of_patch(std::size_t patch, const Vec2& at) const {
    Ray sum;
    double total = 0;
    for (const Share& share : patches_[patch].shares) {
        const View& view = views_[share.view];
        const std::optional<Ray> one = view.model->ray(at - view.low);
        if (!one) return std::nullopt;
        const double weight = ramp(share.x, 0, view, at.x) * ramp(share.y, 1, view, at.y);
        sum.origin += weight * one->origin;
        sum.direction += weight * one->direction;
        total += weight;
    }
    if (!(total > 0)) return std::nullopt;
    sum.origin /= total;
    sum.direction /= total;
    // Views that look opposite ways have no ray between them.
    if (!(length(sum.direction) > 1e-9)) return std::nullopt;
    return sum;
}

std::optional<RaySlopes> MultiPerspective::slopes_of_patch(std::size_t patch, const Vec2& at) const {
    RaySlopes sum;
    WeightSlopes total;
    for (const Share& share : patches_[patch].shares) {
        const View& view = views_[share.view];
        const std::optional<RaySlopes> one = ray_slopes(*view.model, at - view.low, kSlopeStep * film_.width);
        if (!one) return std::nullopt;
        const double x = ramp(share.x, 0, view, at.x), y = ramp(share.y, 1, view, at.y);
        const WeightSlopes weight{x * y, {ramp_slope(share.x, 0) * y, x * ramp_slope(share.y, 1)}};
        add_product(sum, weight, *one);
        total.here += weight.here;
        total.per_pixel += weight.per_pixel;
    }
    if (!(total.here > 0)) return std::nullopt;
    RaySlopes mean;
    add_product(mean, {1 / total.here, -total.per_pixel / (total.here * total.here)}, sum);
    if (!(length(mean.corner.direction) > 1e-9)) return std::nullopt;
    return mean;
}

std::optional<FilmImage> MultiPerspective::place(const Vec3& point, std::size_t patch) const {
    const std::vector<Share>& shares = patches_[patch].shares;
    if (shares.empty()) return std::nullopt;
    if (shares.size() > 1) {
        // The image in the patch, or the one nearest to it: a blend may show a point several times.
        std::optional<FilmImage> best;
        double nearest = 0;
        search(point, patch, kStartsAcross, [&](const FilmImage& image) {
            const Patch& there = patches_[patch];
            const double distance =
                length(glm::max(glm::abs(image.pixel - there.middle) - there.half, Vec2(0)));
            if (!best || distance < nearest) best = image, nearest = distance;
            return distance == 0;
        });
        return best;
    }
    const View& view = views_[shares[0].view];
    // Of a view with several branches the one that its film shows there.
    std::optional<FilmImage> best;
    for (std::size_t branch = 0; branch < view.model->branch_count(); ++branch) {
        std::optional<FilmImage> found = view.model->place(point, branch);
        if (!found) continue;
        const bool shown = view.model->shows(branch, found->pixel);
        found->pixel += view.low;
        if (shown || !best) best = found;
        if (shown) break;
    }
    return best;
}

/// Calls `found` with what Newton's method comes to from places all over the patch, `across` of them to a
/// film's width, until that answers true.
template <class Found>
void MultiPerspective::search(const Vec3& point, std::size_t patch, int across, const Found& found) const {
    const Patch& there = patches_[patch];
    const auto starts = [across](double half, double size) {
        return std::max(across / kStartsAcross, static_cast<int>(std::ceil(2 * half * across / size)));
    };
    const int columns = starts(there.half.x, film_.width), rows = starts(there.half.y, film_.height);
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const Vec2 share((2 * i + 1.0) / columns - 1, (2 * j + 1.0) / rows - 1);
            const auto image = solve(point, patch, there.middle + share * there.half);
            if (image && found(*image)) return;
        }
}

std::vector<FilmImage> MultiPerspective::places(const Vec3& point, std::size_t patch) const {
    const std::vector<Share>& shares = patches_[patch].shares;
    std::vector<FilmImage> images;
    if (shares.size() == 1) {
        const View& view = views_[shares[0].view];
        for (std::size_t branch = 0; branch < view.model->branch_count(); ++branch)
            for (FilmImage image : view.model->places(point, branch)) {
                if (!view.model->shows(branch, image.pixel)) continue;
                image.pixel += view.low;
                images.push_back(image);
            }
        if (!images.empty()) return images;
    }
    if (shares.size() <= 1) return CameraModel::places(point, patch);
    const auto add = [&](const FilmImage& image) {
        for (const FilmImage& known : images)
            if (length(known.pixel - image.pixel) < kSame * film_.width) return false;
        images.push_back(image);
        return true;
    };
    search(point, patch, 2 * kStartsAcross, [&](const FilmImage& image) {
        if (!add(image)) return false;
        const auto other_side = beyond_fold(point, patch, image.pixel);
        if (!other_side) return false;
        if (const auto partner = solve(point, patch, *other_side)) add(*partner);
        return false;
    });
    return images;
}

/// How far the point lies from the patch's ray there, as a share of its distance along the ray.
std::optional<Vec3> MultiPerspective::miss(const Vec3& point, std::size_t patch, const Vec2& at) const {
    const std::optional<Ray> ray = ray_of_patch(patch, at);
    if (!ray) return std::nullopt;
    return miss_slopes({*ray, {}, {}}, point).here;
}

/// About where the image lies that merges with this one at a fold: along the direction in which the miss
/// changes least, where its second order cancels the first.
std::optional<Vec2> MultiPerspective::beyond_fold(const Vec3& point, std::size_t patch,
                                                  const Vec2& at) const {
    const double step = kCurvatureStep * film_.width;
    const auto here = miss(point, patch, at), x1 = miss(point, patch, at + Vec2(step, 0)),
               x0 = miss(point, patch, at - Vec2(step, 0)), y1 = miss(point, patch, at + Vec2(0, step)),
               y0 = miss(point, patch, at - Vec2(0, step));
    if (!here || !x1 || !x0 || !y1 || !y0) return std::nullopt;
    const Vec3 dx = (*x1 - *x0) / (2 * step), dy = (*y1 - *y0) / (2 * step);
    const double angle = 0.5 * std::atan2(2 * dot(dx, dy), dot(dx, dx) - dot(dy, dy));
    const Vec2 most(std::cos(angle), std::sin(angle)), least(-most.y, most.x);
    const Vec3 strong = normalize_or_zero(most.x * dx + most.y * dy);
    const auto ahead = miss(point, patch, at + step * least), back = miss(point, patch, at - step * least);
    if (!ahead || !back) return std::nullopt;
    const Vec3 first = (*ahead - *back) / (2 * step);
    Vec3 second = (*ahead - 2.0 * *here + *back) / (step * step);
    second -= dot(second, strong) * strong;
    const double bend = dot(second, second);
    if (!(bend > 0)) return std::nullopt;
    return at - (2 * dot(first, second) / bend) * least;
}

/// Newton's method on the place of the film; none where it leaves the patch's surroundings, or finds the
/// point behind the ray.
std::optional<FilmImage> MultiPerspective::solve(const Vec3& point, std::size_t patch, Vec2 at) const {
    const Vec2 half = patches_[patch].half;
    const double reach = 2 * std::max(half.x, half.y);
    for (int i = 0; i < kBlendSteps; ++i) {
        const std::optional<RaySlopes> rays = slopes_of_patch(patch, at);
        if (!rays) return std::nullopt;
        const auto& [here, dx, dy] = miss_slopes(*rays, point);
        const double xx = dot(dx, dx), xy = dot(dx, dy), yy = dot(dy, dy), area = xx * yy - xy * xy;
        if (!(area > 1e-12 * xx * yy)) return std::nullopt;
        const double bx = -dot(dx, here), by = -dot(dy, here);
        Vec2 move = Vec2(yy * bx - xy * by, xx * by - xy * bx) / area;
        if (length(move) > reach) move *= reach / length(move);
        at += move;
        const Vec2 off = glm::abs(at - patches_[patch].middle);
        if (!(off.x <= (1 + 2 * kBeyondPatch) * half.x && off.y <= (1 + 2 * kBeyondPatch) * half.y))
            return std::nullopt;
        if (length(move) > kBlendAtRest * film_.width) continue;
        const auto ray = ray_of_patch(patch, at);
        if (!ray) return std::nullopt;
        const Vec3 from = point - ray->origin;
        const double t = dot(from, ray->direction) / dot(ray->direction, ray->direction);
        // At rest beside the point, not on it: no image.
        if (!(t > 0) || length(from - t * ray->direction) > 1e-6 * length(from)) return std::nullopt;
        return FilmImage{at, t, ray->origin};
    }
    return std::nullopt;
}

}  // namespace

ModelPointer make_model(const MultiPerspectiveCamera& kind, const ModelSource& source) {
    return std::make_shared<MultiPerspective>(kind, source);
}

}  // namespace trilens
