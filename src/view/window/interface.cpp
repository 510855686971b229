#include "view/window/interface.h"

#include <imgui.h>

#include <algorithm>

namespace trilens {
namespace {

constexpr float kPanelWidth = 330;

/// Dear ImGui before 1.87 counts keys as the window system does.
auto key_of(ImGuiKey key) {
#if IMGUI_VERSION_NUM < 18700
    return ImGui::GetKeyIndex(key);
#else
    return key;
#endif
}

void keyboard(SceneViewer& viewer) {
    const ImGuiIO& io = ImGui::GetIO();
    if (io.WantTextInput) return;
    const bool z = ImGui::IsKeyPressed(key_of(ImGuiKey_Z));
    if (io.KeyCtrl && z) io.KeyShift ? viewer.redo_step() : viewer.undo_step();
    if (io.KeyCtrl && ImGui::IsKeyPressed(key_of(ImGuiKey_Y))) viewer.redo_step();
    const float step = io.KeyShift ? 0.1f : 0.02f;
    Vec3 walk(0);
    if (ImGui::IsKeyDown(key_of(ImGuiKey_UpArrow))) walk.z += step;
    if (ImGui::IsKeyDown(key_of(ImGuiKey_DownArrow))) walk.z -= step;
    if (ImGui::IsKeyDown(key_of(ImGuiKey_RightArrow))) walk.x += step;
    if (ImGui::IsKeyDown(key_of(ImGuiKey_LeftArrow))) walk.x -= step;
    if (walk != Vec3(0) && viewer.drawing().is_shown()) viewer.move({CameraMove::Kind::kWalk, walk});
}

/// What went wrong, or what the pictures leave out; the last good picture stays beside it.
void messages(const SceneViewer& viewer) {
    const std::string error = viewer.error();
    const auto drawn = viewer.drawn();
    if (!error.empty()) {
        ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1, 0.45f, 0.4f, 1));
        ImGui::TextWrapped("%s", error.c_str());
        ImGui::PopStyleColor();
    } else if (!viewer.gone().empty()) {
        ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1, 0.85f, 0.4f, 1));
        ImGui::TextWrapped("%s", viewer.gone().c_str());
        ImGui::PopStyleColor();
    } else if (!viewer.message().empty()) {
        ImGui::TextWrapped("%s", viewer.message().c_str());
    } else if (drawn && !drawn->warnings.empty()) {
        ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1, 0.85f, 0.4f, 1));
        ImGui::TextWrapped("%s", drawn->warnings.front().c_str());
        ImGui::PopStyleColor();
    } else {
        ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
        ImGui::TextWrapped(
            "%s",
            "drag: orbit   right: look   middle, shift: pan   wheel: dolly   arrows: walk   ctrl-click: path "
            "of a "
            "pixel   alt-click: images of a place   ctrl-Z: undo");
        ImGui::PopStyleColor();
    }
}

}  // namespace

PicturePlace fitted_picture(float x, float y, float width, float height, int film_width, int film_height) {
    PicturePlace place{x, y, width, height, std::max(film_width, 1), std::max(film_height, 1)};
    const float scale = std::min(width / static_cast<float>(place.film_width),
                                 height / static_cast<float>(place.film_height));
    place.width = std::max(1.0f, scale * static_cast<float>(place.film_width));
    place.height = std::max(1.0f, scale * static_cast<float>(place.film_height));
    place.x += (width - place.width) / 2;
    place.y += (height - place.height) / 2;
    return place;
}

void build_interface(SceneViewer& viewer, InterfaceState& state, TextureStore& textures) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    keyboard(viewer);
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize(size);
    ImGui::Begin("trilens", nullptr,
                 ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus |
                     ImGuiWindowFlags_NoScrollWithMouse);
    const ImVec2 inside = ImGui::GetContentRegionAvail();
    const float words = 2.4f * ImGui::GetTextLineHeightWithSpacing();
    const float left = std::max(40.0f, inside.x - kPanelWidth - ImGui::GetStyle().ItemSpacing.x);
    ImGui::BeginChild("pictures", {left, 0}, false,
                      ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse);
    const bool both = viewer.settings().birds_eye.shown;
    const float height = std::max(20.0f, inside.y - words);
    picture_area(viewer, state, textures, both ? 0.62f * height : height);
    if (both) birds_eye_area(viewer, textures, 0.38f * height - ImGui::GetStyle().ItemSpacing.y);
    messages(viewer);
    ImGui::EndChild();
    ImGui::SameLine();
    ImGui::BeginChild("settings", {0, 0}, true);
    settings_panel(viewer, state);
    ImGui::EndChild();
    ImGui::End();
    if (!state.is_scripted && !ImGui::IsAnyMouseDown() && !ImGui::IsAnyItemActive() &&
        !ImGui::GetIO().WantTextInput)
        viewer.release();
}

}  // namespace trilens
