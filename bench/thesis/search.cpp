#include "thesis/search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "trilinear/outline.h"

namespace trilens {
namespace {

struct Start {
    FacetScene scene;
    double score = 0;
};

FacetScene random_scene(Dice& dice) {
    FacetScene scene;
    for (Ray& ray : scene.facet.corner) ray = {dice.normal(), dice.normal()};
    for (Vec3& corner : scene.triangle.corner) corner = 1.5 * dice.normal();
    return scene;
}

FacetScene moved(const FacetScene& from, double step, Dice& dice) {
    FacetScene scene = from;
    for (Ray& ray : scene.facet.corner) {
        ray.origin += step * dice.normal();
        ray.direction += step * dice.normal();
    }
    for (Vec3& corner : scene.triangle.corner) corner += step * dice.normal();
    return scene;
}

/// Keeps a step that scores higher; steps grow where they succeed and shrink where they fail.
Start climbed(Start at, const Configuration& wanted, const SearchParams& params, Dice& dice) {
    double step = 0.1;
    for (int i = 0; i < params.steps; ++i) {
        const FacetScene next = moved(at.scene, step, dice);
        const double score = configuration_of(next) == wanted ? score_of(next, params.weights) : 0;
        if (score > at.score)
            at = {next, score}, step = std::min(0.3, 2 * step);
        else
            step = std::max(1e-3, 0.97 * step);
    }
    return at;
}

}  // namespace

double Dice::one_normal() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
}

Vec3 Dice::normal() {
    const double x = one_normal(), y = one_normal(), z = one_normal();
    return {x, y, z};
}

Found search(const Configuration& wanted, std::uint64_t seed, const SearchParams& params) {
    Dice dice(seed);
    Found found;
    std::vector<Start> starts;
    while (found.draws < params.most_draws && starts.size() < static_cast<std::size_t>(params.starts)) {
        ++found.draws;
        const FacetScene scene = random_scene(dice);
        if (configuration_of(scene) == wanted) starts.push_back({scene, score_of(scene, params.weights)});
    }
    std::stable_sort(starts.begin(), starts.end(),
                     [](const Start& a, const Start& b) { return a.score > b.score; });
    Start best;
    for (std::size_t s = 0; s < std::min(starts.size(), static_cast<std::size_t>(params.improved)); ++s) {
        const Start top = climbed(starts[s], wanted, params, dice);
        if (top.score > best.score) best = top;
    }
    if (best.score > 0) found.framed = framed(best.scene, params.weights);
    return found;
}

namespace {

constexpr int kPerSection = 20;   // points on a piece of an edge's image
constexpr int kTurns = 24;        // rotations of the film that are tried
constexpr double kApart = 0.2;    // of the perimeter, between points that a neck is measured at
constexpr double kMargin = 0.04;  // of the film's side, free on each side

using Polygon = std::vector<Vec2>;  // in the plane of weights: second and third weight

struct Outlines {
    std::vector<Polygon> shapes;
    double t0 = 0, t1 = 0;  // the stretch of t that holds them
};

Outlines outlines_of(const FacetScene& scene) {
    const Coplanarity cubic = make_coplanarity(scene.facet);
    Outlines outlines;
    outlines.t0 = std::numeric_limits<double>::infinity(), outlines.t1 = -outlines.t0;
    for (const Shape& shape : make_shapes(cubic, scene.triangle)) {
        Polygon polygon;
        for (std::size_t i = 0; i < shape.size(); ++i) {
            const double from = shape[i].at.t, to = shape[(i + 1) % shape.size()].at.t;
            outlines.t0 = std::min(outlines.t0, from), outlines.t1 = std::max(outlines.t1, from);
            for (int k = 0; k < kPerSection; ++k) {
                const double t = from + (to - from) * k / kPerSection;
                const auto cut = edge_cut(cubic, scene.triangle, static_cast<std::size_t>(shape[i].edge), t);
                if (cut) polygon.emplace_back(cut->weights.y, cut->weights.z);
            }
        }
        outlines.shapes.push_back(std::move(polygon));
    }
    return outlines;
}

/// The plane of weights made round: the map that gives all points together a unit covariance.
struct Rounding {
    Vec2 centre{0};
    Mat2 root{1}, inverse{1};  // root * inverse = 1; round = inverse * (p - centre)
    bool flat = true;
};

Rounding rounding_of(const std::vector<Polygon>& shapes) {
    Rounding round;
    double count = 0, xx = 0, xy = 0, yy = 0;
    for (const Polygon& shape : shapes)
        for (const Vec2& p : shape) round.centre += p, ++count;
    round.centre /= count;
    for (const Polygon& shape : shapes)
        for (const Vec2& p : shape) {
            const Vec2 d = p - round.centre;
            xx += d.x * d.x / count, xy += d.x * d.y / count, yy += d.y * d.y / count;
        }
    const double left = std::sqrt(xx), lower = xy / left, right = std::sqrt(yy - lower * lower);  // Cholesky
    if (!(left > 0) || !(right > 1e-6 * left) || !std::isfinite(left + right)) return round;
    round.flat = false;
    round.root = Mat2(left, lower, 0, right);
    round.inverse = Mat2(1 / left, -lower / (left * right), 0, 1 / right);
    return round;
}

/// The film, a unit square, from the rounded plane: film = to_film * p + shift.
struct Frame {
    Mat2 to_film{1};
    Vec2 shift{0};
    double area = 0;  // of the film in the rounded plane; 0: no frame
};

/// The smallest rectangle around the points, over kTurns rotations, with kMargin around.
Frame enclosing_frame(const std::vector<Polygon>& shapes) {
    Frame best;
    for (int turn = 0; turn < kTurns; ++turn) {
        const double angle = std::numbers::pi / 2 * turn / kTurns;
        const Mat2 turned(std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle));
        Vec2 low(std::numeric_limits<double>::infinity()), high(-low);
        for (const Polygon& shape : shapes)
            for (const Vec2& p : shape) low = glm::min(low, turned * p), high = glm::max(high, turned * p);
        const Vec2 size = (high - low) / (1 - 2 * kMargin);
        if (!(size.x * size.y > 0) || (best.area > 0 && size.x * size.y >= best.area)) continue;
        best.area = size.x * size.y;
        best.to_film = Mat2(1 / size.x, 0, 0, 1 / size.y) * turned;
        best.shift = -low / size + Vec2(kMargin);
    }
    return best;
}

/// Twice the area over the perimeter: the width of a strip, the radius of a disk.
double width(const Polygon& shape) {
    double area = 0, around = 0;
    for (std::size_t i = 0; i < shape.size(); ++i) {
        const Vec2 &p = shape[i], &q = shape[(i + 1) % shape.size()];
        area += 0.5 * (p.x * q.y - p.y * q.x);
        around += length(q - p);
    }
    return around > 0 ? 2 * std::fabs(area) / around : 0;
}

double distance_to_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
    const double square = dot(b - a, b - a);
    const double share = square > 0 ? std::clamp(dot(p - a, b - a) / square, 0.0, 1.0) : 0.0;
    return length(p - a - share * (b - a));
}

/// The least distance of a vertex of one from an edge of the other.
double gap(const Polygon& a, const Polygon& b) {
    double least = std::numeric_limits<double>::infinity();
    const auto from_vertices = [&](const Polygon& points, const Polygon& edges) {
        for (const Vec2& p : points)
            for (std::size_t i = 0; i < edges.size(); ++i) {
                const double apart = distance_to_segment(p, edges[i], edges[(i + 1) % edges.size()]);
                least = std::min(least, apart);
            }
    };
    from_vertices(a, b), from_vertices(b, a);
    return least;
}

/// Between neighbouring vertices of a shape, which begin its polygon's sections.
double least_spacing(const Polygon& shape) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < shape.size(); i += kPerSection)
        least = std::min(least, length(shape[(i + kPerSection) % shape.size()] - shape[i]));
    return least;
}

/// How narrow a shape is where it all but falls apart: the least distance of border points that both ways
/// around are at least kApart of the perimeter from one another.
double neck(const Polygon& shape) {
    std::vector<double> way{0};
    for (std::size_t i = 0; i < shape.size(); ++i)
        way.push_back(way.back() + length(shape[(i + 1) % shape.size()] - shape[i]));
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < shape.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            const double share = (way[i] - way[j]) / way.back();
            if (share >= kApart && share <= 1 - kApart) least = std::min(least, length(shape[i] - shape[j]));
        }
    return least;
}

}  // namespace

Configuration configuration_of(const FacetScene& scene) {
    Configuration configuration;
    for (const Shape& shape : make_shapes(make_coplanarity(scene.facet), scene.triangle))
        configuration.push_back(shape.size());
    std::sort(configuration.begin(), configuration.end());
    return configuration;
}

double score_of(const FacetScene& scene, const ScoreWeights& weights) {
    std::vector<Polygon> shapes = outlines_of(scene).shapes;
    const Rounding round = rounding_of(shapes);
    if (round.flat) return 0;
    for (Polygon& shape : shapes)
        for (Vec2& p : shape) p = round.inverse * (p - round.centre);
    const Frame frame = enclosing_frame(shapes);
    for (Polygon& shape : shapes)
        for (Vec2& p : shape) p = frame.to_film * p + frame.shift;
    double score = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        score = std::min(score, width(shapes[i]));
        if (weights.spacing > 0) score = std::min(score, weights.spacing * least_spacing(shapes[i]));
        if (weights.neck > 0) score = std::min(score, weights.neck * neck(shapes[i]));
        for (std::size_t j = 0; j < i; ++j) score = std::min(score, 2 * gap(shapes[i], shapes[j]));
    }
    return std::isfinite(score) ? score : 0;
}

FramedScene framed(const FacetScene& scene, const ScoreWeights& weights) {
    Outlines outlines = outlines_of(scene);
    const Rounding round = rounding_of(outlines.shapes);
    for (Polygon& shape : outlines.shapes)
        for (Vec2& p : shape) p = round.inverse * (p - round.centre);
    const Frame frame = enclosing_frame(outlines.shapes);
    const Mat2 from_film = glm::inverse(frame.to_film);

    // New corner rays are rays of the facet's plane; t starts before the first shape and is 1 at about the
    // last.
    FramedScene result{scene, score_of(scene, weights)};
    const double unit = (outlines.t1 - outlines.t0) / 0.7, start = outlines.t0 - 0.2 * unit;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec2 at = round.root * (from_film * (kFacetOnFilm[k] - frame.shift)) + round.centre;
        const Vec3 corner(1 - at.x - at.y, at.x, at.y);
        result.scene.facet.corner[k] = {scene.facet.point(corner, start),
                                        unit * scene.facet.direction(corner)};
    }

    // The triangle's middle becomes the world's origin, its mean side 1.
    SceneTriangle& triangle = result.scene.triangle;
    const Vec3 middle = (triangle.corner[0] + triangle.corner[1] + triangle.corner[2]) / 3.0;
    double side = 0;
    for (std::size_t e = 0; e < 3; ++e) side += length(triangle.to(e) - triangle.from(e)) / 3;
    for (Vec3& corner : triangle.corner) corner = (corner - middle) / side;
    for (Ray& ray : result.scene.facet.corner) ray = {(ray.origin - middle) / side, ray.direction / side};
    return result;
}

TrilinearFacet begun_at(const TrilinearFacet& facet, double t) {
    TrilinearFacet later = facet;
    for (Ray& ray : later.corner) ray.origin += t * ray.direction;
    return later;
}

std::vector<double> visible_areas(const FacetScene& scene) {
    std::vector<double> areas;
    for (const Outline& outline : project_triangle(scene.facet, scene.triangle)) {
        double area = 0;
        for (std::size_t i = 0; i < outline.vertex.size(); ++i) {
            const Vec3 &p = outline.vertex[i].weights,
                       &q = outline.vertex[(i + 1) % outline.vertex.size()].weights;
            area += p.y * q.z - p.z * q.y;
        }
        areas.push_back(std::fabs(area));
    }
    std::sort(areas.rbegin(), areas.rend());
    return areas;
}

}  // namespace trilens
