// The radiosity equation B_i = E_i + rho_i sum_j F_ij B_j, solved by shooting and by gathering; three
// colours.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "base/math/vec.h"
#include "base/util/error.h"
#include "radiosity/form_factors.h"
#include "radiosity/settings.h"

namespace trilens {

/// One entry per side each. Power is area times exitance.
struct RadiosityProblem {
    std::vector<double> area;       // 0: takes no part
    std::vector<Vec3> reflectance;  // 0..1, below 1 somewhere
    std::vector<Vec3> exitance;     // what leaves before anything has come from another side
};

struct SolveParams {
    double tolerance = 1e-3;           // of the power in the problem: what may be left unshot, or still move
    std::size_t most_steps = 1000000;  // rows shot, or sweeps
};

struct RadiositySolution {
    std::vector<Vec3> radiosity;  // what leaves each side
    std::vector<Vec3> arriving;   // irradiance from the other sides
    Vec3 escaped{0}, unshot{0};   // power
    std::vector<RadiosityStep> steps;
    bool converged = false;
};

using RowSource = std::function<FormFactorRow(Id side)>;

/// Progressive refinement: the sides with most unshot power shoot it, F_ji = F_ij A_i / A_j, until little is
/// left. No power is lost but what `unshot` says. `rows` may be asked from several threads at once; the same
/// bits for any number of them. Throws Interrupted.
/// Source: Cohen, Chen, Wallace, Greenberg, A Progressive Refinement Approach to Fast Radiosity Image
/// Generation, SIGGRAPH 1988.
RadiositySolution shoot(const RadiosityProblem& problem, const RowSource& rows, const SolveParams& params,
                        const Progress& progress = {});

/// Gauss and Seidel's iteration over the rows in order, until a sweep moves little. Throws Interrupted.
RadiositySolution gather(const RadiosityProblem& problem, const FormFactorMatrix& matrix,
                         const SolveParams& params, const Progress& progress = {});

}  // namespace trilens
