// How radiosity is found, by names, and how far it has come.
#pragma once

#include <array>
#include <cstddef>

#include "base/util/names.h"

namespace trilens {

/// Hemicubes drawn by the projector, or Embree's rays as their truth.
enum class FormFactorMethod { kHemicube, kRays };

template <>
struct EnumNames<FormFactorMethod> {
    static constexpr std::array kTable{NamedValue<FormFactorMethod>{FormFactorMethod::kHemicube, "hemicube"},
                                       NamedValue<FormFactorMethod>{FormFactorMethod::kRays, "rays"}};
};

/// Progressive refinement shoots from side to side, and needs one row at a time; Gauss-Seidel gathers, and
/// needs all rows at once.
enum class RadiositySolver { kProgressive, kGaussSeidel };

template <>
struct EnumNames<RadiositySolver> {
    static constexpr std::array kTable{
        NamedValue<RadiositySolver>{RadiositySolver::kProgressive, "progressive"},
        NamedValue<RadiositySolver>{RadiositySolver::kGaussSeidel, "gauss-seidel"}};
};

/// How far a solver had come.
struct RadiosityStep {
    std::size_t rows = 0;  // shot, or gathered
    double unshot = 1;     // share of the problem's power, of the worst colour
};

}  // namespace trilens
