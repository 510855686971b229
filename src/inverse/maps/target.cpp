#include "inverse/maps/target.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string_view>

#include "base/util/error.h"
#include "base/util/format.h"
#include "base/util/names.h"
#include "inverse/maps/number_list.h"

namespace trilens {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kBinSide = 64;

/// Axes of a cube map's face: the direction is axis + s * right - t * up with s, t in -1..1, t downward.
struct CubeFace {
    Vec3 axis, right, down;
};
constexpr std::array<CubeFace, 6> kCubeFaces{{{{1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
                                              {{-1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
                                              {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
                                              {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}},
                                              {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}},
                                              {{0, 0, -1}, {-1, 0, 0}, {0, -1, 0}}}};

TargetPlace equirect_place(const Vec2& pixel, double width, double height) {
    const double longitude = (pixel.x / width - 0.5) * 2 * kPi, latitude = (0.5 - pixel.y / height) * kPi;
    const double cl = std::cos(latitude), sl = std::sin(latitude), so = std::sin(longitude),
                 co = std::cos(longitude);
    const Vec3 east(co, 0, so), north(-so * sl, cl, co * sl);
    return {true, {so * cl, sl, -co * cl}, 2 * kPi / width * cl * east, -kPi / height * north};
}

TargetPlace cubemap_place(const Vec2& pixel, double side) {
    const int index = std::clamp(static_cast<int>(std::floor(pixel.x / side)), 0, 5);
    const CubeFace& face = kCubeFaces[static_cast<std::size_t>(index)];
    const Vec3 far = face.axis + (2 * (pixel.x - index * side) / side - 1) * face.right +
                     (2 * pixel.y / side - 1) * face.down;
    const double l = length(far);
    const Vec3 d = far / l;
    const auto across = [&](const Vec3& moved) { return (moved - d * dot(d, moved)) * (2 / (side * l)); };
    return {true, d, across(face.right), across(face.down)};
}

std::optional<TargetPlace> fisheye_place(const Vec2& pixel, const TargetDescription& d) {
    const double half = 0.5 * d.width, scale = d.fov / 2 * kPi / 180 / half;  // radians per pixel
    const Vec2 from_middle = pixel - Vec2(half);
    const double r = length(from_middle), angle = r * scale;
    if (r > half) return std::nullopt;
    const Vec2 way = r > 0 ? from_middle / r : Vec2(1, 0);
    const Vec3 outward(way.x, 0, -way.y), around(-way.y, 0, -way.x);
    const Vec3 d_radial = scale * (std::cos(angle) * outward - Vec3(0, std::sin(angle), 0));
    const Vec3 d_around = (r > 0 ? std::sin(angle) / r : scale) * around;
    return TargetPlace{true, std::sin(angle) * outward + Vec3(0, std::cos(angle), 0),
                       way.x * d_radial - way.y * d_around, way.y * d_radial + way.x * d_around};
}

TargetPlace rectangle_place(const FlatRectangle& r, const Vec2& pixel, const TargetDescription& d) {
    return {false, r.origin + pixel.x / d.width * r.u + (1 - pixel.y / d.height) * r.v, r.u / double(d.width),
            -r.v / double(d.height)};
}

/// How the weights of a triangle's second and third corner go with steps on its texture coordinates.
struct CornerWeights {
    Vec2 ab{0}, ac{0};
    double twice_area = 0;

    Vec2 of(const Vec2& step) const { return {cross(step, ac) / twice_area, cross(ab, step) / twice_area}; }
};

/// None where the triangle has no area there.
std::optional<CornerWeights> corner_weights(const std::array<Vec2, 3>& uvs) {
    const Vec2 ab = uvs[1] - uvs[0], ac = uvs[2] - uvs[0];
    if (cross(ab, ac) == 0) return std::nullopt;
    return CornerWeights{ab, ac, cross(ab, ac)};
}

}  // namespace

std::optional<FlatRectangle> flat_rectangle(const ObjectMesh& object) {
    // The normal of the whole: the sum over triangles, twice the area of each.
    const auto double_area = [&](const IdTriple& t) {
        return cross(object.points[t[1]] - object.points[t[0]], object.points[t[2]] - object.points[t[0]]);
    };
    Vec3 sum{0};
    double area = 0, size = 0;
    for (const IdTriple& t : object.triangles) {
        const Vec3 n = double_area(t);
        sum += n;
        area += length(n);
    }
    if (!(area > 0) || length(sum) < (1 - 1e-6) * area) return std::nullopt;
    const Vec3 normal = normalize_or_zero(sum);
    const IdTriple& first = *std::ranges::find_if(
        object.triangles, [&](const IdTriple& t) { return length(double_area(t)) > 0; });
    const Vec3& start = object.points[first[0]];
    const Vec3 right = normalize_or_zero(object.points[first[1]] - start), up = cross(normal, right);
    Vec2 low(std::numeric_limits<double>::infinity()), high(-low);
    double off = 0;
    for (const IdTriple& t : object.triangles)
        for (const Id p : t) {
            const Vec3 way = object.points[p] - start;
            low = glm::min(low, Vec2(dot(way, right), dot(way, up)));
            high = glm::max(high, Vec2(dot(way, right), dot(way, up)));
            off = std::max(off, std::fabs(dot(way, normal)));
            size = std::max(size, length(way));
        }
    if (off > 1e-6 * size) return std::nullopt;
    return FlatRectangle{start + low.x * right + low.y * up, (high.x - low.x) * right, (high.y - low.y) * up};
}

Target::Target(const TargetDescription& description, const Scene& scene) : description_(description) {
    const TargetDescription& d = description_;
    if (d.width < 1 || d.height < 1 || 1LL * d.width * d.height > kMostPixels)
        throw UsageError(fmt::format("{} x {} pixels are no picture: at least 1 a side and at most {} in all",
                                     d.width, d.height, kMostPixels));
    if (d.kind == TargetKind::kCubemap && d.width != 6 * d.height)
        throw UsageError("a cube map has six square faces side by side");
    if (d.kind == TargetKind::kFisheye && (d.width != d.height || !(d.fov > 0 && d.fov <= 360)))
        throw UsageError("a fisheye target is square, and 0 to 360 degrees across");
    if (d.kind == TargetKind::kPlane) {
        rectangle_ = FlatRectangle{d.origin, d.u, d.v};
        if (!(length(cross(d.u, d.v)) > 0)) throw UsageError("the target's plane has no area");
    }
    if (d.kind != TargetKind::kObject) return;
    const Mesh& mesh = scene.meshes.at(d.object);
    if (mesh.role != Role::kObject)
        throw InputError(scene_title(scene), mesh.name, "is an optic: pictures are unwrapped to objects");
    object_ = &mesh.object;
    rectangle_ = flat_rectangle(mesh.object);
    if (rectangle_) return;
    const auto& uvs = mesh.object.uvs;
    if (uvs.empty())
        throw InputError(scene_title(scene), mesh.name,
                         "is not flat and has no texture coordinates to unwrap a picture to");
    bins_.resize(static_cast<std::size_t>(kBinSide * kBinSide));
    for (std::size_t t = 0; t < uvs.size(); ++t) {
        const Vec2 low = glm::min(glm::min(uvs[t][0], uvs[t][1]), uvs[t][2]);
        const Vec2 high = glm::max(glm::max(uvs[t][0], uvs[t][1]), uvs[t][2]);
        if (low.x < -1e-9 || low.y < -1e-9 || high.x > 1 + 1e-9 || high.y > 1 + 1e-9)
            throw InputError(scene_title(scene), mesh.name,
                             "repeats its texture: coordinates beyond 0..1 have no place of their own");
        const auto bin = [](double x) { return std::clamp(static_cast<int>(x * kBinSide), 0, kBinSide - 1); };
        for (int y = bin(low.y); y <= bin(high.y); ++y)
            for (int x = bin(low.x); x <= bin(high.x); ++x)
                bins_[static_cast<std::size_t>(y * kBinSide + x)].push_back(static_cast<Id>(t));
    }
}

const std::vector<Id>& Target::triangles_near(const Vec2& uv) const {
    const auto bin = [](double x) { return std::clamp(static_cast<int>(x * kBinSide), 0, kBinSide - 1); };
    return bins_[static_cast<std::size_t>(bin(uv.y) * kBinSide + bin(uv.x))];
}

bool Target::shares_coordinates() const {
    constexpr int kPlaces = 100;
    constexpr double kWellInside = 1e-6;  // weights, so that neighbours share nothing along their edge
    if (bins_.empty()) return false;
    const auto is_inside = [&](Id triangle, const Vec2& uv) {
        const std::array<Vec2, 3>& uvs = object_->uvs[triangle];
        const std::optional<CornerWeights> by = corner_weights(uvs);
        if (!by) return false;
        const Vec2 weights = by->of(uv - uvs[0]);
        return std::min({weights.x, weights.y, 1 - weights.x - weights.y}) > kWellInside;
    };
    for (int y = 0; y < kPlaces; ++y)
        for (int x = 0; x < kPlaces; ++x) {
            const Vec2 uv = (Vec2(x, y) + 0.5) / double(kPlaces);
            const std::vector<Id>& near = triangles_near(uv);
            if (std::count_if(near.begin(), near.end(), [&](Id one) { return is_inside(one, uv); }) > 1)
                return true;
        }
    return false;
}

/// In the triangle's plane; `inside`: none where it does not lie in the triangle.
std::optional<TargetPlace> Target::place_on(Id triangle, const Vec2& pixel, bool inside) const {
    const Vec2 uv(pixel.x / description_.width, 1 - pixel.y / description_.height);
    const std::optional<CornerWeights> by = corner_weights(object_->uvs[triangle]);
    if (!by) return std::nullopt;
    const Vec2 weights = by->of(uv - object_->uvs[triangle][0]);
    if (inside && (weights.x < 0 || weights.y < 0 || weights.x + weights.y > 1)) return std::nullopt;
    const IdTriple& corner = object_->triangles[triangle];
    const Vec3 &p = object_->points[corner[0]], ab = object_->points[corner[1]] - p,
               ac = object_->points[corner[2]] - p;
    const auto moved = [&](const Vec2& step) { return by->of(step).x * ab + by->of(step).y * ac; };
    return TargetPlace{false, p + weights.x * ab + weights.y * ac, moved({1.0 / description_.width, 0}),
                       moved({0, -1.0 / description_.height})};
}

std::optional<TargetPlace> Target::object_place(const Vec2& pixel) const {
    const Vec2 uv(pixel.x / description_.width, 1 - pixel.y / description_.height);
    for (const Id t : triangles_near(uv))
        if (const std::optional<TargetPlace> place = place_on(t, pixel, true)) return place;
    return std::nullopt;
}

/// Those that may lie in the pixel, ascending.
std::vector<Id> Target::triangles_around(const Vec2& pixel) const {
    const Vec2 size(description_.width, description_.height);
    const auto bin = [](double x) { return std::clamp(static_cast<int>(x * kBinSide), 0, kBinSide - 1); };
    const Vec2 low = (pixel - 0.5) / size, high = (pixel + 0.5) / size;
    std::vector<Id> around;
    for (int y = bin(1 - high.y); y <= bin(1 - low.y); ++y)
        for (int x = bin(low.x); x <= bin(high.x); ++x) {
            const std::vector<Id>& near = bins_[static_cast<std::size_t>(y * kBinSide + x)];
            around.insert(around.end(), near.begin(), near.end());
        }
    std::sort(around.begin(), around.end());
    around.erase(std::unique(around.begin(), around.end()), around.end());
    return around;
}

std::optional<TargetPlace> Target::place(const Vec2& pixel) const {
    switch (description_.kind) {
        case TargetKind::kEquirect:
            return equirect_place(pixel, description_.width, description_.height);
        case TargetKind::kCubemap:
            return cubemap_place(pixel, description_.height);
        case TargetKind::kFisheye:
            return fisheye_place(pixel, description_);
        case TargetKind::kPlane:
        case TargetKind::kObject:
            break;
    }
    if (rectangle_) return rectangle_place(*rectangle_, pixel, description_);
    return object_place(pixel);
}

std::optional<Vec2> Target::pixel_of_direction(const Vec3& direction) const {
    const Vec3 d = normalize_or_zero(direction);
    if (d == Vec3(0)) return std::nullopt;
    const double width = description_.width, height = description_.height;
    if (description_.kind == TargetKind::kEquirect)
        return Vec2((0.5 + std::atan2(d.x, -d.z) / (2 * kPi)) * width,
                    std::atan2(std::hypot(d.x, d.z), d.y) / kPi * height);
    if (description_.kind == TargetKind::kFisheye) {
        const double across = std::hypot(d.x, d.z), angle = std::atan2(across, d.y);
        const double r = angle / (description_.fov / 2 * kPi / 180) * 0.5 * width;
        if (r > 0.5 * width) return std::nullopt;
        return Vec2(0.5 * width) + (across > 0 ? r / across : 0) * Vec2(d.x, -d.z);
    }
    if (description_.kind != TargetKind::kCubemap) return std::nullopt;
    std::size_t best = 0;
    for (std::size_t f = 1; f < 6; ++f)
        if (dot(d, kCubeFaces[f].axis) > dot(d, kCubeFaces[best].axis)) best = f;
    const CubeFace& face = kCubeFaces[best];
    const Vec3 far = d / dot(d, face.axis);
    return Vec2((static_cast<double>(best) + 0.5 + 0.5 * dot(far, face.right)) * height,
                (0.5 + 0.5 * dot(far, face.down)) * height);
}

std::optional<Vec2> Target::pixel_of_point(const Vec3& point, Id triangle) const {
    const double width = description_.width, height = description_.height;
    if (rectangle_) {
        // Coordinates along sides that need not be at right angles.
        const Vec3 way = point - rectangle_->origin, n = cross(rectangle_->u, rectangle_->v);
        const double whole = dot(n, n);
        const Vec2 uv(dot(cross(way, rectangle_->v), n) / whole, dot(cross(rectangle_->u, way), n) / whole);
        if (uv.x < 0 || uv.y < 0 || uv.x > 1 || uv.y > 1) return std::nullopt;
        return Vec2(uv.x * width, (1 - uv.y) * height);
    }
    if (!object_ || triangle >= object_->uvs.size()) return std::nullopt;
    const auto& [a, b, c] = object_->uvs[triangle];
    const IdTriple& corner = object_->triangles[triangle];
    const Vec3 &p = object_->points[corner[0]], ab = object_->points[corner[1]] - p,
               ac = object_->points[corner[2]] - p, n = cross(ab, ac);
    const double whole = dot(n, n);
    if (!(whole > 0)) return std::nullopt;
    const Vec2 uv =
        a + dot(cross(point - p, ac), n) / whole * (b - a) + dot(cross(ab, point - p), n) / whole * (c - a);
    return Vec2(uv.x * width, (1 - uv.y) * height);
}

double Target::measure(const TargetPlace& place) const {
    return length(cross(place.dx, place.dy));
}

// Targets and proxies as people write them: "equirect:2048x1024", "plane:0,0,0,1,0,0,0,1,0,800x600".

namespace {

struct PixelSize {
    int width = 0, height = 0;
};

std::optional<PixelSize> size_of(std::string_view text) {
    const std::size_t x = text.find('x');
    if (x == std::string_view::npos) return std::nullopt;
    const auto width = whole_number(text.substr(0, x)), height = whole_number(text.substr(x + 1));
    if (!width || !height) return std::nullopt;
    return PixelSize{*width, *height};
}

TargetDescription plane_of(const std::string& text, const std::string& values) {
    const std::size_t comma = values.rfind(',');
    const auto numbers = comma == std::string::npos ? std::nullopt : number_list(values.substr(0, comma));
    const auto size = comma == std::string::npos ? std::nullopt : size_of(values.substr(comma + 1));
    if (!numbers || numbers->size() != 9 || !size)
        throw UsageError(
            "a plane is plane:ox,oy,oz,ux,uy,uz,vx,vy,vz,WxH (lower left corner, side to the "
            "right, side upward), not \"" +
            text + "\"");
    const auto vector = [&](std::size_t i) {
        return Vec3((*numbers)[i], (*numbers)[i + 1], (*numbers)[i + 2]);
    };
    return {TargetKind::kPlane, size->width, size->height, vector(0), vector(3), vector(6)};
}

TargetDescription object_of(const std::string& text, const Scene& scene) {
    const std::size_t colon = text.rfind(':');
    auto size = colon == std::string::npos ? std::nullopt : size_of(std::string_view(text).substr(colon + 1));
    const std::string name = size ? text.substr(0, colon) : text;
    std::vector<std::string> names;
    TargetDescription target;
    target.kind = TargetKind::kObject;
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        if (scene.meshes[m].name == name) target.object = static_cast<Id>(m);
        if (scene.meshes[m].role == Role::kObject) names.push_back(scene.meshes[m].name);
    }
    if (target.object == kNone)
        throw UsageError("the target \"" + text +
                         "\" is neither equirect:WxH, cubemap:N, fisheye:N, plane:... nor an object" +
                         suggestion(name, names));
    if (!size) {
        const auto flat = flat_rectangle(scene.meshes[target.object].object);
        const double aspect = flat ? length(flat->u) / length(flat->v) : 1;
        size = aspect >= 1 ? PixelSize{1024, std::max(1, static_cast<int>(1024 / aspect + 0.5))}
                           : PixelSize{std::max(1, static_cast<int>(1024 * aspect + 0.5)), 1024};
    }
    target.width = size->width;
    target.height = size->height;
    return target;
}

}  // namespace

TargetDescription parse_target(const std::string& text, const Scene& scene) {
    const std::size_t colon = text.find(':');
    const std::string kind = text.substr(0, colon),
                      values = colon == std::string::npos ? "" : text.substr(colon + 1);
    if (kind == "equirect" && colon != std::string::npos) {
        const auto size = size_of(values);
        if (!size) throw UsageError("an equirect target is equirect:WxH, not \"" + text + "\"");
        return {TargetKind::kEquirect, size->width, size->height};
    }
    if (kind == "cubemap" && colon != std::string::npos) {
        const auto side = whole_number(values);
        if (!side || *side > kMostFilmSide) throw UsageError("a cube map is cubemap:N, not \"" + text + "\"");
        return {TargetKind::kCubemap, 6 * *side, *side};
    }
    if (kind == "fisheye" && colon != std::string::npos) {
        const std::size_t second = values.find(':');
        const auto side = whole_number(values.substr(0, second));
        const auto fov = second == std::string::npos ? std::optional(std::vector<double>{180})
                                                     : number_list(values.substr(second + 1));
        if (!side || !fov || fov->size() != 1)
            throw UsageError("a fisheye target is fisheye:N or fisheye:N:DEGREES, not \"" + text + "\"");
        TargetDescription target{TargetKind::kFisheye, *side, *side};
        target.fov = fov->front();
        return target;
    }
    if (kind == "plane" && colon != std::string::npos) return plane_of(text, values);
    return object_of(text, scene);
}

}  // namespace trilens
