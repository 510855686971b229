#include "lens/dispersion.h"

#include <cmath>

#include "base/util/error.h"

namespace trilens {
namespace {

double sellmeier_index(const SellmeierTerms& terms, double wavelength) {
    const double w = wavelength * wavelength;
    double square = 1;
    for (std::size_t i = 0; i < terms.size(); i += 2) square += terms[i] * w / (w - terms[i + 1]);
    return std::sqrt(square);
}

double schott_index(const std::array<double, 6>& a, double wavelength) {
    const double w = wavelength * wavelength;
    return std::sqrt(a[0] + a[1] * w + (a[2] + (a[3] + (a[4] + a[5] / w) / w) / w) / w);
}

template <typename Index>
Glass glass_by(const Index& index, const std::string& name, const std::string& file,
               const std::string& place) {
    const auto at = [&](SpectralLine line) { return index(wavelength_of(line)); };
    return glass_of_lines(name, {at(SpectralLine::kD), at(SpectralLine::kC), at(SpectralLine::kF)}, file,
                          place);
}

}  // namespace

double wavelength_of(SpectralLine line) {
    return line == SpectralLine::kD ? 0.5875618 : line == SpectralLine::kC ? 0.6562725 : 0.4861327;
}

Glass glass_of_lines(const std::string& name, const LineIndices& indices, const std::string& file,
                     const std::string& place) {
    for (const double n : {indices.d, indices.c, indices.f})
        if (!(n >= 1 && n <= 10))
            throw InputError(file, place,
                             "the glass " + name + " has no index from 1 to 10 at a visible line");
    if (!(indices.c <= indices.d && indices.d <= indices.f))
        throw InputError(file, place, "the index of the glass " + name + " does not fall from blue to red");
    const double spread = indices.f - indices.c;
    return {name, indices.d, spread > 0 ? (indices.d - 1) / spread : 0, indices.c, indices.f};
}

Glass sellmeier_glass(const std::string& name, const SellmeierTerms& terms, const std::string& file,
                      const std::string& place) {
    return glass_by([&](double w) { return sellmeier_index(terms, w); }, name, file, place);
}

Glass schott_glass(const std::string& name, const std::array<double, 6>& terms, const std::string& file,
                   const std::string& place) {
    return glass_by([&](double w) { return schott_index(terms, w); }, name, file, place);
}

}  // namespace trilens
