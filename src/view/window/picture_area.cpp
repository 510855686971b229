#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "view/window/interface.h"

namespace trilens {
namespace {

constexpr float kGrip = 6;  // pixels from the wipe's line that still take hold of it

ImVec2 screen_of(const PicturePlace& place, const Vec2& film) {
    const Vec2 at = place.on_screen(film);
    return {static_cast<float>(at.x), static_cast<float>(at.y)};
}

/// The part of a picture from one share of its width to another.
void draw_part(const PicturePlace& place, std::uintptr_t texture, float from, float to) {
    if (!(from < to)) return;
    ImGui::GetWindowDrawList()->AddImage((ImTextureID)texture, {place.x + from * place.width, place.y},
                                         {place.x + to * place.width, place.y + place.height}, {from, 0},
                                         {to, 1});
}

/// Edges or folds.
template <typename Line>
void draw_lines(const PicturePlace& place, const std::vector<Line>& lines, ImU32 colour, float width) {
    std::vector<ImVec2> points;
    for (const Line& line : lines) {
        points.clear();
        for (const Vec2& at : line.points) points.push_back(screen_of(place, at));
        ImGui::GetWindowDrawList()->AddPolyline(points.data(), static_cast<int>(points.size()), colour, 0,
                                                width);
    }
}

/// Images of a picked place: filled where they are visible, hollow where something is before them.
void draw_marks(const PicturePlace& place, const Drawn& drawn, const ViewSettings& settings) {
    ImDrawList* lines = ImGui::GetWindowDrawList();
    if (settings.pixel) {
        const ImVec2 at = screen_of(place, *settings.pixel);
        lines->AddCircle(at, 7, IM_COL32(0, 0, 0, 255), 0, 4);
        lines->AddCircle(at, 7, IM_COL32(90, 200, 255, 255), 0, 2);
    }
    if (!drawn.place_images) return;
    for (const PlaceImage& image : drawn.place_images->images) {
        const ImVec2 at = screen_of(place, image.pixel);
        lines->AddCircleFilled(at, 7, IM_COL32(0, 0, 0, image.visible ? 255 : 0));
        if (image.visible) lines->AddCircleFilled(at, 5.5f, IM_COL32(255, 220, 40, 255));
        lines->AddCircle(at, 7, IM_COL32(255, 220, 40, 255), 0, 1.5f);
        const std::string word = image.line.word.empty() ? "direct" : image.line.word;
        lines->AddText({at.x + 10, at.y - 7}, IM_COL32(0, 0, 0, 255), word.c_str());
        lines->AddText({at.x + 9, at.y - 8}, IM_COL32(255, 230, 90, 255), word.c_str());
    }
}

/// The colours of a heat map with the numbers at its ends.
void draw_scale(const PicturePlace& place, double end, const char* what) {
    ImDrawList* lines = ImGui::GetWindowDrawList();
    const float width = 160, height = 10, x = place.x + place.width - width - 12,
                y = place.y + place.height - 34;
    lines->AddRectFilled({x - 8, y - 8}, {x + width + 8, y + 30}, IM_COL32(0, 0, 0, 190));
    for (int i = 0; i < 40; ++i) {
        const auto colour = heat_colour((i + 0.5) / 40);
        lines->AddRectFilled({x + width * static_cast<float>(i) / 40, y},
                             {x + width * static_cast<float>(i + 1) / 40, y + height},
                             IM_COL32(colour[0], colour[1], colour[2], 255));
    }
    lines->AddText({x, y + height + 1}, IM_COL32_WHITE, "0");
    const std::string high = fmt::format("{:g} {}", end, what);
    lines->AddText({x + width - ImGui::CalcTextSize(high.c_str()).x, y + height + 1}, IM_COL32_WHITE,
                   high.c_str());
}

void draw_names(const PicturePlace& place, const ViewSettings& settings) {
    ImDrawList* lines = ImGui::GetWindowDrawList();
    const auto name = [&](float x, const std::string& text) {
        const ImVec2 size = ImGui::CalcTextSize(text.c_str());
        lines->AddRectFilled({x - 4, place.y + 4}, {x + size.x + 4, place.y + 8 + size.y},
                             IM_COL32(0, 0, 0, 170));
        lines->AddText({x, place.y + 6}, IM_COL32_WHITE, text.c_str());
    };
    const float middle = place.x + static_cast<float>(settings.wipe) * place.width;
    ImGui::PushClipRect({place.x, place.y}, {middle, place.y + place.height}, true);
    if (settings.wipe > 0) name(place.x + 8, name_of(settings.left));
    ImGui::PopClipRect();
    if (settings.wipe < 1) {
        name(std::min(middle + 8, place.x + place.width - 90), name_of(settings.right));
        lines->AddLine({middle, place.y}, {middle, place.y + place.height}, IM_COL32_WHITE, 2);
    }
}

void mouse_on_picture(SceneViewer& viewer, InterfaceState& state, const PicturePlace& place) {
    const ImGuiIO& io = ImGui::GetIO();
    const ViewSettings& settings = viewer.settings();
    const Vec2 mouse(io.MousePos.x, io.MousePos.y), film = place.on_film(mouse);
    const bool hovered = ImGui::IsItemHovered(), active = ImGui::IsItemActive();
    const bool on_film =
        film.x >= 0 && film.y >= 0 && film.x < place.film_width && film.y < place.film_height;
    if (hovered && io.MouseWheel != 0)
        viewer.move({CameraMove::Kind::kDolly, {std::pow(0.9, static_cast<double>(io.MouseWheel)), 0, 0}});
    if (ImGui::IsItemActivated()) {
        const double line = place.x + settings.wipe * place.width;
        state.drags_wipe = settings.wipe < 1 && std::abs(mouse.x - line) < kGrip && ImGui::IsMouseDown(0);
        ViewSettings next = settings;
        if (ImGui::IsMouseDown(0) && io.KeyCtrl && on_film) {
            next.pixel = Vec2(std::floor(film.x) + 0.5, std::floor(film.y) + 0.5);
            next.birds_eye.shown = true;
            viewer.change("", next);
        } else if (ImGui::IsMouseDown(0) && io.KeyAlt && on_film) {
            next.pick = PlacePick{false, film};
            next.birds_eye.shown = true;
            viewer.change("", next);
        }
    }
    if (!active || io.KeyCtrl || io.KeyAlt) return;
    const Vec2 by(io.MouseDelta.x, io.MouseDelta.y);
    if (by == Vec2(0)) return;
    if (state.drags_wipe) {
        ViewSettings next = settings;
        next.wipe = std::clamp((mouse.x - place.x) / place.width, 0.0, 1.0);
        viewer.change("wipe", next);
    } else if (ImGui::IsMouseDown(2) || io.KeyShift) {
        viewer.move({CameraMove::Kind::kPan, {-by.x / place.height, by.y / place.height, 0}});
    } else if (ImGui::IsMouseDown(1)) {
        viewer.move({CameraMove::Kind::kLook, {0.15 * by.x, -0.15 * by.y, 0}});
    } else {
        viewer.move({CameraMove::Kind::kOrbit, {-0.4 * by.x, 0.4 * by.y, 0}});
    }
}

}  // namespace

void picture_area(SceneViewer& viewer, InterfaceState& state, TextureStore& textures, float height) {
    const ImVec2 from = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x;
    if (width < 2 || height < 2) return;
    ImGui::InvisibleButton("picture", {width, height},
                           ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                               ImGuiButtonFlags_MouseButtonMiddle);
    const auto drawn = viewer.drawn();
    if (!drawn || !drawn->left) return;
    const ViewSettings settings = viewer.settings();
    const PicturePlace place =
        fitted_picture(from.x, from.y, width, height, drawn->film_width, drawn->film_height);
    const float wipe = drawn->right ? static_cast<float>(settings.wipe) : 1.0f;
    draw_part(place, textures.texture(0, drawn->left), 0, wipe);
    if (drawn->right) draw_part(place, textures.texture(1, drawn->right), wipe, 1);
    if (drawn->overlay) draw_part(place, textures.texture(2, drawn->overlay), 0, 1);
    ImGui::PushClipRect({place.x, place.y}, {place.x + place.width, place.y + place.height}, true);
    if (drawn->edges) draw_lines(place, *drawn->edges, IM_COL32(50, 205, 255, 255), 1.5f);
    if (drawn->folds) draw_lines(place, *drawn->folds, IM_COL32(255, 90, 220, 255), 2);
    draw_marks(place, *drawn, settings);
    if (drawn->comparison && settings.shows(ShownPicture::kDisplacement))
        draw_scale(place, drawn->comparison->displacement_end, "px");
    else if (drawn->comparison && settings.shows(ShownPicture::kFlip))
        draw_scale(place, 1, "FLIP");
    draw_names(place, settings);
    ImGui::PopClipRect();
    mouse_on_picture(viewer, state, place);
}

}  // namespace trilens
