// The image of a scene triangle in a facet as closed outlines (Vallance 2005, chapters 4 and 5).
#include "trilinear/outline.h"

#include <algorithm>
#include <cmath>

namespace trilens {
namespace {

constexpr int kDeepestHalving = 20;
constexpr double kRejectSlack = 1e-12;  // rounding of a bound, as a share of the terms' size

// All control points beyond one edge of the facet: so is the arc.
bool beyond_border(const ConicArc& arc) {
    for (int k = 0; k < 3; ++k) {
        if (arc.control[0][k] < 0 && arc.control[1][k] < 0 && arc.control[2][k] < 0) return true;
    }
    return false;
}

// From the facet's middle.
double distance_of_chord(const ConicArc& arc) {
    const Vec3 from = arc.control[0] - Vec3(1.0 / 3), chord = arc.control[2] - arc.control[0];
    const double length2 = dot(chord, chord);
    const double share = length2 > 0 ? std::clamp(-dot(from, chord) / length2, 0.0, 1.0) : 0.0;
    return length(from + share * chord);
}

// Draws sections of shapes as polylines.
class Pen {
  public:
    Pen(const FacetAndTriangle& pair, const ShapeParams& params) : pair_(pair), params_(params) {}

    // Vertices strictly inside the section, in its order.
    std::vector<ImageVertex> between(const Section& s) const {
        if (params_.curves == Curves::kStraight || is_level(s)) return {};
        const std::size_t edge = static_cast<std::size_t>(s.edge);
        if (params_.curves == Curves::kSlices) {
            return slice_ends(pair_.cubic, pair_.triangle, edge, {s.from.t, s.to.t}, params_.pieces);
        }
        std::vector<ImageVertex> vertices;
        for (const ConicArc& arc : edge_arcs(pair_.cubic, pair_.triangle, s)) flatten(arc, edge, 0, vertices);
        if (!vertices.empty()) vertices.pop_back();
        if (s.from.t > s.to.t) std::reverse(vertices.begin(), vertices.end());
        return vertices;
    }

    Chain polyline(const std::vector<Section>& sections) const {
        Chain chain{sections.front().from};
        for (const Section& s : sections) {
            for (const ImageVertex& v : between(s)) chain.push_back(v);
            chain.push_back(s.to);
        }
        return chain;
    }

  private:
    // Appends the end of every piece that is flat enough.
    void flatten(const ConicArc& arc, std::size_t edge, int depth, std::vector<ImageVertex>& vertices) const {
        double tolerance = params_.tolerance;
        if (params_.clip == Clip::kUnclipped)
            tolerance *= std::max(1.0, distance_of_chord(arc) - sagitta(arc));
        const bool unseen = params_.clip != Clip::kUnclipped && beyond_border(arc);
        if (unseen || depth == kDeepestHalving || sagitta(arc) <= tolerance) {
            const EdgePoint cut =
                cut_edge(pair_.cubic, arc.t1, pair_.triangle.from(edge), pair_.triangle.to(edge));
            ImageVertex vertex{arc.t1, arc.control[2], Vec3(0)};
            vertex.barycentric[static_cast<int>(edge)] = cut.from;
            vertex.barycentric[static_cast<int>((edge + 1) % 3)] = cut.to;
            vertices.push_back(vertex);
            return;
        }
        const Vec3 *a = &pair_.triangle.from(edge), *b = &pair_.triangle.to(edge);
        if (canonically_before(*b, *a)) std::swap(a, b);
        for (const ConicArc& half : halves(arc, pair_.cubic, *a, *b))
            flatten(half, edge, depth + 1, vertices);
    }

    const FacetAndTriangle& pair_;
    const ShapeParams& params_;
};

std::vector<Section> sections_of(const Shape& shape) {
    std::vector<Section> sections;
    for (std::size_t i = 0; i < shape.size(); ++i) {
        sections.push_back({shape[i].at, shape[(i + 1) % shape.size()].at, shape[i].edge});
    }
    return sections;
}

Outline closed_outline(Chain chain) {
    chain.pop_back();
    return {std::move(chain)};
}

std::vector<Outline> project_curved(const FacetAndTriangle& pair, const ShapeParams& params) {
    std::vector<Shape> shapes;
    for (const Window& window : view_windows(pair.cubic, pair.triangle)) {
        for (Shape& shape : make_shapes(pair.cubic, pair.triangle, window))
            shapes.push_back(std::move(shape));
    }
    const Pen pen(pair, params);
    std::vector<Outline> outlines;
    if (params.clip == Clip::kScene) {
        const ClippedShapes clipped = clip_in_scene(pair, shapes);
        if (clipped.clean) {
            std::vector<Chain> chains;
            for (const auto& run : clipped.chains) chains.push_back(pen.polyline(run));
            outlines = join_along_border(pair, chains);
            for (const auto& ring : clipped.closed) outlines.push_back(closed_outline(pen.polyline(ring)));
            return outlines;
        }
    }
    for (const Shape& shape : shapes) outlines.push_back(closed_outline(pen.polyline(sections_of(shape))));
    return params.clip == Clip::kUnclipped ? outlines : clip_on_screen(pair, std::move(outlines));
}

}  // namespace

std::vector<Outline> project_triangle(const TrilinearFacet& facet, const SceneTriangle& triangle,
                                      const ShapeParams& params) {
    if (params.clip != Clip::kUnclipped && !may_image(facet, triangle)) return {};
    const Coplanarity cubic = make_coplanarity(facet);
    if (params.curves != Curves::kTessellate) return project_curved({facet, cubic, triangle}, params);

    ShapeParams straight = params;
    straight.curves = Curves::kStraight;
    std::vector<Outline> outlines;
    for (const TrianglePiece& piece : tessellate(triangle, params.pieces)) {
        if (params.clip != Clip::kUnclipped && !may_image(facet, piece.triangle)) continue;
        for (Outline& outline : project_curved({facet, cubic, piece.triangle}, straight)) {
            for (ImageVertex& v : outline.vertex) {
                const Vec3 in_piece = v.barycentric;
                v.barycentric = in_piece.x * piece.barycentric[0] + in_piece.y * piece.barycentric[1] +
                                in_piece.z * piece.barycentric[2];
            }
            outlines.push_back(std::move(outline));
        }
    }
    return outlines;
}

std::optional<ImageVertex> plane_hit(const TrilinearFacet& facet, const SceneTriangle& triangle,
                                     const Vec3& weights) {
    const Vec3& a = triangle.corner[0];
    const Vec3 e1 = triangle.corner[1] - a, e2 = triangle.corner[2] - a, normal = cross(e1, e2);
    const Vec3 origin = facet.origin(weights) - a, direction = facet.direction(weights);
    const double slope = dot(normal, direction);
    if (slope == 0) return std::nullopt;
    const double t = -dot(normal, origin) / slope;
    const double second = triple(direction, origin, e2) / slope,
                 third = triple(direction, e1, origin) / slope;
    return ImageVertex{t, weights, Vec3(1 - second - third, second, third)};
}

bool may_image(const TrilinearFacet& facet, const SceneTriangle& triangle) {
    const Vec3& a = triangle.corner[0];
    const Vec3 normal = cross(triangle.corner[1] - a, triangle.corner[2] - a);

    // t is the plane's height over the origins by the descent of the directions; both are linear over the
    // facet.
    bool up = true, down = true, above = true, below = true;
    double size = 0;
    for (const Ray& ray : facet.corner) {
        const double slope = dot(normal, ray.direction), height = dot(normal, a - ray.origin);
        const double steep = kRejectSlack * length(normal) * length(ray.direction);
        const double high = kRejectSlack * length(normal) * length(a - ray.origin);
        up &= slope > steep, down &= slope<-steep, above &= height> high, below &= height < -high;
        size = std::max({size, length(ray.direction) * length(a - ray.origin)});
    }
    if ((up && below) || (down && above)) return false;

    // A ray that hits has all three sides of the sign of normal . direction. The form's six coefficients are
    // those of Bernstein over the facet, so that they bound the side.
    const Coplanarity cubic = make_coplanarity(facet);
    bool positive = !down, negative = !up;
    for (std::size_t e = 0; e < 3; ++e) {
        const Mat3 form = conic_form(cubic, triangle.from(e), triangle.to(e));
        const double slack = kRejectSlack * size * length(triangle.to(e) - triangle.from(e));
        bool all_positive = true, all_negative = true;
        for (int j = 0; j < 3; ++j) {
            for (int k = 0; k <= j; ++k)
                all_positive &= form[j][k] > slack, all_negative &= form[j][k] < -slack;
        }
        positive &= !all_negative, negative &= !all_positive;
    }
    return positive || negative;
}

}  // namespace trilens
