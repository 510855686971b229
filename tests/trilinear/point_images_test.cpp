// Laws of the images of a point: the closed form against a dense sweep in t, special cameras, borders, scale.
#include "trilinear/points/point_images.h"

#include <cmath>
#include <vector>

#include "random_facets.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

using Long = long double;
struct LongVec {
    Long x, y, z;
};
LongVec sub(const LongVec& a, const LongVec& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
LongVec cross3(const LongVec& a, const LongVec& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Long dot3(const LongVec& a, const LongVec& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

// The second answer: nothing but the definition, in long double.
struct Sweep {
    const TrilinearFacet& facet;
    Vec3 point;

    // p_k(t) - X.
    LongVec corner(std::size_t k, Long t) const {
        const Ray& r = facet.corner[k];
        return {r.origin.x + t * r.direction.x - point.x, r.origin.y + t * r.direction.y - point.y,
                r.origin.z + t * r.direction.z - point.z};
    }
    Long determinant(Long t) const { return dot3(corner(0, t), cross3(corner(1, t), corner(2, t))); }

    // Areas of the three triangles that X forms with the sides.
    bool weights(Long t, Long out[3]) const {
        const LongVec p[3] = {corner(0, t), corner(1, t), corner(2, t)};
        const LongVec n = cross3(sub(p[1], p[0]), sub(p[2], p[0]));
        Long sum = 0;
        for (int k = 0; k < 3; ++k) out[k] = dot3(n, cross3(p[(k + 1) % 3], p[(k + 2) % 3])), sum += out[k];
        if (sum == 0) return false;
        for (int k = 0; k < 3; ++k) out[k] /= sum;
        return true;
    }

    Long bisect(Long low, Long high) const {
        const bool rising = determinant(high) > 0;
        for (int i = 0; i < 90; ++i) {
            const Long mid = (low + high) / 2;
            ((determinant(mid) > 0) == rising ? high : low) = mid;
        }
        return (low + high) / 2;
    }

    // Sign changes between samples, and pairs of them around an extremum that comes close to zero.
    void roots_between(const std::vector<Long>& t, std::vector<Long>& found) const {
        std::vector<Long> f;
        for (const Long x : t) f.push_back(determinant(x));
        for (std::size_t i = 0; i + 1 < t.size(); ++i) {
            if ((f[i] > 0) != (f[i + 1] > 0)) found.push_back(bisect(t[i], t[i + 1]));
            if (i == 0 || (f[i] > 0) != (f[i + 1] > 0) || (f[i] > 0) != (f[i - 1] > 0)) continue;
            if (std::fabs(f[i]) >= std::fabs(f[i - 1]) || std::fabs(f[i]) > std::fabs(f[i + 1])) continue;
            Long low = t[i - 1], high = t[i + 1];
            for (int k = 0; k < 200; ++k) {
                const Long a = low + (high - low) * 0.382L, b = low + (high - low) * 0.618L;
                if ((determinant(a) > 0) != (f[i] > 0)) {
                    found.push_back(bisect(t[i - 1], a)), found.push_back(bisect(a, t[i + 1]));
                    break;
                }
                (std::fabs(determinant(a)) < std::fabs(determinant(b)) ? high : low) =
                    std::fabs(determinant(a)) < std::fabs(determinant(b)) ? b : a;
            }
        }
    }

    // Walks t = tan(a) over [0, pi/2), and about every sign change or small value again in steps a hundred
    // times finer.
    std::vector<Long> roots(int samples) const {
        std::vector<Long> t, f;
        for (int i = 0; i <= samples; ++i) {
            t.push_back(std::tan(1.5707L * i / samples));
            f.push_back(determinant(t.back()));
        }
        std::vector<char> close(t.size(), 0);
        for (std::size_t i = 1; i + 1 < t.size(); ++i) {
            const bool changes = (f[i] > 0) != (f[i + 1] > 0) || (f[i] > 0) != (f[i - 1] > 0);
            const bool lowest =
                std::fabs(f[i]) <= std::fabs(f[i - 1]) && std::fabs(f[i]) <= std::fabs(f[i + 1]);
            if (changes || lowest) close[i - 1] = close[i] = 1;
        }
        std::vector<Long> fine;
        for (std::size_t i = 0; i + 1 < t.size(); ++i) {
            const int pieces = close[i] ? 100 : 1;
            for (int k = 0; k < pieces; ++k) fine.push_back(t[i] + (t[i + 1] - t[i]) * k / pieces);
        }
        std::vector<Long> found;
        roots_between(fine, found);
        return found;
    }
};

// Compares the closed form with the sweep; returns the number of images that lie clearly inside.
int compare_with_sweep(const TrilinearFacet& facet, const Vec3& point, int samples, int& unclear) {
    const Coplanarity cubic = make_coplanarity(facet);
    const PointImages images = point_images(cubic, point);
    const Sweep sweep{facet, point};
    std::vector<bool> explained(static_cast<std::size_t>(images.count), false);
    int clear = 0;
    for (const Long t : sweep.roots(samples)) {
        Long w[3];
        if (!sweep.weights(t, w)) continue;
        const Long inside = std::min({w[0], w[1], w[2]});
        bool found = false;
        for (int i = 0; i < images.count; ++i) {
            const PointImage& image = images.image[static_cast<std::size_t>(i)];
            Long apart = std::fabs(image.t - t) / (1 + std::fabs(t));
            for (int k = 0; k < 3; ++k) apart = std::max(apart, std::fabs(image.weights[k] - w[k]));
            if (apart < 1e-5L) found = true, explained[static_cast<std::size_t>(i)] = true;
        }
        if (std::fabs(inside) < 1e-5L && t > 1e-9L) ++unclear;
        if (inside > 1e-5L && t > 1e-9L) {
            ++clear;
            if (!found) {
                FAIL("missing: t " << static_cast<double>(t) << " weights " << static_cast<double>(w[0])
                                   << " " << static_cast<double>(w[1]) << " " << static_cast<double>(w[2]));
            }
        }
    }
    // None extra: each must satisfy the definition by itself, and be one of the sweep's unless it lies on a
    // border or beyond the sweep's end.
    for (int i = 0; i < images.count; ++i) {
        const PointImage& image = images.image[static_cast<std::size_t>(i)];
        const Vec3 miss = facet.point(image.weights, image.t) - point;
        const double size = length(point) + image.t * length(facet.direction(image.weights)) + 1e-30;
        if (length(miss) > 1e-12 * size) FAIL("an image that misses its point by " << length(miss));
        const double border = std::min({image.weights.x, image.weights.y, image.weights.z});
        if (border < -1e-6 || image.t < 0) FAIL("an image outside: " << border << " " << image.t);
        if (explained[static_cast<std::size_t>(i)]) continue;
        if (border > 1e-5 && image.t > 1e-9 && image.t < 1000) {
            FAIL("an image the sweep does not have: t " << image.t << " border " << border);
        }
    }
    return clear;
}

void brute_force(std::uint64_t seed, int trials, int samples) {
    Random random(seed);
    int clear = 0, unclear = 0, several = 0;
    for (int trial = 0; trial < trials; ++trial) {
        const FacetKind kind = static_cast<FacetKind>(trial % static_cast<int>(FacetKind::kCount));
        const TrilinearFacet facet = random_facet(random, kind);
        // Half of the points are planted on a ray of the facet.
        const bool planted = trial % 2 == 0;
        const Vec3 point =
            planted ? facet.point(random.weights(), random.log_uniform(1e-2, 30)) : random.in_box(4);
        INFO("trial " << trial << " kind " << static_cast<int>(kind));
        const int found = compare_with_sweep(facet, point, samples, unclear);
        clear += found, several += found > 1;
    }
    WARN(trials << " points: " << clear << " images, " << several << " points with several, " << unclear
                << " on borders");
    CHECK(clear > trials / 4);
    CHECK(several > trials / 200);
    CHECK(unclear < trials / 200);
}

}  // namespace

TEST_CASE("point images: the cubic agrees with a dense sweep", "[trilinear][point_images][oracle]") {
    brute_force(1, 6000, 300);
}

TEST_CASE("point images: the cubic agrees with a dense sweep, 100,000 points", "[.long][oracle]") {
    brute_force(2, 100000, 1500);
}

TEST_CASE("point images: the precalculated cubic is the determinant",
          "[trilinear][point_images][bad-input][oracle]") {
    Random random(3);
    double worst = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        const double scale = random.log_uniform(1e-4, 1e4);
        TrilinearFacet facet = random_facet(random, FacetKind::kGeneral);
        for (Ray& r : facet.corner) r.origin *= scale, r.direction *= scale;
        const Vec3 point = scale * random.in_box(3);
        const double t = random.uniform(-5, 5);
        const Vec3 a = facet.corner_at(0, t) - point, b = facet.corner_at(1, t) - point,
                   c = facet.corner_at(2, t) - point;
        const double size = length(a) * length(b) * length(c);
        const std::array<double, 4> k = coplanarity_cubic(make_coplanarity(facet), point);
        const double by_cubic = ((k[3] * t + k[2]) * t + k[1]) * t + k[0];
        // F = n . (X - p0) is minus the determinant of the corners seen from X.
        worst = std::max(worst, std::fabs(by_cubic + triple(a, b, c)) / size);
        worst = std::max(worst, std::fabs(side_of_parametric_triangle(make_coplanarity(facet), t, point) +
                                          triple(a, b, c)) /
                                    size);
    }
    CHECK(worst < 1e-10);
}

TEST_CASE("point images: a pinhole images a point once, where perspective puts it",
          "[trilinear][point_images]") {
    Random random(4);
    for (int trial = 0; trial < 20000; ++trial) {
        const TrilinearFacet facet = random_facet(random, FacetKind::kPinhole);
        const Vec3 weights = random.weights();
        const double t = random.log_uniform(1e-3, 1e3);
        const PointImages images = point_images(make_coplanarity(facet), facet.point(weights, t));
        if (images.count != 1) FAIL("trial " << trial << ": " << images.count << " images");
        const double sine =
            std::fabs(triple(normalize(facet.corner[0].direction), normalize(facet.corner[1].direction),
                             normalize(facet.corner[2].direction)));
        const double tolerance = 1e-12 / sine;
        if (std::fabs(images.image[0].t - t) > tolerance * t) FAIL("t at trial " << trial);
        if (length(images.image[0].weights - weights) > tolerance) FAIL("weights at trial " << trial);
    }
}

TEST_CASE("point images: parallel rays image a point once, by projection along them",
          "[trilinear][point_images]") {
    Random random(5);
    for (int trial = 0; trial < 20000; ++trial) {
        const TrilinearFacet facet = random_facet(random, FacetKind::kParallel);
        const Vec3 weights = random.weights();
        const double t = random.log_uniform(1e-3, 1e3);
        const PointImages images = point_images(make_coplanarity(facet), facet.point(weights, t));
        if (images.count != 1) FAIL("trial " << trial << ": " << images.count << " images");
        const Vec3 d = facet.corner[0].direction;
        const Vec3 e1 = facet.corner[1].origin - facet.corner[0].origin,
                   e2 = facet.corner[2].origin - facet.corner[0].origin;
        const double tolerance = 1e-13 * (1 + t) / std::fabs(triple(d, normalize(e1), normalize(e2)));
        if (length(images.image[0].weights - weights) > tolerance / std::min(length(e1), length(e2))) {
            FAIL("weights at trial " << trial);
        }
        if (std::fabs(images.image[0].t - t) > tolerance) FAIL("t at trial " << trial);
    }
}

TEST_CASE("point images: a flat mirror shows a point where its mirror image is seen from the eye",
          "[trilinear][point_images]") {
    Random random(6);
    int seen = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        const Vec3 eye(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0.5, 4));
        TrilinearFacet facet;
        for (Ray& r : facet.corner) {
            r.origin = Vec3(random.uniform(-1, 1), random.uniform(-1, 1), 0);
            r.direction = Vec3(r.origin.x - eye.x, r.origin.y - eye.y, eye.z);
        }
        const Vec3 point(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0.1, 3));
        // The ray from the eye to the point mirrored in z = 0.
        const double s = eye.z / (eye.z + point.z);
        const Vec3 on_mirror(eye.x + s * (point.x - eye.x), eye.y + s * (point.y - eye.y), 0);
        const auto side = [&](std::size_t i, std::size_t j) {
            return cross(facet.corner[j].origin - facet.corner[i].origin, on_mirror - facet.corner[i].origin)
                .z;
        };
        const double area = cross(facet.corner[1].origin - facet.corner[0].origin,
                                  facet.corner[2].origin - facet.corner[0].origin)
                                .z;
        const Vec3 weights = Vec3(side(1, 2), side(2, 0), side(0, 1)) / area;
        const double inside = std::min({weights.x, weights.y, weights.z});
        if (std::fabs(inside) < 1e-6 || std::fabs(area) < 1e-2) continue;
        const PointImages images = point_images(make_coplanarity(facet), point);
        if (images.count != (inside > 0 ? 1 : 0))
            FAIL("trial " << trial << ": " << images.count << " images");
        if (inside < 0) continue;
        ++seen;
        if (length(images.image[0].weights - weights) > 1e-9) FAIL("weights at trial " << trial);
        if (std::fabs(images.image[0].t - point.z / eye.z) > 1e-9) FAIL("t at trial " << trial);
    }
    CHECK(seen > 1000);
}

TEST_CASE("point images: scale and place of the world do not matter", "[trilinear][point_images][law]") {
    Random random(7);
    for (int trial = 0; trial < 5000; ++trial) {
        const TrilinearFacet facet = random_facet(random, FacetKind::kGeneral);
        const Vec3 point = facet.point(random.weights(), random.uniform(0.5, 3));
        const PointImages plain = point_images(make_coplanarity(facet), point);
        const double scale = random.log_uniform(1e-4, 1e4), longer = random.log_uniform(1e-3, 1e3);
        const Vec3 offset = scale * random.in_box(10);
        TrilinearFacet moved = facet;
        for (Ray& r : moved.corner) r.origin = scale * r.origin + offset, r.direction *= scale / longer;
        const PointImages images = point_images(make_coplanarity(moved), scale * point + offset);
        const auto clear = [](const PointImages& list) {
            int count = 0;
            for (const PointImage& i : list) {
                count += std::min({i.weights.x, i.weights.y, i.weights.z}) > 1e-6 && i.t > 1e-6 && i.t < 1e6;
            }
            return count;
        };
        for (const PointImage& a : plain) {
            if (std::min({a.weights.x, a.weights.y, a.weights.z}) < 1e-6 || a.t < 1e-6 || a.t > 1e6) continue;
            bool found = false;
            for (const PointImage& b : images) {
                found |=
                    length(a.weights - b.weights) < 1e-5 && std::fabs(b.t / longer - a.t) < 1e-5 * (1 + a.t);
            }
            if (!found) FAIL("trial " << trial << " of " << clear(plain) << " and " << clear(images));
        }
    }
}

TEST_CASE("point images: a point on a border that two facets share is found", "[trilinear][point_images]") {
    Random random(8);
    for (int trial = 0; trial < 50000; ++trial) {
        const FacetKind kind = static_cast<FacetKind>(trial % static_cast<int>(FacetKind::kCount));
        TrilinearFacet one = random_facet(random, kind), other = one;
        // The second facet lies across the edge (1, 2) of the first, in reverse order; everything far off and
        // small.
        const Vec3 far = random.log_uniform(1e-2, 1e3) * random.on_sphere();
        const double scale = random.log_uniform(1e-2, 1);
        for (Ray& r : one.corner) r.origin = scale * r.origin + far;
        other.corner = {one.corner[2], one.corner[1],
                        Ray{one.corner[1].origin + one.corner[2].origin - one.corner[0].origin,
                            one.corner[1].direction + one.corner[2].direction - one.corner[0].direction}};
        const double u = random.uniform(0, 1);
        const Vec3 point = one.point({0, 1 - u, u}, random.uniform(0.01, 5));
        const int found = point_images(make_coplanarity(one), point).count +
                          point_images(make_coplanarity(other), point).count;
        if (found == 0) FAIL("trial " << trial << " kind " << static_cast<int>(kind));
    }
}

TEST_CASE("point images: degenerate facets have none", "[trilinear][point_images][bad-input]") {
    TrilinearFacet line;
    for (std::size_t k = 0; k < 3; ++k) line.corner[k] = {Vec3(static_cast<double>(k), 0, 0), Vec3(0, 0, 1)};
    CHECK(point_images(make_coplanarity(line), Vec3(0.5, 0, 1)).count == 0);
    TrilinearFacet ray;
    for (Ray& r : ray.corner) r = {Vec3(1, 2, 3), Vec3(0, 0, 1)};
    CHECK(point_images(make_coplanarity(ray), Vec3(1, 2, 4)).count == 0);
    CHECK(point_images(make_coplanarity(TrilinearFacet{}), Vec3(0)).count == 0);
}
