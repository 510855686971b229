// Forms of surfaces in CODE V's sequences: a side is known once all that is said of x, of y and of its terms
// has been read.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "base/description/lens_side.h"

namespace trilens {

/// A command's number, and the place where it stands.
struct PlacedNumber {
    double value = 0;
    std::string place = {};
};

/// What a sequence says of one surface beside its radius. What throws, throws InputError with the file and
/// the place of the command that is wrong.
class CodeVForm {
  public:
    /// SPH, CON, ASP, YTO, XTO, AAS, CYL, or "SPS QBF" and "SPS QCN"; false for any other command. A surface
    /// has one form.
    bool take_form(const std::string& name, const std::string& file, const std::string& place);

    /// Whether take_number() takes the command: RDX, CUX, K, KX, KY and A to G.
    static bool has_number(std::string_view key);
    /// The last number of each counts.
    void take_number(const std::string& key, const PlacedNumber& number);

    /// SCO: "C1", "C3", ..., or NRADIUS, QB4, QB6, ... as CODE V lists them; the last number of each counts.
    void take_coefficient(const std::string& name, const PlacedNumber& number, const std::string& file);

    /// Adds all to a side that has the curvature of RDY.
    void shape(LensSide& side, const std::string& file) const;

  private:
    using Refused = std::optional<PlacedNumber> CodeVForm::*;
    void refuse(Refused number, const std::string& why, const std::string& file) const;
    void refuse_terms(const std::string& why, const std::string& file) const;
    void refuse_of_others(const std::string& file) const;
    void bend_cylinder(LensSide& side, const std::string& file) const;
    void add_q_terms(LensSide& side, const std::string& file) const;

    std::string name_ = {}, place_ = {};
    std::optional<PlacedNumber> x_curvature_ = {}, conic_ = {}, x_conic_ = {}, y_conic_ = {};
    std::array<PlacedNumber, kAsphereTerms> terms_{};
    std::map<int, PlacedNumber> coefficients_ = {};
};

}  // namespace trilens
