// Optics put up in a test, and rays followed through them.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "intersect/test_surfaces.h"
#include "paths/trace/follow.h"
#include "shade/optic_weights.h"
#include "surfaces/surfaces.h"

namespace trilens_test {

inline trilens::Material glass_of(double ior) {
    trilens::Material glass;
    glass.transmission_factor = 1;
    glass.ior = ior;
    return glass;
}

inline trilens::Material mirror_of(const Vec3& tint = Vec3(1)) {
    trilens::Material mirror;
    mirror.metallic_factor = 1;
    mirror.base_color_factor = tint;
    return mirror;
}

/// Owns what a PathWorld points to.
class Stage {
  public:
    trilens::PathWorld world;

    Id add(std::shared_ptr<const trilens::Surface> surface, const trilens::Material& material,
           int priority = 0) {
        materials_.push_back(material);
        tracers_.emplace_back(*surface, grid_of(*surface, 16));
        patches_.push_back(std::make_shared<trilens::PatchTree>(*surface, trilens::make_grid(*surface, 16)));
        surfaces_.push_back(std::move(surface));
        world.optics.push_back({&tracers_.back(), &materials_.back(), trilens::is_mirror(material), priority,
                                surfaces_.back()->sphere_curvature() > 0,
                                [tree = patches_.back()]() -> const trilens::PatchTree& { return *tree; }});
        return static_cast<Id>(world.optics.size() - 1);
    }
    Id add_ball(const Vec3& center, double radius, const trilens::Material& material, int priority = 0) {
        return add(
            trilens::make_primitive_surface({.center = center, .kind = trilens::SpherePrimitive{radius}}),
            material, priority);
    }
    template <class Body>
    Id add_body(Body body, const trilens::Material& material, int priority = 0) {
        return add(std::make_shared<Body>(std::move(body)), material, priority);
    }
    const trilens::Surface& surface(Id optic) const { return *surfaces_[optic]; }

    /// The ray's paths from the first optic that it meets; none where it meets none. `direction` any length.
    std::optional<trilens::FollowedPaths> follow(const Vec3& from, const Vec3& direction,
                                                 double least_weight = trilens::kLeastWeight) const {
        const auto first = trilens::next_optic(world, {{from, normalize(direction)}});
        if (!first) return std::nullopt;
        return trilens::follow_paths(world, {first->meeting, first->distance},
                                     {.objects = nullptr, .least_weight = least_weight});
    }

  private:
    std::deque<trilens::Material> materials_;
    std::deque<trilens::LimitTracer> tracers_;
    std::vector<std::shared_ptr<const trilens::PatchTree>> patches_;
    std::vector<std::shared_ptr<const trilens::Surface>> surfaces_;
};

/// The steps from the first optic to a segment.
inline std::vector<trilens::Step> steps_to(const std::vector<trilens::PathSegment>& segments, Id last) {
    std::vector<trilens::Step> steps;
    for (Id s = last; s != trilens::kNone; s = segments[s].parent)
        steps.insert(steps.begin(), segments[s].step);
    return steps;
}

/// The end with that history, in these colours; null where there is none.
inline const trilens::PathSegment* end_with(const trilens::FollowedPaths& paths,
                                            const std::vector<trilens::Step>& steps,
                                            trilens::Colours colours = trilens::kAllColours) {
    for (std::size_t i = 0; i < paths.segments.size(); ++i)
        if (paths.segments[i].ends && paths.segments[i].colours == colours &&
            steps_to(paths.segments, static_cast<Id>(i)) == steps)
            return &paths.segments[i];
    return nullptr;
}

/// A ray that goes through the optics one after the other, in by each front and out by each back.
inline std::vector<trilens::Step> through(const std::vector<Id>& optics) {
    std::vector<trilens::Step> steps;
    for (const Id optic : optics) steps.push_back({optic, trilens::Event::kTransmit});
    return steps;
}

}  // namespace trilens_test
