// A window on the screen: GLFW and OpenGL 3.
#pragma once

#include <functional>
#include <memory>

#include "view/window/interface.h"

struct ImDrawData;

namespace trilens {

/// A window with OpenGL, ready for ImGui, which must have its context. Closed when it goes.
class GlScreen {
  public:
    /// Throws ComputationError where there is no display, or its OpenGL is older than 3.2.
    GlScreen(int width, int height, const std::string& title);
    ~GlScreen();
    GlScreen(const GlScreen&) = delete;
    GlScreen& operator=(const GlScreen&) = delete;

    /// Whether frames wait for the display's; they do at first.
    void wait_for_display(bool waits);
    bool wants_close() const;
    /// Takes what the user did. Where nothing moves it waits for that, for new pictures (see wake) or for as
    /// long as `seconds`.
    void take_input(double seconds);
    /// Ends a take_input that waits; from any thread.
    static void wake();
    /// Whether the window has pixels: one of zero size, or an icon, has none, and then nothing is drawn.
    bool has_pixels() const;
    void begin_frame();
    /// Shows a frame; `read`, where there is one, gets its pixels.
    void show(ImDrawData& data, Pixels* read = nullptr);
    TextureStore& textures();
    std::string renderer_name() const;  // of OpenGL: "llvmpipe ..."

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace trilens
