#include "scene/formats/code_v_form.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/util/error.h"
#include "lens/q_asphere.h"
#include "scene/formats/line_scanner.h"

namespace trilens {
namespace {

/// A cylinder is a toric side whose other radius is infinite.
constexpr std::pair<std::string_view, SideForm> kForms[] = {
    {"SPH", SideForm::kRound},  {"CON", SideForm::kRound},     {"ASP", SideForm::kRound},
    {"YTO", SideForm::kToricY}, {"XTO", SideForm::kToricX},    {"AAS", SideForm::kBiconic},
    {"CYL", SideForm::kToricY}, {"SPS QBF", SideForm::kRound}, {"SPS QCN", SideForm::kRound}};

SideForm form_of(const std::string& name) {
    for (const auto& [known, form] : kForms)
        if (known == name) return form;
    return SideForm::kRound;
}

/// Conicoid and asphere: what A, B, ... multiply is r^4, r^6, ...
constexpr std::string_view kTerms = "ABCDEFG";
constexpr std::string_view kNumbers[] = {"RDX", "CUX", "K", "KX", "KY"};

bool is_q_type(const std::string& form) {
    return form == "SPS QBF" || form == "SPS QCN";
}

/// Of Q-type surfaces: C1 is the normalization radius, from C3 on are a0, a1, ... The listing that CODE V
/// writes of Qbfs calls them NRADIUS, QB4, QB6, ..., by the powers of r that they begin with.
constexpr int kNormalizationRadius = 1, kFirstQTerm = 3;

/// The number of a coefficient; 0 for what is none.
int coefficient_of(const std::string& name, const std::string& form) {
    if (name.size() > 1 && name[0] == 'C')
        return std::max(0, parse_integer(std::string_view(name).substr(1)).value_or(0));
    if (name == "NRADIUS") return kNormalizationRadius;
    if (form != "SPS QBF" || !name.starts_with("QB")) return 0;
    const int power = parse_integer(std::string_view(name).substr(2)).value_or(0);
    return power >= 4 && power % 2 == 0 ? kFirstQTerm + power / 2 - 2 : 0;
}

}  // namespace

bool CodeVForm::take_form(const std::string& name, const std::string& file, const std::string& place) {
    const auto has_name = [&](const auto& form) { return form.first == name; };
    if (std::none_of(std::begin(kForms), std::end(kForms), has_name)) return false;
    if (!name_.empty() && name_ != name)
        throw InputError(file, place, name + ": the surface has a form already, " + name_ + " in " + place_);
    name_ = name;
    place_ = place;
    return true;
}

bool CodeVForm::has_number(std::string_view key) {
    return std::find(std::begin(kNumbers), std::end(kNumbers), key) != std::end(kNumbers) ||
           (key.size() == 1 && kTerms.find(key[0]) != std::string_view::npos);
}

void CodeVForm::take_number(const std::string& key, const PlacedNumber& number) {
    if (key == "RDX" || key == "CUX") {
        const bool is_radius = key == "RDX" && number.value != 0;
        x_curvature_ = PlacedNumber{is_radius ? 1 / number.value : number.value, number.place};
    } else if (key == "K") {
        conic_ = number;
    } else if (key == "KX" || key == "KY") {
        (key == "KX" ? x_conic_ : y_conic_) = number;
    } else {
        terms_.at(kTerms.find(key[0]) + 1) = number;
    }
}

void CodeVForm::take_coefficient(const std::string& name, const PlacedNumber& number,
                                 const std::string& file) {
    const auto fail = [&](const std::string& why) {
        throw InputError(file, number.place, "SCO " + name + " " + why);
    };
    if (!is_q_type(name_)) fail("before its surface's form: it is read of Q-type ones (SPS QBF, SPS QCN)");
    const int index = coefficient_of(name, name_);
    if (index == 0) fail("is not read: C1 is the normalization radius, from C3 on are the terms");
    if (number.value == 0) {
        coefficients_.erase(index);
        return;
    }
    if (index == kFirstQTerm - 1) fail("of a Q-type surface is not known: conic constants are read from K");
    if (index - kFirstQTerm >= static_cast<int>(kQTerms)) fail("is beyond r^16");
    coefficients_[index] = number;
}

void CodeVForm::refuse(Refused number, const std::string& why, const std::string& file) const {
    if (this->*number) throw InputError(file, (this->*number)->place, why);
}

void CodeVForm::refuse_terms(const std::string& why, const std::string& file) const {
    for (const PlacedNumber& term : terms_)
        if (term.value != 0) throw InputError(file, term.place, "A to G are not of " + why);
}

void CodeVForm::refuse_of_others(const std::string& file) const {
    if (form_of(name_) == SideForm::kRound)
        refuse(&CodeVForm::x_curvature_,
               "RDX and CUX are read of cylinders, toric and biconic surfaces (CYL, YTO, XTO, AAS)", file);
    if (name_ != "AAS")
        for (const Refused conic : {&CodeVForm::x_conic_, &CodeVForm::y_conic_})
            refuse(conic, "KX and KY are read of biconic surfaces (AAS)", file);
    if (name_ == "AAS") refuse_terms("an anamorphic asphere (AAS)", file);
    if (name_ == "CYL") refuse_terms("a cylinder (CYL)", file);
    if (is_q_type(name_)) refuse_terms("a Q-type surface (" + name_ + ")", file);
    if (name_ == "CYL" && conic_ && conic_->value != 0)
        refuse(&CodeVForm::conic_, "K is not of a cylinder (CYL)", file);
    if (name_ == "SPS QBF" && conic_ && conic_->value != 0)
        refuse(&CodeVForm::conic_, "SPS QBF departs from a sphere: K must be 0", file);
    if (name_ == "AAS" && !x_curvature_) throw InputError(file, place_, "AAS needs RDX or CUX");
}

/// Its profile lies along the axis that it is bent along.
void CodeVForm::bend_cylinder(LensSide& side, const std::string& file) const {
    if (side.across_curvature == 0) return;
    if (side.curvature != 0)
        throw InputError(file, x_curvature_->place,
                         "a cylinder (CYL) is bent along y (RDY) or along x (RDX), not along both");
    side.form = SideForm::kToricX;
    std::swap(side.curvature, side.across_curvature);
}

void CodeVForm::add_q_terms(LensSide& side, const std::string& file) const {
    std::vector<double> terms;
    double radius = 0;
    for (const auto& [index, number] : coefficients_) {
        if (index == kNormalizationRadius) {
            radius = number.value;
        } else {
            terms.resize(static_cast<std::size_t>(index - kFirstQTerm) + 1);
            terms.back() = number.value;
        }
    }
    if (terms.empty()) return;
    if (!(radius > 0)) throw InputError(file, place_, name_ + " without a normalization radius (SCO C1)");
    side.terms_radius = radius;
    if (name_ == "SPS QBF")
        side.normal_departures = qbfs_departures(terms, radius);
    else
        side.coefficients = qcon_coefficients(terms, radius);
}

void CodeVForm::shape(LensSide& side, const std::string& file) const {
    refuse_of_others(file);
    side.form = form_of(name_);
    for (std::size_t i = 0; i < terms_.size(); ++i) side.coefficients[i] = terms_[i].value;
    if (conic_) side.conic = conic_->value;
    if (x_curvature_) side.across_curvature = x_curvature_->value;
    if (x_conic_) side.across_conic = x_conic_->value;
    if (y_conic_) side.conic = y_conic_->value;
    if (side.form == SideForm::kToricX) std::swap(side.curvature, side.across_curvature);
    if (name_ == "CYL") bend_cylinder(side, file);
    if (is_q_type(name_)) add_q_terms(side, file);
}

}  // namespace trilens
