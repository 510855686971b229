#include "view/viewer.h"

#include <trilens/animation.h>
#include <trilens/error.h>
#include <trilens/utilities.h>

#include <cmath>
#include <utility>

#include "view/display_stream.h"

namespace trilens {

using Clock = std::chrono::steady_clock;

namespace {

constexpr double kTurnSeconds = 12;  // of a turntable's whole turn

double seconds_between(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double>(to - from).count();
}

std::string camera_pointer(const ViewSettings& settings) {
    return "/cameras/" + std::to_string(settings.frame.camera);
}

}  // namespace

SceneViewer::SceneViewer(const SceneRequest& source) : source_(source), session_(open_session(source)) {
    reach_ = session_.reach;
    drawing_.ask(session_);
}

template <typename Work>
bool SceneViewer::attempt(const Work& work) {
    try {
        work();
        message_.clear();
        failed_ = false;
    } catch (const Error& error) {
        message_ = error.what();
        failed_ = true;
    }
    return !failed_;
}

void SceneViewer::change(const std::string& gesture, const ViewSettings& settings) {
    begin_change(session_, gesture);
    session_.now.settings = settings;
    message_.clear();
    failed_ = false;
    drawing_.ask(session_);
}

void SceneViewer::move(const CameraMove& move) {
    attempt([&] {
        const std::string pointer = camera_pointer(settings());
        const Json* camera = find_value(scene(), pointer);
        if (!camera) throw UsageError("the scene has no " + pointer);
        Json moved = *camera;
        move_camera(moved, move, reach_);
        set_value(session_, pointer, moved);
        drawing_.ask(session_);
    });
}

void SceneViewer::set(const std::string& pointer, const Json& value) {
    attempt([&] {
        set_value(session_, pointer, value);
        drawing_.ask(session_);
    });
}

void SceneViewer::undo_step() {
    if (undo(session_)) drawing_.ask(session_);
}

void SceneViewer::redo_step() {
    if (redo(session_)) drawing_.ask(session_);
}

void SceneViewer::reload_files() {
    attempt([&] {
        reload(session_, source_);
        reach_ = session_.reach;
        drawing_.ask(session_);
    });
}

void SceneViewer::look_for_changes() {
    const auto now = Clock::now();
    if (seconds_between(looked_, now) < 0.5) return;
    looked_ = now;
    const std::string missing = missing_file(session_);
    const std::string was = std::exchange(gone_, missing);
    if (files_changed(session_))
        reload_files();
    else if (!was.empty() && missing != was && !failed_)
        message_ = was + " is back, as it was";
}

std::string SceneViewer::gone() const {
    return gone_.empty() ? ""
                         : gone_ + " is gone: the scene is shown as it was, and read again once it is back";
}

void SceneViewer::show_on(const std::string& display_server) {
    const auto stream = std::make_shared<DisplayStream>(display_server, session_.file);
    drawing_.with_painter([&](Painter& painter) {
        painter.watch([stream](const StagePictures& stage, std::vector<std::string>& warnings) {
            stream->send(stage, warnings);
        });
    });
    drawing_.ask(session_);
}

void SceneViewer::play(bool runs, bool turns) {
    playing_ = {runs, turns, Clock::now()};
    end_gesture(session_);
}

void SceneViewer::advance() {
    const auto drawn = drawing_.latest();
    // A state that is not shown yet must be, or nothing would move.
    if (!playing_.runs || !drawn || !drawing_.is_shown()) return;
    const auto now = Clock::now();
    const double seconds = seconds_between(playing_.last, now);
    playing_.last = now;
    if (playing_.turns) {
        move({CameraMove::Kind::kOrbit, {360 * seconds / kTurnSeconds, 0, 0}});
        if (failed_) playing_.runs = false;
        return;
    }
    if (!drawn->animation) {
        message_ = "the scene has no animation";
        playing_.runs = false;
        return;
    }
    ViewSettings next = settings();
    const AnimationInfo& animation = *drawn->animation;
    next.time += seconds * animation.fps;
    if (next.time > animation.last)
        next.time = animation.first +
                    std::fmod(next.time - animation.last, std::max(animation.last - animation.first, 1e-9));
    change("play", next);
}

void SceneViewer::save_or_throw(const std::string& file) {
    const std::string ending = file_ending(file);
    if (ending == ".json") {
        replace_text_file(file, session_text(session_));
    } else if (ending == ".svg") {
        std::string svg;
        drawing_.with_painter([&](Painter& painter) { svg = painter.svg(); });
        replace_text_file(file, svg);
    } else if (ending == ".exr" || ending == ".png") {
        Image picture;
        drawing_.with_painter([&](Painter& painter) { picture = painter.picture(); });
        write_image(file, picture, settings().tone);
    } else {
        throw UsageError("\"" + file + "\" ends in none of .json, .exr, .png and .svg");
    }
}

bool SceneViewer::save(const std::string& file) {
    if (attempt([&] { save_or_throw(file); })) message_ = "saved " + file;
    return !failed_;
}

std::string SceneViewer::error() const {
    if (failed_) return message_;
    const auto drawn = drawing_.latest();
    return drawn ? drawn->error : "";
}

}  // namespace trilens
