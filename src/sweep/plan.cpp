#include "sweep/plan.h"

#include <cstddef>

#include "base/hash.h"

namespace trilens {
namespace {

// Part of every hash: raise it when what a run stores changes.
constexpr const char* kFormat = "trilens.sweep/2";

/// Hash of parts such that no two lists of parts read the same.
std::string hash_parts(const std::vector<std::string>& parts) {
    std::string text;
    for (const std::string& part : parts) text += std::to_string(part.size()) + ":" + part;
    return hash_text(text);
}

std::string run_id(int n) {
    const std::string digits = std::to_string(n);
    return "n" + std::string(digits.size() < 4 ? 4 - digits.size() : 0, '0') + digits;
}

}  // namespace

std::vector<PlannedRun> make_plan(const Axis& axis, const std::vector<SweptOptic>& optics,
                                  const SweepKeys& keys) {
    std::vector<PlannedRun> plan;
    for (const int n : axis.values) {
        const std::string value = axis.name + "=" + std::to_string(n);
        const std::string truth = hash_parts({kFormat, "truth", keys.truth, keys.truth_per_run ? value : ""});
        std::vector<std::string> parts = {kFormat, truth, keys.job, value};
        for (const SweptOptic& optic : optics) {
            parts.push_back(std::to_string(optic.object));
            parts.push_back(optic.name);
        }
        plan.push_back({run_id(n), n, hash_parts(parts), truth});
    }
    return plan;
}

}  // namespace trilens
