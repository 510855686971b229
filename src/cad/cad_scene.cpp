#include "cad/cad_scene.h"

#include <fnmatch.h>
#include <trilens/error.h>
#include <trilens/scene.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "terminal/libraries.h"

namespace trilens {
namespace {

enum class CadRole { kObject, kMirror, kGlass };

bool fits(const std::string& name, const std::vector<std::string>& patterns) {
    return std::any_of(patterns.begin(), patterns.end(), [&](const std::string& pattern) {
        return pattern == name || fnmatch(pattern.c_str(), name.c_str(), FNM_NOESCAPE) == 0;
    });
}

Json json_of(const Vec3& v) {
    return {v.x, v.y, v.z};
}

Json json_of(const std::vector<Vec3>& points) {
    Json list = Json::array();
    for (const Vec3& point : points) list.push_back(json_of(point));
    return list;
}

struct Bounds {
    Vec3 low{INFINITY}, high{-INFINITY};
    void include(const std::vector<CadBody>& bodies) {
        for (const CadBody& body : bodies)
            for (const CadFace& face : body.faces)
                for (const Vec3& point : face.points)
                    low = glm::min(low, point), high = glm::max(high, point);
    }
    Vec3 middle() const { return 0.5 * (low + high); }
    double size() const { return length(high - low); }
};

class SceneOfCad {
  public:
    SceneOfCad(const CadModel& model, const CadOptions& options) : options_(options) {
        const std::vector<CadBody>& bodies = model.bodies;
        for (const std::string& warning : model.warnings)
            made_.warnings.push_back(options.file + ": " + warning);
        check_patterns(bodies);
        for (const CadBody& body : bodies) add(body);
        finish(bodies);
    }

    CadScene take() { return std::move(made_); }

  private:
    void check_patterns(const std::vector<CadBody>& bodies) const {
        for (const auto* list : {&options_.mirrors, &options_.glass})
            for (const std::string& pattern : *list)
                if (std::none_of(bodies.begin(), bodies.end(),
                                 [&](const CadBody& body) { return fits(body.name, {pattern}); }))
                    throw InputError(options_.file, "",
                                     "has no body \"" + pattern + "\"; it has " + names(bodies));
    }

    static std::string names(const std::vector<CadBody>& bodies) {
        constexpr std::size_t kMost = 10;
        std::string text;
        for (std::size_t i = 0; i < std::min(bodies.size(), kMost); ++i)
            text += (i > 0 ? ", \"" : "\"") + bodies[i].name + "\"";
        return bodies.size() > kMost ? fmt::format("{} and {} more", text, bodies.size() - kMost) : text;
    }

    CadRole role_of(const CadBody& body) const {
        if (options_.mirrors.empty() && options_.glass.empty()) return CadRole::kMirror;
        const bool mirror = fits(body.name, options_.mirrors), glass = fits(body.name, options_.glass);
        if (mirror && glass) throw InputError(options_.file, body.name, "is to be a mirror and glass");
        return mirror ? CadRole::kMirror : glass ? CadRole::kGlass : CadRole::kObject;
    }

    std::string new_name(const std::string& wanted) {
        std::string name = wanted;
        for (int i = 2; !names_.insert(name).second; ++i) name = fmt::format("{} ({})", wanted, i);
        return name;
    }

    void add(const CadBody& body) {
        const CadRole role = role_of(body);
        const std::string name = new_name(body.name);
        if (role == CadRole::kObject) {
            add_object(name, body);
            return;
        }
        if (role == CadRole::kGlass && !body.is_solid)
            throw InputError(options_.file, body.name, "is no solid, which glass must be");
        ++(role == CadRole::kGlass ? made_.glass : made_.mirrors);
        Json patches = Json::array();
        for (std::size_t i = 0; i < body.faces.size(); ++i) {
            const CadFace& face = body.faces[i];
            if (!face.fault.empty())
                throw InputError(options_.file, body.name, fmt::format("face {}: {}", i + 1, face.fault));
            if (face.covered < 1)
                made_.warnings.push_back(fmt::format(
                    "{}: {}: face {} is trimmed to {:.3g} % of its surface, all of which is shown",
                    options_.file, body.name, i + 1, 100 * face.covered));
            for (const CadSurface& surface : face.surfaces) patches.push_back(patch_of(surface, body, i));
        }
        made_.patches += patches.size();
        meshes_.push_back({{"name", name},
                           {"role", "optic"},
                           {"material", role == CadRole::kGlass ? "glass" : "mirror"},
                           {"patches", std::move(patches)}});
    }

    Json patch_of(const CadSurface& surface, const CadBody& body, std::size_t face) const {
        if (std::max(surface.degree[0], surface.degree[1]) > kHighestPatchDegree)
            throw InputError(
                options_.file, body.name,
                fmt::format("face {} has degree {}: patches have {} at most", face + 1,
                            std::max(surface.degree[0], surface.degree[1]), kHighestPatchDegree));
        return {{"type", "nurbs"},
                {"columns", surface.columns},
                {"degree", surface.degree},
                {"points", json_of(surface.points)},
                {"weights", surface.weights},
                {"knots", surface.knots}};
    }

    void add_object(const std::string& name, const CadBody& body) {
        ++made_.objects;
        Json indices = Json::array();
        std::vector<Vec3> points;
        for (const CadFace& face : body.faces) {
            const std::size_t first = points.size();
            points.insert(points.end(), face.points.begin(), face.points.end());
            for (const std::array<int, 3>& triangle : face.triangles)
                for (const int corner : triangle) indices.push_back(first + static_cast<std::size_t>(corner));
        }
        const std::vector<int> counts(indices.size() / 3, 3);
        meshes_.push_back({{"name", name},
                           {"role", "object"},
                           {"material", "paint"},
                           {"points", json_of(points)},
                           {"shading", "smooth"},  // faces have their points for themselves
                           {"faceVertexCounts", counts},
                           {"faceVertexIndices", std::move(indices)}});
    }

    /// Those that are used.
    Json materials() const {
        Json used = Json::array();
        if (made_.mirrors > 0)
            used.push_back(
                {{"name", "mirror"}, {"baseColorFactor", {0.95, 0.95, 0.95}}, {"metallicFactor", 1}});
        if (made_.glass > 0)
            used.push_back({{"name", "glass"}, {"transmissionFactor", 1}, {"ior", options_.ior}});
        if (made_.objects > 0) used.push_back({{"name", "paint"}, {"baseColorFactor", {0.6, 0.6, 0.62}}});
        used.push_back({{"name", "chequers"},
                        {"baseColorTexture",
                         {{"pattern", "checker"},
                          {"count", {24, 24}},
                          {"colors", {{0.75, 0.73, 0.68}, {0.3, 0.34, 0.4}}}}}});
        return used;
    }

    /// Camera, floor and light around all of it.
    void finish(const std::vector<CadBody>& bodies) {
        Bounds bounds;
        bounds.include(bodies);
        constexpr double kYfov = 35, kRadians = 3.14159265358979323846 / 180;
        const double size = bounds.size(), far = 0.6 * size / std::sin(0.5 * kYfov * kRadians);
        const Vec3 at = bounds.middle(), eye = at + far * normalize(Vec3(0.55, -1, 0.5));
        const double floor = bounds.low.z - 0.02 * size, half = 4 * size;
        const std::vector<Vec3> corners{{at.x - half, at.y - half, floor},
                                        {at.x + half, at.y - half, floor},
                                        {at.x + half, at.y + half, floor},
                                        {at.x - half, at.y + half, floor}};
        meshes_.push_back({{"name", new_name("floor")},
                           {"role", "object"},
                           {"material", "chequers"},
                           {"points", json_of(corners)},
                           {"uvs", {{0, 0}, {1, 0}, {1, 1}, {0, 1}}},
                           {"faceVertexCounts", {4}},
                           {"faceVertexIndices", {0, 1, 2, 3}}});
        const Json scene{{"version", 1},
                         {"film", {{"width", 960}, {"height", 540}, {"spp", 4}}},
                         {"cameras",
                          {{{"name", "whole"},
                            {"yfov", kYfov},
                            {"lookAt", {{"eye", json_of(eye)}, {"at", json_of(at)}, {"up", {0, 0, 1}}}}}}},
                         {"background", {{"color", {0.45, 0.55, 0.7}}}},
                         {"materials", materials()},
                         {"meshes", std::move(meshes_)},
                         {"lights",
                          {{{"type", "directional"},
                            {"direction", {-0.4, 0.5, -1}},
                            {"intensity", 2.2},
                            {"angle", 2},
                            {"samples", 9},
                            {"shadows", true}},
                           {{"type", "ambient"}, {"intensity", 0.5}}}}};
        made_.text = scene.dump(1) + "\n";
    }

    const CadOptions& options_;
    CadScene made_;
    Json meshes_ = Json::array();
    std::set<std::string> names_;
};

}  // namespace

CadScene scene_of_cad(const CadModel& model, const CadOptions& options) {
    return SceneOfCad(model, options).take();
}

}  // namespace trilens
