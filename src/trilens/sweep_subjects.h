// A cache of the scenes and renderers that a sweep's points need.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "sweep/store/results.h"
#include "trilens/render.h"
#include "trilens/sweep_axes.h"

namespace trilens {

/// What a plan needs to know of one scene.
struct SubjectFacts {
    std::string title;   // as messages name the scene
    std::string digest;  // of everything that decides its pictures
    std::vector<SweptOptic> optics;
    std::string camera;              // the one that is used
    bool has_camera_facets = false;  // its facets can be an axis
    Film film;
    std::size_t faces = 0;           // of the optics' cages
    std::vector<std::string> files;  // that the scene was read from
};

/// A renderer with what making it took.
struct LoadedSubject {
    Renderer renderer;
    std::size_t camera = 0;
    double seconds = 0;  // for surfaces and trees
};

/// Thread-safe. Scenes that differ by nothing are one; as many renderers are kept as are set.
class Subjects {
  public:
    Subjects(Warn warn, std::size_t kept) : warn_(std::move(warn)), kept_(kept) {}

    /// Throws as load_scene does, UsageError for its camera.
    const SubjectFacts& facts(const PointRequest& request);
    std::shared_ptr<const LoadedSubject> load(const PointRequest& request);

    /// The files of all scenes whose facts were asked for, each once.
    std::vector<std::string> files();

  private:
    void warn_once(const Scene& scene);

    struct Slot {
        std::mutex making;
        std::shared_ptr<const LoadedSubject> subject;
    };
    Warn warn_;
    std::size_t kept_;
    std::mutex mutex_;
    std::map<std::string, SubjectFacts> facts_;
    std::map<std::string, bool> warned_;
    std::deque<std::pair<std::string, std::shared_ptr<Slot>>> slots_;  // the last used first
};

}  // namespace trilens
