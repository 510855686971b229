#include "view/session.h"

#include <trilens/animation.h>
#include <trilens/error.h>
#include <trilens/utilities.h>

#include <algorithm>
#include <cmath>
#include <system_error>

namespace trilens {
namespace {

/// Keys of a JSON pointer (RFC 6901), unescaped.
std::vector<std::string> pointer_keys(const std::string& pointer) {
    if (pointer.empty() || pointer[0] != '/')
        throw UsageError("a JSON pointer begins with /, not \"" + pointer + "\"");
    std::vector<std::string> keys(1);
    for (std::size_t i = 1; i < pointer.size(); ++i) {
        if (pointer[i] == '/') {
            keys.emplace_back();
        } else if (pointer[i] == '~' && i + 1 < pointer.size() &&
                   (pointer[i + 1] == '0' || pointer[i + 1] == '1')) {
            keys.back() += pointer[++i] == '0' ? '~' : '/';
        } else {
            keys.back() += pointer[i];
        }
    }
    return keys;
}

std::optional<std::size_t> array_index(const std::string& key) {
    if (key.empty() || key.size() > 9 || key.find_first_not_of("0123456789") != std::string::npos)
        return std::nullopt;
    return static_cast<std::size_t>(std::stoul(key));
}

/// NaN and infinity, which no file can hold.
bool all_finite(const Json& value) {
    if (value.is_number_float()) return std::isfinite(value.get<double>());
    if (!value.is_structured()) return true;
    for (const Json& one : value)
        if (!all_finite(one)) return false;
    return true;
}

std::optional<FileStamp> stamp_of(const std::string& path) {
    std::error_code error;
    FileStamp stamp{path, std::filesystem::last_write_time(path, error), 0};
    if (error) return std::nullopt;
    stamp.size = std::filesystem::file_size(path, error);
    return error ? std::nullopt : std::optional(stamp);
}

void take_scene(Session& session, const Scene& scene) {
    session.now.scene = std::make_shared<const Json>(Json::parse(scene.resolved));
    session.file = scene_title(scene);
    session.folder = scene.folder;
    session.reach = scene_reach(scene);
    session.files.clear();
    for (const FileRead& file : scene.files)
        if (const auto stamp = stamp_of(file.path)) session.files.push_back(*stamp);
}

}  // namespace

double scene_reach(const Scene& scene) {
    if (scene.meshes.empty()) return 10;
    const Vec3 across = make_scene_info(scene).bounds.size();
    const double diagonal = std::sqrt(dot(across, across));
    return std::isfinite(diagonal) && diagonal > 1e-9 ? diagonal : 10;
}

Session open_session(const SceneRequest& request) {
    const Scene scene = load_scene(request);
    Session session;
    take_scene(session, scene);
    session.now.settings.frame.camera = scene.own_camera;
    if (const auto animation = find_animation(scene)) session.now.settings.time = animation->first;
    return session;
}

void reload(Session& session, const SceneRequest& request) {
    const Scene scene = load_scene(request);
    begin_change(session, "");
    take_scene(session, scene);
    if (session.now.settings.frame.camera >= scene.cameras.size())
        session.now.settings.frame.camera = scene.own_camera;
}

bool files_changed(Session& session) {
    bool changed = false;
    for (FileStamp& file : session.files) {
        const std::optional<FileStamp> now = stamp_of(file.path);
        if (!now || (now->written == file.written && now->size == file.size)) continue;
        file = *now;
        changed = true;
    }
    return changed;
}

std::string missing_file(const Session& session) {
    const auto missing = std::find_if(session.files.begin(), session.files.end(),
                                      [](const FileStamp& file) { return !stamp_of(file.path); });
    return missing == session.files.end() ? "" : missing->path;
}

void begin_change(Session& session, const std::string& gesture) {
    session.future.clear();
    if (!gesture.empty() && gesture == session.gesture) return;
    session.past.push_back(session.now);
    if (session.past.size() > kMostUndoSteps) session.past.erase(session.past.begin());
    session.gesture = gesture;
}

void end_gesture(Session& session) {
    session.gesture.clear();
}

bool undo(Session& session) {
    if (session.past.empty()) return false;
    session.future.push_back(std::move(session.now));
    session.now = std::move(session.past.back());
    session.past.pop_back();
    session.gesture.clear();
    return true;
}

bool redo(Session& session) {
    if (session.future.empty()) return false;
    session.past.push_back(std::move(session.now));
    session.now = std::move(session.future.back());
    session.future.pop_back();
    session.gesture.clear();
    return true;
}

void set_value(Session& session, const std::string& pointer, const Json& value) {
    if (!all_finite(value)) throw UsageError(pointer + ": not a finite number");
    auto scene = std::make_shared<Json>(*session.now.scene);
    Json* at = scene.get();
    for (const std::string& key : pointer_keys(pointer)) {
        if (at->is_object()) {
            at = &(*at)[key];
            if (at->is_null()) *at = Json::object();
        } else if (const auto index = array_index(key); at->is_array() && index && *index < at->size()) {
            at = &(*at)[*index];
        } else {
            throw UsageError("the scene has no " + pointer);
        }
    }
    *at = value;
    begin_change(session, "set " + pointer);
    session.now.scene = std::move(scene);
}

const Json* find_value(const Json& scene, const std::string& pointer) {
    const Json* at = &scene;
    for (const std::string& key : pointer_keys(pointer)) {
        const auto index = array_index(key);
        if (at->is_object() && at->contains(key))
            at = &at->at(key);
        else if (at->is_array() && index && *index < at->size())
            at = &at->at(*index);
        else
            return nullptr;
    }
    return at;
}

std::string session_text(const Session& session) {
    return session.now.scene->dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace trilens
