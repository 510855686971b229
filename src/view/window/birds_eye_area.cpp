#include <imgui.h>

#include <algorithm>

#include "view/window/interface.h"

namespace trilens {
namespace {

ImU32 colour_of(const DrawnLine& line) {
    const int alpha = 90 + static_cast<int>(165 * std::clamp(line.weight, 0.0, 1.0));
    if (line.kind == DrawnLine::Kind::kCamera) return IM_COL32(255, 255, 255, 120);
    if (line.kind == DrawnLine::Kind::kPlacePath)
        return line.in_glass ? IM_COL32(255, 150, 40, alpha) : IM_COL32(255, 220, 40, alpha);
    return line.in_glass ? IM_COL32(60, 255, 170, alpha) : IM_COL32(90, 200, 255, alpha);
}

void draw_lines_in(const PicturePlace& place, const ShownBirdsEye& shown) {
    ImDrawList* lines = ImGui::GetWindowDrawList();
    std::vector<ImVec2> points;
    for (const DrawnLine& line : shown.lines) {
        points.clear();
        for (const Vec2& film : line.points) {
            const Vec2 at = place.on_screen(film);
            points.emplace_back(static_cast<float>(at.x), static_cast<float>(at.y));
        }
        const float width = line.kind == DrawnLine::Kind::kCamera
                                ? 1.0f
                                : 1.2f + 2.3f * static_cast<float>(std::clamp(line.weight, 0.0, 1.0));
        lines->AddPolyline(points.data(), static_cast<int>(points.size()), colour_of(line), 0, width);
    }
    if (!shown.place) return;
    const Vec2 at = place.on_screen(*shown.place);
    lines->AddCircleFilled({static_cast<float>(at.x), static_cast<float>(at.y)}, 5,
                           IM_COL32(255, 220, 40, 255));
}

std::string medium_name(const Drawn& drawn, Id medium) {
    return medium < drawn.optics.size() ? drawn.optics[medium].name : "air";
}

void path_words(const Drawn& drawn, const PathLine& path) {
    ImGui::TextColored(ImVec4(0.55f, 0.85f, 1, 1), "%s   weight %.4g %.4g %.4g",
                       path.word.empty() ? "direct" : path.word.c_str(), path.weight.x, path.weight.y,
                       path.weight.z);
    for (const PathCorner& corner : path.corners)
        ImGui::Text("  %s %s (%.3f, %.3f, %.3f)%s", corner.event.c_str(), corner.name.c_str(), corner.point.x,
                    corner.point.y, corner.point.z,
                    corner.medium == kNone ? "" : (", in " + medium_name(drawn, corner.medium)).c_str());
}

void mouse_on_birds_eye(SceneViewer& viewer, const PicturePlace& place) {
    const ImGuiIO& io = ImGui::GetIO();
    ViewSettings next = viewer.settings();
    if (ImGui::IsItemHovered() && io.MouseWheel != 0) {
        next.birds_eye.distance =
            std::clamp(next.birds_eye.distance * (io.MouseWheel > 0 ? 0.9 : 1 / 0.9), 0.05, 20.0);
        viewer.change("bird's eye", next);
    }
    if (ImGui::IsItemActivated() && io.KeyAlt) {
        next.pick = PlacePick{true, place.on_film({io.MousePos.x, io.MousePos.y})};
        viewer.change("", next);
    } else if (ImGui::IsItemActive() && !io.KeyAlt && (io.MouseDelta.x != 0 || io.MouseDelta.y != 0)) {
        next.birds_eye.azimuth -= 0.4 * static_cast<double>(io.MouseDelta.x);
        next.birds_eye.elevation =
            std::clamp(next.birds_eye.elevation + 0.4 * static_cast<double>(io.MouseDelta.y), -89.0, 89.0);
        viewer.change("bird's eye", next);
    }
}

}  // namespace

void birds_eye_area(SceneViewer& viewer, TextureStore& textures, float height) {
    const auto drawn = viewer.drawn();
    const ImVec2 from = ImGui::GetCursorScreenPos();
    const float all = ImGui::GetContentRegionAvail().x, width = std::min(0.6f * all, height * 4 / 3);
    if (width < 2 || height < 2) return;
    ImGui::InvisibleButton("bird's eye", {width, height});
    if (drawn && drawn->birds_eye) {
        const auto shown = drawn->birds_eye;
        const PicturePlace place =
            fitted_picture(from.x, from.y, width, height, shown->picture.width, shown->picture.height);
        const std::uintptr_t texture =
            textures.texture(3, std::shared_ptr<const Pixels>(shown, &shown->picture));
        ImGui::GetWindowDrawList()->AddImage((ImTextureID)texture, {place.x, place.y},
                                             {place.x + place.width, place.y + place.height});
        ImGui::PushClipRect({place.x, place.y}, {place.x + place.width, place.y + place.height}, true);
        draw_lines_in(place, *shown);
        ImGui::PopClipRect();
        mouse_on_birds_eye(viewer, place);
    }
    ImGui::SameLine();
    ImGui::BeginChild("paths", {0, height}, false, ImGuiWindowFlags_HorizontalScrollbar);
    if (drawn && drawn->pixel_paths && viewer.settings().pixel) {
        ImGui::Text("pixel %.1f, %.1f: %zu %s", viewer.settings().pixel->x, viewer.settings().pixel->y,
                    drawn->pixel_paths->size(), drawn->pixel_paths->size() == 1 ? "path" : "paths");
        for (const PathLine& path : *drawn->pixel_paths) path_words(*drawn, path);
    }
    if (drawn && drawn->place_images) {
        const PlaceImages& images = *drawn->place_images;
        ImGui::TextColored(ImVec4(1, 0.86f, 0.16f, 1), "place (%.3f, %.3f, %.3f): %zu %s%s", images.place.x,
                           images.place.y, images.place.z, images.images.size(),
                           images.images.size() == 1 ? "image" : "images",
                           images.complete ? ", proven to be all" : "");
        for (const PlaceImage& image : images.images)
            ImGui::Text("  %s at %.2f, %.2f  weight %.3g%s",
                        image.line.word.empty() ? "direct" : image.line.word.c_str(), image.pixel.x,
                        image.pixel.y, dot(image.line.weight, Vec3(1)) / 3, image.visible ? "" : ", hidden");
    }
    ImGui::EndChild();
}

}  // namespace trilens
