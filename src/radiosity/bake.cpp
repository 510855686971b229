#include "radiosity/bake.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "base/math/box.h"
#include "base/math/luminance.h"
#include "base/util/format.h"
#include "base/util/parallel.h"
#include "json/json.h"
#include "radiosity/bake_progress.h"
#include "radiosity/element_mesh.h"
#include "radiosity/form_factors.h"
#include "radiosity/patch_light.h"
#include "radiosity/solve.h"
#include "radiosity/vertex_light.h"
#include "render/world/world.h"
#include "scene/read/override.h"
#include "surfaces/memory_budget.h"

namespace trilens {
namespace {

constexpr int kMostPasses = 24;
constexpr double kBytesPerFactor = sizeof(Id) + sizeof(double);
/// Making form factors reciprocal holds both estimates, and what they are sorted in.
constexpr double kMatrixCopies = 4;
/// Rows that are kept while they are shot, as a share of the machine's memory.
constexpr double kKeptShare = 0.25;

void check_request(const BakeRequest& request) {
    const auto require = [](bool holds, const std::string& what) {
        if (!holds) throw UsageError(what);
    };
    const int n = request.hemicube_resolution;
    require(n >= 2 && n <= 1024 && n % 2 == 0,
            "a hemicube has an even number of pixels, 2..1024, to an edge");
    require(request.rays >= 1 && request.rays <= 10'000'000, "form factors take 1 to 1e7 rays");
    require(request.tolerance > 0 && request.tolerance < 1, "a bake's tolerance is above 0 and below 1");
    require(request.patch_size > 0 && request.patch_size <= 1, "patches are above 0 and at most 1 large");
    require(request.smallest_size > 0 && request.smallest_size <= request.patch_size,
            "the smallest elements are above 0 and at most as large as patches");
    require(request.contrast > 0 && std::isfinite(request.contrast), "a contrast is above 0");
}

/// What patches have come to.
struct PatchPass {
    PatchLight light;
    std::vector<double> area;  // per side of patches and of what stands between them
    RadiositySolution solution;
};

class Baker {
  public:
    Baker(const World& world, const BakeRequest& request, const Progress& progress)
        : world_(world), request_(request), clock_(progress), mesh_(world) {}

    Bake bake() {
        check();
        divide();
        const std::shared_ptr<const TriangleScene> triangles = mesh_.triangles();
        const FormFactors factors(triangles, params_of(request_.form_factors));
        clock_.measure(factors, size());
        clock_.begin_shadows();
        const DirectLight direct(world_, clock_.stage());
        const PatchPass patches = solve(direct, *triangles, factors);
        VertexLight light(mesh_, direct, {factors, patches.solution.radiosity});
        clock_.begin_corners();
        do {
            report_.vertices = light.vertices().size();
            light.update(clock_.stage());
        } while (report_.passes < kMostPasses && halve(patches, light));
        report_.coarse = count_of(too_coarse(patches, light, false));
        report_.vertices = light.vertices().size();
        clock_.begin_check();
        check_vertices(*triangles, light, patches.solution.radiosity);
        finish(patches, light);
        Bake bake{scene_with(light), std::move(report_)};
        clock_.finish();
        return bake;
    }

  private:
    void check() const;
    void divide();
    BakeSize size() const;
    PatchPass solve(const DirectLight& direct, const TriangleScene& triangles, const FormFactors& factors);
    void check_matrix_memory(std::size_t sides) const;
    std::vector<char> too_coarse(const PatchPass& patches, const VertexLight& light, bool skips_small) const;
    static std::size_t count_of(const std::vector<char>& marked) {
        return static_cast<std::size_t>(std::count(marked.begin(), marked.end(), 1));
    }
    bool halve(const PatchPass& patches, const VertexLight& light);
    void balance(const PatchPass& patches);
    void check_vertices(const TriangleScene& triangles, const VertexLight& light,
                        std::span<const Vec3> radiosity);
    void finish(const PatchPass& patches, const VertexLight& light);
    void warn();
    Scene scene_with(const VertexLight& vertices) const;
    std::string title() const { return scene_title(world_.scene); }
    double length_of(double share) const { return share * world_.shading.size; }
    FormFactorParams params_of(FormFactorMethod method) const {
        return {method, request_.hemicube_resolution, 1, request_.rays, length_of(kShadowOffset)};
    }

    const World& world_;
    const BakeRequest& request_;
    BakeProgress clock_;
    ElementMesh mesh_;
    BakeReport report_;
};

void Baker::check() const {
    check_request(request_);
    for (std::size_t m = 0; m < world_.scene.meshes.size(); ++m)
        if (!world_.scene.meshes[m].object.baked.empty())
            throw InputError(title(), "/meshes/" + std::to_string(m) + "/bakedLight",
                             "is light that is baked already: bake the scene that it was made of");
    if (mesh_.elements().empty())
        throw InputError(title(), "/meshes", "there is no object whose light could be baked");
}

/// Until no element is larger than asked.
void Baker::divide() {
    report_.triangles = mesh_.elements().size();
    while (true) {
        std::vector<char> large(mesh_.elements().size());
        for (std::size_t e = 0; e < large.size(); ++e)
            large[e] = mesh_.longest_edge(e) > length_of(request_.patch_size);
        const bool is_done = std::none_of(large.begin(), large.end(), [](char one) { return one; });
        const std::size_t count = is_done ? large.size() : mesh_.count_after(large);
        if (count > request_.most_elements)
            throw InputError(
                title(), "/meshes",
                fmt::format("{} patches and more are needed for patches of {} of the scene's size, "
                            "but {} elements are the most: take larger patches, or allow more",
                            count, request_.patch_size, request_.most_elements));
        if (is_done) break;
        mesh_.halve(large);
    }
    mesh_.name_patches();
    report_.patches = mesh_.elements().size();
}

BakeSize Baker::size() const {
    BakeSize size{report_.patches, VertexLight::count(mesh_), 0, request_.most_elements};
    for (std::size_t e = 0; e < size.patches; ++e)
        size.large += mesh_.longest_edge(e) > length_of(request_.smallest_size);
    return size;
}

namespace {

RadiosityProblem problem_of(const PatchLight& light, const std::vector<double>& area) {
    RadiosityProblem problem;
    problem.area = area;
    problem.reflectance.assign(area.size(), Vec3(0));
    problem.exitance.assign(area.size(), Vec3(0));
    for (std::size_t s = 0; s < light.sides.size(); ++s) {
        const PatchSide& side = light.sides[s];
        problem.reflectance[s] = side.reflectance;
        problem.exitance[s] = std::numbers::pi * (side.emission + side.reflectance * side.direct);
    }
    return problem;
}

}  // namespace

void Baker::check_matrix_memory(std::size_t sides) const {
    const double samples = 3.0 * request_.hemicube_resolution * request_.hemicube_resolution;
    const double per_row = std::min(
        static_cast<double>(sides) / 2,
        request_.form_factors == FormFactorMethod::kHemicube ? samples : static_cast<double>(request_.rays));
    check_memory({kMatrixCopies * kBytesPerFactor * per_row * static_cast<double>(sides),
                  "all form factors of " + std::to_string(mesh_.elements().size()) + " patches",
                  "take larger patches, or progressive refinement, which needs one row at a time"},
                 {machine_memory(), title()});
}

PatchPass Baker::solve(const DirectLight& direct, const TriangleScene& triangles,
                       const FormFactors& factors) {
    PatchPass patches;
    clock_.begin_patches();
    patches.light = patch_light(world_, direct, mesh_, clock_.stage());
    clock_.begin_exchange(kPointsPerSide * patches.light.sides.size());
    for (const double area : triangle_areas(triangles)) patches.area.insert(patches.area.end(), 2, area);
    const RadiosityProblem problem = problem_of(patches.light, patches.area);
    double power = 0;
    for (std::size_t s = 0; s < problem.area.size(); ++s)
        power += problem.area[s] * luminance(problem.exitance[s]);
    if (!(power > 0))
        throw InputError(title(), "/lights",
                         "nothing shines on the objects: there is neither a light that reaches them nor an "
                         "emissive material");
    const SolveParams params{request_.tolerance, SolveParams().most_steps};
    if (request_.solver == RadiositySolver::kProgressive) {
        BoundedCache<FormFactorRow> kept(factors.side_count(),
                                         {static_cast<std::size_t>(kKeptShare * machine_memory()), 0});
        const auto row = [&](Id side) {
            return kept.with(
                side, [&](std::size_t i) { return factors.row(static_cast<Id>(i)); },
                [](const FormFactorRow& made) { return made; });
        };
        patches.solution = shoot(problem, row, params, clock_.stage());
    } else {
        check_matrix_memory(factors.side_count());
        const FormFactorMatrix matrix = make_matrix(factors, clock_.stage());
        clock_.begin_gathering();
        patches.solution = gather(problem, made_reciprocal(matrix, patches.area), params, clock_.stage());
    }
    return patches;
}

/// Elements whose light changes by more than the contrast from corner to corner; `skips_small`: without
/// those that are small already.
std::vector<char> Baker::too_coarse(const PatchPass& patches, const VertexLight& light,
                                    bool skips_small) const {
    double sum = 0, areas = 0;
    for (std::size_t s = 0; s < patches.light.sides.size(); ++s) {
        const double arriving =
            luminance(patches.light.sides[s].direct + patches.solution.arriving[s] / std::numbers::pi);
        if (!(arriving > 0)) continue;
        sum += patches.area[s] * arriving;
        areas += patches.area[s];
    }
    const double most = areas > 0 ? request_.contrast * sum / areas : 0;
    std::vector<char> marked(mesh_.elements().size());
    for (Id side = 0; side < 2 * marked.size(); ++side) {
        const RadiosityElement& element = mesh_.elements()[side / 2];
        if (patches.light.sides[side_of(element.patch, side % 2 == 1)].reflectance == Vec3(0)) continue;
        double low = std::numeric_limits<double>::infinity(), high = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const LightAtVertex at = light.at(side, k);
            const double here = luminance(at.direct + at.indirect);
            low = std::min(low, here), high = std::max(high, here);
        }
        if (!(high - low > most)) continue;
        if (skips_small && mesh_.longest_edge(side / 2) <= length_of(request_.smallest_size)) continue;
        marked[side / 2] = 1;
    }
    return marked;
}

bool Baker::halve(const PatchPass& patches, const VertexLight& light) {
    const std::vector<char> marked = too_coarse(patches, light, true);
    HalvingPass pass{marked.size(), mesh_.count_after(marked), 1};
    if (count_of(marked) == 0 || pass.after > request_.most_elements) return false;
    pass.length = mesh_.longest_edge(marked) / length_of(request_.smallest_size);
    clock_.begin_pass(pass, light.vertices().size(), light.vertices().size() - report_.vertices);
    mesh_.halve(marked);
    ++report_.passes;
    return true;
}

void Baker::balance(const PatchPass& patches) {
    RadiosityBalance& balance = report_.balance;
    balance.escaped = patches.solution.escaped;
    balance.unshot = patches.solution.unshot;
    for (std::size_t s = 0; s < patches.area.size(); ++s) {
        const Vec3 arriving = patches.area[s] * patches.solution.arriving[s];
        if (s >= patches.light.sides.size()) {
            balance.blocked += arriving;
            continue;
        }
        const PatchSide& side = patches.light.sides[s];
        const double power = std::numbers::pi * patches.area[s];
        balance.emitted += power * side.emission;
        balance.from_lights += power * side.direct;
        balance.absorbed += (Vec3(1) - side.reflectance) * (arriving + power * side.direct);
    }
}

/// Some vertices by the way that the bake did not go, evenly over those that light comes to.
void Baker::check_vertices(const TriangleScene& triangles, const VertexLight& light,
                           std::span<const Vec3> radiosity) {
    std::vector<std::size_t> lit;
    for (std::size_t v = 0; v < light.vertices().size(); ++v)
        if (luminance(light.light()[v].indirect) > 0) lit.push_back(v);
    const std::size_t count = std::min(request_.checked_vertices, lit.size());
    if (count == 0) return;
    const bool is_drawn = request_.form_factors == FormFactorMethod::kHemicube;
    const std::shared_ptr<const TriangleScene> in_place(std::shared_ptr<void>(), &triangles);
    const FormFactors other(in_place,
                            params_of(is_drawn ? FormFactorMethod::kRays : FormFactorMethod::kHemicube));
    std::vector<double> difference(count);
    parallel_for(count, 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            const std::size_t v = lit[i * lit.size() / count];
            const double here = std::numbers::pi * luminance(light.light()[v].indirect);
            const double there = luminance(other.irradiance_at(light.vertices()[v].place, radiosity));
            difference[i] = std::fabs(here - there) / std::max(here, there);
        }
    });
    report_.check.vertices = count;
    for (const double one : difference) {
        report_.check.mean += one / static_cast<double>(count);
        report_.check.most = std::max(report_.check.most, one);
    }
}

void Baker::finish(const PatchPass& patches, const VertexLight& light) {
    for (const LightAtVertex& at : light.light()) {
        const Vec3 sum = at.direct + at.indirect;
        if (!std::isfinite(sum.x + sum.y + sum.z)) throw ComputationError("the baked light is not finite");
    }
    report_.elements = mesh_.elements().size();
    report_.convergence = patches.solution.steps;
    for (std::size_t e = 0; e < report_.patches; ++e) report_.flat += !(patches.area[2 * e] > 0);
    balance(patches);
    warn();
    const auto say = [&](std::size_t count, const std::string& what) {
        if (count > 0) report_.warnings.push_back(std::to_string(count) + " " + what);
    };
    say(patches.light.glossy, "patches are of materials that are not matt: only their matt part is baked");
    say(patches.light.too_white, fmt::format("patches reflect more than {} of the light: they are taken to "
                                             "reflect that much",
                                             kMostReflectance));
    say(report_.flat, "patches have no area, and take no part");
    say(report_.coarse,
        "elements are coarser than the contrast asks: the smallest size or the greatest "
        "number of elements is reached");
    if (!patches.solution.converged)
        report_.warnings.push_back("the light has not come to rest after all its steps");
}

void Baker::warn() {
    const Scene& scene = world_.scene;
    std::size_t mirrors = 0, glasses = 0;
    for (const Optic& optic : world_.optics) (optic.mirror ? mirrors : glasses)++;
    if (mirrors > 0)
        report_.warnings.push_back(std::to_string(mirrors) +
                                   " mirrors stop the light between objects: what they reflect is left out");
    if (glasses > 0)
        report_.warnings.push_back(std::to_string(glasses) +
                                   " bodies of glass let the light between objects through, unbent and "
                                   "undimmed");
    const std::size_t blended =
        std::count_if(scene.meshes.begin(), scene.meshes.end(), [&](const Mesh& mesh) {
            return std::any_of(mesh.object.material.begin(), mesh.object.material.end(), [&](Id material) {
                return scene.materials[material].alpha_mode == AlphaMode::kBlend;
            });
        });
    if (blended > 0)
        report_.warnings.push_back(std::to_string(blended) +
                                   " objects blend with what is behind them: they get no light from others "
                                   "and stop none");
    if (!scene.volumes.empty()) report_.warnings.push_back("volumes are left out");
    for (std::size_t l = 0; l < scene.lights.size(); ++l)
        if (!is_hindered(scene.lights[l]) && !scene.lights[l].baked)
            report_.warnings.push_back("light " + std::to_string(l) +
                                       " has no shadows: it shines through objects here, too");
}

Scene Baker::scene_with(const VertexLight& vertices) const {
    Scene scene = world_.scene;
    std::vector<std::vector<BakedLight>> light(scene.meshes.size());
    for (Id m = 0; m < scene.meshes.size(); ++m) light[m].resize(mesh_.triangle_count(m));
    for (Id e = 0; e < mesh_.elements().size(); ++e) {
        BakedLight both;
        for (const bool is_back : {false, true}) {
            const Id side = side_of(e, is_back);
            for (std::size_t k = 0; k < 3; ++k) {
                const LightAtVertex at = vertices.at(side, k);
                Vec3& corner = (is_back ? both.back : both.front)[k];
                corner = request_.keeps_lights ? at.indirect : at.direct + at.indirect;
            }
        }
        light[mesh_.elements()[e].mesh][mesh_.elements()[e].number] = rounded(both);
    }
    std::vector<char> is_lit(scene.meshes.size());
    for (const RadiosityElement& element : mesh_.elements()) is_lit[element.mesh] = 1;
    Json json = scene.resolved.empty() ? Json() : resolved_json(scene);
    for (Id m = 0; m < scene.meshes.size(); ++m) {
        if (!is_lit[m]) continue;
        ObjectMesh& object = scene.meshes[m].object;
        const BakedLightRecord record{object.triangles.size(), weighted_corners(object), mesh_.splits(m),
                                      std::move(light[m])};
        if (!scene.resolved.empty()) json["meshes"][m]["bakedLight"] = baked_light_json(record);
        TriangleSplitter splitter(object);
        for (const TriangleSplit& split : record.splits) splitter.split(split);
        object.baked = record.light;
    }
    for (std::size_t l = 0; l < scene.lights.size() && !request_.keeps_lights; ++l) {
        scene.lights[l].baked = true;
        if (!scene.resolved.empty()) json["lights"][l]["baked"] = true;
    }
    if (!scene.resolved.empty()) scene.resolved = json.dump();
    return scene;
}

}  // namespace

Bake bake_light(const World& world, const BakeRequest& request, const Progress& progress) {
    return Baker(world, request, progress).bake();
}

}  // namespace trilens
