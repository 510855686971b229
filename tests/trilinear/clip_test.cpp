// Laws of clipping and of the ways to draw curves: borders, continuity across facets, partition, convergence,
// scale.
#include <algorithm>
#include <cmath>
#include <set>

#include "random_facets.h"
#include "support/test.h"
#include "trilinear/outline.h"

using namespace trilens;
using namespace trilens_test;

namespace {

double least(const Vec3& w) {
    return std::min({w.x, w.y, w.z});
}

bool holds(const std::vector<Outline>& outlines, const Vec3& w) {
    bool inside = false;
    for (const Outline& outline : outlines) {
        const std::size_t n = outline.vertex.size();
        for (std::size_t i = 0; i < n; ++i) {
            const Vec3 &a = outline.vertex[i].weights, &b = outline.vertex[(i + 1) % n].weights;
            if ((a.z > w.z) != (b.z > w.z) && w.y < a.y + (w.z - a.z) / (b.z - a.z) * (b.y - a.y))
                inside = !inside;
        }
    }
    return inside;
}

bool ray_meets(const TrilinearFacet& facet, const SceneTriangle& triangle, const Vec3& w) {
    const auto hit = plane_hit(facet, triangle, w);
    return hit && hit->t >= 0 && least(hit->barycentric) >= 0;
}

SceneTriangle triangle_about(Random& random, const TrilinearFacet& facet, double size) {
    const Vec3 seen = facet.point(random.weights(), random.log_uniform(0.3, 5));
    return {{seen + random.in_box(size), seen + random.in_box(size), seen + random.in_box(size)}};
}

const Curves kAllCurves[] = {Curves::kStraight, Curves::kSlices, Curves::kTessellate, Curves::kArcs};

}  // namespace

TEST_CASE("clip: clipped outlines stay in the facet, and every vertex is seen where it says",
          "[trilinear][clip][law]") {
    Random random(1);
    int vertices = 0, on_border = 0;
    double worst = 0;
    for (int trial = 0; trial < 4000; ++trial) {
        const TrilinearFacet facet =
            random_facet(random, static_cast<FacetKind>(trial % static_cast<int>(FacetKind::kCount)));
        const SceneTriangle triangle = triangle_about(random, facet, 3);
        ShapeParams params;
        params.curves = kAllCurves[trial % 4], params.pieces = 3;
        params.clip = trial % 8 < 4 ? Clip::kScene : Clip::kScreen;
        for (const Outline& outline : project_triangle(facet, triangle, params)) {
            for (const ImageVertex& v : outline.vertex) {
                ++vertices, on_border += least(v.weights) == 0;
                if (least(v.weights) < -1e-15) FAIL("outside at trial " << trial << ": " << least(v.weights));
                if (std::fabs(v.weights.x + v.weights.y + v.weights.z - 1) > 1e-12)
                    FAIL("sum at trial " << trial);
                const Vec3 miss = facet.point(v.weights, v.t) - triangle.point(v.barycentric);
                if (params.clip == Clip::kScene) worst = std::max(worst, length(miss) / (1 + std::fabs(v.t)));
            }
        }
    }
    CHECK(vertices > 10000);
    CHECK(on_border > vertices / 20);
    CHECK(worst < 1e-4);
}

TEST_CASE("clip: facets that share an edge cut the scene at the same points, bit by bit",
          "[trilinear][clip][law]") {
    Random random(2);
    int shared = 0;
    for (int trial = 0; trial < 6000; ++trial) {
        const FacetKind kind = static_cast<FacetKind>(trial % static_cast<int>(FacetKind::kCount));
        const TrilinearFacet one = random_facet(random, kind);
        // Across the edge from corner 1 to corner 2; its corners in another order.
        TrilinearFacet other;
        other.corner = {one.corner[2], one.corner[1],
                        Ray{one.corner[1].origin + one.corner[2].origin - one.corner[0].origin,
                            one.corner[1].direction + one.corner[2].direction - one.corner[0].direction +
                                random.in_box(0.1)}};
        const SceneTriangle triangle = triangle_about(random, one, 3);
        ShapeParams params;
        params.curves = kAllCurves[trial % 4], params.pieces = 2;
        const auto places = [&](const TrilinearFacet& facet, int from, int to, int opposite) {
            std::set<std::array<double, 3>> found;
            for (const Outline& outline : project_triangle(facet, triangle, params)) {
                for (const ImageVertex& v : outline.vertex) {
                    // Corners of the facet belong to its border, not to the scene's edges.
                    const bool corner = v.weights[from] == 0 || v.weights[to] == 0;
                    if (v.weights[opposite] == 0 && !corner)
                        found.insert({v.t, v.weights[from], v.weights[to]});
                }
            }
            return found;
        };
        const auto a = places(one, 1, 2, 0), b = places(other, 1, 0, 2);
        shared += static_cast<int>(a.size());
        if (a != b)
            FAIL("trial " << trial << " kind " << static_cast<int>(kind) << ": " << a.size() << " and "
                          << b.size());
    }
    CHECK(shared > 1000);
}

TEST_CASE("clip: triangles of a fan divide the facet without gap or overlap", "[trilinear][clip]") {
    // Exact arcs of a common edge are the same points, so the even-odd answer flips from one triangle to the
    // other.
    Random random(3);
    int covered = 0;
    for (int trial = 0; trial < 600; ++trial) {
        const TrilinearFacet facet =
            random_facet(random, static_cast<FacetKind>(trial % static_cast<int>(FacetKind::kCount)));
        const SceneTriangle whole = triangle_about(random, facet, 4);
        const Vec3 middle = whole.point(random.weights());
        std::vector<Outline> parts[3];
        ShapeParams params;
        params.tolerance = 1e-2;
        for (std::size_t e = 0; e < 3; ++e) {
            parts[e] = project_triangle(facet, {{whole.from(e), whole.to(e), middle}}, params);
        }
        const std::vector<Outline> all = project_triangle(facet, whole, params);
        for (int i = 0; i < 100; ++i) {
            const Vec3 w = random.weights();
            const int count = holds(parts[0], w) + holds(parts[1], w) + holds(parts[2], w);
            if (count != (holds(all, w) ? 1 : 0))
                FAIL("trial " << trial << ": in " << count << " of the parts");
            covered += count;
        }
    }
    CHECK(covered > 5000);
}

TEST_CASE("clip: slices and tessellation approach the exact image as their number grows",
          "[trilinear][clip][law][many]") {
    for (const Curves curves : {Curves::kSlices, Curves::kTessellate}) {
        for (const Clip clip : {Clip::kScreen, Clip::kScene}) {
            double wrong[3] = {0, 0, 0};
            for (int level = 0; level < 3; ++level) {
                Random random(4);
                for (int trial = 0; trial < 400; ++trial) {
                    const TrilinearFacet facet =
                        random_facet(random, trial % 2 ? FacetKind::kGeneral : FacetKind::kConcave);
                    const SceneTriangle triangle = triangle_about(random, facet, 2);
                    ShapeParams params;
                    params.curves = curves, params.clip = clip, params.pieces = 1 << (2 * level);
                    const std::vector<Outline> outlines = project_triangle(facet, triangle, params);
                    for (int i = 0; i < 200; ++i) {
                        const Vec3 w = random.weights();
                        // Pieces are drawn one by one; a point in two of them is still covered once.
                        bool seen = false;
                        if (curves == Curves::kTessellate) {
                            for (const Outline& o : outlines) seen |= holds({o}, w);
                        } else {
                            seen = holds(outlines, w);
                        }
                        wrong[level] += seen != ray_meets(facet, triangle, w);
                    }
                }
            }
            WARN("curves " << static_cast<int>(curves) << " clip " << static_cast<int>(clip) << ": wrong "
                           << wrong[0] << " " << wrong[1] << " " << wrong[2]
                           << " of 80000 for 1, 4, 16 pieces");
            CHECK(wrong[1] < 0.6 * wrong[0]);
            CHECK(wrong[2] < 0.5 * wrong[1]);
        }
    }
}

TEST_CASE("clip: scale and place of the world change nothing that is seen", "[trilinear][clip][law]") {
    Random random(5);
    for (int trial = 0; trial < 1500; ++trial) {
        TrilinearFacet facet =
            random_facet(random, static_cast<FacetKind>(trial % static_cast<int>(FacetKind::kCount)));
        SceneTriangle triangle = triangle_about(random, facet, 2);
        const double scale = random.log_uniform(1e-4, 1e4), longer = random.log_uniform(1e-2, 1e2);
        const Vec3 offset = scale * random.in_box(5);
        const std::vector<Outline> plain = project_triangle(facet, triangle);
        TrilinearFacet moved = facet;
        SceneTriangle moved_triangle = triangle;
        for (Ray& r : moved.corner) r.origin = scale * r.origin + offset, r.direction *= scale * longer;
        for (Vec3& c : moved_triangle.corner) c = scale * c + offset;
        const std::vector<Outline> other = project_triangle(moved, moved_triangle);
        int differ = 0;
        for (int i = 0; i < 100; ++i) {
            const Vec3 w = random.weights();
            differ += holds(plain, w) != holds(other, w);
        }
        if (differ > 2) FAIL("trial " << trial << ": " << differ << " of 100");
    }
}

TEST_CASE("clip: degenerate scenes do no harm", "[trilinear][clip][bad-input]") {
    Random random(6);
    for (int trial = 0; trial < 3000; ++trial) {
        const TrilinearFacet facet =
            random_facet(random, static_cast<FacetKind>(trial % static_cast<int>(FacetKind::kCount)));
        SceneTriangle triangle = triangle_about(random, facet, 2);
        const Vec3 on_border = facet.point({0, 0.5, 0.5}, 1), on_corner = facet.point({1, 0, 0}, 1.5);
        switch (trial % 7) {
            case 0:
                triangle.corner[1] = triangle.corner[0];
                break;  // no area
            case 1:
                triangle.corner[2] = 0.5 * (triangle.corner[0] + triangle.corner[1]);
                break;  // a line
            case 2:
                triangle.corner[0] = on_border;
                break;  // touches the border
            case 3:
                triangle.corner[0] = on_corner;
                break;  // on a corner ray
            case 4:
                triangle.corner = {facet.corner_at(0, 1), facet.corner_at(1, 1), facet.corner_at(2, 1)};
                break;
            case 5:
                triangle.corner = {facet.corner_at(0, 0), facet.corner_at(1, 0), facet.corner_at(2, 0)};
                break;
            default:
                triangle.corner[0] = facet.corner[0].origin;
                break;  // starts at a ray's origin
        }
        for (const Clip clip : {Clip::kUnclipped, Clip::kScreen, Clip::kScene}) {
            ShapeParams params;
            params.clip = clip, params.curves = kAllCurves[trial % 4], params.pieces = 2;
            const std::vector<Outline> outlines = project_triangle(facet, triangle, params);
            for (const Outline& outline : outlines) {
                for (const ImageVertex& v : outline.vertex) {
                    if (!std::isfinite(v.t) || !std::isfinite(length(v.weights)))
                        FAIL("not finite at trial " << trial);
                }
            }
            if (trial % 7 != 2 && trial % 7 != 3) continue;
            if (params.curves != Curves::kArcs || clip == Clip::kUnclipped) continue;
            int wrong = 0;
            for (int i = 0; i < 100; ++i) {
                const Vec3 w = random.weights();
                wrong += holds(outlines, w) != ray_meets(facet, triangle, w);
            }
            if (wrong > 3) FAIL("touching case at trial " << trial << ": " << wrong);
        }
    }
}

TEST_CASE("tessellate: the pieces tile the triangle and share their corners", "[trilinear][clip]") {
    Random random(7);
    const SceneTriangle triangle{{random.in_box(1), random.in_box(1), random.in_box(1)}};
    const SceneTriangle turned{{triangle.corner[1], triangle.corner[0], random.in_box(1)}};
    for (const int pieces : {1, 2, 3, 7}) {
        const std::vector<TrianglePiece> tiles = tessellate(triangle, pieces);
        REQUIRE(tiles.size() == static_cast<std::size_t>(pieces * pieces));
        Vec3 area(0);
        std::set<std::array<double, 3>> corners, along_edge, along_turned;
        for (const TrianglePiece& tile : tiles) {
            const auto& c = tile.triangle.corner;
            area += cross(c[1] - c[0], c[2] - c[0]);
            for (std::size_t k = 0; k < 3; ++k) {
                corners.insert({c[k].x, c[k].y, c[k].z});
                if (tile.barycentric[k].z == 0) along_edge.insert({c[k].x, c[k].y, c[k].z});
            }
        }
        for (const TrianglePiece& tile : tessellate(turned, pieces)) {
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3& c = tile.triangle.corner[k];
                if (tile.barycentric[k].z == 0) along_turned.insert({c.x, c.y, c.z});
            }
        }
        CHECK(corners.size() == static_cast<std::size_t>((pieces + 1) * (pieces + 2) / 2));
        CHECK(along_edge == along_turned);
        const Vec3 whole =
            cross(triangle.corner[1] - triangle.corner[0], triangle.corner[2] - triangle.corner[0]);
        CHECK(length(area - whole) < 1e-13);
    }
}
