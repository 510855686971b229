#include "scene/data/alpha_cut.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/image/texture_lookup.h"
#include "base/math/polygon.h"
#include "scene/data/polygons.h"

namespace trilens {
namespace {

constexpr double kMostCells = 1 << 22;  // of one triangle
constexpr double kLeastArea = 1e-12;    // of a piece that is kept, in cells

/// A place on the picture in half texels from the first texel's middle; y downward.
using GridPlace = Vec2;

/// How much more opaque the picture is than the cutoff.
class Opacity {
  public:
    Opacity(const Material& material, double cutoff)
        : texture_(*material.base_color_texture),
          sampler_(material.base_color_sampler),
          cutoff_(cutoff / material.alpha_factor) {}

    GridPlace place(const Vec2& uv) const {
        const Vec2 at = sampler_.place(uv);
        return {2 * (at.x * texture_.width - 0.5), 2 * ((1 - at.y) * texture_.height - 0.5)};
    }
    /// At a corner of the grid of half texels.
    double at(long long x, long long y) const {
        const long long x0 = x >> 1, y0 = y >> 1, x1 = (x + 1) >> 1, y1 = (y + 1) >> 1;
        return 0.25 * (texel(x0, y0) + texel(x1, y0) + texel(x0, y1) + texel(x1, y1)) - cutoff_;
    }

  private:
    double texel(long long x, long long y) const {
        const auto column = static_cast<std::size_t>(wrapped_texel(x, texture_.width, sampler_.wrap_s)),
                   row = static_cast<std::size_t>(wrapped_texel(y, texture_.height, sampler_.wrap_t));
        return static_cast<double>(texture_.alpha[row * static_cast<std::size_t>(texture_.width) + column]);
    }

    const Texture& texture_;
    const TextureSampler& sampler_;
    double cutoff_;
};

using GridPolygon = std::vector<GridPlace>;

/// A convex polygon's part on the left of the line from a to b [Sutherland and Hodgman 1974].
GridPolygon left_of(const GridPolygon& polygon, const GridPlace& a, const GridPlace& b) {
    GridPolygon kept;
    const auto side = [&](const GridPlace& p) { return cross(b - a, p - a); };
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const GridPlace &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
        const double at_p = side(p), at_q = side(q);
        if (at_p >= 0) kept.push_back(p);
        if ((at_p > 0 && at_q < 0) || (at_p < 0 && at_q > 0))
            kept.push_back(p + at_p / (at_p - at_q) * (q - p));
    }
    return kept;
}

/// What of one cell is opaque, where not all of it is: convex parts. A corner that is just as opaque as the
/// cutoff lies on the contour.
class CellParts {
  public:
    CellParts(long long x, long long y, const std::array<double, 4>& values)
        : corners_{GridPlace(x, y), GridPlace(x + 1, y), GridPlace(x + 1, y + 1), GridPlace(x, y + 1)},
          values_(values) {}

    std::vector<GridPolygon> parts() const {
        for (const std::size_t k : {std::size_t{0}, std::size_t{1}})
            if (is_inside(k) && is_inside(k + 2) && !is_inside(k + 1) && !is_inside((k + 3) % 4))
                return of_diagonal(k);
        return {around()};
    }

  private:
    bool is_inside(std::size_t k) const { return values_[k] > 0; }

    /// Where the contour crosses the edge from a corner to the next, or to the one before.
    GridPlace crossing(std::size_t k, std::size_t other) const {
        // From the lesser corner, so that both cells of an edge have the same point.
        const std::size_t edge = (k + 1) % 4 == other ? k : other, next = (edge + 1) % 4;
        const auto [from, to] = edge < 2 ? std::pair(edge, next) : std::pair(next, edge);
        return corners_[from] +
               values_[from] / (values_[from] - values_[to]) * (corners_[to] - corners_[from]);
    }

    GridPolygon around() const {
        GridPolygon part;
        for (std::size_t k = 0; k < 4; ++k) {
            const std::size_t next = (k + 1) % 4;
            if (is_inside(k)) part.push_back(corners_[k]);
            if (is_inside(k) != is_inside(next)) part.push_back(crossing(k, next));
        }
        return part;
    }

    /// Corners k and k + 2 are opaque, the others are not: joined where the opacity's saddle is opaque
    /// [Nielson, Hamann, The Asymptotic Decider, 1991]. A saddle on the contour is where its two lines cross.
    std::vector<GridPolygon> of_diagonal(std::size_t k) const {
        const std::size_t b = k + 1, c = k + 2, d = (k + 3) % 4;
        const double saddle = values_[k] * values_[c] - values_[b] * values_[d];
        if (saddle > 0) return {around()};
        const GridPlace ab = crossing(k, b), bc = crossing(c, b), cd = crossing(c, d), da = crossing(k, d);
        if (saddle < 0) return {{corners_[k], ab, da}, {corners_[c], cd, bc}};
        const GridPlace middle = corners_[k] + (ab - corners_[k]) + (da - corners_[k]);
        return {{corners_[k], ab, middle, da}, {corners_[c], cd, middle, bc}};
    }

    std::array<GridPlace, 4> corners_;
    const std::array<double, 4>& values_;
};

/// Whether it has an area: pieces that only touch a triangle have none.
bool has_area(const GridPolygon& polygon) {
    return std::fabs(polygon_area(polygon)) > kLeastArea;
}

/// The pieces of one triangle that are left.
class TriangleCut {
  public:
    TriangleCut(const std::array<GridPlace, 3>& corners, const Opacity& opacity)
        : corners_(corners), opacity_(opacity) {
        turn_ = cross(corners[1] - corners[0], corners[2] - corners[0]);
    }

    bool is_too_fine() const {
        const Vec2 size = high() - low();
        return !(size.x * size.y <= kMostCells);
    }

    /// Whether anything of it is cut away; pieces() has the rest.
    bool cut() {
        const Vec2 least = low(), most = high();
        const auto x0 = static_cast<long long>(std::floor(least.x)),
                   x1 = static_cast<long long>(std::ceil(most.x)),
                   y0 = static_cast<long long>(std::floor(least.y)),
                   y1 = static_cast<long long>(std::ceil(most.y));
        bool any = false;
        for (long long y = y0; y < std::max(y1, y0 + 1); ++y) {
            long long run = x0;  // whole cells since there
            std::array<double, 4> values{opacity_.at(x0, y), 0, 0, opacity_.at(x0, y + 1)};
            const long long end = std::max(x1, x0 + 1);
            for (long long x = x0; x < end; ++x) {
                values[1] = opacity_.at(x + 1, y);
                values[2] = opacity_.at(x + 1, y + 1);
                const bool whole = std::all_of(values.begin(), values.end(), [](double v) { return v >= 0; });
                if (!whole) {
                    add_run(run, x, y);
                    run = x + 1;
                    if (meets(x, y)) {
                        any = true;
                        for (GridPolygon& part : CellParts(x, y, values).parts()) add(std::move(part));
                    }
                }
                values[0] = values[1];
                values[3] = values[2];
            }
            add_run(run, end, y);
        }
        return any;
    }

    const std::vector<GridPolygon>& pieces() const { return pieces_; }
    /// Pieces wind as the picture does, from x to y; the triangle may lie on it the other way round.
    bool turns() const { return turn_ < 0; }

    /// Barycentric coordinates of the second and third corners.
    Vec2 weights(const GridPlace& p) const {
        return {cross(p - corners_[0], corners_[2] - corners_[0]) / turn_,
                cross(corners_[1] - corners_[0], p - corners_[0]) / turn_};
    }

  private:
    Vec2 low() const { return glm::min(corners_[0], glm::min(corners_[1], corners_[2])); }
    Vec2 high() const { return glm::max(corners_[0], glm::max(corners_[1], corners_[2])); }

    GridPolygon clipped(GridPolygon polygon) const {
        for (std::size_t k = 0; k < 3 && polygon.size() > 2; ++k) {
            const GridPlace &a = corners_[k], &b = corners_[(k + 1) % 3];
            polygon = turn_ > 0 ? left_of(polygon, a, b) : left_of(polygon, b, a);
        }
        return polygon;
    }
    bool meets(long long x, long long y) const {
        return has_area(
            clipped({GridPlace(x, y), GridPlace(x + 1, y), GridPlace(x + 1, y + 1), GridPlace(x, y + 1)}));
    }
    void add_run(long long from, long long to, long long y) {
        if (to > from)
            add({GridPlace(from, y), GridPlace(to, y), GridPlace(to, y + 1), GridPlace(from, y + 1)});
    }
    void add(GridPolygon polygon) {
        polygon = clipped(std::move(polygon));
        if (has_area(polygon)) pieces_.push_back(std::move(polygon));
    }

    std::array<GridPlace, 3> corners_;
    const Opacity& opacity_;
    double turn_ = 0;
    std::vector<GridPolygon> pieces_;
};

bool has_alpha(const std::vector<std::array<Vec4, 3>>& colors, std::size_t triangle) {
    return !colors.empty() && std::any_of(colors[triangle].begin(), colors[triangle].end(),
                                          [](const Vec4& color) { return color.w < 1; });
}

/// The mesh that is made of another's triangles.
class MeshCutter {
  public:
    MeshCutter(const ObjectMesh& from, const std::vector<Material>& materials)
        : from_(from), materials_(materials) {
        to_.points = from.points;
    }

    AlphaCut run(ObjectMesh& into) {
        for (std::size_t t = 0; t < from_.triangles.size(); ++t) cut(t);
        into = std::move(to_);
        return done_;
    }

  private:
    void cut(std::size_t t) {
        const Material& material = materials_[from_.material[t]];
        if (material.alpha_mode != AlphaMode::kMask) return keep(t);
        if (has_alpha(from_.colors, t)) ++done_.colored;
        const double cutoff = material.alpha_cutoff;
        const Texture* texture = material.base_color_texture.get();
        const auto& uvs = material.base_color_sampler.uv_set == 0 ? from_.uvs : from_.second_uvs;
        if (!texture || texture->alpha.empty() || uvs.empty() || !(material.alpha_factor > 0)) {
            if (material.alpha_factor >= cutoff) return keep(t);
            ++done_.cut;
            return;
        }
        const Opacity opacity(material, cutoff);
        std::array<GridPlace, 3> corners;
        for (std::size_t k = 0; k < 3; ++k) corners[k] = opacity.place(uvs[t][k]);
        if (!(std::abs(cross(corners[1] - corners[0], corners[2] - corners[0])) > 1e-12) ||
            lacks_area(from_.points, from_.triangles[t]))
            return keep(t);
        TriangleCut pieces(corners, opacity);
        if (pieces.is_too_fine()) {
            ++done_.too_fine;
            return keep(t);
        }
        if (!pieces.cut()) return keep(t);
        ++done_.cut;
        for (const GridPolygon& piece : pieces.pieces()) add(t, piece, pieces);
    }

    void keep(std::size_t t) {
        to_.triangles.push_back(from_.triangles[t]);
        to_.material.push_back(from_.material[t]);
        if (!from_.uvs.empty()) to_.uvs.push_back(from_.uvs[t]);
        if (!from_.second_uvs.empty()) to_.second_uvs.push_back(from_.second_uvs[t]);
        if (!from_.colors.empty()) to_.colors.push_back(from_.colors[t]);
        if (!from_.normals.empty()) to_.normals.push_back(from_.normals[t]);
        if (!from_.tangents.empty()) to_.tangents.push_back(from_.tangents[t]);
    }

    void add(std::size_t t, const GridPolygon& piece, const TriangleCut& cut) {
        const auto first = static_cast<Id>(to_.points.size());
        std::vector<Vec2> uvs, second_uvs;
        std::vector<Vec4> colors, tangents;
        std::vector<Vec3> normals;
        for (const GridPlace& place : piece) {
            const Vec2 weights = cut.weights(place);
            const auto mix = [&]<typename T>(const T& a, const T& b, const T& c) -> T {
                return a + weights.x * (b - a) + weights.y * (c - a);
            };
            const IdTriple& corner = from_.triangles[t];
            to_.points.push_back(
                mix(from_.points[corner[0]], from_.points[corner[1]], from_.points[corner[2]]));
            const auto mix_set = [&](const auto& set) { return mix(set[t][0], set[t][1], set[t][2]); };
            if (!from_.uvs.empty()) uvs.push_back(mix_set(from_.uvs));
            if (!from_.second_uvs.empty()) second_uvs.push_back(mix_set(from_.second_uvs));
            if (!from_.colors.empty()) colors.push_back(mix_set(from_.colors));
            if (!from_.tangents.empty()) tangents.push_back(mix_set(from_.tangents));
            if (!from_.normals.empty())
                normals.push_back(
                    normalize_or_zero(mix(from_.normals[t][0], from_.normals[t][1], from_.normals[t][2])));
        }
        for (std::size_t k = 1; k + 1 < piece.size(); ++k) {
            const std::size_t b = cut.turns() ? k + 1 : k, c = cut.turns() ? k : k + 1;
            const IdTriple corners{first, first + static_cast<Id>(b), first + static_cast<Id>(c)};
            if (lacks_area(to_.points, corners)) continue;  // three points on one side of the piece
            to_.triangles.push_back(corners);
            to_.material.push_back(from_.material[t]);
            if (!uvs.empty()) to_.uvs.push_back({uvs[0], uvs[b], uvs[c]});
            if (!second_uvs.empty()) to_.second_uvs.push_back({second_uvs[0], second_uvs[b], second_uvs[c]});
            if (!colors.empty()) to_.colors.push_back({colors[0], colors[b], colors[c]});
            if (!tangents.empty()) to_.tangents.push_back({tangents[0], tangents[b], tangents[c]});
            if (!from_.normals.empty()) to_.normals.push_back({normals[0], normals[b], normals[c]});
        }
    }

    const ObjectMesh& from_;
    const std::vector<Material>& materials_;
    ObjectMesh to_;
    AlphaCut done_;
};

}  // namespace

Blending blending_of(const Material& material) {
    if (material.alpha_mode != AlphaMode::kBlend) return Blending::kNever;
    const bool has_alpha = material.base_color_texture && !material.base_color_texture->alpha.empty();
    return material.alpha_factor < 1 || has_alpha ? Blending::kAll : Blending::kByColors;
}

bool blends(Blending material, const ObjectMesh& mesh, std::size_t triangle) {
    return material == Blending::kAll ||
           (material == Blending::kByColors && has_alpha(mesh.colors, triangle));
}

AlphaCut cut_by_alpha(ObjectMesh& mesh, const std::vector<Material>& materials) {
    const bool any = std::any_of(mesh.material.begin(), mesh.material.end(), [&](Id material) {
        return materials[material].alpha_mode == AlphaMode::kMask;
    });
    if (!any) return {};
    const ObjectMesh whole = std::move(mesh);
    return MeshCutter(whole, materials).run(mesh);
}

}  // namespace trilens
