// Context in planar navigation: the near ground as one walks it, the far ground turned up like a map.
//
// In the plane of heading and ground normal the bent ground is a flat piece, an arc and a straight tail. A
// film ray, straight from the eye, meets the bent ground under some turn beta; turned back by beta about the
// ground point it is a ray of the flat world. The eyes of these rays lie on a curve: rays are continuous.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "camera/model/models.h"

namespace trilens {
namespace {

constexpr double kArcRadians = std::numbers::pi / 180;
constexpr int kArcStrips =
    16;  // of the arc, each a branch: points above the ground may be seen several times
constexpr std::size_t kScan =
    24;                        // intervals of a strip and its surroundings in which an image is looked for
constexpr int kHalvings = 60;  // of one of them
constexpr double kBeyondStrip = 2;  // a strip's formula goes on by so many of its sizes at both ends

/// Turned back by `angle`.
Vec2 turned_back(const Vec2& v, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * v.x + s * v.y, -s * v.x + c * v.y};
}

/// Where a ray meets the bent ground; the branches are the flat piece, the tail and the strips of the arc.
enum class Zone { kFlat, kArc, kTail };
enum Branch : std::size_t { kFlatBranch, kTailBranch, kFirstStrip, kBranches = kFirstStrip + kArcStrips };

class PlanarContext final : public CameraModel {
  public:
    PlanarContext(const PlanarContextCamera& from, const ModelSource& source);
    std::optional<Ray> ray(const Vec2& at) const override;
    std::size_t branch_count() const override { return kBranches; }
    std::optional<FilmImage> place(const Vec3& point, std::size_t branch) const override;
    std::vector<FilmImage> places(const Vec3& point, std::size_t branch) const override;
    bool shows(std::size_t branch, const Vec2& at) const override {
        const Met where = met(across(direction_at(at)));
        if (where.zone == Zone::kFlat) return branch == kFlatBranch;
        if (where.zone == Zone::kTail) return branch == kTailBranch;
        const auto strip = static_cast<std::size_t>(where.beta / angle_ * kArcStrips);
        return branch == kFirstStrip + std::min<std::size_t>(strip, kArcStrips - 1);
    }
    std::vector<double> breaks_y() const override;
    double focus() const override { return focus_; }

  private:
    /// Where a ray of the plane meets the bent ground.
    struct Met {
        Zone zone = Zone::kFlat;
        double beta = 0;
    };
    Met met(const Vec2& direction) const;

    Vec3 direction_at(const Vec2& at) const {
        const Vec2 middle(0.5 * film_.width, 0.5 * film_.height);
        return axes_.to_world({(at.x - middle.x) / focal_, (middle.y - at.y) / focal_, 1});
    }
    std::optional<Vec2> pixel_of(const Vec3& direction) const {
        const Vec3 local = axes_.from_world(direction);
        if (!(local.z > 0)) return std::nullopt;
        return Vec2(0.5 * film_.width + focal_ * local.x / local.z,
                    0.5 * film_.height - focal_ * local.y / local.z);
    }
    Vec2 across(const Vec3& v) const { return {dot(v, heading_), dot(v, normal_)}; }
    Vec3 to_world(const Vec2& in_plane, double aside) const {
        return in_plane.x * heading_ + in_plane.y * normal_ + aside * side_;
    }
    Vec2 bent_ground(double beta) const {
        return {bend_ + radius_ * std::sin(beta), radius_ * (1 - std::cos(beta))};
    }
    Vec2 flat_ground(double beta) const { return {bend_ + radius_ * beta, 0}; }
    /// The eye as the flat world sees it from the ground that is turned by beta.
    Vec2 eye_for(double beta) const {
        return flat_ground(beta) + turned_back(eye_ - bent_ground(beta), beta);
    }
    /// Across which the point lies from the ray that meets the arc at beta.
    double miss(const Vec2& point, double beta) const {
        return cross(point - flat_ground(beta), turned_back(bent_ground(beta) - eye_, beta));
    }
    double root_between(const Vec2& point, double from, double to) const;
    double nearest_miss(const Vec2& point, double from, double to) const;
    std::vector<double> betas_of(const Vec2& point, std::size_t strip) const;
    std::optional<FilmImage> image_at(const Vec3& point, double beta) const;

    FilmAxes axes_;
    FilmSize film_;
    double focus_, focal_ = 1;
    Vec3 foot_{0}, heading_{0}, normal_{0}, side_{0};  // foot: of the eye on the ground
    Vec2 eye_{0};
    double bend_ = 1, angle_ = 1, radius_ = 1;
};

PlanarContext::PlanarContext(const PlanarContextCamera& from, const ModelSource& source)
    : axes_(source.axes()), film_(source.film), focus_(source.focus()) {
    const Vec3& eye = source.from.eye;
    if (!(from.yfov > 0 && from.yfov < 180))
        source.site.reject("yfov", "the angle must lie between 0 and 180 degrees");
    focal_ = 0.5 * film_.height / std::tan(0.5 * from.yfov * kArcRadians);
    normal_ = normalize_or_zero(from.ground_normal);
    if (normal_ == Vec3(0)) source.site.reject("ground", "its normal must not be zero");
    const double height = dot(eye - from.ground_point, normal_);
    if (!(height > 0)) source.site.reject("ground", "the eye must stand above the ground");
    heading_ = normalize_or_zero(axes_.forward - dot(axes_.forward, normal_) * normal_);
    if (!(length(cross(axes_.forward, normal_)) > 1e-9))
        source.site.reject("lookAt", "looks straight along the ground's normal: it has no heading");
    if (!(from.bend > 0 && std::isfinite(from.bend)))
        source.site.reject("bend", "must be a positive distance");
    if (!(from.angle > 0 && from.angle <= 90))
        source.site.reject("angle", "the ground turns up by more than 0 and at most 90 degrees");
    side_ = cross(heading_, normal_);
    foot_ = eye - height * normal_;
    eye_ = {0, height};
    bend_ = from.bend;
    angle_ = from.angle * kArcRadians;
    radius_ = bend_ / angle_;
}

PlanarContext::Met PlanarContext::met(const Vec2& direction) const {
    if (direction.y < 0 && direction.x * eye_.y <= -direction.y * bend_) return {Zone::kFlat, 0};
    const Met tail{Zone::kTail, angle_};
    const double elevation = std::atan2(direction.y, direction.x);
    if (elevation >= angle_) return tail;

    // Out of the arc's circle.
    const Vec2 from_middle = eye_ - Vec2(bend_, radius_);
    const double a = dot(direction, direction), b = dot(from_middle, direction),
                 c = dot(from_middle, from_middle) - radius_ * radius_;
    const double root = b * b - a * c;
    if (!(root >= 0)) return tail;
    const Vec2 out = from_middle + ((-b + std::sqrt(root)) / a) * direction;
    const double beta = std::atan2(out.x, -out.y);
    return beta >= angle_ || beta < -0.5 * std::numbers::pi ? tail : Met{Zone::kArc, std::max(beta, 0.0)};
}

std::optional<Ray> PlanarContext::ray(const Vec2& at) const {
    const Vec3 direction = direction_at(at);
    const Met where = met(across(direction));
    return Ray{foot_ + to_world(eye_for(where.beta), 0),
               to_world(turned_back(across(direction), where.beta), dot(direction, side_))};
}

/// Between two turns at which the miss has different signs.
double PlanarContext::root_between(const Vec2& point, double from, double to) const {
    const bool negative = miss(point, from) < 0;
    for (int halving = 0; halving < kHalvings; ++halving) {
        const double half = 0.5 * (from + to);
        ((miss(point, half) < 0) == negative ? from : to) = half;
    }
    return 0.5 * (from + to);
}

/// The turn between two at which the miss is nearest to changing its sign, by golden sections.
double PlanarContext::nearest_miss(const Vec2& point, double from, double to) const {
    const double sign = miss(point, from) < 0 ? -1 : 1, golden = 0.5 * (std::sqrt(5.0) - 1);
    for (int step = 0; step < kHalvings; ++step) {
        const double a = to - golden * (to - from), b = from + golden * (to - from);
        if (sign * miss(point, a) < sign * miss(point, b))
            to = b;
        else
            from = a;
    }
    return 0.5 * (from + to);
}

/// All turns around the strip at which the ray through the arc meets the point, ahead along the ray and not
/// behind the eye; two that are about to merge at a fold among them.
std::vector<double> PlanarContext::betas_of(const Vec2& point, std::size_t strip) const {
    const double size = angle_ / kArcStrips, middle = (static_cast<double>(strip) + 0.5) * size;
    const double low = middle - (0.5 + kBeyondStrip) * size, high = middle + (0.5 + kBeyondStrip) * size;
    std::array<double, kScan + 1> beta, missed;
    for (std::size_t k = 0; k <= kScan; ++k) {
        beta[k] = low + (high - low) * static_cast<double>(k) / kScan;
        missed[k] = miss(point, beta[k]);
    }
    const auto differ = [](double a, double b) { return (a < 0) != (b < 0); };
    std::vector<double> found;
    const auto add = [&](double from, double to) {
        const double at = root_between(point, from, to);
        if (dot(point - eye_for(at), turned_back(bent_ground(at) - eye_, at)) > 0) found.push_back(at);
    };
    for (std::size_t k = 0; k < kScan; ++k) {
        if (differ(missed[k], missed[k + 1])) add(beta[k], beta[k + 1]);
        if (k == 0 || differ(missed[k - 1], missed[k]) || differ(missed[k], missed[k + 1])) continue;
        // A dip towards 0 between three of one sign may hide two.
        const double least = std::fabs(missed[k]);
        if (least > std::fabs(missed[k - 1]) || least > std::fabs(missed[k + 1])) continue;
        const double dip = nearest_miss(point, beta[k - 1], beta[k + 1]);
        if (!differ(miss(point, dip), missed[k])) continue;
        add(beta[k - 1], dip);
        add(dip, beta[k + 1]);
    }
    return found;
}

std::optional<FilmImage> PlanarContext::image_at(const Vec3& point, double beta) const {
    const Vec2 there = across(point - foot_);
    const Vec2 origin = eye_for(beta), way = turned_back(there - origin, -beta);
    const Vec3 direction = to_world(way, dot(point - foot_, side_));
    const std::optional<Vec2> pixel = pixel_of(direction);
    if (!pixel) return std::nullopt;
    return FilmImage{*pixel, dot(direction, axes_.forward), foot_ + to_world(origin, 0)};
}

/// Of several the one nearest to the strip's middle.
std::optional<FilmImage> PlanarContext::place(const Vec3& point, std::size_t branch) const {
    if (branch < kFirstStrip) return image_at(point, branch == kTailBranch ? angle_ : 0);
    const std::size_t strip = branch - kFirstStrip;
    const double middle = (static_cast<double>(strip) + 0.5) * angle_ / kArcStrips;
    const std::vector<double> betas = betas_of(across(point - foot_), strip);
    const auto nearest = std::min_element(betas.begin(), betas.end(), [&](double a, double b) {
        return std::fabs(a - middle) < std::fabs(b - middle);
    });
    return nearest == betas.end() ? std::nullopt : image_at(point, *nearest);
}

std::vector<FilmImage> PlanarContext::places(const Vec3& point, std::size_t branch) const {
    if (branch < kFirstStrip) return CameraModel::places(point, branch);
    std::vector<FilmImage> images;
    for (const double beta : betas_of(across(point - foot_), branch - kFirstStrip))
        if (const std::optional<FilmImage> image = image_at(point, beta)) images.push_back(*image);
    return images;
}

std::vector<double> PlanarContext::breaks_y() const {
    std::vector<double> breaks;
    if (std::fabs(dot(axes_.right, normal_)) > 1e-9) return breaks;
    for (const double beta : {0.0, angle_})
        if (const auto pixel = pixel_of(to_world(bent_ground(beta) - eye_, 0))) breaks.push_back(pixel->y);
    return breaks;
}

}  // namespace

ModelPointer make_model(const PlanarContextCamera& kind, const ModelSource& source) {
    return std::make_shared<PlanarContext>(kind, source);
}

}  // namespace trilens
