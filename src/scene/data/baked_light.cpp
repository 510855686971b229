#include "scene/data/baked_light.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "base/util/check.h"

namespace trilens {
namespace {

constexpr int kDigits = 5, kCornerDigits = 12;
constexpr double kCornerSlack = 1e-8;  // shares of the mesh's greatest coordinate

double rounded(double value, int digits = kDigits) {
    char text[64];
    const auto written =
        std::to_chars(std::begin(text), std::end(text), value, std::chars_format::scientific, digits - 1);
    double back = 0;
    std::from_chars(text, written.ptr, back);
    return back;
}

Vec3 rounded(const Vec3& v) {
    return {rounded(v.x), rounded(v.y), rounded(v.z)};
}

struct ByComponents {
    bool operator()(const Vec3& a, const Vec3& b) const {
        return std::lexicographical_compare(&a.x, &a.x + 3, &b.x, &b.x + 3);
    }
};

/// Colours, each once, in the order in which they come.
class Palette {
  public:
    std::size_t index(const Vec3& color) {
        const auto [at, is_new] = numbers_.emplace(color, numbers_.size());
        if (is_new) colors_.push_back({color.x, color.y, color.z});
        return at->second;
    }
    Json colors() && { return std::move(colors_); }

  private:
    std::map<Vec3, std::size_t, ByComponents> numbers_;
    Json colors_ = Json::array();
};

bool is_dark(const std::array<Vec3, 3>& side) {
    return std::all_of(side.begin(), side.end(), [](const Vec3& light) { return light == Vec3(0); });
}

/// Of the i-th corner: within -1..-0.5 or 0.5..1. Source: Steele, Lea, Flood, Fast Splittable Pseudorandom
/// Number Generators, OOPSLA 2014 (SplitMix64).
double corner_weight(std::uint64_t i) {
    std::uint64_t bits = (i + 1) * 0x9e3779b97f4a7c15u;
    bits = (bits ^ bits >> 30) * 0xbf58476d1ce4e5b9u;
    bits = (bits ^ bits >> 27) * 0x94d049bb133111ebu;
    bits ^= bits >> 31;
    const double size = 0.5 + 0.5 * static_cast<double>(bits >> 12) / static_cast<double>(1ull << 52);
    return bits % 2 == 0 ? size : -size;
}

/// What the halves of a triangle have at their corners, where `middle` is between `first` and the next.
template <typename Corners>
void split_corners(std::vector<Corners>& all, const TriangleSplit& split, const Corners& middle) {
    if (all.empty()) return;
    const std::size_t k = static_cast<std::size_t>(split.edge), next = (k + 1) % 3;
    Corners other = all[split.triangle];
    other[k] = middle[0];
    all[split.triangle][next] = middle[0];
    all.push_back(other);
}

template <typename Corners>
Corners middle_of(const std::vector<Corners>& all, const TriangleSplit& split) {
    Corners middle{};
    if (all.empty()) return middle;
    const std::size_t k = static_cast<std::size_t>(split.edge), next = (k + 1) % 3;
    middle[0] = 0.5 * (all[split.triangle][k] + all[split.triangle][next]);
    return middle;
}

}  // namespace

Id TriangleSplitter::midpoint(Id a, Id b) {
    const auto [at, is_new] = midpoints_.emplace(std::minmax(a, b), static_cast<Id>(object_.points.size()));
    if (is_new) {
        const Vec3 middle = 0.5 * (object_.points[a] + object_.points[b]);
        object_.points.push_back(middle);
    }
    return at->second;
}

void TriangleSplitter::split(const TriangleSplit& split) {
    TRILENS_CHECK(split.triangle < object_.triangles.size() && split.edge >= 0 && split.edge < 3,
                  "a split is of a triangle that there is");
    TRILENS_CHECK(object_.baked.empty(), "triangles are divided before they get their light");
    const std::size_t k = static_cast<std::size_t>(split.edge), next = (k + 1) % 3;
    const IdTriple corner = object_.triangles[split.triangle];
    const Id middle = midpoint(corner[k], corner[next]);
    split_corners(object_.triangles, split, IdTriple{middle, middle, middle});
    split_corners(object_.uvs, split, middle_of(object_.uvs, split));
    split_corners(object_.second_uvs, split, middle_of(object_.second_uvs, split));
    split_corners(object_.colors, split, middle_of(object_.colors, split));
    split_corners(object_.tangents, split, middle_of(object_.tangents, split));
    auto normal = middle_of(object_.normals, split);
    normal[0] = normalize_or_zero(normal[0]);
    split_corners(object_.normals, split, normal);
    object_.material.push_back(object_.material[split.triangle]);
}

Vec3 weighted_corners(const ObjectMesh& mesh) {
    Vec3 sum{0};
    std::uint64_t i = 0;
    for (const IdTriple& triangle : mesh.triangles)
        for (const Id corner : triangle) sum = sum + corner_weight(i++) * mesh.points[corner];
    return sum;
}

bool has_corners(const ObjectMesh& mesh, const Vec3& corners) {
    double greatest = 0;
    for (const Vec3& point : mesh.points)
        greatest = std::max({greatest, std::fabs(point.x), std::fabs(point.y), std::fabs(point.z)});
    const double slack =
        kCornerSlack * greatest * std::sqrt(3.0 * static_cast<double>(mesh.triangles.size()));
    return length(weighted_corners(mesh) - corners) <= slack;
}

BakedLight rounded(const BakedLight& light) {
    BakedLight result;
    for (std::size_t k = 0; k < 3; ++k) {
        result.front[k] = rounded(light.front[k]);
        result.back[k] = rounded(light.back[k]);
    }
    return result;
}

Json baked_light_json(const BakedLightRecord& record) {
    Palette palette;
    Json splits = Json::array(), front = Json::array(), back = Json::array();
    for (const TriangleSplit& split : record.splits) {
        splits.push_back(split.triangle);
        splits.push_back(split.edge);
    }
    const auto add = [&](const std::array<Vec3, 3>& side, Json& into) {
        for (const Vec3& light : side) into.push_back(palette.index(light));
    };
    for (const BakedLight& light : record.light) add(light.front, front);
    const bool has_back = !std::all_of(record.light.begin(), record.light.end(),
                                       [](const BakedLight& light) { return is_dark(light.back); });
    for (const BakedLight& light : record.light)
        if (has_back) add(light.back, back);
    Json json{{"triangles", record.triangles}};
    if (const auto& at = record.corners)
        json["corners"] = {rounded(at->x, kCornerDigits), rounded(at->y, kCornerDigits),
                           rounded(at->z, kCornerDigits)};
    if (!splits.empty()) json["splits"] = std::move(splits);
    json["colors"] = std::move(palette).colors();
    json["front"] = std::move(front);
    if (has_back) json["back"] = std::move(back);
    return json;
}

}  // namespace trilens
