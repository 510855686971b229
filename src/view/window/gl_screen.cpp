#include "view/window/gl_screen.h"

#include <GLFW/glfw3.h>
#include <imgui.h>
#include <imgui_impl_glfw.h>
#include <imgui_impl_opengl3.h>
#include <trilens/error.h>

#include <algorithm>
#include <cstdlib>

namespace trilens {
namespace {

constexpr const char* kWithoutWindow =
    "trilens view SCENE --script STEPS.json --screenshot PICTURE.png works without one";

std::string& glfw_message() {
    static std::string message;
    return message;
}

class GlTextures : public TextureStore {
  public:
    ~GlTextures() override {
        for (const Slot& slot : slots_)
            if (slot.name != 0) glDeleteTextures(1, &slot.name);
    }
    std::uintptr_t texture(std::size_t at, const std::shared_ptr<const Pixels>& pixels) override {
        if (slots_.size() <= at) slots_.resize(at + 1);
        Slot& slot = slots_[at];
        if (slot.shown == pixels && slot.data == pixels.get()) return slot.name;
        if (slot.name == 0) glGenTextures(1, &slot.name);
        glBindTexture(GL_TEXTURE_2D, slot.name);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
        glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
        if (slot.width == pixels->width && slot.height == pixels->height)
            glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, pixels->width, pixels->height, GL_RGBA, GL_UNSIGNED_BYTE,
                            pixels->rgba.data());
        else
            glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA, pixels->width, pixels->height, 0, GL_RGBA,
                         GL_UNSIGNED_BYTE, pixels->rgba.data());
        slot.shown = pixels;
        slot.data = pixels.get();
        slot.width = pixels->width;
        slot.height = pixels->height;
        return slot.name;
    }

  private:
    struct Slot {
        GLuint name = 0;
        int width = 0, height = 0;
        const Pixels* data = nullptr;
        std::shared_ptr<const Pixels> shown;
    };
    std::vector<Slot> slots_;
};

GLFWwindow* make_window(int width, int height, const std::string& title) {
    glfwSetErrorCallback([](int, const char* message) { glfw_message() = message; });
    if (!glfwInit()) {
        const bool none = !std::getenv("DISPLAY") && !std::getenv("WAYLAND_DISPLAY");
        throw ComputationError(
            std::string(none ? "there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set)"
                             : "the display cannot be opened: " + glfw_message()) +
            "; " + kWithoutWindow);
    }
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 2);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    GLFWwindow* window = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
    if (!window) {
        const std::string message = glfw_message();
        glfwTerminate();
        throw ComputationError("the display has no OpenGL 3.2 (" + message + "); " + kWithoutWindow);
    }
    return window;
}

}  // namespace

namespace {

/// What is drawn and not yet swapped, rows from the top.
Pixels drawn_pixels(int width, int height) {
    Pixels pixels{width, height, {}};
    const auto row = static_cast<std::size_t>(width) * 4;
    pixels.rgba.resize(row * static_cast<std::size_t>(height));
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, pixels.rgba.data());
    for (std::size_t top = 0, bottom = pixels.rgba.size(); top + row < bottom; top += row) {
        bottom -= row;
        std::swap_ranges(pixels.rgba.begin() + static_cast<std::ptrdiff_t>(top),
                         pixels.rgba.begin() + static_cast<std::ptrdiff_t>(top + row),
                         pixels.rgba.begin() + static_cast<std::ptrdiff_t>(bottom));
    }
    return pixels;
}

}  // namespace

struct GlScreen::Parts {
    GLFWwindow* window = nullptr;
    std::unique_ptr<GlTextures> textures;
};

GlScreen::GlScreen(int width, int height, const std::string& title) : parts_(std::make_unique<Parts>()) {
    parts_->window = make_window(std::max(width, 1), std::max(height, 1), title);
    glfwMakeContextCurrent(parts_->window);
    glfwSwapInterval(1);
    ImGui_ImplGlfw_InitForOpenGL(parts_->window, true);
    ImGui_ImplOpenGL3_Init("#version 150");
    parts_->textures = std::make_unique<GlTextures>();
}

GlScreen::~GlScreen() {
    parts_->textures.reset();
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    glfwDestroyWindow(parts_->window);
    glfwTerminate();
}

void GlScreen::wait_for_display(bool waits) {
    glfwSwapInterval(waits ? 1 : 0);
}

bool GlScreen::wants_close() const {
    return glfwWindowShouldClose(parts_->window);
}

void GlScreen::take_input(double seconds) {
    if (seconds > 0)
        glfwWaitEventsTimeout(seconds);
    else
        glfwPollEvents();
}

void GlScreen::wake() {
    glfwPostEmptyEvent();
}

bool GlScreen::has_pixels() const {
    int width = 0, height = 0;
    glfwGetFramebufferSize(parts_->window, &width, &height);
    return width > 0 && height > 0 && !glfwGetWindowAttrib(parts_->window, GLFW_ICONIFIED);
}

void GlScreen::begin_frame() {
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
}

void GlScreen::show(ImDrawData& data, Pixels* read) {
    int width = 0, height = 0;
    glfwGetFramebufferSize(parts_->window, &width, &height);
    glViewport(0, 0, width, height);
    constexpr float kGrey = kScreenGrey / 255.0f;
    glClearColor(kGrey, kGrey, kGrey, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    ImGui_ImplOpenGL3_RenderDrawData(&data);
    if (read) *read = drawn_pixels(width, height);
    glfwSwapBuffers(parts_->window);
}

TextureStore& GlScreen::textures() {
    return *parts_->textures;
}

std::string GlScreen::renderer_name() const {
    const GLubyte* name = glGetString(GL_RENDERER);
    return name ? reinterpret_cast<const char*>(name) : "";
}

}  // namespace trilens
