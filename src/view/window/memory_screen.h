// A screen in memory: what Dear ImGui draws, rasterized without a window, a display or OpenGL.
#pragma once

#include <memory>
#include <vector>

#include "view/window/interface.h"

struct ImDrawData;

namespace trilens {

/// Textures as they are; slot s is called s + 2, and 1 is the font.
class MemoryTextures : public TextureStore {
  public:
    /// Builds ImGui's font; asks for its context.
    MemoryTextures();
    std::uintptr_t texture(std::size_t slot, const std::shared_ptr<const Pixels>& pixels) override;
    /// Null for a name that is none.
    const Pixels* find(std::uintptr_t name) const;

  private:
    std::vector<std::shared_ptr<const Pixels>> textures_;
};

/// The triangles of a frame in their order, each over those before: colours times texture (nearest), blended
/// by alpha, as Dear ImGui's backends have it. A pixel belongs to a triangle that holds its centre; on an
/// edge of two, to one of them.
Pixels rasterize_interface(const ImDrawData& data, const MemoryTextures& textures);

}  // namespace trilens
