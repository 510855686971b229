#include "lens/first_order.h"

#include <cmath>
#include <limits>

#include "base/util/error.h"

namespace trilens {
namespace {

/// Curvature at the vertex: the conicoid's with the coefficient of r^2.
double vertex_curvature(const LensSide& side) {
    return side.curvature + 2 * side.coefficients[0];
}

double index_before(const LensPrescription& lens, std::size_t row, SpectralLine line) {
    return row == 0 ? 1 : index_at(lens.rows[row - 1].glass, line);
}

/// The term of r^4 beyond that of the sphere with the vertex' curvature.
double figuring(const LensSide& side) {
    const double c = side.curvature, at_vertex = vertex_curvature(side);
    return (1 + side.conic) * c * c * c / 8 + side.coefficients[1] - at_vertex * at_vertex * at_vertex / 8;
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
    std::vector<ParaxialPlace> places;
    double height = start.height, slope = start.slope, before = 1;
    for (const LensRow& row : lens.rows) {
        const double behind = index_at(row.glass, line);
        slope = (before * slope - height * vertex_curvature(row.side) * (behind - before)) / behind;
        places.push_back({height, slope});
        height += row.thickness * slope;
        before = behind;
    }
    return places;
}

FirstOrder first_order(const LensPrescription& lens, SpectralLine line) {
    check_prescription(lens);
    // The two basic rays: parallel to the axis at height 1, and through the first vertex with slope 1.
    const std::vector<ParaxialPlace> parallel = paraxial_ray(lens, {1, 0}, line),
                                     central = paraxial_ray(lens, {0, 1}, line);
    const ParaxialPlace &a = parallel.back(), &b = central.back();
    if (a.slope == 0)
        throw InputError(lens.file, "", "has no focal length: rays along the axis leave along the axis");
    FirstOrder first;
    first.focal_length = -1 / a.slope;
    first.back_focal_length = -a.height / a.slope;
    first.back_principal = first.back_focal_length - first.focal_length;
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
    for (std::size_t i = 0; i < lens.rows.size(); ++i) {
        const double before = index_before(lens, i, line), behind = index_at(lens.rows[i].glass, line);
        petzval += vertex_curvature(lens.rows[i].side) * (behind - before) / (before * behind);
    }
    first.petzval_radius = -ratio(1, petzval);
    return first;
}

SeidelSums seidel_sums(const LensPrescription& lens, const LensBeam& beam) {
    const FirstOrder first = first_order(lens);
    const std::vector<ParaxialPlace> marginal = paraxial_ray(lens, {beam.pupil_radius, 0});
    const ParaxialPlace start{-first.entrance_pupil * beam.field_slope, beam.field_slope};
    const std::vector<ParaxialPlace> chief = paraxial_ray(lens, start);
    const double invariant = -beam.pupil_radius * beam.field_slope;

    SeidelSums seidel;
    double u = 0, chief_u = beam.field_slope;
    for (std::size_t i = 0; i < lens.rows.size(); ++i) {
        const LensRow& row = lens.rows[i];
        const double c = vertex_curvature(row.side), h = marginal[i].height, chief_h = chief[i].height;
        const double before = index_before(lens, i, SpectralLine::kD), behind = row.glass.index;
        // Refraction invariants, and changes across the surface.
        const double by_marginal = before * (u + h * c), by_chief = before * (chief_u + chief_h * c);
        const double of_slope = marginal[i].slope / behind - u / before;
        const double of_inverse = 1 / behind - 1 / before;
        const double of_square = 1 / (behind * behind) - 1 / (before * before);
        const auto spread = [](const Glass& glass) {
            return glass.abbe > 0 ? (glass.index - 1) / glass.abbe : 0;
        };
        const double of_colour =
            spread(row.glass) / behind - (i > 0 ? spread(lens.rows[i - 1].glass) / before : 0);

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
    seidel.image_slope = u;
    seidel.image_height = chief.back().height + first.back_focal_length * chief_u;
    return seidel;
}

}  // namespace trilens
