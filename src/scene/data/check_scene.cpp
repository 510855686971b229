#include "scene/data/check_scene.h"

#include <cmath>
#include <string>

#include "base/raymesh/sample_grid.h"
#include "base/util/error.h"

namespace trilens {
static_assert(kLargestCoordinate == kLargestNumber);
namespace {

bool is_finite(double x) {
    return std::isfinite(x);
}
bool is_finite(const Vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

class SceneCheck {
  public:
    explicit SceneCheck(const Scene& scene) : scene_(scene) {}

    void film() const {
        const Film& film = scene_.film;
        require(film.width > 0 && film.height > 0, "/film", "has no pixels");
        require(static_cast<long long>(film.width) * film.height <= kMostPixels, "/film",
                "has too many pixels");
        require(film.spp >= 1 && film.spp <= kMaxSpp, "/film/spp", "is not in 1..64");
    }
    void cameras() const;
    void materials() const;
    void lights() const;
    void meshes() const;
    void volumes() const;
    void marks() const;

  private:
    [[noreturn]] void fail(const std::string& place, const std::string& message) const {
        throw InputError(scene_title(scene_), place, message);
    }
    void require(bool holds, const std::string& place, const std::string& message) const {
        if (!holds) fail(place, message);
    }
    template <typename T>
    void finite(const std::vector<T>& values, const std::string& place) const {
        for (std::size_t i = 0; i < values.size(); ++i)
            if (!is_finite(values[i])) fail(place + "/" + std::to_string(i), "is not finite");
    }
    void texture(const Texture* texture, const std::string& place) const {
        if (!texture) return;
        require(texture->width > 0 && texture->height > 0, place, "has no pixels");
        require(texture->rgb.size() ==
                    3 * static_cast<std::size_t>(texture->width) * static_cast<std::size_t>(texture->height),
                place, "has not three values per pixel");
        require(texture->alpha.empty() || 3 * texture->alpha.size() == texture->rgb.size(), place,
                "has not one alpha per pixel");
    }
    void object(const Mesh& whole, const std::string& place) const;
    void optic(const Mesh& mesh, const std::string& place) const;
    void patch(const RationalPatch& patch, const std::string& place) const;

    const Scene& scene_;
};

void SceneCheck::cameras() const {
    require(!scene_.cameras.empty(), "/cameras", "a scene has a camera");
    require(scene_.own_camera < scene_.cameras.size(), "/cameras", "the scene's own camera is none of them");
    for (std::size_t i = 0; i < scene_.cameras.size(); ++i) {
        const CameraDescription& camera = scene_.cameras[i];
        const std::string place = "/cameras/" + std::to_string(i);
        const bool finite_angle = std::visit(
            [](const auto& kind) {
                if constexpr (requires { kind.yfov; }) return is_finite(kind.yfov);
                return true;
            },
            camera.kind);
        require(is_finite(camera.eye) && is_finite(camera.at) && is_finite(camera.up) && finite_angle, place,
                "is not finite");
    }
}

void SceneCheck::materials() const {
    texture(scene_.background.environment.get(), "/background/file");
    require(is_finite(scene_.background.color), "/background/color", "is not finite");
    for (std::size_t i = 0; i < scene_.materials.size(); ++i) {
        const Material& m = scene_.materials[i];
        const std::string place = "/materials/" + std::to_string(i);
        require(is_finite(m.base_color_factor) && is_finite(m.attenuation_color), place, "is not finite");
        require(is_finite(m.ior) && m.ior > 0, place + "/ior", "is not positive");
        require(is_finite(m.attenuation_distance) && m.attenuation_distance >= 0,
                place + "/volume/attenuationDistance", "is negative");
        require(
            is_finite(m.emissive_factor) && is_finite(m.specular_color_factor) && is_finite(m.normal_scale),
            place, "is not finite");
        texture(m.base_color_texture.get(), place + "/baseColorTexture");
        texture(m.metallic_roughness_texture.picture.get(), place + "/metallicRoughnessTexture");
        texture(m.normal_texture.picture.get(), place + "/normalTexture");
        texture(m.occlusion_texture.picture.get(), place + "/occlusionTexture");
        texture(m.emissive_texture.picture.get(), place + "/emissiveTexture");
    }
}

void SceneCheck::lights() const {
    for (std::size_t i = 0; i < scene_.lights.size(); ++i) {
        const Light& light = scene_.lights[i];
        const std::string place = "/lights/" + std::to_string(i);
        require(is_finite(light.color) && is_finite(light.intensity), place, "is not finite");
        std::visit(
            [&](const auto& kind) {
                if constexpr (requires { kind.position; })
                    require(is_finite(kind.position), place, "is not finite");
                if constexpr (requires { kind.direction; })
                    require(std::fabs(length(kind.direction) - 1) < 1e-6, place,
                            "has a direction that is not unit");
                if constexpr (requires { kind.radius; })
                    require(is_finite(kind.radius) && kind.radius > 0, place + "/radius", "is not positive");
                if constexpr (requires { kind.size; })
                    require(std::isfinite(kind.size.x) && std::isfinite(kind.size.y) && kind.size.x > 0 &&
                                kind.size.y > 0,
                            place + "/size", "is not positive");
                if constexpr (requires { kind.samples; })
                    require(kind.samples >= 1 && kind.samples <= kMostLightSamples, place + "/samples",
                            "is not in 1.." + std::to_string(kMostLightSamples));
                if constexpr (requires { kind.angle; })
                    require(kind.angle >= 0 && kind.angle < 180, place + "/angle", "is not in 0..180");
                if constexpr (requires { kind.outer_cone_angle; })
                    require(kind.inner_cone_angle >= 0 && kind.inner_cone_angle < kind.outer_cone_angle &&
                                kind.outer_cone_angle <= 90,
                            place, "has no inner cone within an outer one of at most 90 degrees");
            },
            light.kind);
    }
}

void SceneCheck::object(const Mesh& whole, const std::string& place) const {
    require(whole.material == kNone || whole.material < scene_.materials.size(), place + "/material",
            "is no material of the scene");
    const ObjectMesh& mesh = whole.object;
    const std::size_t count = mesh.triangles.size();
    finite(mesh.points, place + "/points");
    for (std::size_t t = 0; t < count; ++t)
        for (const Id corner : mesh.triangles[t])
            if (corner >= mesh.points.size())
                fail(place + "/triangles/" + std::to_string(t), "has a corner that is no point");
    require(mesh.material.size() == count, place + "/material", "needs one material per triangle");
    for (const Id material : mesh.material)
        if (material >= scene_.materials.size()) fail(place + "/material", "names no material of the scene");
    require(mesh.uvs.empty() || mesh.uvs.size() == count, place + "/uvs",
            "needs one entry per triangle, or none");
    require(mesh.second_uvs.empty() || mesh.second_uvs.size() == count, place + "/uvs1",
            "needs one entry per triangle, or none");
    require(mesh.colors.empty() || mesh.colors.size() == count, place + "/colors",
            "needs one entry per triangle, or none");
    for (const std::array<Vec4, 3>& corners : mesh.colors)
        for (const Vec4& color : corners)
            for (int k = 0; k < 4; ++k)
                require(color[k] >= 0 && color[k] <= 1, place + "/colors", "has a number outside 0..1");
    require(mesh.normals.empty() || mesh.normals.size() == count, place + "/normals",
            "needs one entry per triangle, or none");
    require(mesh.tangents.empty() || mesh.tangents.size() == count, place + "/tangents",
            "needs one entry per triangle, or none");
    for (const std::array<Vec4, 3>& corners : mesh.tangents)
        for (const Vec4& tangent : corners)
            require(is_finite(Vec3(tangent)) && is_finite(tangent.w), place + "/tangents", "is not finite");
    require(mesh.baked.empty() || mesh.baked.size() == count, place + "/bakedLight",
            "needs one entry per triangle, or none");
    for (const BakedLight& light : mesh.baked)
        for (const auto& side : {light.front, light.back})
            for (const Vec3& at_corner : side)
                require(is_finite(at_corner), place + "/bakedLight", "is not finite");
}

void SceneCheck::patch(const RationalPatch& patch, const std::string& place) const {
    const auto is_degree = [](int degree) { return degree >= 1 && degree <= kHighestPatchDegree; };
    require(is_degree(patch.degree_u) && is_degree(patch.degree_v), place,
            "has a degree that is too high or low");
    const std::size_t count = patch.row() * (static_cast<std::size_t>(patch.degree_v) + 1);
    require(patch.points.size() == count, place, "needs as many points as its degrees say");
    require(is_finite(patch.origin), place, "is not finite");
    for (const Vec4& point : patch.points)
        require(is_finite(Vec3(point)) && is_finite(point.w) && point.w > 0, place,
                "has a point that is not finite, or a weight that is not above 0");
}

void SceneCheck::optic(const Mesh& mesh, const std::string& place) const {
    require(mesh.material < scene_.materials.size(), place + "/material", "is no material of the scene");
    const double roughness = scene_.materials[mesh.material].roughness_factor;
    require(roughness >= 0 && roughness <= kMostRoughness, place + "/material",
            "has a roughness that is not in 0..0.3");
    require(mesh.resolution >= 1 && mesh.resolution <= kMaxResolution, place + "/resolution",
            "is not in 1.." + std::to_string(kMaxResolution));
    require(mesh.primitive || !mesh.patches.empty() || !mesh.cage.points.empty(), place,
            "an optic has a primitive, patches or a cage");
    for (const RationalPatch& one : mesh.patches) patch(one, place + "/patches");
    require(mesh.cage_uvs.empty() || mesh.cage_uvs.size() == mesh.cage.face_vertex_indices.size(),
            place + "/uvs", "needs one entry per corner of a face, or none");
    require(mesh.cage_tangents.empty() || mesh.cage_tangents.size() == mesh.cage.face_vertex_indices.size(),
            place + "/tangents", "needs one entry per corner of a face, or none");
    for (const Vec4& tangent : mesh.cage_tangents)
        require(is_finite(Vec3(tangent)) && is_finite(tangent.w), place + "/tangents", "is not finite");
    require(!mesh.maps_normals || scene_.materials[mesh.material].normal_texture.picture, place,
            "maps normals of a picture that its material does not have");
    require(
        is_finite(mesh.normals.center) && is_finite(mesh.normals.amplitude) && is_finite(mesh.normals.scale),
        place + "/normals", "is not finite");
}

void SceneCheck::meshes() const {
    for (std::size_t m = 0; m < scene_.meshes.size(); ++m) {
        const std::string place = "/meshes/" + std::to_string(m);
        if (scene_.meshes[m].role == Role::kObject)
            object(scene_.meshes[m], place);
        else
            optic(scene_.meshes[m], place);
    }
}

void SceneCheck::volumes() const {
    for (std::size_t v = 0; v < scene_.volumes.size(); ++v) {
        const Volume& volume = scene_.volumes[v];
        const std::string place = "/volumes/" + std::to_string(v);
        require(volume.cells && !volume.cells->cells.empty(), place, "has no cells");
        const TetMesh& mesh = *volume.cells;
        finite(mesh.points, place + "/points");
        finite(mesh.scalars, place + "/scalars");
        require(mesh.scalars.size() == mesh.points.size(), place + "/scalars", "needs one entry per point");
        for (const Tetrahedron& cell : mesh.cells) {
            for (const Id corner : cell)
                if (corner >= mesh.points.size()) fail(place + "/cells", "has a corner that is no point");
            const Vec3& a = mesh.points[cell[0]];
            const Vec3 normal = cross(mesh.points[cell[1]] - a, mesh.points[cell[2]] - a);
            if (!(dot(normal, mesh.points[cell[3]] - a) > 0))
                fail(place + "/cells", "has a cell that is flat or inverted");
        }
        const std::vector<TransferPoint>& points = volume.transfer.points;
        require(!points.empty(), place + "/transferFunction", "has no points");
        for (std::size_t i = 0; i < points.size(); ++i) {
            require(is_finite(points[i].value) && is_finite(points[i].color) && points[i].extinction >= 0 &&
                        is_finite(points[i].extinction),
                    place + "/transferFunction", "has a point that is not finite, or is negative");
            require(i == 0 || points[i].value > points[i - 1].value, place + "/transferFunction",
                    "has values that do not rise");
        }
    }
}

void SceneCheck::marks() const {
    for (std::size_t i = 0; i < scene_.points.size(); ++i) {
        const PointCloud& cloud = scene_.points[i];
        const std::string place = "/points/" + std::to_string(i);
        require(!cloud.places.empty(), place, "has no points");
        require(cloud.places.size() <= kMostPoints, place, "has too many points");
        finite(cloud.places, place + "/at");
        require(cloud.colors.empty() || cloud.colors.size() == cloud.places.size(), place + "/colors",
                "needs one entry per point");
        finite(cloud.colors, place + "/colors");
        require(is_finite(cloud.radius) && cloud.radius >= 0 && is_finite(cloud.size) && cloud.size > 0,
                place, "needs a size");
    }
    for (std::size_t i = 0; i < scene_.labels.size(); ++i) {
        const Label& label = scene_.labels[i];
        const std::string place = "/labels/" + std::to_string(i);
        require(!label.style.text.empty(), place + "/text", "is empty");
        require(is_finite(label.place) && is_finite(label.color), place, "is not finite");
        require(is_finite(label.priority), place + "/priority", "is not finite");
        require(is_finite(label.style.size) && label.style.size > 0, place + "/size", "must be above 0");
    }
}

}  // namespace

void check_scene(const Scene& scene) {
    const SceneCheck check(scene);
    check.film();
    check.cameras();
    check.materials();
    check.lights();
    check.meshes();
    check.volumes();
    check.marks();
}

}  // namespace trilens
