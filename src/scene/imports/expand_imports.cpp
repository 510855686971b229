#include "scene/imports/expand_imports.h"

#include <algorithm>
#include <filesystem>

#include "base/files/files.h"
#include "base/util/error.h"
#include "json/schema.h"
#include "scene/imports/gltf_scene.h"

namespace trilens {
namespace {

constexpr const char* kNamedLists[] = {"cameras", "materials", "meshes", "lights"};

std::set<std::string> keys_in_schema(const Json& schema) {
    const std::vector<std::string> keys = known_keys(schema);
    return {keys.begin(), keys.end()};
}

KnownKeys make_known_keys() {
    const Json& definitions = scene_schema_json().at("definitions");
    KnownKeys known{keys_in_schema(definitions.at("material")),
                    keys_in_schema(definitions.at("texture")),
                    keys_in_schema(definitions.at("light")),
                    {}};
    for (const Json& type : definitions.at("light").at("properties").at("type").at("enum"))
        known.light_types.insert(type.get<std::string>());
    return known;
}

/// One glTF that is taken in.
struct ImportEntry {
    std::string file;
    std::string place;
    ImportOptions options;
};

ImportEntry read_entry(const Json& json, const std::string& place, const ImportOptions& over) {
    ImportEntry entry{"", place, over};
    if (json.is_string()) {
        entry.file = json.get<std::string>();
        return entry;
    }
    entry.file = json.at("file").get<std::string>();
    entry.place += "/file";
    if (json.contains("optics"))
        for (const Json& pattern : json.at("optics"))
            entry.options.optics.push_back(pattern.get<std::string>());
    if (json.contains("time") && !over.time) entry.options.time = json.at("time").get<double>();
    if (json.contains("animation") && over.animation.empty())
        entry.options.animation = json.at("animation").get<std::string>();
    return entry;
}

std::vector<ImportEntry> read_entries(const Json& import, const ImportOptions& over) {
    if (!import.is_array()) return {read_entry(import, "/import", over)};
    std::vector<ImportEntry> entries;
    for (std::size_t i = 0; i < import.size(); ++i)
        entries.push_back(read_entry(import[i], "/import/" + std::to_string(i), over));
    return entries;
}

void check_import(const Json& scene, const std::string& file) {
    const Json& whole = scene_schema_json();
    const Json alone{{"definitions", whole.at("definitions")},
                     {"title", "a scene"},
                     {"type", "object"},
                     {"properties", {{"import", whole.at("properties").at("import")}}}};
    if (const auto found = find_problem(Json{{"import", scene.at("import")}}, alone))
        fail_at(file, found->place, found->message);
}

Json* find_entry(Json& list, const Json& entry) {
    if (!entry.is_object() || !entry.contains("name")) return nullptr;
    for (Json& known : list)
        if (known.is_object() && known.contains("name") && known.at("name") == entry.at("name"))
            return &known;
    return nullptr;
}

/// The file's own entries over, or beside, those of `base`.
void lay_over(Json& base, const Json& own, bool own_first) {
    Json added = Json::array();
    for (const Json& entry : own) {
        Json* known = find_entry(base, entry);
        if (known)
            known->merge_patch(entry);
        else
            added.push_back(entry);
    }
    Json& first = own_first ? added : base;
    const Json& second = own_first ? base : added;
    for (const Json& entry : second) first.push_back(entry);
    if (own_first) base = std::move(added);
}

/// A second glTF's entries beside the first's: its names give way.
void append_import(Json& base, const Json& more, const std::string& stem) {
    for (const char* list : kNamedLists) {
        for (Json entry : more.at(list)) {
            if (find_entry(base.at(list), entry))
                entry["name"] = stem + "/" + entry.at("name").get<std::string>();
            base.at(list).push_back(std::move(entry));
        }
    }
    if (more.contains("film") && !base.contains("film")) base["film"] = more.at("film");
}

class Imports {
  public:
    Imports(const ImportOptions& options, Reading& reading) : options_(options), reading_(reading) {}

    Json read(const Json& import) {
        Json base;
        for (const ImportEntry& entry : read_entries(import, options_)) {
            Json next = read_one(entry);
            if (base.is_null()) {
                base = std::move(next);
                continue;
            }
            const std::string stem = std::filesystem::path(entry.file).stem().string();
            append_second(base, next, stem);
        }
        return base;
    }

    void add_studio(Json& scene, bool camera, bool light) const {
        if (!model_ || (!camera && !light)) return;
        const GltfStudio studio = studio_of_gltf(*model_, path_);
        if (camera) scene["cameras"] = studio.cameras;
        if (light) scene["lights"] = studio.lights;
    }

  private:
    Json read_one(const ImportEntry& entry) {
        const std::string path = reading_.resolve(entry.file);
        if (!is_gltf_name(entry.file))
            fail_at(reading_.file, entry.place,
                    "'" + path + "' is no glTF: its name ends neither in .gltf nor .glb");
        const bool is_direct = path == reading_.file;  // its own messages name the file already
        try {
            const GltfModel& model = read_gltf_once(reading_, path);
            if (!model_) {
                model_ = &model;
                path_ = path;
            }
            GltfScene got = scene_of_gltf(model, {path, entry.file, entry.options, make_known_keys()});
            for (const std::string& warning : got.warnings)
                reading_.scene.warnings.push_back(path + ": " + one_line(warning));
            return std::move(got.scene);
        } catch (const InputError& error) {
            if (is_direct) throw;
            fail_at(reading_.file, entry.place, error.what());
        }
    }

    /// Materials that give way are named anew in the meshes that have them, and tracks count on.
    static void append_second(Json& base, Json& next, const std::string& stem) {
        for (Json& mesh : next.at("meshes"))
            if (find_entry(base.at("materials"), Json{{"name", mesh.at("material")}}))
                mesh["material"] = stem + "/" + mesh.at("material").get<std::string>();
        if (next.contains("animation")) {
            if (!base.contains("animation"))
                base["animation"] = {{"fps", next.at("animation").at("fps")}, {"tracks", Json::array()}};
            for (Json track : next.at("animation").at("tracks")) {
                track["target"] = shifted(track.at("target").get<std::string>(), base);
                base["animation"]["tracks"].push_back(std::move(track));
            }
        }
        append_import(base, next, stem);
    }

    /// "/meshes/2/time" behind the meshes that there are.
    static std::string shifted(const std::string& target, const Json& base) {
        const std::size_t slash = target.find('/', 1), end = target.find('/', slash + 1);
        const std::string list = target.substr(1, slash - 1);
        const std::size_t index =
            std::stoul(target.substr(slash + 1, end - slash - 1)) + base.at(list).size();
        return "/" + list + "/" + std::to_string(index) + target.substr(end);
    }

    const ImportOptions& options_;
    Reading& reading_;
    const GltfModel* model_ = nullptr;  // the first
    std::string path_;
};

/// How far cameras of the file's own move those of tracks on.
void shift_camera_tracks(Json& scene, std::size_t by) {
    if (!scene.contains("animation") || by == 0) return;
    const std::string list = "/cameras/";
    for (Json& track : scene["animation"]["tracks"]) {
        const std::string target = track.at("target").get<std::string>();
        if (target.rfind(list, 0) != 0) continue;
        const std::size_t end = target.find('/', list.size());
        track["target"] = list +
                          std::to_string(std::stoul(target.substr(list.size(), end - list.size())) + by) +
                          target.substr(end);
    }
}

}  // namespace

bool is_gltf_name(const std::string& file) {
    const std::string ending = file_ending(file);
    return ending == ".gltf" || ending == ".glb";
}

void expand_imports(Json& scene, const ImportOptions& options, Reading& reading) {
    if (!scene.is_object() || !scene.contains("import")) {
        if (!options.empty())
            throw UsageError(
                "--optic, --time and --animation are for glTF, which this scene imports none of");
        return;
    }
    check_import(scene, reading.file);
    const Json own = scene;
    Imports imports(options, reading);
    Json base = imports.read(own.at("import"));
    Json whole = Json::object();
    whole["version"] = own.value("version", Json(1));
    const std::size_t imported_cameras = base.at("cameras").size();
    for (const char* list : kNamedLists)
        if (own.contains(list)) {
            if (!own.at(list).is_array()) fail_at(reading.file, std::string("/") + list, "is no array");
            lay_over(base.at(list), own.at(list), list == std::string("cameras"));
        }
    shift_camera_tracks(base, base.at("cameras").size() - imported_cameras);
    whole.update(base);
    for (const auto& [key, value] : own.items()) {
        const bool is_list =
            std::find(std::begin(kNamedLists), std::end(kNamedLists), key) != std::end(kNamedLists);
        if (is_list || key == "import" || key == "version") continue;
        if (key == "animation" || !whole.contains(key))
            whole[key] = value;
        else
            whole[key].merge_patch(value);
    }
    const bool camera = whole.at("cameras").empty(), light = whole.at("lights").empty();
    const bool all_unlit =
        std::all_of(whole.at("materials").begin(), whole.at("materials").end(),
                    [](const Json& one) { return one.value("unlit", Json(false)) == true; });
    imports.add_studio(whole, camera, light && !all_unlit);
    if (camera) reading.warn("", "has no camera: one that shows all of it is added, 'whole'");
    if (light && !all_unlit) reading.warn("", "has no lights: 'key' and 'fill' are added");
    scene = std::move(whole);
}

}  // namespace trilens
