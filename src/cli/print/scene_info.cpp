#include "cli/print/print.h"

#include <trilens/camera.h>
#include <trilens/version.h>

#include <string>
#include <vector>

#include "terminal/libraries.h"

namespace trilens {
namespace {

Json box_json(const Box& bounds) {
    if (bounds.empty()) return nullptr;
    return {{"low", {bounds.low.x, bounds.low.y, bounds.low.z}},
            {"high", {bounds.high.x, bounds.high.y, bounds.high.z}}};
}

Json mesh_json(const MeshInfo& mesh) {
    Json json{{"name", mesh.name},     {"role", mesh.role == Role::kOptic ? "optic" : "object"},
              {"shape", mesh.shape},   {"material", mesh.material},
              {"points", mesh.points}, {"faces", mesh.faces}};
    if (mesh.role == Role::kObject) {
        json["triangles"] = mesh.triangles;
    } else {
        json["resolution"] = mesh.resolution;
        json["creases"] = mesh.creases;
        json["corners"] = mesh.corners;
        json["holes"] = mesh.holes;
    }
    json["bounds"] = box_json(mesh.bounds);
    if (const std::optional<TerrainInfo>& terrain = mesh.terrain)
        json["terrain"] = {{"samples", {terrain->columns, terrain->rows}},
                           {"missing_heights", terrain->missing_heights},
                           {"whole_triangles", terrain->whole_triangles},
                           {"greatest_error", terrain->greatest_error},
                           {"rms_error", terrain->rms_error}};
    return json;
}

/// Counts by the kinds' names, of those that there are.
Json kinds_json(const FacetKinds& kinds) {
    Json json = Json::object();
    for (std::size_t k = 0; k < kGeneralLinearKindCount; ++k)
        if (kinds.of_kind[k] > 0)
            json[general_linear_kind_name(static_cast<GeneralLinearKind>(k))] = kinds.of_kind[k];
    if (kinds.without > 0) json["none"] = kinds.without;
    return json;
}

Json camera_kinds(const Scene& scene, std::size_t index) {
    const FilmSize film{static_cast<double>(scene.film.width), static_cast<double>(scene.film.height)};
    const CameraSite site{scene.file, "/cameras/" + std::to_string(index)};
    return kinds_json(facet_kinds(make_camera(scene.cameras[index], film, site)));
}

/// "  camera  NAME: TYPE, 2 facets: pinhole", or with a count for each of several kinds.
std::string camera_line(const std::string& name, const std::string& type, const Json& kinds) {
    std::size_t facets = 0;
    std::string words;
    for (const auto& [kind, count] : kinds.items()) {
        facets += count.get<std::size_t>();
        words += (words.empty() ? "" : ", ") + (kinds.size() > 1 ? count.dump() + " " : "") + kind;
    }
    return "  camera  " + name + ": " + type + ", " + std::to_string(facets) + " facets: " + words + "\n";
}

std::string mesh_line(const MeshInfo& mesh) {
    std::string line = mesh.role == Role::kOptic ? "  optic   " : "  object  ";
    line += mesh.name + ": " + mesh.shape;
    if (mesh.terrain)
        line += fmt::format(", {} x {} samples", mesh.terrain->columns, mesh.terrain->rows);
    else if (mesh.faces > 0)
        line += ", " + std::to_string(mesh.faces) + " faces";
    line += mesh.role == Role::kOptic ? ", resolution " + std::to_string(mesh.resolution)
                                      : ", " + std::to_string(mesh.triangles) + " triangles";
    if (mesh.terrain)
        line += fmt::format(" of {}, off by at most {:.4g}", mesh.terrain->whole_triangles,
                            mesh.terrain->greatest_error);
    line += ", material " + mesh.material;
    if (!mesh.bounds.empty()) {
        const Vec3 &a = mesh.bounds.low, &b = mesh.bounds.high;
        line +=
            fmt::format(", from {:.6g} {:.6g} {:.6g} to {:.6g} {:.6g} {:.6g}", a.x, a.y, a.z, b.x, b.y, b.z);
    }
    return line + "\n";
}

Json volume_json(const VolumeInfo& volume) {
    return {{"name", volume.name},
            {"field", volume.field},
            {"cells", volume.cells},
            {"tetrahedra", volume.tetrahedra},
            {"points", volume.points},
            {"range", {volume.least, volume.most}},
            {"bounds", box_json(volume.bounds)}};
}

std::string volume_line(const VolumeInfo& volume) {
    return fmt::format("  volume  {}: {} cells, {} tetrahedra, {}{:.6g} to {:.6g}\n", volume.name,
                       volume.cells, volume.tetrahedra, volume.field.empty() ? "" : volume.field + " ",
                       volume.least, volume.most);
}

}  // namespace

Answer info_answer(const Scene& scene) {
    const SceneInfo found = make_scene_info(scene);
    Answer answer;
    Json& fields = answer.fields;
    fields["film"] = {{"width", scene.film.width}, {"height", scene.film.height}, {"spp", scene.film.spp}};
    fields["cameras"] = found.cameras;
    fields["camera_types"] = found.camera_types;
    fields["camera_kinds"] = Json::array();
    for (std::size_t i = 0; i < scene.cameras.size(); ++i)
        fields["camera_kinds"].push_back(camera_kinds(scene, i));
    fields["objects"] = found.objects;
    fields["optics"] = found.optics;
    fields["triangles"] = found.triangles;
    fields["lights"] = found.lights;
    fields["bounds"] = box_json(found.bounds);
    fields["materials"] = Json::array();
    for (const MaterialInfo& material : found.materials)
        fields["materials"].push_back({{"name", material.name},
                                       {"kind", material.kind},
                                       {"texture", material.has_texture},
                                       {"meshes", material.meshes}});
    fields["meshes"] = Json::array();

    answer.text = "film " + std::to_string(scene.film.width) + " x " + std::to_string(scene.film.height) +
                  ", " + std::to_string(scene.film.spp) + " x " + std::to_string(scene.film.spp) +
                  " samples\n";
    for (std::size_t i = 0; i < found.cameras.size(); ++i)
        answer.text += camera_line(found.cameras[i], found.camera_types[i], fields["camera_kinds"][i]);
    answer.text += std::to_string(found.optics) + " optics, " + std::to_string(found.objects) + " objects, " +
                   std::to_string(found.triangles) + " triangles, " + std::to_string(found.lights) +
                   " lights\n";
    for (const MeshInfo& mesh : found.meshes) {
        fields["meshes"].push_back(mesh_json(mesh));
        answer.text += mesh_line(mesh);
    }
    fields["volumes"] = Json::array();
    for (const VolumeInfo& volume : found.volumes) {
        fields["volumes"].push_back(volume_json(volume));
        answer.text += volume_line(volume);
    }
    fields["points"] = Json::array();
    for (const CloudInfo& cloud : found.points) {
        fields["points"].push_back({{"name", cloud.name},
                                    {"points", cloud.points},
                                    {"colors", cloud.has_colors},
                                    {"bounds", box_json(cloud.bounds)}});
        answer.text += fmt::format("  points  {}: {}{}\n", cloud.name, cloud.points,
                                   cloud.has_colors ? ", with colours" : "");
    }
    fields["labels"] = found.labels;
    if (!found.labels.empty()) answer.text += fmt::format("  labels  {}\n", found.labels.size());
    return answer;
}

namespace {

std::vector<std::string> instruction_sets() {
    std::vector<std::string> sets;
#if defined(__x86_64__)
    __builtin_cpu_init();
    if (__builtin_cpu_supports("sse4.2")) sets.push_back("sse4.2");
    if (__builtin_cpu_supports("avx")) sets.push_back("avx");
    if (__builtin_cpu_supports("avx2")) sets.push_back("avx2");
    if (__builtin_cpu_supports("fma")) sets.push_back("fma");
    if (__builtin_cpu_supports("avx512f")) sets.push_back("avx512f");
#endif
    return sets;
}

std::string compiler() {
#if defined(__clang__)
    return "clang " __clang_version__;
#else
    return "gcc " __VERSION__;
#endif
}

std::string join(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
    return text;
}

}  // namespace

Answer build_answer() {
    const std::vector<std::string> libraries = library_versions();
    Answer answer;
    answer.fields["version"] = version();
    answer.fields["compiler"] = compiler();
    answer.fields["build_type"] = TRILENS_BUILD_TYPE;
    answer.fields["libraries"] = libraries;
    answer.fields["instruction_sets"] = instruction_sets();
    answer.fields["threads"] = threads();
    answer.text = "trilens " + version() + "\ncompiler   " + compiler() + ", " + TRILENS_BUILD_TYPE;
    for (const std::string& library : libraries) answer.text += "\nlibrary    " + library;
    answer.text += "\nprocessor  " + join(instruction_sets()) + "\nthreads    " + std::to_string(threads());
    return answer;
}

}  // namespace trilens
