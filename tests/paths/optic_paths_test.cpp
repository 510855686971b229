// The RayMeshes of an optic's paths: parts that cover a facet once, rays that are those of the exact paths,
// and flat mirrors that stay exact.
#include "paths/facets/optic_paths.h"

#include <algorithm>
#include <map>

#include "intersect/random_scene.h"
#include "paths/bodies.h"
#include "paths/stage.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// A camera at `eye` that looks to -z, or parallel to it; 400 pixels to a unit at distance 1, the film's
/// middle straight ahead.
PathCamera camera_at(const Vec3& eye, bool parallel = false) {
    PathCamera camera;
    camera.film = Vec2(10000);
    camera.parallel = parallel;
    camera.screen = [=](const Vec3& p) {
        const double w = parallel ? 1 : eye.z - p.z;
        return Vec3(400 * (p.x - eye.x) + 5000 * w, 400 * (eye.y - p.y) + 5000 * w, w);
    };
    camera.ray = [=](const Vec3&, const Vec3& chord) {
        const Vec3 direction = parallel ? Vec3(0, 0, -1) : chord - eye;
        return Ray{chord - direction, direction};
    };
    return camera;
}

/// The exact paths of the camera's ray to a point of an optic; none where it does not see the point.
std::optional<FollowedPaths> exact_paths(const Stage& stage, Id optic, const PathCamera& camera,
                                         const Vec3& chord) {
    const Ray ray = camera.ray({}, chord);
    const Ray unit{ray.origin, normalize(ray.direction)};
    const auto first = next_optic(stage.world, {unit});
    if (!first || first->meeting.optic != optic || length(first->meeting.point - chord) > 1e-6)
        return std::nullopt;
    return follow_paths(stage.world, {first->meeting, first->distance},
                        {.objects = nullptr, .least_weight = 1e-3 * kLeastWeight});
}

std::vector<Id> all_facets(const OpticPaths& paths) {
    std::vector<Id> all(paths.outline.facets.size());
    for (std::size_t f = 0; f < all.size(); ++f) all[f] = static_cast<Id>(f);
    return all;
}

std::vector<Step> steps_of(const OpticPaths& paths, Id node) {
    std::vector<Step> steps;
    for (Id n = node; n != kNone; n = paths.nodes[n].parent) steps.insert(steps.begin(), paths.nodes[n].step);
    return steps;
}

Vec3 random_weights(Random& random) {
    double a = random.uniform(0, 1), b = random.uniform(0, 1);
    if (a + b > 1) a = 1 - a, b = 1 - b;
    return {1 - a - b, a, b};
}

/// The screen position and the world point of a facet for these weights of its corners.
struct OnFacet {
    Vec3 screen{0}, chord{0};
};
OnFacet on_facet(const OpticPaths& paths, const SurfaceGrid& grid, Id facet, const Vec3& weights) {
    OnFacet at;
    for (int k = 0; k < 3; ++k) {
        const Id corner = grid.facets[facet][static_cast<std::size_t>(k)];
        at.screen += weights[k] * paths.outline.screen[corner];
        at.chord += weights[k] * grid.points[grid.corner_point[corner]];
    }
    return at;
}

/// Rays of a facet at some places: by history and colour, all of them.
using RaysAt = std::map<std::tuple<std::string, int, bool>, std::array<double, 8>>;
RaysAt rays_at(const OpticPaths& paths, const SurfaceGrid& grid, Id facet, const Vec3& weights) {
    RaysAt rays;
    const Id leaf = leaf_at(paths, facet, weights);
    const Vec3 s = on_facet(paths, grid, facet, weights).screen;
    for (std::size_t n = 0; n < paths.nodes.size(); ++n) {
        const PathNode& node = paths.nodes[n];
        const Id own = node.facet_of(leaf);
        if (own == kNone) continue;
        std::string history;
        for (const Step& step : steps_of(paths, static_cast<Id>(n)))
            history += std::to_string(step.optic) + event_name(step.event) + " ";
        const FacetWeights of_node = facet_weights(node.mesh, own);
        const Ray ray = sample_ray(node.mesh, own, of_node, {s.x / s.z, s.y / s.z});
        const bool added =
            rays.insert({{history, node.colours, node.medium != kNone},
                         {ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y,
                          ray.direction.z, static_cast<double>(node.ends[own]),
                          static_cast<double>(paths.leaves[leaf].level)}})
                .second;
        CHECK(added);
    }
    return rays;
}

/// A glass ball, a mirror ball beside it and a mirror behind: facets of every kind.
void put_up(Stage& stage) {
    stage.add_ball({0, 0, 0}, 1, glass_of(1.5));
    stage.add_ball({1.9, 0.2, 0.1}, 0.8, mirror_of());
    stage.add_body(make_box({-4, -4, -5}, {4, 4, -4}), mirror_of({0.9, 0.8, 0.7}));
}

Primitive plane_at(const Vec3& center, const Vec3& axis, const Vec3& tangent) {
    return {center, normalize(axis), normalize(tangent), PlanePrimitive{{6, 6}}};
}

/// The images of `eye` in the mirrors of a node's history, the last mirror's last.
Vec3 virtual_eye(Vec3 eye, const std::vector<Step>& steps, const std::vector<Primitive>& planes) {
    for (const Step& step : steps) {
        const Primitive& plane = planes[step.optic];
        eye -= 2 * dot(eye - plane.center, plane.axis) * plane.axis;
    }
    return eye;
}

/// Flat mirrors that see one another: every projected ray is the exact one.
void check_flat_mirrors(const std::vector<Primitive>& planes, const Vec3& eye, bool parallel,
                        int least_steps) {
    Stage stage;
    for (const Primitive& plane : planes) stage.add(make_primitive_surface(plane), mirror_of());
    const SurfaceGrid grid = make_grid(stage.surface(0), 3);
    const PathCamera camera = camera_at(eye, parallel);
    PathBuilder builder = paths_over_grid({&stage.world, 0, &stage.surface(0), camera}, grid, DivideParams{});
    const OpticPaths& paths = builder.paths();
    builder.prepare(all_facets(paths));

    std::size_t most_steps = 0, rays = 0;
    for (std::size_t n = 0; n < paths.nodes.size() && !parallel; ++n) {
        const PathNode& node = paths.nodes[n];
        const std::vector<Step> steps = steps_of(paths, static_cast<Id>(n));
        const Vec3 image = virtual_eye(eye, steps, planes);
        CHECK(node.unfolds);
        for (const Ray& ray : node.mesh.rays) CHECK(length(ray.origin - ray.direction - image) < 1e-10);
        most_steps = std::max(most_steps, steps.size());
    }
    // Between the corners too: origin on the last mirror, direction from the virtual eye.
    Random random(51);
    for (Id f = 0; f < grid.facets.size(); ++f)
        for (int i = 0; i < 30; ++i) {
            const Vec3 weights = random_weights(random);
            const OnFacet at = on_facet(paths, grid, f, weights);
            const auto exact = exact_paths(stage, 0, camera, at.chord);
            const Id leaf = leaf_at(paths, f, weights);
            if (!exact || paths.leaves[leaf].method != LeafMethod::kProjected) continue;
            for (std::size_t n = 0; n < paths.nodes.size(); ++n) {
                const PathNode& node = paths.nodes[n];
                const Id own = node.facet_of(leaf);
                if (own == kNone) continue;
                const std::vector<Step> steps = steps_of(paths, static_cast<Id>(n));
                const auto same =
                    std::find_if(exact->segments.begin(), exact->segments.end(), [&](const auto& one) {
                        return steps_to(exact->segments, static_cast<Id>(&one - exact->segments.data())) ==
                               steps;
                    });
                if (same == exact->segments.end()) continue;  // where the part's corners did not tell
                const Ray ray = sample_ray(node.mesh, own, facet_weights(node.mesh, own),
                                           {at.screen.x / at.screen.z, at.screen.y / at.screen.z});
                CHECK(length(ray.origin - same->ray.origin) < 1e-9);
                CHECK(length(normalize(ray.direction) - same->ray.direction) < 1e-10);
                most_steps = std::max(most_steps, steps.size());
                ++rays;
            }
        }
    CHECK(most_steps >= static_cast<std::size_t>(least_steps));
    CHECK(rays > 100);
}

}  // namespace

TEST_CASE("the parts of a facet cover it once, each where leaf_at says", "[paths][law]") {
    Stage stage;
    put_up(stage);
    const SurfaceGrid grid = make_grid(stage.surface(0), 4);
    PathBuilder builder =
        paths_over_grid({&stage.world, 0, &stage.surface(0), camera_at({0.3, 0.2, 5})}, grid, DivideParams{});
    const OpticPaths& paths = builder.paths();
    builder.prepare(all_facets(paths));

    Random random(52);
    std::vector<double> hits(paths.leaves.size(), 0);
    std::size_t projected = 0, traced = 0, divided = 0;
    for (Id f = 0; f < grid.facets.size(); ++f)
        for (int i = 0; i < 200; ++i) {
            const Vec3 weights = random_weights(random);
            const Id l = leaf_at(paths, f, weights);
            REQUIRE(l < paths.leaves.size());
            const PathLeaf& leaf = paths.leaves[l];
            CHECK(leaf.facet == f);
            CHECK((leaf.level == 0) == paths.is_whole(f));
            const Vec3& corner = grid.points[grid.corner_point[grid.facets[f][0]]];
            if (dot(Vec3(0.3, 0.2, 5) - corner, corner) > 0)  // the sphere's normal; others turn away
                (leaf.method == LeafMethod::kTraced ? traced : projected) += 1;
            divided += leaf.level > 0;
            // Every mesh of the leaf has the place inside of its facet on the screen.
            const Vec3 s = on_facet(paths, grid, f, weights).screen;
            for (const PathNode& node : paths.nodes) {
                const Id own = node.facet_of(l);
                if (own == kNone) continue;
                const FacetWeights of_node = facet_weights(node.mesh, own);
                if (of_node.edge_on) continue;
                const Vec3 e = of_node.unnormalised(s.x / s.z, s.y / s.z);
                const double sum = e.x + e.y + e.z;
                for (int k = 0; k < 3; ++k) CHECK(e[k] / sum > -1e-6);
            }
        }
    CHECK(projected > traced);
    CHECK(traced > 0);
    CHECK(divided > 0);
    // Corners and edges belong to some part too.
    for (const Vec3& weights :
         {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(0.5, 0.5, 0), Vec3(0, 0.25, 0.75)})
        for (Id f = 0; f < grid.facets.size(); ++f)
            CHECK(paths.leaves[leaf_at(paths, f, weights)].facet == f);
}

TEST_CASE("a facet's rays do not depend on what was asked for before", "[paths][law]") {
    Stage stage;
    put_up(stage);
    const SurfaceGrid grid = make_grid(stage.surface(0), 3);
    const ProbeContext context{&stage.world, 0, &stage.surface(0), camera_at({0.3, 0.2, 5})};
    DivideParams params;
    params.per_pixel = GENERATE(0.0, 2e-4, 1e-2);  // all are looked into; the large ones; all but parts
    PathBuilder first = paths_over_grid(context, grid, params),
                second = paths_over_grid(context, grid, params);
    const OpticPaths &at_once = first.paths(), &one_by_one = second.paths();
    std::vector<Id> facets = all_facets(at_once);
    first.prepare(facets);
    std::reverse(facets.begin(), facets.end());
    for (const Id f : facets) second.prepare(std::vector<Id>{f, f});
    second.prepare(facets);  // known already

    CHECK(at_once.probe_report.plan.decides() == (params.per_pixel > 0));
    CHECK(at_once.probe_report.surveyed == one_by_one.probe_report.surveyed);
    if (params.per_pixel > 0)
        CHECK(at_once.probe_report.plan.least_samples() == one_by_one.probe_report.plan.least_samples());
    Random random(53);
    CHECK(at_once.leaves.size() == one_by_one.leaves.size());
    CHECK(at_once.nodes.size() == one_by_one.nodes.size());
    std::vector<std::vector<Step>> order_a, order_b;
    for (const Id n : nodes_in_order(at_once)) order_a.push_back(steps_of(at_once, n));
    for (const Id n : nodes_in_order(one_by_one)) order_b.push_back(steps_of(one_by_one, n));
    CHECK(order_a == order_b);
    for (const Id f : facets)
        for (int i = 0; i < 20; ++i) {
            const Vec3 weights = random_weights(random);
            CHECK(rays_at(at_once, grid, f, weights) == rays_at(one_by_one, grid, f, weights));
        }
}

TEST_CASE("facets whose paths there is no room for are traced, the same ones whatever is asked for first",
          "[paths][law]") {
    Stage stage;
    put_up(stage);
    const SurfaceGrid grid = make_grid(stage.surface(0), 6);
    const ProbeContext context{&stage.world, 0, &stage.surface(0), camera_at({0.3, 0.2, 5})};
    DivideParams tight;
    tight.most_bytes = 1u << 18;
    PathBuilder wide = paths_over_grid(context, grid, DivideParams{}),
                first = paths_over_grid(context, grid, tight), second = paths_over_grid(context, grid, tight);
    const OpticPaths &roomy = wide.paths(), &at_once = first.paths(), &one_by_one = second.paths();
    std::vector<Id> facets = all_facets(at_once);
    wide.prepare(facets);
    first.prepare(facets);
    std::reverse(facets.begin(), facets.end());
    for (const Id f : facets) second.prepare(std::vector<Id>{f});
    CHECK(roomy.crowded_out == 0);
    CHECK(at_once.crowded_out > facets.size() / 10);
    CHECK(at_once.crowded_out < facets.size());
    CHECK(one_by_one.crowded_out == at_once.crowded_out);

    Random random(54);
    std::size_t traced = 0;
    for (const Id f : facets) {
        const Vec3 weights = random_weights(random);
        const bool is_traced =
            at_once.is_whole(f) &&
            at_once.leaves[leaf_at(at_once, f, Vec3(1.0 / 3))].method == LeafMethod::kTraced;
        traced += is_traced;
        CHECK(rays_at(at_once, grid, f, weights) == rays_at(one_by_one, grid, f, weights));
        if (!is_traced) CHECK(rays_at(at_once, grid, f, weights) == rays_at(roomy, grid, f, weights));
    }
    CHECK(traced >= at_once.crowded_out);
}

TEST_CASE("a corner's ray is the exact path's, as long as the eye's ray times ray_scale", "[paths]") {
    Stage stage;
    put_up(stage);
    const Vec3 eye(0.3, 0.2, 5);
    const PathCamera camera = camera_at(eye);
    const SurfaceGrid grid = make_grid(stage.surface(0), 4);
    PathBuilder builder = paths_over_grid({&stage.world, 0, &stage.surface(0), camera}, grid, DivideParams{});
    const OpticPaths& paths = builder.paths();
    builder.prepare(all_facets(paths));
    std::size_t compared = 0;
    for (Id f = 0; f < grid.facets.size(); ++f) {
        if (!paths.is_whole(f)) continue;
        const Id leaf = leaf_at(paths, f, Vec3(1.0 / 3));
        for (std::size_t n = 0; n < paths.nodes.size(); ++n) {
            const PathNode& node = paths.nodes[n];
            const Id own = node.facet_of(leaf);
            if (own == kNone) continue;
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3& point = grid.points[grid.corner_point[grid.facets[f][k]]];
                const auto exact = exact_paths(stage, 0, camera, point);
                if (!exact) continue;  // on the far side
                for (std::size_t s = 0; s < exact->segments.size(); ++s) {
                    if (steps_to(exact->segments, static_cast<Id>(s)) != steps_of(paths, static_cast<Id>(n)))
                        continue;
                    const Ray& ray = node.mesh.rays[node.mesh.facets[own][k]];
                    CHECK(length(ray.origin - exact->segments[s].ray.origin) < 1e-8);
                    CHECK(length(normalize(ray.direction) - exact->segments[s].ray.direction) < 1e-8);
                    ++compared;
                }
            }
        }
    }
    CHECK(compared > 100);
}

TEST_CASE("flat plates and flat mirrors have ray_scale 1", "[paths]") {
    Random random(54);
    Stage stage;
    const Primitive mirror = plane_at({0, 0, 2}, {0.2, 0.1, 1}, {1, 0, -0.2});
    const Id flat = stage.add(make_primitive_surface(mirror), mirror_of());
    const Id plate = stage.add_body(make_box({-3, -3, -1}, {3, 3, 0}), glass_of(1.5));
    const Vec3 eye(0.2, 0.4, 1.5);
    std::size_t seen = 0;
    for (int i = 0; i < 100; ++i) {
        const ProbeContext context{&stage.world, plate, &stage.surface(plate), camera_at(eye)};
        Place place{0, {random.uniform(0, 1), random.uniform(0, 1)}};  // the side at z = 0
        const SurfacePoint at = stage.surface(plate).eval(place.face, place.uv);
        place.point = at.position;
        place.normal = at.normal;
        PathProbe probe = probe_point(context, place, {});
        REQUIRE(probe.state == ProbeState::kSeen);
        set_ray_scale(context, probe);
        for (std::size_t s = 0; s < probe.segments.size(); ++s) {
            if (!probe.segments[s].ends || probe.ray_scale[s] == 0) continue;
            const std::vector<Step> steps = steps_to(probe.segments, static_cast<Id>(s));
            // In glass the bundle is narrower; all that left it has the ray scale 1 again.
            if (probe.segments[s].medium != kNone) continue;
            // The sides of the plate are no part of a flat plate.
            if (steps.size() > 4) continue;
            INFO("steps " << steps.size() << ", eye " << length(probe.incident));
            CHECK(probe.ray_scale[s] == Approx(1).margin(2e-3));
            ++seen;
        }
    }
    CHECK(seen > 100);
    (void)flat;
}

TEST_CASE("two flat mirrors are exact: every ray comes from the eye's image in both", "[paths][law]") {
    const std::vector<Primitive> planes{plane_at({0, 0, 0}, {0.3, 0, 1}, {1, 0, -0.3}),
                                        plane_at({2, 0, 1}, {-1, 0.1, 0.4}, {0.4, 0, 1})};
    check_flat_mirrors(planes, {-0.5, 0.3, 4}, false, 2);
    check_flat_mirrors(planes, {-0.5, 0.3, 4}, true, 2);
}

TEST_CASE("three flat mirrors in a corner are exact", "[paths]") {
    const std::vector<Primitive> planes{plane_at({0, 0, 0}, {0, 0, 1}, {1, 0, 0}),
                                        plane_at({3, 0, 3}, {-1, 0, 0}, {0, 0, 1}),
                                        plane_at({0, -3, 3}, {0, 1, 0}, {1, 0, 0})};
    check_flat_mirrors(planes, {-2, 1.7, 5}, false, 3);
}

TEST_CASE("what is left at the smallest size is traced, what is whole is not divided", "[paths]") {
    Stage stage;
    put_up(stage);
    const SurfaceGrid grid = make_grid(stage.surface(0), 4);
    for (const double least_area : {8.0, 200.0, 1e9}) {
        PathBuilder builder = paths_over_grid({&stage.world, 0, &stage.surface(0), camera_at({0.3, 0.2, 5})},
                                              grid, DivideParams{least_area, 6});
        const OpticPaths& paths = builder.paths();
        builder.prepare(all_facets(paths));
        for (const PathLeaf& leaf : paths.leaves) {
            CHECK(leaf.level <= 6);
            if (least_area == 1e9) CHECK(leaf.level == 0);
        }
    }
}
