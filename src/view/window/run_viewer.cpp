#include "view/window/run_viewer.h"

#include <imgui.h>
#include <trilens/error.h>
#include <trilens/image.h>
#include <trilens/utilities.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iterator>
#include <optional>

#include "cli/options.h"
#include "view/script.h"
#include "view/window/gl_screen.h"
#include "view/window/memory_screen.h"

namespace trilens {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point from) {
    return std::chrono::duration<double>(Clock::now() - from).count();
}

class ImGuiContextOwner {
  public:
    ImGuiContextOwner() {
        IMGUI_CHECKVERSION();
        ImGui::CreateContext();
        ImGui::GetIO().IniFilename = nullptr;  // nothing is written that nobody asked for
        ImGui::StyleColorsDark();
    }
    ~ImGuiContextOwner() { ImGui::DestroyContext(); }
    ImGuiContextOwner(const ImGuiContextOwner&) = delete;
    ImGuiContextOwner& operator=(const ImGuiContextOwner&) = delete;
};

struct WindowSize {
    int width = 1280, height = 800;
};

WindowSize window_size(const std::string& text) {
    if (text.empty()) return {};
    const std::vector<int> size = parse_integers(text, 'x', 2, "--window-size");
    if (size[0] < 1 || size[1] < 1 || size[0] > 8192 || size[1] > 8192)
        throw UsageError("--window-size: from 1x1 to 8192x8192, not " + text);
    return {size[0], size[1]};
}

/// Gives ImGui a hand on the mouse, as its backends do.
void give_pointer(const Pointer& pointer) {
    ImGuiIO& io = ImGui::GetIO();
    const ImVec2 at(static_cast<float>(pointer.at.x), static_cast<float>(pointer.at.y));
#if IMGUI_VERSION_NUM < 18700
    io.MousePos = at;
    for (int button = 0; button < 3; ++button) io.MouseDown[button] = button == pointer.button;
    io.MouseWheel = static_cast<float>(pointer.wheel);
    io.KeyCtrl = pointer.ctrl;
    io.KeyAlt = pointer.alt;
    io.KeyShift = pointer.shift;
#else
    io.AddKeyEvent(ImGuiMod_Ctrl, pointer.ctrl);
    io.AddKeyEvent(ImGuiMod_Alt, pointer.alt);
    io.AddKeyEvent(ImGuiMod_Shift, pointer.shift);
    io.AddMousePosEvent(at.x, at.y);
    for (int button = 0; button < 3; ++button) io.AddMouseButtonEvent(button, button == pointer.button);
    if (pointer.wheel != 0) io.AddMouseWheelEvent(0, static_cast<float>(pointer.wheel));
#endif
}

/// One frame of the interface in memory; its pixels where they are wanted.
class MemoryWindow {
  public:
    explicit MemoryWindow(const WindowSize& size) {
        ImGuiIO& io = ImGui::GetIO();
        io.DisplaySize = {static_cast<float>(size.width), static_cast<float>(size.height)};
        io.DeltaTime = 1.0f / 60;
        io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;  // more than 65536 corners
    }
    void frame(SceneViewer& viewer, InterfaceState& state) {
        ImGui::NewFrame();
        build_interface(viewer, state, textures_);
        ImGui::Render();
    }
    Pixels screenshot() const { return rasterize_interface(*ImGui::GetDrawData(), textures_); }

  private:
    MemoryTextures textures_;
};

struct ViewerRun {
    Clock::time_point begun = Clock::now();
    std::optional<double> first_picture;  // seconds from the beginning until it was on the screen
    std::size_t window_frames = 0;
    std::vector<std::string> written;
    std::string gl;  // empty: no window

    void saw(const SceneViewer& viewer) {
        ++window_frames;
        const auto drawn = viewer.drawn();
        if (!first_picture && drawn && drawn->left) first_picture = seconds_since(begun);
    }
};

void window_frame(GlScreen& screen, SceneViewer& viewer, InterfaceState& state, ViewerRun& run,
                  Pixels* read = nullptr) {
    if (!screen.has_pixels()) return;
    screen.begin_frame();
    ImGui::NewFrame();
    build_interface(viewer, state, screen.textures());
    ImGui::Render();
    screen.show(*ImGui::GetDrawData(), read);
    run.saw(viewer);
    state.frames_per_second = static_cast<double>(ImGui::GetIO().Framerate);
}

void write_screenshot(const Pixels& pixels, const std::string& file, ViewerRun& run) {
    if (pixels.empty()) throw OutputError(file, "the window has no pixels");
    write_image(file, image_of(pixels));
    run.written.push_back(file);
}

Json path_json(const PathLine& path) {
    Json json{{"path", path.word}, {"weight", {path.weight.x, path.weight.y, path.weight.z}}};
    json["corners"] = Json::array();
    for (const PathCorner& corner : path.corners)
        json["corners"].push_back({{"event", corner.event},
                                   {"name", corner.name},
                                   {"point", {corner.point.x, corner.point.y, corner.point.z}}});
    return json;
}

Json shown_json(const Drawn& drawn) {
    Json json{{"stage", name_of(drawn.stage)}, {"film", {drawn.film_width, drawn.film_height}}};
    if (drawn.comparison) {
        json["rmse"] = json_number(drawn.comparison->metrics.rmse);
        json["flip"] = json_number(drawn.comparison->metrics.flip);
        if (drawn.comparison->displacement)
            json["displacement_mean"] = json_number(drawn.comparison->displacement->mean);
    }
    if (drawn.pixel_paths)
        for (const PathLine& path : *drawn.pixel_paths) json["pixel_paths"].push_back(path_json(path));
    if (drawn.place_images)
        for (const PlaceImage& image : drawn.place_images->images)
            json["place_images"].push_back({{"pixel", {image.pixel.x, image.pixel.y}},
                                            {"path", image.line.word},
                                            {"visible", image.visible}});
    return json;
}

double percentile(std::vector<double> values, double percent) {
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end());
    return values[static_cast<std::size_t>((static_cast<double>(values.size()) - 1) * percent / 100)];
}

/// What the window has shown of what goes on without: a display server that went away.
void warn_of(const SceneViewer& viewer, Console& console) {
    if (const auto drawn = viewer.drawn())
        for (const std::string& warning : drawn->warnings) console.warn(warning);
}

Answer answer_of(SceneViewer& viewer, const Script* script, const ViewerRun& run) {
    Answer answer;
    answer.is_report = true;
    const DrawTimes times = viewer.drawing().times();
    answer.fields["seconds"] = seconds_since(run.begun);
    answer.fields["first_picture_seconds"] = run.first_picture ? Json(*run.first_picture) : Json();
    answer.fields["pictures"] = times.pictures;
    answer.fields["window_frames"] = run.window_frames;
    answer.fields["opengl"] = run.gl;
    answer.fields["latency"] = {{"p50", percentile(times.latencies, 50)},
                                {"p95", percentile(times.latencies, 95)},
                                {"max", percentile(times.latencies, 100)}};
    answer.fields["error"] = viewer.error();
    answer.fields["written"] = run.written;
    if (const auto drawn = viewer.drawn()) answer.fields["shown"] = shown_json(*drawn);
    answer.fields["steps"] = Json::array();
    if (!script) return answer;
    for (const StepReport& step : script->reports()) {
        answer.fields["steps"].push_back({{"action", step.action},
                                          {"frames", step.frames},
                                          {"seconds", step.seconds},
                                          {"frames_per_second", step.frames / std::max(step.seconds, 1e-9)},
                                          {"error", step.error}});
        if (step.frames > 1)
            answer.text += fmt::format("{}: {} frames, {:.1f} a second\n", step.action, step.frames,
                                       step.frames / std::max(step.seconds, 1e-9));
    }
    for (const std::string& file : run.written) answer.text += file + "\n";
    return answer;
}

std::string script_text(const std::string& file) {
    if (file.empty()) return "[]";
    if (is_standard_stream(file)) return standard_input("a script is");
    std::ifstream in(file, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    if (!in) throw InputError(file, "", "cannot be read");
    return text;
}

}  // namespace

Answer run_viewer(const ViewOptions& options, Console& console) {
    const Clock::time_point begun = Clock::now();
    console.files().reads({options.scene.scene, options.script});
    console.files().writes(options.screenshot);
    const bool is_scripted = !options.script.empty() || !options.screenshot.empty();
    const WindowSize size = window_size(options.window_size);
    std::optional<Script> script;
    if (is_scripted) script.emplace(options.script, script_text(options.script));

    const ImGuiContextOwner context;
    std::optional<GlScreen> screen;
    std::optional<MemoryWindow> memory;
    if (!is_scripted || options.window)
        screen.emplace(size.width, size.height, "trilens: " + options.scene.scene);
    else
        memory.emplace(size);

    SceneViewer viewer(scene_request(options.scene));
    ViewSettings first = viewer.settings();
    if (!options.scene.camera.empty()) {
        const Json name = options.scene.camera;
        viewer.change("", shown_settings({{"camera", name}}, first, viewer.scene()));
    }
    if (!options.display_server.empty()) viewer.show_on(options.display_server);
    InterfaceState state;
    state.is_scripted = is_scripted;
    ViewerRun run;
    run.begun = begun;
    if (screen) run.gl = screen->renderer_name();
    const auto frame = [&](Pixels* read = nullptr) {
        if (screen) {
            screen->take_input(0);
            window_frame(*screen, viewer, state, run, read);
        } else {
            memory->frame(viewer, state);
            run.saw(viewer);
            if (read) *read = memory->screenshot();
        }
    };
    const auto take_screenshot = [&](const std::string& file) {
        Pixels pixels;
        frame();  // sizes are known after the first
        frame(&pixels);
        write_screenshot(pixels, file, run);
    };

    if (is_scripted) {
        if (screen) screen->wait_for_display(false);
        script->screenshot = take_screenshot;
        script->point = [&](const Pointer& pointer) {
            give_pointer(pointer);
            frame();
        };
        viewer.drawing().wait_shown(60);
        frame();
        while (script->advance(viewer) && !stop_requested()) frame();
        if (!options.screenshot.empty()) {
            viewer.drawing().wait_done(600);
            take_screenshot(options.screenshot);
        }
        warn_of(viewer, console);
        return answer_of(viewer, &*script, run);
    }
    viewer.drawing().notify([] { GlScreen::wake(); });
    while (!screen->wants_close() && !stop_requested()) {
        const std::string was_gone = viewer.gone();
        viewer.look_for_changes();
        if (!viewer.gone().empty() && viewer.gone() != was_gone) console.warn(viewer.gone());
        viewer.advance();
        // Where nothing moves, neither user nor picture, the window sleeps.
        screen->take_input(viewer.is_playing() || ImGui::IsAnyMouseDown() ? 0.004 : 0.25);
        window_frame(*screen, viewer, state, run);
    }
    viewer.drawing().notify({});
    warn_of(viewer, console);
    return answer_of(viewer, nullptr, run);
}

}  // namespace trilens
