// trilens scene: validate, info, schema, example.
#include <trilens/render.h>
#include <trilens/scene.h>
#include <trilens/text.h>

#include "cli/commands.h"
#include "cli/scene_options.h"

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
    return json;
}

std::string mesh_line(const MeshInfo& mesh) {
    std::string line = mesh.role == Role::kOptic ? "  optic   " : "  object  ";
    line += mesh.name + ": " + mesh.shape;
    if (mesh.faces > 0) line += ", " + std::to_string(mesh.faces) + " faces";
    line += mesh.role == Role::kOptic ? ", resolution " + std::to_string(mesh.resolution)
                                      : ", " + std::to_string(mesh.triangles) + " triangles";
    return line + ", material " + mesh.material + "\n";
}

Answer info(const SceneOptions& options, Console& console) {
    const Scene scene = load_scene(options, console);
    const SceneInfo found = make_scene_info(scene);
    Answer answer;
    Json& fields = answer.fields;
    fields["film"] = {{"width", scene.film.width}, {"height", scene.film.height}, {"spp", scene.film.spp}};
    fields["cameras"] = found.cameras;
    fields["camera_types"] = found.camera_types;
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
                  " samples\ncameras:";
    for (std::size_t i = 0; i < found.cameras.size(); ++i)
        answer.text += (i == 0 ? " " : ", ") + found.cameras[i] + " (" + found.camera_types[i] + ")";
    answer.text += "\n" + std::to_string(found.optics) + " optics, " + std::to_string(found.objects) +
                   " objects, " + std::to_string(found.triangles) + " triangles, " +
                   std::to_string(found.lights) + " lights\n";
    for (const MeshInfo& mesh : found.meshes) {
        fields["meshes"].push_back(mesh_json(mesh));
        answer.text += mesh_line(mesh);
    }
    return answer;
}

/// Loading is not all: a cage may have no limit surface.
Answer validate(const SceneOptions& options, Console& console) {
    const Renderer renderer = load_renderer(options, console);
    // What drawing would refuse.
    for (std::size_t i = 0; i < renderer.scene().cameras.size(); ++i)
        if (options.camera.empty() || i == find_camera(renderer.scene(), options.camera))
            renderer.check({i, 0});
    const std::size_t optics = renderer.optics().size(), triangles = renderer.triangle_count();
    Answer answer;
    answer.is_report = true;
    answer.text = options.scene + ": valid, " + std::to_string(optics) + " optics, " +
                  std::to_string(triangles) + " triangles";
    answer.fields["optics"] = optics;
    answer.fields["triangles"] = triangles;
    return answer;
}

Answer example(const std::string& name) {
    Answer answer;
    answer.fields["examples"] = Json::array();
    std::vector<std::string> names;
    for (const SceneExample& one : scene_examples()) {
        names.push_back(one.name);
        if (name == one.name) {
            answer.text = one.json;
            answer.fields = {{"name", one.name}, {"scene", Json::parse(one.json, nullptr, true, true)}};
            return answer;
        }
        answer.text += std::string(one.name) + ": " + one.summary + "\n";
        answer.fields["examples"].push_back({{"name", one.name}, {"summary", one.summary}});
    }
    if (!name.empty() && name != "list")
        throw UsageError("there is no example \"" + name + "\"" + suggestion(name, names));
    return answer;
}

}  // namespace

Command scene_command() {
    auto options = std::make_shared<SceneOptions>();
    const std::vector<Option> of_scene = joined({scene_argument(*options), scene_overrides(*options)});
    Command check{.name = "validate",
                  .summary = "check a scene file and everything it names",
                  .options = of_scene,
                  .schema = "scene"};
    check.body = [options](Console& console) { return validate(*options, console); };
    Command look{.name = "info", .summary = "what a scene holds", .options = of_scene, .schema = "scene"};
    look.body = [options](Console& console) { return info(*options, console); };
    Command schema{.name = "schema", .summary = "print the JSON Schema of scene files", .schema = "scene"};
    schema.body = [](Console&) {
        return Answer{.text = scene_schema(), .fields = {{"schema_document", Json::parse(scene_schema())}}};
    };
    auto name = std::make_shared<std::string>();
    Command print{.name = "example",
                  .summary = "print an example scene, or the list of them",
                  .options = {{.names = "NAME",
                               .target = name.get(),
                               .help = "which example; without it, the list",
                               .offer = Offer::kExample}},
                  .schema = "scene"};
    print.body = [name](Console&) { return example(*name); };
    return {.name = "scene",
            .summary = "look at scene files",
            .commands = {std::move(check), std::move(look), std::move(schema), std::move(print)}};
}

}  // namespace trilens
