#include "measure/compare.h"

#include <algorithm>
#include <utility>

#include "base/util/error.h"
#include "base/util/format.h"
#include "base/util/names.h"

namespace trilens {
namespace {

using Metric = std::optional<double>;
using Layers = std::vector<const LayerComparison*>;

constexpr const char* kLayerNames[] = {"reflect", "refract"};

double number(std::size_t count) {
    return static_cast<double>(count);
}

Metric percent(std::size_t part, std::size_t whole) {
    if (whole == 0) return std::nullopt;
    return 100 * number(part) / number(whole);
}

void add_colours(const Comparison& comparison, std::vector<NamedMetric>& all) {
    for (const ColourMetric& one : kColourMetrics)
        all.push_back(
            {one.limit_name ? one.limit_name : one.name, comparison.metrics.*one.value, one.is_likeness});
    const CompareCounts& c = comparison.counts;
    all.insert(all.end(), {{"fail", number(c.fail)}, {"warn", number(c.warn)}, {"hard", number(c.hard)}});
}

void add_seen(const Layers& layers, const std::string& prefix, std::vector<NamedMetric>& all) {
    SeenMismatch seen;
    bool is_measured = false;
    for (const LayerComparison* layer : layers) {
        if (!layer->seen) continue;
        is_measured = true;
        seen.pixels += layer->seen->pixels;
        seen.object_mismatch += layer->seen->object_mismatch;
        seen.primitive_mismatch += layer->seen->primitive_mismatch;
        seen.coverage_mismatch += layer->seen->coverage_mismatch;
    }
    const std::pair<const char*, std::size_t> counts[] = {{"object_mismatch", seen.object_mismatch},
                                                          {"primitive_mismatch", seen.primitive_mismatch},
                                                          {"coverage_mismatch", seen.coverage_mismatch}};
    for (const auto& [name, count] : counts) {
        all.push_back({prefix + name, is_measured ? Metric(number(count)) : std::nullopt});
        all.push_back({prefix + name + "_percent", percent(count, seen.pixels)});
    }
}

Metric largest(const Metric& one, const Metric& other) {
    if (!one || !other) return one ? one : other;
    return std::max(*one, *other);
}

void add_displacement(const Layers& layers, const std::string& prefix, std::vector<NamedMetric>& all) {
    const std::pair<const char*, double Summary::*> statistics[] = {{"displacement_mean", &Summary::mean},
                                                                    {"displacement_p50", &Summary::p50},
                                                                    {"displacement_p95", &Summary::p95},
                                                                    {"displacement_p99", &Summary::p99},
                                                                    {"displacement_max", &Summary::max}};
    std::vector<const Displacement*> measured;
    for (const LayerComparison* layer : layers)
        if (layer->displacement) measured.push_back(&*layer->displacement);
    for (const auto& [name, which] : statistics) {
        Metric worst;
        for (const Displacement* d : measured)
            if (d->summary) worst = largest(worst, (*d->summary).*which);
        all.push_back({prefix + name, worst});
    }

    Metric off_folds, coverage;
    std::size_t lost = 0, unmeasured = 0, beyond = 0, missing = 0, found = 0;
    for (const Displacement* d : measured) {
        off_folds = largest(off_folds, d->mean_off_folds);
        if (d->coverage) coverage = std::min(coverage.value_or(1), *d->coverage);
        lost += d->lost;
        unmeasured += d->unmeasured;
        beyond += d->beyond_radius;
        missing += d->missing;
        found += d->pixels;
    }
    const auto counted = [&](std::size_t count) {
        return measured.empty() ? Metric() : Metric(number(count));
    };
    all.push_back({prefix + "displacement_mean_off_folds", off_folds});
    all.push_back({prefix + "lost", counted(lost)});
    all.push_back({prefix + "lost_percent", percent(lost, found + lost + unmeasured)});
    all.push_back({prefix + "unmeasured", counted(unmeasured)});
    all.push_back({prefix + "unmeasured_percent", percent(unmeasured, found + lost + unmeasured)});
    all.push_back({prefix + "beyond_radius", counted(beyond)});
    all.push_back({prefix + "missing", counted(missing)});
    Metric beyond_bound;
    for (const LayerComparison* layer : layers)
        if (layer->bounds)
            beyond_bound = beyond_bound.value_or(0) + static_cast<double>(layer->bounds->beyond);
    all.push_back({prefix + "beyond_bound", beyond_bound});
    all.push_back({prefix + "coverage", coverage, true});
}

}  // namespace

std::vector<NamedMetric> named_metrics(const Comparison& comparison,
                                       const std::vector<LayerComparison>& layers) {
    std::vector<NamedMetric> all;
    add_colours(comparison, all);
    Layers every;
    for (const LayerComparison& layer : layers) every.push_back(&layer);
    add_seen(every, "", all);
    add_displacement(every, "", all);
    for (const std::string name : kLayerNames) {
        Layers one = every;
        std::erase_if(one, [&](const LayerComparison* layer) { return layer->layer != name; });
        add_seen(one, name + ".", all);
        add_displacement(one, name + ".", all);
    }
    return all;
}

std::vector<std::string> metric_names() {
    std::vector<std::string> names;
    for (const NamedMetric& metric : named_metrics({}, {})) names.push_back(metric.name);
    return names;
}

std::vector<std::string> broken_limits(const std::vector<MetricLimit>& limits,
                                       const std::vector<NamedMetric>& metrics) {
    std::vector<std::string> reasons;
    for (const MetricLimit& limit : limits) {
        const auto found = std::find_if(metrics.begin(), metrics.end(), [&](const NamedMetric& metric) {
            return metric.name == limit.metric;
        });
        if (found == metrics.end())
            throw UsageError("there is no metric \"" + limit.metric + "\"" +
                             suggestion(limit.metric, metric_names()));
        const char* word = found->is_likeness ? "at least" : "at most";
        if (!found->value)
            reasons.push_back(fmt::format("{} was not measured, and {} {:.6g} is asked for", limit.metric,
                                          word, limit.value));
        else if (!(found->is_likeness ? *found->value >= limit.value : *found->value <= limit.value))
            reasons.push_back(fmt::format("{} is {:.6g}, and {} {:.6g} is asked for", limit.metric,
                                          *found->value, word, limit.value));
    }
    return reasons;
}

}  // namespace trilens
