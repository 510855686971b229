// The viewer without its window: a session, the thread that draws it, and everything that a user can do to
// it.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "view/camera_moves.h"
#include "view/drawing_thread.h"
#include "view/numbers.h"
#include "view/session.h"

namespace trilens {

/// An animation, or a turntable, that runs.
struct Playing {
    bool runs = false;
    bool turns = false;  // the camera about the scene; else the scene's animation
    std::chrono::steady_clock::time_point last;
};

/// What goes wrong in an action stands in `message`, for the window to show; nothing is thrown.
class SceneViewer {
  public:
    /// Reads the scene and begins to draw it. Throws InputError as load_scene does.
    explicit SceneViewer(const SceneRequest& source);

    const Session& session() const { return session_; }
    const ViewSettings& settings() const { return session_.now.settings; }
    const Json& scene() const { return *session_.now.scene; }
    std::shared_ptr<const Drawn> drawn() const { return drawing_.latest(); }
    DrawingThread& drawing() { return drawing_; }
    const std::string& message() const { return message_; }
    double reach() const { return reach_; }

    /// Changes settings as one step of undo for each run of the same `gesture`.
    void change(const std::string& gesture, const ViewSettings& settings);
    /// Moves the chosen camera; written into the scene's JSON.
    void move(const CameraMove& move);
    /// Changes a number, or any value, of the scene.
    void set(const std::string& pointer, const Json& value);
    void release() { end_gesture(session_); }
    void undo_step();
    void redo_step();

    /// Reads the files again where one changed, once it is there; asked at most twice a second.
    void look_for_changes();
    /// Says which of the scene's files was gone when last looked for; empty: none.
    std::string gone() const;
    void reload_files();

    /// From now on a display server shows what is drawn, too. Throws as DisplayStream does.
    void show_on(const std::string& display_server);

    void play(bool runs, bool turns);
    bool is_playing() const { return playing_.runs; }
    /// Goes on with what plays: to where it is at this moment.
    void advance();

    /// By the ending: .json the scene with the camera as it is now, .exr and .png the picture with the film's
    /// own samples, .svg its outlines. Waits for the drawing. Whether it was saved; `message` says where, or
    /// why not.
    bool save(const std::string& file);
    /// The same, but failures are thrown: UsageError for other endings, OutputError.
    void save_or_throw(const std::string& file);

    /// Says something in the window, or clears it.
    void say(const std::string& message) { message_ = message; }
    /// What went wrong last: of an action, else of the newest drawing; empty: nothing.
    std::string error() const;

  private:
    template <typename Work>
    bool attempt(const Work& work);

    SceneRequest source_;
    Session session_;
    double reach_ = 10;
    std::string message_;
    bool failed_ = false;
    std::string gone_;
    Playing playing_;
    std::chrono::steady_clock::time_point looked_;
    DrawingThread drawing_;
};

}  // namespace trilens
