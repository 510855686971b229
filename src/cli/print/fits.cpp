#include "cli/print/print.h"

#include <trilens/utilities.h>

#include <cmath>

#include "terminal/libraries.h"

namespace trilens {
namespace {

Json matrix_json(const std::vector<std::vector<double>>& matrix) {
    Json rows = Json::array();
    for (const std::vector<double>& row : matrix) {
        rows.push_back(Json::array());
        for (const double value : row) rows.back().push_back(json_number(value));
    }
    return rows;
}

Json pair_json(const FittedPair& pair, const Correspondence& given) {
    Json json{{"pixel", {given.pixel.x, given.pixel.y}},
              {"point", vector_json(given.point)},
              {"state", pair_state_name(pair.state)},
              {"path", pair.path}};
    if (pair.state != PairState::kLost) {
        json["dx"] = json_number(pair.residual.x);
        json["dy"] = json_number(pair.residual.y);
    }
    return json;
}

}  // namespace

Answer fit_answer(const FitResult& result, std::span<const Correspondence> pairs) {
    Answer answer;
    Json& fields = answer.fields;
    fields["parameters"] = Json::array();
    for (const FittedParameter& one : result.parameters) {
        fields["parameters"].push_back({{"pointer", one.pointer},
                                        {"start", json_number(one.start)},
                                        {"value", json_number(one.value)},
                                        {"sigma", json_number(one.sigma)}});
        answer.text +=
            fmt::format("{}: {:.9g} +- {:.3g} (from {:.9g})\n", one.pointer, one.value, one.sigma, one.start);
    }
    fields["covariance"] = matrix_json(result.covariance);
    fields["correlation"] = matrix_json(result.correlation);
    fields["rank"] = result.rank;
    fields["undetermined"] = result.undetermined;
    fields["null_vectors"] = matrix_json(result.null_vectors);
    fields["rms_px"] = json_number(result.rms);
    fields["rms_start_px"] = json_number(result.rms_start);
    fields["noise_px"] = json_number(result.noise);
    fields["iterations"] = result.iterations;
    fields["converged"] = result.converged;
    fields["used"] = result.used;
    fields["outliers"] = result.outliers;
    fields["lost"] = result.lost;
    fields["pairs"] = Json::array();
    for (std::size_t i = 0; i < pairs.size(); ++i)
        fields["pairs"].push_back(pair_json(result.pairs[i], pairs[i]));
    answer.text += fmt::format(
        "{} pairs used, {} outliers, {} lost; rms {:.4g} px, {:.4g} px before, {} iterations", result.used,
        result.outliers, result.lost, result.rms, result.rms_start, result.iterations);
    return answer;
}

}  // namespace trilens
