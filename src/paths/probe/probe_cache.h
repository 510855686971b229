// The probes of a facet's points while it is divided: no point twice, and no more of its paths than are
// needed.
#pragma once

#include <deque>
#include <functional>
#include <initializer_list>
#include <map>
#include <span>
#include <utility>

#include "paths/probe/path_probe.h"

namespace trilens {

/// A point of a facet. `screen` homogeneous, `chord` on the facet's plane, world.
struct FacetPoint {
    PathProbe* probe = nullptr;
    Vec3 screen{0}, chord{0};
    Id shared = kNone;  // see PartCorner
};

/// How a facet's points are looked at.
struct ProbeCacheParams {
    ProbeSide side = ProbeSide::kFront;
    double reach = 0;     // see Chord
    bool beside = false;  // probe_offsets() where all paths are followed
};

/// Makes probes and keeps them. `context` must live longer.
class ProbeCache {
  public:
    ProbeCache(const ProbeContext& context, const ProbeCacheParams& params)
        : context_(context), params_(params) {}

    /// The point with equal weights of these. Of the paths there the principal ones alone are followed.
    FacetPoint between(std::initializer_list<const FacetPoint*> points);

    /// between() two, in whatever order; the same probe each time.
    FacetPoint middle_of(const FacetPoint& a, const FacetPoint& b);

    /// Has all paths followed there, down to `least_weight`.
    void follow_all_at(const FacetPoint& point, double least_weight);

    /// Counts what the paths left out at a probe, which need not be one of these.
    void note(const CutPaths& cut) { cut_ = most_cut(cut_, cut); }

    /// The probes, at places that stay, and the most that any left out.
    std::deque<PathProbe>& probes() { return probes_; }
    const CutPaths& cut() const { return cut_; }

  private:
    using Ends = std::pair<const PathProbe*, const PathProbe*>;

    const ProbeContext& context_;
    ProbeCacheParams params_;
    std::deque<PathProbe> probes_;
    CutPaths cut_;
    std::map<Ends, FacetPoint> middles_;  // of edges; nothing depends on the order
};

/// Whether one list of histories may hold at all these points: they see the optic from one side, by the same
/// principal paths.
bool may_agree(std::span<const FacetPoint> points);

}  // namespace trilens
