#include "trilens/sweep_subjects.h"

#include <algorithm>
#include <set>

#include "base/util/error.h"
#include "base/util/hash.h"
#include "base/util/progress.h"
#include "scene/data/scene_digest.h"

namespace trilens {
namespace {

/// Everything of a request that decides its scene and camera.
std::string key_of(const PointRequest& request) {
    std::string key = request.scene.file + "\n" + std::to_string(request.scene.resolution) + "\n" +
                      request.camera + "\n" + request.optic + "\n" + std::to_string(request.camera_facets) +
                      "\n";
    for (const SceneOverride& change : request.scene.overrides)
        key += change.pointer + "\n" + change.value + "\n" + (change.removes ? "-" : "+");
    for (const auto& [name, value] : request.of_optics) key += name + "\n" + value + "\n";
    return key;
}

SubjectFacts facts_of(const Scene& scene, const PointRequest& request) {
    const CameraDescription& camera = scene.cameras[find_camera(scene, request.camera)];
    SubjectFacts facts;
    facts.title = scene_title(scene);
    facts.camera = camera.name;
    facts.has_camera_facets = chooses_facets(camera);
    facts.digest = hash_text(scene.resolved + "\n" + scene_digest(scene));
    facts.film = scene.film;
    for (const FileRead& file : scene.files) facts.files.push_back(file.path);
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        if (scene.meshes[m].role != Role::kOptic) continue;
        facts.optics.push_back({static_cast<Id>(m), scene.meshes[m].name});
        facts.faces += std::max<std::size_t>(6, scene.meshes[m].face_count);
    }
    return facts;
}

}  // namespace

void Subjects::warn_once(const Scene& scene) {
    if (!warn_) return;
    for (const std::string& warning : scene.warnings)
        if (warned_.emplace(warning, true).second) warn_(warning);
}

const SubjectFacts& Subjects::facts(const PointRequest& request) {
    const std::string key = key_of(request);
    {
        const std::lock_guard guard(mutex_);
        const auto known = facts_.find(key);
        if (known != facts_.end()) return known->second;
    }
    const Scene scene = load_scene(request);
    SubjectFacts facts = facts_of(scene, request);
    const std::lock_guard guard(mutex_);
    warn_once(scene);
    return facts_.emplace(key, std::move(facts)).first->second;
}

std::vector<std::string> Subjects::files() {
    const std::lock_guard guard(mutex_);
    std::set<std::string> files;
    for (const auto& [key, facts] : facts_) files.insert(facts.files.begin(), facts.files.end());
    return {files.begin(), files.end()};
}

std::shared_ptr<const LoadedSubject> Subjects::load(const PointRequest& request) {
    const std::string key = key_of(request);
    std::shared_ptr<Slot> slot;
    {
        const std::lock_guard guard(mutex_);
        const auto known =
            std::ranges::find(slots_, key, &std::pair<std::string, std::shared_ptr<Slot>>::first);
        slot = known == slots_.end() ? std::make_shared<Slot>() : known->second;
        if (known != slots_.end()) slots_.erase(known);
        slots_.push_front({key, slot});
        while (slots_.size() > kept_) slots_.pop_back();
    }
    // One makes it, the others wait for it; other scenes are made meanwhile.
    const std::lock_guard guard(slot->making);
    if (slot->subject) return slot->subject;
    Scene scene = load_scene(request);
    const std::size_t camera = find_camera(scene, request.camera);
    const Stopwatch watch;
    Renderer renderer(std::move(scene), {});
    slot->subject =
        std::make_shared<const LoadedSubject>(LoadedSubject{std::move(renderer), camera, watch.seconds()});
    return slot->subject;
}

}  // namespace trilens
