// Sphere normals and gradient noise, for grids and for exact surfaces alike.
#include "surfaces/normal_override.h"

#include <array>
#include <cmath>
#include <utility>

#include "base/util/check.h"
#include "surfaces/polynomial/face_hulls.h"

namespace trilens {
namespace {

/// A well mixed 64-bit number (Steele, Lea and Flood, Fast Splittable Pseudorandom Number Generators, 2014).
std::uint64_t mixed(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

using LatticePoint = std::array<std::int64_t, 3>;

/// dot(gradient of this lattice point, offset), with Perlin's twelve gradients: the edge middles of a cube.
double lattice_slope(const LatticePoint& at, std::uint64_t seed, const Vec3& offset) {
    std::uint64_t hash = mixed(seed);
    for (const std::int64_t coordinate : at) hash = mixed(hash ^ static_cast<std::uint64_t>(coordinate));
    const std::uint64_t edge = (hash >> 32) % 12;
    const double first = edge % 4 < 2 ? 1 : -1, second = edge % 2 == 0 ? 1 : -1;
    if (edge < 4) return first * offset.x + second * offset.y;
    if (edge < 8) return first * offset.y + second * offset.z;
    return first * offset.z + second * offset.x;
}

/// Perlin's quintic blend: first and second derivatives vanish at 0 and 1, so the noise is twice
/// differentiable.
double fade(double x) {
    return x * x * x * (x * (x * 6 - 15) + 10);
}

/// Gradient noise in about [-1, 1] (Perlin, Improving Noise, 2002), with a hash in place of the permutation
/// table.
double gradient_noise(const Vec3& position, std::uint64_t seed) {
    const Vec3 cell = glm::floor(position), inside = position - cell;
    const LatticePoint base{static_cast<std::int64_t>(cell.x), static_cast<std::int64_t>(cell.y),
                            static_cast<std::int64_t>(cell.z)};
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const std::array<int, 3> step{corner & 1, (corner >> 1) & 1, corner >> 2};
        double weight = 1;
        Vec3 offset(0);
        LatticePoint at{};
        for (int k = 0; k < 3; ++k) {
            const auto axis = static_cast<std::size_t>(k);
            weight *= step[axis] ? fade(inside[k]) : 1 - fade(inside[k]);
            offset[k] = inside[k] - step[axis];
            at[axis] = base[axis] + step[axis];
        }
        sum += weight * lattice_slope(at, seed, offset);
    }
    return sum;
}

Vec3 tilted(const NormalField& field, const Vec3& position, const Vec3& own) {
    const Vec3 where = position * field.scale;
    Vec3 noise;
    for (int k = 0; k < 3; ++k)
        noise[k] = gradient_noise(where, mixed(field.seed) + static_cast<std::uint64_t>(k));

    // Only the part along the surface, so that no amplitude can turn the normal to the other side.
    const Vec3 tangential = noise - dot(noise, own) * own;
    return normalize_or_zero(own + field.amplitude * tangential);
}

/// The normal at a point of a face.
using NormalAt = std::function<Vec3(Id face, const Vec2& uv, const SurfacePoint& point)>;

/// A surface that answers with another normal.
class BorrowedNormals final : public Surface, public HasHulls {
  public:
    BorrowedNormals(std::shared_ptr<const Surface> surface, NormalAt normal)
        : surface_(std::move(surface)), normal_(std::move(normal)) {}

    std::size_t face_count() const override { return surface_->face_count(); }
    FaceDomain domain(Id face) const override { return surface_->domain(face); }
    FaceBorder border(Id face) const override { return surface_->border(face); }

    SurfacePoint eval(Id face, const Vec2& uv) const override {
        return turned(face, uv, surface_->eval(face, uv));
    }
    SurfacePoint eval_first_order(Id face, const Vec2& uv) const override {
        return turned(face, uv, surface_->eval_first_order(face, uv));
    }

    std::size_t bytes_held() const override { return surface_->bytes_held(); }
    std::optional<Box> hull(Id face) const override {
        const auto* known = dynamic_cast<const HasHulls*>(surface_.get());
        return known ? known->hull(face) : std::nullopt;
    }

    bool has_closed_form() const override { return surface_->has_closed_form(); }
    std::optional<SurfaceHit> intersect(const Ray& ray, double t_min) const override {
        std::optional<SurfaceHit> hit = surface_->intersect(ray, t_min);
        if (hit) hit->point = turned(hit->face, hit->uv, hit->point);
        return hit;
    }

  private:
    SurfacePoint turned(Id face, const Vec2& uv, SurfacePoint point) const {
        point.normal = normal_(face, uv, point);
        return point;
    }

    std::shared_ptr<const Surface> surface_;
    NormalAt normal_;
};

}  // namespace

Vec3 eval_normal(const NormalField& field, const Vec3& position, const Vec3& own) {
    if (field.type == NormalField::Type::kSphere) {
        const Vec3 outward = normalize_or_zero(position - field.center);
        return dot(outward, own) < 0 ? -outward : outward;
    }
    if (field.type == NormalField::Type::kNoise && own != Vec3(0)) return tilted(field, position, own);
    return own;
}

void override_normals(SurfaceGrid& grid, const NormalField& field) {
    for (std::size_t k = 0; k < grid.corner_normal.size(); ++k) {
        Vec3& normal = grid.corner_normal[k];
        normal = eval_normal(field, grid.points[grid.corner_point[k]], normal);
    }
}

std::unique_ptr<Surface> with_normals(std::shared_ptr<const Surface> surface, const NormalField& field) {
    TRILENS_CHECK(surface != nullptr, "there must be a surface to turn the normals of");
    return std::make_unique<BorrowedNormals>(std::move(surface),
                                             [field](Id, const Vec2&, const SurfacePoint& point) {
                                                 return eval_normal(field, point.position, point.normal);
                                             });
}

std::unique_ptr<Surface> with_normal_map(std::shared_ptr<const Surface> surface, TexturePlaces places,
                                         MapNormals normals) {
    TRILENS_CHECK(surface != nullptr, "there must be a surface to turn the normals of");
    return std::make_unique<BorrowedNormals>(
        std::move(surface), [places = std::move(places), normals = std::move(normals)](
                                Id face, const Vec2& uv, const SurfacePoint& point) {
            const TexturePlace place = places(face, uv, point);
            const Vec3& own = point.normal;
            const Vec3 tangent = normalize_or_zero(place.along_u - dot(place.along_u, own) * own);
            if (tangent == Vec3(0) || own == Vec3(0)) return own;
            Vec3 bitangent = cross(own, tangent);
            if (dot(bitangent, place.along_v) < 0) bitangent = -bitangent;
            const Vec3 in_map = normals(place.uv);
            const Vec3 turned = normalize_or_zero(in_map.x * tangent + in_map.y * bitangent + in_map.z * own);
            return turned == Vec3(0) ? own : turned;
        });
}

}  // namespace trilens
