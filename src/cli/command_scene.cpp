// trilens scene: validate, info, convert, schema, example.
#include <trilens/render.h>
#include <trilens/scene.h>
#include <trilens/utilities.h>

#include <filesystem>

#include "cli/commands.h"
#include "cli/options.h"
#include "cli/print/print.h"

namespace trilens {
namespace {

Answer info(const SceneOptions& options, Console& console) {
    return info_answer(load_scene(options, console));
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

/// The scene with nothing left to import, its files named from where the output lies.
Answer convert(const SceneOptions& options, const std::string& output, Console& console) {
    const bool to_file = !output.empty() && !is_standard_stream(output);
    if (to_file) check_scene_output(output, console);
    const Scene scene = load_scene(options, console);
    const std::string folder =
        to_file ? std::filesystem::absolute(output).parent_path().string() : scene.folder;
    const std::string text = scene_document(scene, folder);
    if (to_file) return write_output(output, text, console);
    Answer answer;
    answer.text = text;
    answer.fields["scene"] = Json::parse(text);
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
    auto output = std::make_shared<std::string>();
    Command turn{.name = "convert",
                 .summary = "write a glTF, or a scene with what it imports, as one scene file",
                 .options = joined({of_scene,
                                    {{.names = "-o,--output",
                                      .target = output.get(),
                                      .help = "scene file to write; without it, standard output",
                                      .value = "OUT.json"}}}),
                 .schema = "scene"};
    turn.body = [options, output](Console& console) { return convert(*options, *output, console); };
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
            .commands = {std::move(check), std::move(look), std::move(turn), std::move(schema),
                         std::move(print)}};
}

}  // namespace trilens
