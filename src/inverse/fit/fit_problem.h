// The least squares problem of a fit: residuals and Jacobians of all pairs, along rays or by exact images.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "inverse/fit/fit.h"
#include "inverse/fit/fit_scene.h"
#include "inverse/fit/path_derivatives.h"
#include "inverse/solve/levenberg_marquardt.h"

namespace trilens {

/// What a pair's residual is: along the ray of its pixel, (dx/dX) (X - Y) with Y the ray's place nearest to
/// the point X (Sampson's, its metric held until the next linearisation); or by the image of X.
enum class FitResidual { kRay, kImage };

/// A pair as the problem holds it.
struct FitPair {
    Vec2 pixel{0};
    Vec3 point{0};
    double sigma = 1;
    std::size_t camera = 0;
    std::string word;

    Vec2 guess{0};           // kImage: where its image was last
    std::size_t events = 0;  // of its path
    bool is_lost = false;
    std::array<Vec3, 2> metric{};  // dx/dX at the last linearisation
    std::vector<OpticEvent> path = {};
};

/// Residuals are in units of the pairs' sigmas; unknowns in the parameters' scales. The scene must live
/// longer.
class FitProblem {
  public:
    FitProblem(const Scene& scene, Json document, std::vector<FitParameter> parameters,
               std::vector<FitPair> pairs);

    struct Prior {
        std::size_t parameter = 0;
        double value = 0, sigma = 1;
    };

    std::vector<Prior> priors;
    double huber = 4;  // pixels; of a pair in units of its own sigma
    FitResidual residual = FitResidual::kRay;
    const Progress* progress = nullptr;

    LeastSquares least_squares();
    Linearisation linearise();

    const Json& document() const { return document_; }
    const std::vector<FitParameter>& parameters() const { return parameters_; }
    std::vector<FitPair>& pairs() { return pairs_; }
    const Json& start() const { return start_; }

  private:
    std::optional<std::vector<double>> residuals_after(std::span<const double> step);
    bool move(std::span<const double> step, Json& document, FitScene& scene) const;
    std::vector<ParameterDifference> differences() const;
    Vec2 linearise_pair(FitPair& pair, std::span<const ParameterDifference> parameters, DenseMatrix& jacobian,
                        std::size_t row) const;
    std::optional<Vec2> trial_residual(const FitPair& pair, const FitScene& scene) const;
    std::optional<ShotPath> shoot(const FitScene& scene, const FitPair& pair, const Vec2& pixel) const;
    struct Image {
        Vec2 pixel{0};
        ShotPath path;
    };
    std::optional<Image> image_of(const FitScene& scene, const FitPair& pair) const;
    void add_priors(const Json& document, std::vector<double>& residuals) const;

    FitSceneMaker maker_;
    Json start_, document_;
    std::vector<FitParameter> parameters_;
    std::vector<FitPair> pairs_;
    FitScene scene_;
};

}  // namespace trilens
