// The law of outlines: what they enclose is what rays meet, for every configuration, clip and way of drawing
// curves.
#include "trilinear/outline.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <string>

#include "random_facets.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

// The direct answer, in long double: does the ray of these weights meet the triangle with t in the range?
bool ray_meets(const TrilinearFacet& facet, const SceneTriangle& triangle, const Vec3& w, double farthest) {
    using Long = long double;
    Long o[3] = {0, 0, 0}, d[3] = {0, 0, 0}, e[2][3];
    for (int x = 0; x < 3; ++x) {
        for (int k = 0; k < 3; ++k) {
            const Ray& r = facet.corner[static_cast<std::size_t>(k)];
            o[x] += static_cast<Long>(w[k]) * r.origin[x], d[x] += static_cast<Long>(w[k]) * r.direction[x];
        }
        o[x] -= triangle.corner[0][x];
        for (int k = 0; k < 2; ++k) {
            e[k][x] = static_cast<Long>(triangle.corner[static_cast<std::size_t>(k + 1)][x]) -
                      triangle.corner[0][x];
        }
    }
    const auto det = [](const Long* a, const Long* b, const Long* c) {
        return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]);
    };
    // o + t d = s e0 + r e1 by Cramer's rule.
    const Long all = det(d, e[0], e[1]);
    if (all == 0) return false;
    const Long t = -det(o, e[0], e[1]) / all, s = det(d, o, e[1]) / all, r = det(d, e[0], o) / all;
    return t >= 0 && t <= farthest && s >= 0 && r >= 0 && s + r <= 1;
}

struct Place {
    bool inside = false;    // by the even-odd rule
    double distance = 1e9;  // from the nearest side, in weights
};

Place locate(const std::vector<Outline>& outlines, const Vec3& w) {
    Place place;
    const double x = w.y, y = w.z;
    for (const Outline& outline : outlines) {
        const std::size_t n = outline.vertex.size();
        for (std::size_t i = 0; i < n; ++i) {
            const Vec3 &a = outline.vertex[i].weights, &b = outline.vertex[(i + 1) % n].weights;
            if ((a.z > y) != (b.z > y) && x < a.y + (y - a.z) / (b.z - a.z) * (b.y - a.y)) {
                place.inside = !place.inside;
            }
            const double dx = b.y - a.y, dy = b.z - a.z, length2 = dx * dx + dy * dy;
            const double along = ((x - a.y) * dx + (y - a.z) * dy) / (length2 > 0 ? length2 : 1);
            const double share = std::clamp(along, 0.0, 1.0);
            place.distance = std::min(place.distance, std::hypot(x - a.y - share * dx, y - a.z - share * dy));
        }
    }
    return place;
}

struct Tally {
    int points = 0, hits = 0, near = 0, wrong = 0;
};

// Compares both answers at random weights of the facet (or, unclipped, around it).
Tally compare(const TrilinearFacet& facet, const SceneTriangle& triangle, const ShapeParams& params,
              Random& random, int points) {
    const std::vector<Outline> outlines = project_triangle(facet, triangle, params);
    double farthest = 1e300;
    if (params.clip == Clip::kUnclipped) {
        const std::vector<Window> windows = view_windows(make_coplanarity(facet), triangle);
        farthest = windows.empty() ? 0 : windows.back().end;
    }
    Tally tally;
    for (int i = 0; i < points; ++i) {
        Vec3 w = random.weights();
        if (params.clip == Clip::kUnclipped) w = Vec3(1.0 / 3) + 3.0 * (w - Vec3(1.0 / 3));
        const bool truth = ray_meets(facet, triangle, w, farthest);
        const Place place = locate(outlines, w);
        ++tally.points, tally.hits += truth;
        if (truth == place.inside) continue;
        // Unclipped, the tolerance grows with the distance from the facet; the points lie within 3 of its
        // middle.
        const double times = params.clip == Clip::kUnclipped ? 4 : 1;
        if (place.distance <= 1.01 * times * params.tolerance)
            ++tally.near;
        else
            ++tally.wrong;
    }
    return tally;
}

std::string configuration(const TrilinearFacet& facet, const SceneTriangle& triangle) {
    const Coplanarity cubic = make_coplanarity(facet);
    std::vector<int> r, v;
    for (const RealRoots& k : project_vertices(cubic, triangle)) r.push_back(k.count);
    for (const Shape& s : make_shapes(cubic, triangle)) v.push_back(static_cast<int>(s.size()));
    std::sort(r.rbegin(), r.rend()), std::sort(v.rbegin(), v.rend());
    std::ostringstream text;
    for (const int n : r) text << n;
    text << ":";
    for (const int n : v) text << " " << n;
    return text.str();
}

struct Case {
    TrilinearFacet facet;
    SceneTriangle triangle;
};

// A triangle about a point that the facet sees, so that most pairs meet.
Case random_case(Random& random, FacetKind kind) {
    Case c{random_facet(random, kind), {}};
    const double size = random.log_uniform(0.1, 10);
    const Vec3 seen = c.facet.point(random.weights(), random.log_uniform(0.05, 10));
    for (Vec3& corner : c.triangle.corner) corner = seen + random.in_box(size);
    return c;
}

// Half a wall (or, across y, floor) of a room about the origin.
SceneTriangle axis_triangle(Random& random, int across) {
    const int u = (across + 1) % 3, v = (across + 2) % 3;
    const double away = random.below(2) ? random.uniform(1.5, 4) : random.uniform(-4, -1.5);
    const double low_u = random.uniform(-4, 0), high_u = random.uniform(0, 4);
    const double low_v = random.uniform(-4, 0), high_v = random.uniform(0, 4);
    const double corners[3][2] = {{low_u, low_v}, {high_u, low_v}, {high_u, high_v}};
    SceneTriangle triangle;
    for (std::size_t k = 0; k < 3; ++k) {
        Vec3& corner = triangle.corner[k];
        corner[across] = away, corner[u] = corners[k][0], corner[v] = corners[k][1];
    }
    return triangle;
}

// Two mirrorings, which leave every length and angle but no coordinate.
Case turned_about_origin(const Case& c, const Vec3& first, const Vec3& second) {
    const auto turn = [&](Vec3 v) {
        for (const Vec3& n : {normalize(first), normalize(second)}) v -= 2.0 * dot(v, n) * n;
        return v;
    };
    Case turned = c;
    for (Ray& ray : turned.facet.corner) ray = {turn(ray.origin), turn(ray.direction)};
    for (Vec3& corner : turned.triangle.corner) corner = turn(corner);
    return turned;
}

const Clip kClips[] = {Clip::kUnclipped, Clip::kScreen, Clip::kScene};

void check_law(std::uint64_t seed, int pairs_per_kind, int points) {
    Random random(seed);
    for (int kind = 0; kind < static_cast<int>(FacetKind::kCount); ++kind) {
        for (const Clip clip : kClips) {
            Tally sum;
            int bad_pairs = 0;
            for (int i = 0; i < pairs_per_kind; ++i) {
                const Case c = random_case(random, static_cast<FacetKind>(kind));
                ShapeParams params;
                params.clip = clip;
                params.tolerance = 1e-4;
                const Tally tally = compare(c.facet, c.triangle, params, random, points);
                sum.points += tally.points, sum.hits += tally.hits, sum.near += tally.near,
                    sum.wrong += tally.wrong;
                bad_pairs += tally.wrong > 0;
            }
            WARN("kind " << kind << " clip " << static_cast<int>(clip) << ": " << sum.points << " points, "
                         << sum.hits << " hits, " << sum.near << " near an edge, " << sum.wrong
                         << " wrong in " << bad_pairs << " pairs");
            CHECK(sum.wrong == 0);
            CHECK(sum.hits > sum.points / 30);
            CHECK(sum.near < sum.points / 1000 + 5);
        }
    }
}

}  // namespace

TEST_CASE("outlines: even-odd inside is what rays meet for every kind of facet and clip",
          "[trilinear][outline][law]") {
    check_law(1, 400, 50);
}

TEST_CASE("outlines: cylinder mirrors and triangles along their axis", "[trilinear][outline]") {
    // A scene edge along the axis stays parallel to every parametric triangle: its image has one t.
    Random random(4);
    for (const bool turned : {false, true}) {
        for (const Clip clip : kClips) {
            Tally sum;
            int bad_pairs = 0;
            for (int i = 0; i < 3000; ++i) {
                const double angle = random.uniform(-3, 3);
                const Vec3 eye(4 * std::sin(angle), random.uniform(-1.5, 1.5), 4 * std::cos(angle));
                const bool stands = i % 3 == 0;  // a corner or an edge of the facet is in the floor's plane
                Case c{cylinder_facet(random, eye), axis_triangle(random, stands ? 1 : random.below(3))};
                if (stands) {
                    const double height = c.facet.corner[static_cast<std::size_t>(i % 9 / 3)].origin.y;
                    for (Vec3& corner : c.triangle.corner) corner.y = height;
                }
                if (turned) c = turned_about_origin(c, random.on_sphere(), random.on_sphere());
                ShapeParams params;
                params.clip = clip, params.tolerance = 1e-4;
                const Tally tally = compare(c.facet, c.triangle, params, random, 50);
                sum.points += tally.points, sum.hits += tally.hits, sum.near += tally.near,
                    sum.wrong += tally.wrong;
                bad_pairs += tally.wrong > 0;
            }
            INFO("turned " << turned << " clip " << static_cast<int>(clip) << ": " << sum.points
                           << " points, " << sum.hits << " hits, " << sum.near << " near an edge, "
                           << sum.wrong << " wrong in " << bad_pairs << " pairs");
            CHECK(sum.wrong == 0);
            CHECK(sum.hits > sum.points / 30);
            CHECK(sum.near < sum.points / 1000 + 5);
        }
    }
}

TEST_CASE("outlines: even-odd inside is what rays meet in many pairs", "[.long]") {
    check_law(2, 20000, 100);
}

TEST_CASE("outlines: all fifteen configurations, with viewing plane and clipping",
          "[trilinear][outline][many]") {
    Random random(3);
    std::map<std::string, int> seen, hits;
    const int wanted = 12;
    for (int trial = 0; trial < 400000; ++trial) {
        const Case c = random_case(random, FacetKind::kGeneral);
        const std::string name = configuration(c.facet, c.triangle);
        if (seen[name] >= wanted) continue;
        ++seen[name];
        for (const Clip clip : kClips) {
            ShapeParams params;
            params.clip = clip;
            params.tolerance = 1e-4;
            const Tally tally = compare(c.facet, c.triangle, params, random, 200);
            hits[name] += tally.hits;
            INFO(name << " trial " << trial << " clip " << static_cast<int>(clip) << ": " << tally.wrong
                      << " of " << tally.points);
            CHECK(tally.wrong == 0);
        }
    }
    CHECK(seen.size() == 15);
    for (const auto& [name, count] : seen) {
        INFO(name << ": " << count << " pairs, " << hits[name] << " hits");
        CHECK(count >= (name == "333: 3 2 2 2" || name == "333: 5 2 2" ? 5 : wanted));
        CHECK(hits[name] > 0);
    }
}
