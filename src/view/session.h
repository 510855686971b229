// A viewing session as plain data: the scene's JSON, what is shown of it, and the way back (undo by
// snapshots).
#pragma once

#include <trilens/image.h>
#include <trilens/render.h>
#include <trilens/scene.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "terminal/libraries.h"

namespace trilens {

/// What a side of the wipe shows. kProjected: the chosen engine's picture. kTruth: the ray trace of the exact
/// surfaces. kDifference: the absolute difference of the two. kDisplacement: how many pixels what is seen
/// lies from where the truth shows it. kFlip: the errors of FLIP.
enum class ShownPicture { kProjected, kTruth, kDifference, kDisplacement, kFlip };

template <>
struct EnumNames<ShownPicture> {
    static constexpr std::array kTable{NamedValue<ShownPicture>{ShownPicture::kProjected, "projected"},
                                       NamedValue<ShownPicture>{ShownPicture::kTruth, "truth"},
                                       NamedValue<ShownPicture>{ShownPicture::kDifference, "difference"},
                                       NamedValue<ShownPicture>{ShownPicture::kDisplacement, "displacement"},
                                       NamedValue<ShownPicture>{ShownPicture::kFlip, "flip"}};
};

/// Lines and tints over the picture.
struct Overlays {
    bool facets = false;    // outlines of the facets that pixels were projected through
    bool edges = false;     // of the objects, as the camera and the optics show them
    bool folds = false;     // curves where what the optics show turns over
    bool method = false;    // a tint: projected, part of a divided facet, traced
    bool caustics = false;  // in the bird\'s-eye view: where neighbouring rays behind the optics meet

    bool operator==(const Overlays&) const = default;
};

/// The second camera, which looks at the whole scene, the first camera and its paths: degrees about and above
/// the scene's middle, distance as a multiple of the scene's size.
struct BirdsEye {
    bool shown = false;
    double azimuth = 35, elevation = 35, distance = 1.15;

    bool operator==(const BirdsEye&) const = default;
};

/// A place of the scene named by where it is seen: a film place of the first camera, or of the bird's-eye
/// view.
struct PlacePick {
    bool in_birds_eye = false;
    Vec2 at{0};  // pixels of that picture, a pixel's centre at .5

    bool operator==(const PlacePick&) const = default;
};

/// All that is chosen beside the scene.
struct ViewSettings {
    FrameParams frame{.facets = FacetUse::kWorthwhile};  // as pictures are drawn everywhere
    Engine engine = Engine::kExact;
    ToneMapping tone;
    std::string layer;  // empty: the beauty; else "direct", "reflect", "refract"
    ShownPicture left = ShownPicture::kProjected, right = ShownPicture::kTruth;
    double wipe = 1;               // 0..1: the share of the film's width, from the left, that shows `left`
    double difference_scale = 10;  // by which differences are multiplied
    Overlays overlays;
    BirdsEye birds_eye;
    std::optional<Vec2> pixel;      // whose path is drawn: film, a pixel's centre at .5
    std::optional<Vec3> place;      // whose images are marked: world
    std::optional<PlacePick> pick;  // the place that it shows is the one, instead of `place`
    double time = 0;                // frame of the scene's animation

    /// Whether any of the picture shows this.
    bool shows(ShownPicture what) const { return (wipe > 0 && left == what) || (wipe < 1 && right == what); }
    /// Whether anything shown needs the truth.
    bool compares() const {
        return (wipe > 0 && left != ShownPicture::kProjected) ||
               (wipe < 1 && right != ShownPicture::kProjected);
    }
};

/// What undo brings back.
struct SessionState {
    std::shared_ptr<const Json> scene;  // never null
    ViewSettings settings;
};

/// A file as it was when it was read: when it was written last, and how long it was.
struct FileStamp {
    std::string path;
    std::filesystem::file_time_type written;
    std::uintmax_t size = 0;
};

struct Session {
    std::string file, folder;  // of the scene, as messages and relative paths have them
    double reach = 10;         // how large what it shows is: scene_reach
    SessionState now;
    std::vector<SessionState> past, future;
    std::string
        gesture;  // the name of the change that goes on; the next of that name is the same step of undo
    std::vector<FileStamp> files;  // that the scene was made of
};

inline constexpr std::size_t kMostUndoSteps = 200;

/// How large what a scene shows is: the diagonal of its bounds, scene units; 10 for a scene without any.
double scene_reach(const Scene& scene);

/// Reads a scene. Throws InputError as load_scene does.
Session open_session(const SceneRequest& request);

/// Reads the scene's files again, as they are now; one step of undo. Throws InputError where they hold no
/// scene: then nothing has changed.
void reload(Session& session, const SceneRequest& request);

/// Whether one of the files that the scene was made of was written since it was read; files that are not
/// there just now were not. What is seen becomes known, so that one change is told once.
bool files_changed(Session& session);

/// The first of the files that the scene was made of that is not there just now; empty: all are.
std::string missing_file(const Session& session);

/// Puts the present state into the past, before a change called `gesture`; a change that has the name of the
/// one before it goes on with that step, unless end_gesture was called between them.
void begin_change(Session& session, const std::string& gesture);
void end_gesture(Session& session);

/// False where there is nothing to go back, or forward, to.
bool undo(Session& session);
bool redo(Session& session);

/// Changes what a JSON pointer names; missing keys of objects are added, with the objects on the way. Throws
/// UsageError for a pointer that is none, leads through something that is no object or array, or beyond an
/// array's end, and for numbers that are not finite. Whether the result is a scene is told when it is drawn.
void set_value(Session& session, const std::string& pointer, const Json& value);

/// What a JSON pointer names; null where it names nothing.
const Json* find_value(const Json& scene, const std::string& pointer);

/// The scene as a file of its own would have it, ending in a line break.
std::string session_text(const Session& session);

}  // namespace trilens
