#include "view/script.h"

#include <trilens/error.h>
#include <trilens/utilities.h>

#include <algorithm>
#include <cmath>

namespace trilens {

using Clock = std::chrono::steady_clock;

namespace {

const std::vector<std::string> kActions{"orbit",  "look", "pan",        "dolly", "walk", "turntable",
                                        "set",    "show", "pixel",      "place", "pick", "wait",
                                        "save",   "time", "screenshot", "undo",  "redo", "reload",
                                        "random", "drag", "click",      "wheel"};

/// The step's one action.
std::string action_of(const Json& step) {
    std::string found;
    for (const auto& [key, value] : step.items()) {
        static const std::vector<std::string> kBeside{"frames", "value", "birdsEye", "button", "keys"};
        if (std::find(kBeside.begin(), kBeside.end(), key) != kBeside.end()) continue;
        if (std::find(kActions.begin(), kActions.end(), key) == kActions.end())
            throw UsageError("unknown action \"" + key + "\"" + suggestion(key, kActions));
        if (!found.empty()) throw UsageError("two actions in one step: " + found + " and " + key);
        found = key;
    }
    if (found.empty()) throw UsageError("a step without an action");
    return found;
}

constexpr double kPatience = 600;  // seconds for any one picture
constexpr double kSmallestDolly = 1e-6, kLargestDolly = 1e6;
constexpr int kMostStepFrames = 1'000'000;
constexpr double kMostSeed = 1e15;  // whole numbers up to there

int frames_of(const Json& step) {
    if (!step.contains("frames")) return 1;
    try {
        return count_in(step.at("frames"), kMostStepFrames);
    } catch (const UsageError& error) {
        throw UsageError(std::string("frames: ") + error.what());
    }
}

/// A move's share for one of several frames.
CameraMove move_of(const std::string& action, const Json& value, int frames) {
    using Kind = CameraMove::Kind;
    if (action == "dolly")
        return {Kind::kDolly,
                {std::pow(number_in(value, kSmallestDolly, kLargestDolly), 1.0 / frames), 0, 0}};
    if (action == "walk") {
        const auto by = numbers_in(value, 3);
        return {Kind::kWalk, Vec3(by[0], by[1], by[2]) / static_cast<double>(frames)};
    }
    const auto by = numbers_in(value, 2);
    const Kind kind = action == "orbit" ? Kind::kOrbit : action == "look" ? Kind::kLook : Kind::kPan;
    return {kind, Vec3(by[0], by[1], 0) / static_cast<double>(frames)};
}

bool is_move(const std::string& action) {
    static const std::vector<std::string> kMoves{"orbit", "look", "pan", "dolly", "walk", "turntable"};
    return std::find(kMoves.begin(), kMoves.end(), action) != kMoves.end();
}

/// Where a step's pointer goes from and to, and what is held meanwhile.
struct PointerStep {
    Vec2 from{0}, to{0};
    Pointer held;
};

PointerStep pointer_step(const Json& step, const std::string& action) {
    PointerStep found;
    const Json& value = step.at(action);
    if (action == "drag") {
        if (!value.is_array() || value.size() != 2) throw UsageError("needs two places, [[x, y], [x, y]]");
        const auto from = numbers_in(value[0], 2), to = numbers_in(value[1], 2);
        found = {Vec2(from[0], from[1]), Vec2(to[0], to[1]), {}};
    } else {
        const auto at = numbers_in(value, action == "wheel" ? 3 : 2);
        found.from = found.to = Vec2(at[0], at[1]);
        if (action == "wheel") found.held.wheel = at[2];
    }
    static const std::vector<std::string> kButtons{"left", "right", "middle"};
    const std::string button = step.contains("button") ? text_in(step.at("button")) : "left";
    const auto at = std::find(kButtons.begin(), kButtons.end(), button);
    if (at == kButtons.end())
        throw UsageError("unknown button \"" + button + "\"" + suggestion(button, kButtons));
    if (action != "wheel") found.held.button = static_cast<int>(at - kButtons.begin());
    const std::string keys = step.contains("keys") ? text_in(step.at("keys")) : "";
    found.held.ctrl = keys.find("ctrl") != std::string::npos;
    found.held.alt = keys.find("alt") != std::string::npos;
    found.held.shift = keys.find("shift") != std::string::npos;
    return found;
}

bool is_pointer(const std::string& action) {
    return action == "drag" || action == "click" || action == "wheel";
}

/// Throws UsageError for values that are none, where that can be told without a scene.
void check_step(const Json& step, const std::string& action) {
    const Json& value = step.at(action);
    const int frames = frames_of(step);
    if (is_pointer(action)) pointer_step(step, action);
    if (action == "turntable")
        count_in(value, kMostStepFrames);
    else if (is_move(action))
        move_of(action, value, frames);
    else if (action == "wait" && value != "done" && value != "picture")
        number_in(value, 0, kPatience);
    else if (action == "undo" || action == "redo")
        count_in(value, static_cast<int>(kMostUndoSteps));
    else if (action == "random")
        number_in(value, 0, kMostSeed);
    else if (action == "show" && value.is_object()) {
        Json apart = value;
        apart.erase("camera");
        shown_settings(apart, {}, Json());
    }
}

/// The frame of what is animated now. Throws UsageError where that has none such.
double frame_in(const Json& value, SceneViewer& viewer) {
    viewer.drawing().wait_shown(kPatience);
    const auto drawn = viewer.drawn();
    if (!drawn || !drawn->animation) throw UsageError("the scene has no animation");
    return number_in(value, drawn->animation->first, drawn->animation->last);
}

}  // namespace

Script::Script(const std::string& file, const std::string& text) : file_(file) {
    const Json all = Json::parse(text, nullptr, false);
    if (all.is_discarded()) throw InputError(file, "", "is no JSON");
    const bool is_object = all.is_object() && all.contains("steps");
    if (!is_object && !all.is_array()) throw InputError(file, "", "needs an array of \"steps\"");
    const Json& steps = is_object ? all.at("steps") : all;
    for (const Json& step : steps) {
        const std::string place = "/steps/" + std::to_string(steps_.size());
        if (!step.is_object()) throw InputError(file, place, "a step is an object");
        try {
            const std::string action = action_of(step);
            try {
                check_step(step, action);
            } catch (const UsageError& error) {
                throw UsageError(action + ": " + error.what());
            }
        } catch (const UsageError& error) {
            throw InputError(file, place, error.what());
        }
        steps_.push_back(step);
    }
}

bool Script::advance(SceneViewer& viewer) {
    if (at_ >= steps_.size()) return false;
    const Json& step = steps_[at_];
    const std::string action = action_of(step);
    if (frame_ == 0) begun_ = Clock::now();
    bool goes_on = false;
    try {
        goes_on = run(viewer, step);
    } catch (const UsageError& error) {
        throw InputError(file_, "/steps/" + std::to_string(at_), action + ": " + error.what());
    }
    ++frame_;
    if (goes_on) return true;
    const double seconds = std::chrono::duration<double>(Clock::now() - begun_).count();
    reports_.push_back({action, frame_, seconds, viewer.error()});
    viewer.release();
    ++at_;
    frame_ = 0;
    return at_ < steps_.size();
}

/// Each frame's picture is waited for when the next is due, so that a window is drawn meanwhile.
bool Script::run_moves(SceneViewer& viewer, const Json& step, const std::string& action) {
    const bool turns = action == "turntable";
    const int frames = turns ? count_in(step.at(action), kMostStepFrames) : frames_of(step);
    viewer.drawing().wait_shown(kPatience);
    viewer.move(turns ? CameraMove{CameraMove::Kind::kOrbit, {360.0 / frames, 0, 0}}
                      : move_of(action, step.at(action), frames));
    if (frame_ + 1 < frames) return true;
    viewer.drawing().wait_shown(kPatience);
    return false;
}

/// To the place, pressed there, dragged in so many frames, released.
bool Script::run_pointer(SceneViewer& viewer, const Json& step, const std::string& action) {
    const PointerStep pointer = pointer_step(step, action);
    const int frames = frames_of(step);
    Pointer now = pointer.held;
    const double share = std::clamp(static_cast<double>(frame_ - 1) / frames, 0.0, 1.0);
    now.at = pointer.from + share * (pointer.to - pointer.from);
    const bool is_over = frame_ >= frames + 2;
    if (frame_ == 0 || is_over) {
        now = {};
        now.at = is_over ? pointer.to : pointer.from;
    }
    if (action == "wheel" && frame_ != 1) now.wheel = 0;
    if (point) point(now);
    viewer.drawing().wait_shown(kPatience);
    return !is_over;
}

/// Any action with any number, many times: what a user could do who cares for nothing.
void Script::run_random(SceneViewer& viewer) {
    const auto next = [this](std::uint64_t below) {  // splitmix64
        random_ += 0x9e3779b97f4a7c15u;
        std::uint64_t z = random_;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return (z ^ (z >> 31)) % below;
    };
    const auto share = [&] { return static_cast<double>(next(2001)) / 1000 - 1; };
    // What is no scene is shown for a while, then taken back.
    if (!viewer.error().empty() && next(4) != 0) return viewer.undo_step();
    ViewSettings settings = viewer.settings();
    switch (next(12)) {
        case 0:
            viewer.move({CameraMove::Kind::kPan, {share(), share(), 0}});
            return;
        case 1:
            viewer.move({CameraMove::Kind::kDolly, {std::pow(2, share()), 0, 0}});
            return;
        case 2:
            viewer.move({CameraMove::Kind::kWalk, {share(), share(), share()}});
            return;
        case 3:
            viewer.move({CameraMove::Kind::kLook, {40 * share(), 40 * share(), 0}});
            return;
        case 4:
            viewer.undo_step();
            return;
        case 5:
            viewer.redo_step();
            return;
        case 6: {
            const std::vector<std::string> numbers = scene_numbers(viewer.scene());
            const std::string& pointer = numbers[next(numbers.size())];
            const Json* value = find_value(viewer.scene(), pointer);
            const double to = value->get<double>() * (1 + share()) + (next(3) == 0 ? share() : 0.0);
            viewer.set(pointer, value->is_number_integer() ? Json(std::llround(to)) : Json(to));
            return;
        }
        case 7:
            settings.pixel = Vec2(320 * (share() + 1), 240 * (share() + 1));
            break;
        case 8:
            settings.place = viewer.reach() * Vec3(share(), share(), share());
            break;
        case 9:
            settings.overlays = {next(2) == 0, next(2) == 0, next(2) == 0, next(2) == 0, next(2) == 0};
            break;
        case 10:
            settings.birds_eye.shown = !settings.birds_eye.shown;
            break;
        default:
            viewer.move({CameraMove::Kind::kOrbit, {90 * share(), 40 * share(), 0}});
            return;
    }
    viewer.change("random", settings);
}

bool Script::run(SceneViewer& viewer, const Json& step) {
    const std::string action = action_of(step);
    const Json& value = step.at(action);
    if (is_move(action)) return run_moves(viewer, step, action);
    if (is_pointer(action)) return run_pointer(viewer, step, action);
    ViewSettings settings = viewer.settings();
    if (action == "set") {
        if (!step.contains("value")) throw UsageError("needs a \"value\"");
        viewer.set(text_in(value), step.at("value"));
    } else if (action == "show") {
        viewer.change("", shown_settings(value, settings, viewer.scene()));
    } else if (action == "pixel") {
        settings.pixel.reset();
        if (!value.is_null()) settings.pixel = Vec2(numbers_in(value, 2)[0], numbers_in(value, 2)[1]);
        viewer.change("", settings);
    } else if (action == "place") {
        settings.place.reset();
        settings.pick.reset();
        if (!value.is_null()) {
            const auto at = numbers_in(value, 3);
            settings.place = Vec3(at[0], at[1], at[2]);
        }
        viewer.change("", settings);
    } else if (action == "pick") {
        settings.pick.reset();
        if (!value.is_null()) {
            const auto at = numbers_in(value, 2);
            settings.pick =
                PlacePick{step.contains("birdsEye") && flag_in(step.at("birdsEye")), Vec2(at[0], at[1])};
        }
        viewer.change("", settings);
    } else if (action == "time") {
        settings.time = frame_in(value, viewer);
        viewer.change("", settings);
    } else if (action == "wait") {
        if (value == "done")
            viewer.drawing().wait_done(kPatience);
        else if (value == "picture")
            viewer.drawing().wait_shown(kPatience);
        else
            viewer.drawing().wait_done(number_in(value, 0, kPatience));
    } else if (action == "screenshot") {
        if (screenshot) screenshot(text_in(value));
    } else if (action == "save") {
        viewer.save_or_throw(text_in(value));
    } else if (action == "undo" || action == "redo") {
        for (int i = count_in(value, static_cast<int>(kMostUndoSteps)); i > 0; --i)
            action == "undo" ? viewer.undo_step() : viewer.redo_step();
    } else if (action == "reload") {
        viewer.reload_files();
    } else if (action == "random") {
        if (frame_ == 0) random_ = static_cast<std::uint64_t>(number_in(value, 0, kMostSeed));
        run_random(viewer);
        if (random_ % 4 != 0) viewer.drawing().wait_shown(kPatience);
        return frame_ + 1 < frames_of(step);
    }
    return false;
}

}  // namespace trilens
