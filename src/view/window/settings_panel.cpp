#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "view/window/interface.h"

namespace trilens {
namespace {

/// A list of an enumeration's names; whether another was chosen. `none`: what stands first, for no choice.
template <typename E>
bool choose(const char* label, std::optional<E>& chosen, const char* none) {
    const std::vector<std::string> names = names_of<E>();
    int at = 0;
    std::string items = none ? std::string(none) + '\0' : "";
    for (std::size_t i = 0; i < names.size(); ++i) {
        items += names[i] + '\0';
        if (chosen && name_of(*chosen) == names[i]) at = static_cast<int>(i) + (none ? 1 : 0);
    }
    if (!ImGui::Combo(label, &at, (items + '\0').c_str())) return false;
    if (none && at == 0)
        chosen.reset();
    else
        chosen = find_named<E>(names[static_cast<std::size_t>(at - (none ? 1 : 0))]);
    return true;
}

template <typename E>
bool choose(const char* label, E& chosen) {
    std::optional<E> one = chosen;
    if (!choose(label, one, nullptr)) return false;
    chosen = *one;
    return true;
}

/// A line of text that is typed.
void type_text(const char* label, const char* hint, std::string& text) {
    std::array<char, 512> typed{};
    text.copy(typed.data(), typed.size() - 1);
    if (ImGui::InputTextWithHint(label, hint, typed.data(), typed.size())) text = typed.data();
}

/// A slider whose numbers are finite whatever is typed into it.
bool slide(const char* label, double& value, double least, double most, const char* format = "%.3g") {
    double next = value;
    if (!ImGui::SliderScalar(label, ImGuiDataType_Double, &next, &least, &most, format)) return false;
    if (!std::isfinite(next)) return false;
    value = next;
    return true;
}

void state_words(const SceneViewer& viewer, const InterfaceState& state) {
    const auto drawn = viewer.drawn();
    if (!drawn) return ImGui::TextDisabled("drawing the first picture ...");
    std::string stage = name_of(drawn->stage);
    if (drawn->stage == DrawStage::kCoarse && drawn->left)
        stage = fmt::format("coarse: {} x {}", drawn->left->width, drawn->left->height);
    ImGui::Text("%d x %d   %s   %.1f ms", drawn->film_width, drawn->film_height, stage.c_str(),
                1000 * drawn->draw_seconds);
    if (state.frames_per_second > 0)
        ImGui::SameLine(), ImGui::TextDisabled("  %.0f fps", state.frames_per_second);
    if (!drawn->comparison) return;
    const ShownComparison& known = *drawn->comparison;
    ImGui::Text("rmse %.3g   FLIP %.3g   ssim %.4f", known.metrics.rmse, known.metrics.flip,
                known.metrics.ssim);
    if (known.displacement)
        ImGui::TextWrapped("displacement mean %.3g, p95 %.3g px, lost %zu", known.displacement->mean,
                           known.displacement->p95, known.lost);
}

void camera_choice(SceneViewer& viewer) {
    const Json& cameras = viewer.scene().at("cameras");
    ViewSettings next = viewer.settings();
    const auto name = [&](std::size_t i) {
        return cameras[i].value("name", "camera " + std::to_string(i)) + " (" +
               cameras[i].value("type", "perspective") + ")";
    };
    const std::size_t now = std::min(next.frame.camera, cameras.size() - 1);
    if (!ImGui::BeginCombo("camera", name(now).c_str())) return;
    for (std::size_t i = 0; i < cameras.size(); ++i)
        if (ImGui::Selectable((name(i) + "##" + std::to_string(i)).c_str(), i == now)) {
            next.frame.camera = i;
            viewer.change("", next);
        }
    ImGui::EndCombo();
}

void projection(SceneViewer& viewer) {
    if (!ImGui::CollapsingHeader("projection", ImGuiTreeNodeFlags_DefaultOpen)) return;
    ViewSettings next = viewer.settings();
    camera_choice(viewer);
    if (ImGui::SliderInt("n", &next.frame.resolution, 0, 128, next.frame.resolution == 0 ? "scene's" : "%d",
                         ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp))
        viewer.change("n", next);
    if (choose("engine", next.engine)) viewer.change("engine", next);
    if (choose("rays", next.frame.rays, "scene's")) viewer.change("rays", next);
    if (choose("grid", next.frame.grid, "scene's")) viewer.change("grid", next);
    if (choose("facets' use", next.frame.facets)) viewer.change("use", next);
    double error = next.frame.max_error.value_or(0);
    if (slide("max error (px)", error, 0, 8, error > 0 ? "%.2f" : "scene's")) {
        next.frame.max_error = error > 0 ? std::optional(error) : std::nullopt;
        viewer.change("max error", next);
    }
    const Json* depth = find_value(viewer.scene(), "/render/maxDepth");
    int deep = depth && depth->is_number() ? depth->get<int>() : RenderSettings().max_depth;
    if (ImGui::SliderInt("max depth", &deep, 0, kMostDepth, "%d", ImGuiSliderFlags_AlwaysClamp))
        viewer.set("/render/maxDepth", deep);
}

void colours(SceneViewer& viewer) {
    if (!ImGui::CollapsingHeader("colours", ImGuiTreeNodeFlags_DefaultOpen)) return;
    ViewSettings next = viewer.settings();
    if (slide("exposure", next.tone.exposure, -10, 10, "%.2f")) viewer.change("exposure", next);
    int curve = static_cast<int>(next.tone.curve);
    if (ImGui::Combo("tone", &curve, "none\0reinhard\0aces\0neutral\0")) {
        next.tone.curve = static_cast<ToneCurve>(curve);
        viewer.change("tone", next);
    }
    static const char* kLayers[] = {"", "direct", "reflect", "refract"};
    int layer = 0;
    for (int i = 0; i < 4; ++i)
        if (next.layer == kLayers[i]) layer = i;
    if (ImGui::Combo("layer", &layer, "beauty\0direct\0reflect\0refract\0")) {
        next.layer = kLayers[layer];
        viewer.change("layer", next);
    }
}

void comparison(SceneViewer& viewer) {
    if (!ImGui::CollapsingHeader("comparison", ImGuiTreeNodeFlags_DefaultOpen)) return;
    ViewSettings next = viewer.settings();
    if (choose("left", next.left)) viewer.change("left", next);
    if (choose("right", next.right)) viewer.change("right", next);
    if (slide("wipe", next.wipe, 0, 1, "%.2f")) viewer.change("wipe", next);
    if ((next.left == ShownPicture::kDifference || next.right == ShownPicture::kDifference) &&
        slide("times", next.difference_scale, 1, 100, "%.0f"))
        viewer.change("scale", next);
}

void overlays(SceneViewer& viewer) {
    if (!ImGui::CollapsingHeader("overlays", ImGuiTreeNodeFlags_DefaultOpen)) return;
    ViewSettings next = viewer.settings();
    bool changed = ImGui::Checkbox("facets", &next.overlays.facets);
    ImGui::SameLine();
    changed = ImGui::Checkbox("edges", &next.overlays.edges) || changed;
    ImGui::SameLine();
    changed = ImGui::Checkbox("folds", &next.overlays.folds) || changed;
    ImGui::SameLine();
    changed = ImGui::Checkbox("method", &next.overlays.method) || changed;
    if (ImGui::Checkbox("caustics", &next.overlays.caustics)) {
        next.birds_eye.shown = next.birds_eye.shown || next.overlays.caustics;
        changed = true;
    }
    ImGui::SameLine();
    changed = ImGui::Checkbox("bird's eye", &next.birds_eye.shown) || changed;
    ImGui::SameLine();
    if (ImGui::Button("clear marks")) {
        next.pixel.reset();
        next.place.reset();
        next.pick.reset();
        changed = true;
    }
    if (changed) viewer.change("", next);
}

void one_number(SceneViewer& viewer, InterfaceState& state) {
    const std::string& pointer = state.chosen_number;
    const Json* found = find_value(viewer.scene(), pointer);
    if (!found || !found->is_number()) return;
    const NumberRange range = number_range(viewer.scene(), pointer);
    double value = found->get<double>();
    // The slider's ends stay where they are while it is dragged.
    if (!state.slides) state.span = slider_span(range, value);
    ImGui::TextWrapped("%s", pointer.c_str());
    if (!range.help.empty()) ImGui::TextDisabled("%.60s", range.help.c_str());
    ImGui::SetNextItemWidth(-1);
    const bool changed =
        slide("##value", value, state.span.least, state.span.most, range.whole ? "%.0f" : "%.5g");
    state.slides = ImGui::IsItemActive();
    if (changed)
        viewer.set(pointer, range.whole ? Json(static_cast<long long>(std::llround(value))) : Json(value));
}

void numbers(SceneViewer& viewer, InterfaceState& state) {
    if (!ImGui::CollapsingHeader("numbers of the scene", ImGuiTreeNodeFlags_DefaultOpen)) return;
    if (!state.chosen_number.empty()) one_number(viewer, state);
    ImGui::SetNextItemWidth(-1);
    type_text("##filter", "part of a JSON pointer", state.number_filter);
    ImGui::BeginChild("list", {0, 110}, true);
    for (const std::string& pointer : scene_numbers(viewer.scene()))
        if (pointer.find(state.number_filter) != std::string::npos &&
            ImGui::Selectable(pointer.c_str(), pointer == state.chosen_number))
            state.chosen_number = pointer;
    ImGui::EndChild();
}

void lists(const SceneViewer& viewer) {
    const auto drawn = viewer.drawn();
    if (drawn && ImGui::CollapsingHeader("optics"))
        for (const OpticInfo& optic : drawn->optics)
            ImGui::Text("%s: %s, n %d, %zu faces", optic.name.c_str(), optic.mirror ? "mirror" : "glass",
                        optic.resolution, optic.faces);
    if (!viewer.scene().contains("materials") || !ImGui::CollapsingHeader("materials")) return;
    for (const Json& material : viewer.scene().at("materials"))
        ImGui::TextWrapped("%s: %s", material.value("name", "").c_str(),
                           material.contains("kind") ? material.value("kind", "").c_str()
                                                     : material.value("type", "").c_str());
}

void files_and_time(SceneViewer& viewer, InterfaceState& state) {
    if (!ImGui::CollapsingHeader("time and files", ImGuiTreeNodeFlags_DefaultOpen)) return;
    const auto drawn = viewer.drawn();
    if (drawn && drawn->animation) {
        ViewSettings next = viewer.settings();
        if (slide("frame", next.time, drawn->animation->first, drawn->animation->last, "%.1f"))
            viewer.change("frame", next);
        if (ImGui::Button("play")) viewer.play(true, false);
        ImGui::SameLine();
    }
    if (ImGui::Button("turntable")) viewer.play(true, true);
    ImGui::SameLine();
    if (ImGui::Button("stop")) viewer.play(false, false);
    ImGui::SetNextItemWidth(-60);
    type_text("##save", ".json .exr .png .svg", state.save_name);
    ImGui::SameLine();
    if (ImGui::Button("save")) viewer.save(state.save_name);
    if (ImGui::Button("undo")) viewer.undo_step();
    ImGui::SameLine();
    if (ImGui::Button("redo")) viewer.redo_step();
    ImGui::SameLine();
    if (ImGui::Button("reload")) viewer.reload_files();
}

}  // namespace

void settings_panel(SceneViewer& viewer, InterfaceState& state) {
    state_words(viewer, state);
    ImGui::PushItemWidth(170);
    projection(viewer);
    colours(viewer);
    comparison(viewer);
    overlays(viewer);
    files_and_time(viewer, state);
    numbers(viewer, state);
    lists(viewer);
    ImGui::PopItemWidth();
}

}  // namespace trilens
