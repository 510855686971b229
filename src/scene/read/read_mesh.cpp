// One entry of `meshes`: its material, its shape as optic or object, and what is doubtful about it.
#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "base/math/box.h"
#include "base/util/names.h"
#include "scene/data/alpha_cut.h"
#include "scene/data/cage_diagnostics.h"
#include "scene/meshes/tangents.h"
#include "scene/meshes/vertex_normals.h"
#include "scene/meshes/weld.h"
#include "scene/read/reading.h"

namespace trilens {

namespace {

bool inherits(const Node& node) {
    const std::string material = string_or(node, "material", node.has("file") ? "inherit" : "");
    if (material != "inherit") return false;
    if (!node.has("file")) node["material"].fail("only a mesh with a file has materials to inherit");
    return true;
}

/// Index into the scene's materials; kNone where the mesh names none, or inherits.
Id find_material(const Node& node, const Reading& reading) {
    if (!node.has("material") || node.json.at("material") == "inherit") return kNone;
    const std::string name = node["material"].json.get<std::string>();
    std::vector<std::string> known;
    for (std::size_t i = 0; i < reading.named_materials; ++i)
        known.push_back(reading.scene.materials[i].name);
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
        node["material"].fail("unknown material '" + name + "'" + suggestion(name, known));
    return static_cast<Id>(found - known.begin());
}

/// What a material has that optics do not show: a mirror or glass is of one colour, perfect or rough alike
/// everywhere, and neither shines nor is hidden from the sky.
void warn_of_idle(const std::string& place, const Material& material, Reading& reading) {
    std::string idle;
    const auto add = [&](bool has, const char* key) {
        if (has) idle += (idle.empty() ? "" : ", ") + std::string(key);
    };
    add(material.base_color_texture != nullptr, "baseColorTexture");
    add(material.metallic_roughness_texture.picture && material.roughness_factor > 0,
        "metallicRoughnessTexture");
    add(material.occlusion_texture.picture != nullptr, "occlusionTexture");
    add(material.emissive_factor != Vec3(0), "emissiveFactor");
    add(material.alpha_mode != AlphaMode::kOpaque, "alphaMode");
    const bool is_glass = material.transmission_factor == 1;
    add(is_glass && material.specular_factor != 1, "specularFactor");
    add(is_glass && material.specular_color_factor != Vec3(1), "specularColorFactor");
    if (!idle.empty())
        reading.warn(place, "the material '" + material.name + "' of an optic: not drawn there: " + idle);
}

void check_optic_material(const Node& node, Id index, Reading& reading) {
    if (index == kNone)
        node["material"].fail("an optic cannot inherit: name a mirror or a glass of 'materials'");
    const Material& material = reading.scene.materials[index];
    const bool mirror = material.metallic_factor == 1, glass = material.transmission_factor == 1;
    const std::string optic = "the material '" + material.name + "' of an optic ";
    if (!mirror && !glass)
        node["material"].fail(optic + "must be a mirror (metallicFactor 1) or glass (transmissionFactor 1)");
    if (mirror && glass) node["material"].fail(optic + "cannot be mirror and glass at once");
    if (material.roughness_factor > kMostRoughness)
        node["material"].fail(optic + "must have a roughnessFactor of at most " + describe(kMostRoughness));
    warn_of_idle(node["material"].place, material, reading);
}

void warn_count(std::size_t count, const std::string& what, const std::string& place, Reading& reading) {
    if (count > 0) reading.warn(place, std::to_string(count) + " " + what);
}

}  // namespace

void warn_of_inside_out(const Node& node, Reading& reading) {
    reading.warn(node.place,
                 "the fronts of its faces look into it: this body of glass is drawn as a hollow in endless "
                 "glass; turn the order of each face's points round");
}

namespace {

void check_far_points(const Node& node, const Cage& cage) {
    const std::optional<std::size_t> far = find_far_point(cage);
    if (!far) return;
    const std::string message = "lies more than " + describe(kFarthestPoint) +
                                " times as far from the middle of the cage as half of its points do";
    if (node.has("points")) node["points"][*far].fail(message);
    node["file"].fail("point " + std::to_string(*far + 1) + " of the file " + message);
}

/// The uv and tangents that the material's normal map lies by, where it has one. The cage has its scheme.
void read_optic_uvs(const Node& node, const PolygonMesh& polygons, Mesh& mesh, Reading& reading) {
    const PlacedTexture& map = reading.scene.materials[mesh.material].normal_texture;
    if (!map.picture) return;
    const bool is_second = map.sampler.uv_set == 1 && !polygons.second_uvs.empty();
    mesh.cage_uvs = is_second ? polygons.second_uvs : polygons.uvs;
    mesh.maps_normals = !mesh.cage_uvs.empty();
    if (!mesh.maps_normals) reading.warn(node.place, "has no uv: the normal map of its material is ignored");
    if (!mesh.maps_normals || polygons.tangents.empty()) return;
    if (polygons.cage.scheme == SubdivisionScheme::kUnsubdivided)
        mesh.cage_tangents = polygons.tangents;
    else
        reading.warn(node.place, "the tangents of its points are ignored: it is subdivided");
}

/// Of a lens, checked: sides that go on beyond what their terms were made for.
void warn_of_terms(const Node& primitive, Reading& reading) {
    for (const char* key : {"front", "back"}) {
        if (!primitive.has(key)) continue;
        LensSide side;
        from_json_value(primitive[key].json, side);
        if (outreaches_terms(side)) reading.warn(primitive[key].place, kOutreachesTerms);
    }
}

void read_optic(const Node& node, Mesh& mesh, Reading& reading) {
    if (node.has("colors")) node["colors"].fail("are an object's: an optic has its material's colour alone");
    if (node.has("shading"))
        node["shading"].fail("is an object's: an optic shows what it reflects and refracts");
    check_optic_material(node, mesh.material, reading);
    if (node.has("primitive")) {
        if (node.has("fit")) node["fit"].fail("an optic's primitive has its own center and size");
        if (node.has("displacement"))
            node["displacement"].fail("an optic's primitive is exact: heights move the points of a cage");
        mesh.primitive = read_primitive(node["primitive"], read_transform(node), node);
        warn_of_terms(node["primitive"], reading);
        mesh.maps_normals = reading.scene.materials[mesh.material].normal_texture.picture != nullptr;
        return;
    }
    if (node.has("patches")) {
        const bool is_glass = reading.scene.materials[mesh.material].transmission_factor == 1;
        read_optic_patches(node, is_glass, mesh, reading);
        read_optic_uvs(node, {}, mesh, reading);
        return;
    }
    PolygonMesh polygons =
        node.has("file") ? read_mesh_file(node, false, reading) : read_inline_polygons(node);
    const bool is_colored = std::any_of(polygons.colors.begin(), polygons.colors.end(),
                                        [](const Vec4& color) { return color != Vec4(1); });
    if (is_colored) reading.warn(node.place, "the colours of its points are ignored: it is an optic");
    // Triangle meshes have points once per seam, cages once.
    if (node.has("file") && polygons.is_triangle_soup) weld_points(polygons);
    read_subdivision(node, polygons.cage);
    if (polygons.is_triangle_soup && polygons.cage.scheme == SubdivisionScheme::kCatmullClark)
        join_quads(polygons);
    if (polygons.cage.scheme == SubdivisionScheme::kUnsubdivided) cut_into_triangles(polygons);
    check_scheme(node, polygons.cage);
    read_displacement(node, polygons, reading);
    place_mesh(polygons, node);
    check_far_points(node, polygons.cage);
    read_optic_uvs(node, polygons, mesh, reading);
    mesh.cage = std::move(polygons.cage);
    if (mesh.cage.scheme == SubdivisionScheme::kUnsubdivided) mesh.cage.normals = std::move(polygons.normals);
    mesh.face_count = mesh.cage.face_vertex_counts.size();

    const CageDiagnostics doubts = diagnose_cage(mesh.cage);
    const bool glass = reading.scene.materials[mesh.material].transmission_factor == 1;
    warn_count(doubts.non_manifold_edges,
               "edges are not manifold: more than two faces meet there, or their windings disagree",
               node.place, reading);
    if (glass)
        warn_count(doubts.boundary_edges,
                   "edges have one face only: this glass is one interface, or a body with holes", node.place,
                   reading);
    if (glass && doubts.is_inside_out) warn_of_inside_out(node, reading);
    warn_count(doubts.repeated_corners, "faces visit a point twice", node.place, reading);
    warn_count(doubts.unknown_creases, "creases lie where there is no edge", node.place, reading);
    warn_count(doubts.flat_faces, "faces have no area", node.place, reading);
}

/// Moves a file's own materials into the scene, and gives every triangle a material of the scene.
void settle_materials(std::vector<Material>& own, Mesh& mesh, Scene& scene) {
    const auto first = static_cast<Id>(scene.materials.size());
    for (Material& material : own) {
        material.name = mesh.name + "/" + material.name;
        scene.materials.push_back(std::move(material));
    }
    std::vector<Id>& materials = mesh.object.material;
    if (mesh.material == kNone && std::find(materials.begin(), materials.end(), kNone) != materials.end()) {
        scene.materials.emplace_back();
        scene.materials.back().name = mesh.name + "/default";
    }
    const Id fallback = mesh.material != kNone ? mesh.material : static_cast<Id>(scene.materials.size() - 1);
    for (Id& material : materials)
        material = mesh.material != kNone || material == kNone ? fallback : first + material;
}

bool asks_for_second_uvs(const Material& material) {
    const TextureSampler* samplers[] = {&material.base_color_sampler,
                                        &material.metallic_roughness_texture.sampler,
                                        &material.normal_texture.sampler, &material.occlusion_texture.sampler,
                                        &material.emissive_texture.sampler};
    return std::any_of(std::begin(samplers), std::end(samplers),
                       [](const TextureSampler* sampler) { return sampler->uv_set == 1; });
}

/// Leaves the second set of uv where a material asks for it; where there is none the first stands in.
void settle_second_uvs(const Node& node, ObjectMesh& object, Reading& reading) {
    const bool is_asked = std::any_of(object.material.begin(), object.material.end(), [&](Id material) {
        return asks_for_second_uvs(reading.scene.materials[material]);
    });
    if (!is_asked) object.second_uvs.clear();
    if (!is_asked || !object.second_uvs.empty()) return;
    reading.warn(node.place,
                 "a texture asks for a second set of uv, of which there is none: the first is taken");
    object.second_uvs = object.uvs;
}

}  // namespace

ObjectShading read_shading(const Node& node) {
    return *find_named<ObjectShading>(
        string_or(node, "shading", std::string(name_of(ObjectShading::kGivenNormals))));
}

namespace {

/// In the world, with the normals that they are lit by. Counts the faces that cross themselves where they are
/// triangles already.
PolygonMesh read_object_polygons(const Node& node, Mesh& mesh, std::size_t& uncovered_faces,
                                 Reading& reading) {
    if (node.has("patches")) {
        PolygonMesh polygons = read_object_patches(node, mesh, reading);
        set_shading(polygons, read_shading(node));
        return polygons;
    }
    PolygonMesh polygons = node.has("file")        ? read_mesh_file(node, inherits(node), reading)
                           : node.has("primitive") ? read_object_primitive(node["primitive"])
                                                   : read_inline_polygons(node);
    if (node.has("primitive")) warn_of_terms(node["primitive"], reading);
    if (node.has("vertexColors") && !node.json.at("vertexColors").get<bool>()) polygons.colors.clear();
    read_subdivision(node, polygons.cage);
    mesh.face_count = polygons.cage.face_vertex_counts.size();
    uncovered_faces = read_displacement(node, polygons, reading);
    place_mesh(polygons, node);
    set_shading(polygons, read_shading(node));
    return polygons;
}

void read_object(const Node& node, Mesh& mesh, Reading& reading) {
    if (waits_for_views(node, reading)) return;
    if (mesh.material != kNone) {
        const Material& material = reading.scene.materials[mesh.material];
        const bool is_mirror = material.metallic_factor == 1 && material.is_matt();
        if (is_mirror || material.transmission_factor == 1)
            reading.warn(
                node["material"].place,
                "a mirror or glass on an object is drawn as a plain surface: an optic reflects and refracts");
    }
    std::vector<Material> own;
    std::size_t uncovered_faces = 0;
    if (node.has("heights")) {
        read_terrain(node, mesh, reading);
    } else {
        PolygonMesh polygons = read_object_polygons(node, mesh, uncovered_faces, reading);
        TriangulatedMesh triangulated = triangulate(polygons);
        mesh.object = std::move(triangulated.object);
        uncovered_faces += triangulated.uncovered_faces;
        own = std::move(polygons.materials);
    }
    settle_materials(own, mesh, reading.scene);
    settle_second_uvs(node, mesh.object, reading);
    add_tangents(mesh.object, reading.scene.materials);
    const AlphaCut cut = cut_by_alpha(mesh.object, reading.scene.materials);
    warn_count(cut.colored,
               "triangles of a mask have colours with an alpha at their points, which does not cut them",
               node.place, reading);
    warn_count(cut.too_fine, "triangles are not cut out by their picture, which has too many texels there",
               node.place, reading);
    warn_count(uncovered_faces, "faces cross themselves: they are drawn as fans from their first corners",
               node.place, reading);
    warn_count(count_without_area(mesh.object), "triangles have no area", node.place, reading);
    if (node.has("bakedLight")) read_baked_light(node["bakedLight"], mesh.object);
}

}  // namespace

Mesh read_mesh(const Node& node, std::size_t index, Reading& reading) {
    Mesh mesh;
    mesh.name = "mesh" + std::to_string(index);
    read_fields(node, mesh_fields(), mesh);
    inherits(node);
    mesh.material = find_material(node, reading);
    if (node.has("normals")) read_fields(node["normals"], normal_fields(), mesh.normals);
    mesh.role == Role::kOptic ? read_optic(node, mesh, reading) : read_object(node, mesh, reading);
    return mesh;
}

}  // namespace trilens
