// The viewer's interface, drawn by Dear ImGui on whatever screen there is: a window, or memory.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "view/viewer.h"

namespace trilens {

/// Where textures live: a window keeps them on the graphics card, a memory screen as they are.
class TextureStore {
  public:
    virtual ~TextureStore() = default;
    /// Puts pixels into the texture of a slot (0, 1, 2 ...), which is made where it is new; what ImGui calls
    /// it. Asked again with the same pixels it does nothing.
    virtual std::uintptr_t texture(std::size_t slot, const std::shared_ptr<const Pixels>& pixels) = 0;
};

/// A picture's place on the screen.
struct PicturePlace {
    float x = 0, y = 0, width = 0, height = 0;  // screen pixels
    int film_width = 0, film_height = 0;

    /// Screen pixels of a film place, and back.
    Vec2 on_screen(const Vec2& film) const {
        return {x + film.x * width / film_width, y + film.y * height / film_height};
    }
    Vec2 on_film(const Vec2& screen) const {
        return {(screen.x - x) * film_width / width, (screen.y - y) * film_height / height};
    }
};

/// What the interface remembers between frames that is none of the session's.
struct InterfaceState {
    std::string number_filter, save_name = "view.png";
    std::string chosen_number;  // a JSON pointer
    SliderSpan span;            // of its slider
    bool slides = false;        // the slider is being dragged
    bool is_scripted = false;   // a script says where one step of undo ends, not the mouse
    bool drags_wipe = false;
    double frames_per_second = 0;  // of the window
};

/// What a screen is cleared with before a frame is drawn on it, of each colour: the interface has no
/// background of its own, which would be drawn over all pixels once more.
inline constexpr int kScreenGrey = 16;  // of 255

/// Builds one frame of the interface between ImGui::NewFrame and ImGui::Render, and does what the user asks.
void build_interface(SceneViewer& viewer, InterfaceState& state, TextureStore& textures);

// Its parts; each fills what ImGui has open.

/// The picture with its overlays, wipe and marks, and the mouse on it.
void picture_area(SceneViewer& viewer, InterfaceState& state, TextureStore& textures, float height);
/// The bird's-eye view, and the paths that it shows as words.
void birds_eye_area(SceneViewer& viewer, TextureStore& textures, float height);
/// Settings, numbers, lists and buttons.
void settings_panel(SceneViewer& viewer, InterfaceState& state);

/// Fits a film into a rectangle of the screen: centred, its pixels square.
PicturePlace fitted_picture(float x, float y, float width, float height, int film_width, int film_height);

}  // namespace trilens
