#include "lens/first_order.h"

#include <cmath>
#include <limits>
#include <span>
#include <string>

#include "base/util/error.h"

namespace trilens {
namespace {

/// Curvature at the vertex, along y: the conicoid's with the coefficients of r^2.
double vertex_curvature(const LensSide& of) {
    const LensSide side = section_of(of, LensSection::kY);
    return side.curvature + 2 * (side.coefficients[0] + side.normal_departures[0]);
}

/// Before the first row and behind each; negative where light runs against the axis.
std::vector<double> signed_indices(const std::vector<LensMedium>& media, SpectralLine line) {
    std::vector<double> indices;
    for (const LensMedium& medium : media) indices.push_back(medium.sense * index_at(medium.glass, line));
    return indices;
}

/// The term of r^4 beyond that of the sphere with the vertex' curvature. 1 / sqrt(1 - c^2 r^2) is 1 + c^2 r^2
/// / 2 so far.
double figuring(const LensSide& of) {
    const LensSide side = section_of(of, LensSection::kY);
    const double c = side.curvature, at_vertex = vertex_curvature(side);
    const double along_normal = side.normal_departures[1] + side.normal_departures[0] * c * c / 2;
    return (1 + side.conic) * c * c * c / 8 + side.coefficients[1] + along_normal -
           at_vertex * at_vertex * at_vertex / 8;
}

/// How much of the dispersion of the d line's index a medium has.
double relative_spread(const Glass& glass) {
    return (index_at(glass, SpectralLine::kF) - index_at(glass, SpectralLine::kC)) / glass.index;
}

SeidelTerms& operator+=(SeidelTerms& sum, const SeidelTerms& one) {
    for (const auto& [name, number] : kSeidelNumbers) sum.*number += one.*number;
    return sum;
}

/// a / b, infinite without a sign where b is 0.
double ratio(double a, double b) {
    return b != 0 ? a / b : std::numeric_limits<double>::infinity();
}

}  // namespace

std::vector<ParaxialPlace> paraxial_ray(const LensPrescription& lens, const ParaxialPlace& start,
                                        SpectralLine line) {
    const std::vector<double> index = signed_indices(lens_media(lens), line);
    std::vector<ParaxialPlace> places;
    double height = start.height, slope = start.slope;
    for (std::size_t i = 0; i < lens.rows.size(); ++i) {
        const double power = vertex_curvature(lens.rows[i].side) * (index[i + 1] - index[i]);
        slope = (index[i] * slope - height * power) / index[i + 1];
        places.push_back({height, slope});
        height += lens.rows[i].thickness * slope;
    }
    return places;
}

namespace {

/// Whether `ray`, which comes along the axis, leaves along another way. Its slope behind, times the index
/// there, is the sum of what each surface bends it by: where these cancel, rounding is left.
bool gathers(const LensPrescription& lens, std::span<const ParaxialPlace> ray, SpectralLine line) {
    constexpr double kRounding = 1e-12;
    if (ray.empty()) return false;
    const std::vector<double> index = signed_indices(lens_media(lens), line);
    double bent = 0;
    for (std::size_t i = 0; i < ray.size(); ++i)
        bent += std::fabs(ray[i].height * vertex_curvature(lens.rows[i].side) * (index[i + 1] - index[i]));
    return std::fabs(index.back() * ray.back().slope) > kRounding * bent;
}

}  // namespace

LensSection imaging_section(const LensPrescription& lens) {
    const auto gathers_along = [&](LensSection section) {
        const LensPrescription cut = section_of(lens, section);
        return gathers(cut, paraxial_ray(cut, {1, 0}), SpectralLine::kD);
    };
    return !gathers_along(LensSection::kY) && gathers_along(LensSection::kX) ? LensSection::kX
                                                                             : LensSection::kY;
}

FirstOrder first_order(const LensPrescription& lens, SpectralLine line) {
    check_prescription(lens);
    // The two basic rays: parallel to the axis at height 1, and through the first vertex with slope 1.
    const std::vector<ParaxialPlace> parallel = paraxial_ray(lens, {1, 0}, line),
                                     central = paraxial_ray(lens, {0, 1}, line);
    const ParaxialPlace &a = parallel.back(), &b = central.back();
    for (const double number : {a.height, a.slope, b.height, b.slope})
        if (!std::isfinite(number))
            throw InputError(lens.file, "", "is bent so strongly that its rays are no numbers");
    if (!gathers(lens, parallel, line))
        throw InputError(lens.file, "",
                         std::string("has no focal length") + (is_round(lens) ? "" : " along y") +
                             ": rays along the axis leave along the axis");
    const std::vector<double> index = signed_indices(lens_media(lens), line);
    FirstOrder first;
    first.focal_length = -1 / (index.back() * a.slope);
    first.back_focal_length = -a.height / a.slope;
    first.back_principal = (1 - a.height) / a.slope;
    // The ray from the front focus leaves along the axis: height * a.slope + slope * b.slope = 0.
    first.front_focus = b.slope / a.slope;
    first.front_principal = first.front_focus + first.focal_length;
    first.length = vertex_of(lens, lens.rows.size() - 1);

    // The chief ray meets the stop on the axis.
    const std::size_t stop = stop_row(lens);
    const double at_a = parallel[stop].height, at_b = central[stop].height;
    first.entrance_pupil = ratio(at_b, at_a);
    const ParaxialPlace chief{at_b * a.height - at_a * b.height, at_b * a.slope - at_a * b.slope};
    first.exit_pupil = ratio(-chief.height, chief.slope);
    first.entrance_radius = lens.rows[stop].side.aperture * ratio(1, std::fabs(at_a));
    // Behind, a ray from the stop's centre with slope 1 there, and one from its rim.
    if (std::isfinite(first.exit_pupil))
        first.exit_radius = first.entrance_radius * std::fabs(a.height + first.exit_pupil * a.slope);
    if (first.entrance_radius > 0)
        first.f_number = std::fabs(first.focal_length) / (2 * first.entrance_radius);

    double petzval = 0;
    for (std::size_t i = 0; i < lens.rows.size(); ++i)
        petzval +=
            vertex_curvature(lens.rows[i].side) * (index[i + 1] - index[i]) / (index[i] * index[i + 1]);
    first.petzval_radius = -ratio(1, index.back() * petzval);
    return first;
}

SeidelSums seidel_sums(const LensPrescription& lens, const LensBeam& beam) {
    const FirstOrder first = first_order(lens);
    const std::vector<ParaxialPlace> marginal = paraxial_ray(lens, {beam.pupil_radius, 0});
    const ParaxialPlace start{-first.entrance_pupil * beam.field_slope, beam.field_slope};
    const std::vector<ParaxialPlace> chief = paraxial_ray(lens, start);
    const double invariant = -beam.pupil_radius * beam.field_slope;
    const std::vector<LensMedium> media = lens_media(lens);
    const std::vector<double> index = signed_indices(media, SpectralLine::kD);

    SeidelSums seidel;
    double u = 0, chief_u = beam.field_slope;
    for (std::size_t i = 0; i < lens.rows.size(); ++i) {
        const LensRow& row = lens.rows[i];
        const double c = vertex_curvature(row.side), h = marginal[i].height, chief_h = chief[i].height;
        const double before = index[i], behind = index[i + 1];
        // Refraction invariants, and changes across the surface.
        const double by_marginal = before * (u + h * c), by_chief = before * (chief_u + chief_h * c);
        const double of_slope = marginal[i].slope / behind - u / before;
        const double of_inverse = 1 / behind - 1 / before;
        const double of_square = 1 / (behind * behind) - 1 / (before * before);
        const double of_colour = relative_spread(media[i + 1].glass) - relative_spread(media[i].glass);

        SeidelTerms terms;
        terms.spherical = -by_marginal * by_marginal * h * of_slope;
        terms.coma = -by_marginal * by_chief * h * of_slope;
        terms.astigmatism = -by_chief * by_chief * h * of_slope;
        terms.petzval = -invariant * invariant * c * of_inverse;
        terms.distortion = -by_chief * (by_chief * by_chief * h * of_square +
                                        (invariant - by_chief * h) * chief_h * c * of_inverse);
        terms.axial_colour = by_marginal * h * of_colour;
        terms.lateral_colour = by_chief * h * of_colour;
        const double figure = 8 * figuring(row.side) * (behind - before);
        terms.spherical += figure * h * h * h * h;
        terms.coma += figure * h * h * h * chief_h;
        terms.astigmatism += figure * h * h * chief_h * chief_h;
        terms.distortion += figure * h * chief_h * chief_h * chief_h;
        seidel.rows.push_back(terms);
        seidel.sum += terms;
        u = marginal[i].slope, chief_u = chief[i].slope;
    }
    seidel.image_slope = index.back() * u;
    seidel.image_height = chief.back().height + first.back_focal_length * chief_u;
    return seidel;
}

}  // namespace trilens
