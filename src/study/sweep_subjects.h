// A cache of the scenes and worlds that a sweep's points need; which scenes have what its axes vary, and what
// is done about those that have not.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "study/checked_world.h"
#include "study/sweep.h"
#include "sweep/store/results.h"

namespace trilens {

// A cache of the scenes and worlds that a sweep's points need.

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

/// A world with what making it took.
struct LoadedSubject {
    std::unique_ptr<const World> world;
    std::size_t camera = 0;
    double seconds = 0;  // for surfaces and trees
};

/// Thread-safe. Scenes that differ by nothing are one; as many worlds are kept as are set.
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

// Which of a sweep's scenes have what its axes vary, and what is done about those that have not.

/// What a plan needs to know of the point's scene. Throws as Subjects::facts does, InputError where nothing
/// in the scene could be swept: it has no optic, and no axis is its camera's facets.
const SubjectFacts& sweepable_facts(Subjects& subjects, const PointRequest& request);

/// The axes with camera-facets in the place of resolution, where the scene of `base` is a file without an
/// optic and its camera chooses its facets; said by `warn`. Else the axes as they are. Throws as
/// Subjects::facts does, UsageError for values that camera-facets cannot have.
SweepAxes axes_for_scene(const SweepAxes& axes, const PointRequest& base, Subjects& subjects,
                         const Warn& warn);

/// Takes the scenes out of an axis of scenes that lack what another axis varies (an optic, a camera, a place
/// in the file), each said by `warn`. Throws what is thrown for the first of them where none would be left,
/// and what load_scene throws for a scene that cannot be read whatever is varied.
std::vector<LeftOutScene> leave_out_scenes(SweepAxes& axes, const PointRequest& base, Subjects& subjects,
                                           const Warn& warn);

}  // namespace trilens
