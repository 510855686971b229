// The forms by products of vectors, and their values by Horner's rule.
#include "projector/place.h"

#include <cmath>

namespace trilens {
namespace {

double linear(const std::array<double, 3>& c, const Vec2& at) {
    return c[0] + at.x * c[1] + at.y * c[2];
}

double quadratic(const std::array<double, 6>& c, const Vec2& at) {
    return c[0] + at.x * (c[1] + at.x * c[3] + at.y * c[4]) + at.y * (c[2] + at.y * c[5]);
}

}  // namespace

PlaceForms place_forms(const FacetRays& facet, const std::array<Vec3, 3>& corner) {
    const Vec3 e1 = corner[1] - corner[0], e2 = corner[2] - corner[0], turned = corner[0] - corner[2];
    const Vec3 normal = cross(e1, e2);
    PlaceForms forms;
    for (std::size_t k = 0; k < 3; ++k) {
        forms.above[k] = dot(facet.rays.weight[k] * corner[0] - facet.rays.origin[k], normal);
        forms.along[k] = dot(facet.rays.direction[k], normal);
    }
    for (std::size_t k = 0; k < 6; ++k) {
        const Vec3 moment = facet.line.moment[k] - cross(corner[0], facet.line.direction[k]);
        forms.second[k] = dot(turned, moment);
        forms.third[k] = dot(e1, moment);
    }
    forms.size = largest_part(e1) * largest_part(e2);
    return forms;
}

std::optional<LineHit> place(const FacetRays& facet, const PlaceForms& forms, const Vec2& from) {
    const double weight = linear(facet.rays.weight, from), along = linear(forms.along, from);
    const Vec2 far = glm::abs(from);
    const double speed = linear(facet.speed, far);
    const std::array<double, 3>& w = facet.rays.weight;
    const double weight_terms = linear({std::fabs(w[0]), std::fabs(w[1]), std::fabs(w[2])}, far);
    const double scale = 1 / (weight * along);
    const double t = linear(forms.above, from) * (weight * scale);
    const double b1 = quadratic(forms.second, from) * scale, b2 = quadratic(forms.third, from) * scale;
    if (!(std::fabs(weight) >= kLeastWeightShare * weight_terms)) return std::nullopt;
    if (!(std::fabs(along) >= kLeastDeterminant * (speed * forms.size))) return std::nullopt;
    if (!(b1 >= 0 && b2 >= 0 && b1 + b2 <= 1 && std::isfinite(t))) return std::nullopt;
    return LineHit{t, {b1, b2}};
}

}  // namespace trilens
