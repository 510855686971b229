// Triangle rasterization by edge functions (Pineda 1988) with the top-left rule.
#include "view/window/memory_screen.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace trilens {
namespace {

struct ClipWindow {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

struct Rgba {
    float r = 0, g = 0, b = 0, a = 0;
};

Rgba unpacked(ImU32 colour) {
    const auto part = [colour](int shift) { return static_cast<float>((colour >> shift) & 255) / 255; };
    return {part(IM_COL32_R_SHIFT), part(IM_COL32_G_SHIFT), part(IM_COL32_B_SHIFT), part(IM_COL32_A_SHIFT)};
}

Rgba texel(const Pixels* texture, float u, float v) {
    if (!texture || texture->empty()) return {1, 1, 1, 1};
    const int x = std::clamp(static_cast<int>(u * static_cast<float>(texture->width)), 0, texture->width - 1);
    const int y =
        std::clamp(static_cast<int>(v * static_cast<float>(texture->height)), 0, texture->height - 1);
    const std::uint8_t* at = texture->rgba.data() + 4 * (static_cast<std::ptrdiff_t>(y) * texture->width + x);
    return {static_cast<float>(at[0]) / 255, static_cast<float>(at[1]) / 255, static_cast<float>(at[2]) / 255,
            static_cast<float>(at[3]) / 255};
}

void blend(std::uint8_t* at, const Rgba& colour) {
    const auto mix = [&](std::uint8_t below, float above) {
        return static_cast<std::uint8_t>(std::lround(std::clamp(
            static_cast<float>(below) + (255 * above - static_cast<float>(below)) * colour.a, 0.0f, 255.0f)));
    };
    at[0] = mix(at[0], colour.r);
    at[1] = mix(at[1], colour.g);
    at[2] = mix(at[2], colour.b);
    at[3] = 255;
}

/// Twice the signed area of a, b and (x, y).
float edge(const ImVec2& a, const ImVec2& b, float x, float y) {
    return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

/// Whether an edge owns the pixel centres that lie exactly on it.
bool owns(const ImVec2& a, const ImVec2& b) {
    return (a.y == b.y && b.x < a.x) || b.y > a.y;
}

void triangle(Pixels& screen, const ClipWindow& clip, std::array<const ImDrawVert*, 3> v,
              const Pixels* texture) {
    float area = edge(v[0]->pos, v[1]->pos, v[2]->pos.x, v[2]->pos.y);
    if (!(std::abs(area) > 0)) return;
    if (area < 0) {
        std::swap(v[1], v[2]);
        area = -area;
    }
    const auto [low_x, high_x] = std::minmax({v[0]->pos.x, v[1]->pos.x, v[2]->pos.x});
    const auto [low_y, high_y] = std::minmax({v[0]->pos.y, v[1]->pos.y, v[2]->pos.y});
    const std::array<Rgba, 3> colours{unpacked(v[0]->col), unpacked(v[1]->col), unpacked(v[2]->col)};
    const int x0 = std::max(clip.x0, static_cast<int>(std::floor(low_x))),
              x1 = std::min(clip.x1, static_cast<int>(std::ceil(high_x)) + 1);
    const int y0 = std::max(clip.y0, static_cast<int>(std::floor(low_y))),
              y1 = std::min(clip.y1, static_cast<int>(std::ceil(high_y)) + 1);
    for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) {
            const float px = static_cast<float>(x) + 0.5f, py = static_cast<float>(y) + 0.5f;
            std::array<float, 3> w{};
            bool inside = true;
            for (std::size_t k = 0; k < 3; ++k) {
                const ImVec2 &a = v[(k + 1) % 3]->pos, &b = v[(k + 2) % 3]->pos;
                w[k] = edge(a, b, px, py);
                inside = inside && (w[k] > 0 || (w[k] == 0 && owns(a, b)));
            }
            if (!inside) continue;
            Rgba colour;
            float u = 0, t = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const float share = w[k] / area;
                colour.r += share * colours[k].r;
                colour.g += share * colours[k].g;
                colour.b += share * colours[k].b;
                colour.a += share * colours[k].a;
                u += share * v[k]->uv.x;
                t += share * v[k]->uv.y;
            }
            const Rgba texture_colour = texel(texture, u, t);
            colour = {colour.r * texture_colour.r, colour.g * texture_colour.g, colour.b * texture_colour.b,
                      colour.a * texture_colour.a};
            if (colour.a > 0)
                blend(screen.rgba.data() + 4 * (static_cast<std::ptrdiff_t>(y) * screen.width + x), colour);
        }
}

}  // namespace

MemoryTextures::MemoryTextures() {
    unsigned char* font = nullptr;
    int width = 0, height = 0;
    ImGui::GetIO().Fonts->GetTexDataAsRGBA32(&font, &width, &height);
    Pixels pixels{width, height, {}};
    pixels.rgba.assign(font, font + static_cast<std::ptrdiff_t>(width) * height * 4);
    textures_.push_back(std::make_shared<const Pixels>(std::move(pixels)));
    ImGui::GetIO().Fonts->SetTexID((ImTextureID)std::uintptr_t{1});
}

std::uintptr_t MemoryTextures::texture(std::size_t slot, const std::shared_ptr<const Pixels>& pixels) {
    if (textures_.size() < slot + 2) textures_.resize(slot + 2);
    textures_[slot + 1] = pixels;
    return slot + 2;
}

const Pixels* MemoryTextures::find(std::uintptr_t name) const {
    return name >= 1 && name <= textures_.size() ? textures_[name - 1].get() : nullptr;
}

Pixels rasterize_interface(const ImDrawData& data, const MemoryTextures& textures) {
    Pixels screen{static_cast<int>(data.DisplaySize.x), static_cast<int>(data.DisplaySize.y), {}};
    screen.rgba.assign(static_cast<std::size_t>(std::max(screen.width, 0)) *
                           static_cast<std::size_t>(std::max(screen.height, 0)) * 4,
                       kScreenGrey);
    for (int i = 0; i < data.CmdListsCount; ++i) {
        const ImDrawList& list = *data.CmdLists[i];
        for (const ImDrawCmd& command : list.CmdBuffer) {
            if (command.UserCallback) continue;
            const ClipWindow clip{std::max(0, static_cast<int>(command.ClipRect.x)),
                                  std::max(0, static_cast<int>(command.ClipRect.y)),
                                  std::min(screen.width, static_cast<int>(command.ClipRect.z)),
                                  std::min(screen.height, static_cast<int>(command.ClipRect.w))};
            const Pixels* texture = textures.find((std::uintptr_t)command.GetTexID());
            for (unsigned at = 0; at + 2 < command.ElemCount; at += 3) {
                const auto vertex = [&](unsigned k) {
                    return &list.VtxBuffer[static_cast<int>(
                        command.VtxOffset + list.IdxBuffer[static_cast<int>(command.IdxOffset + at + k)])];
                };
                triangle(screen, clip, {vertex(0), vertex(1), vertex(2)}, texture);
            }
        }
    }
    for (std::size_t i = 3; i < screen.rgba.size(); i += 4) screen.rgba[i] = 255;
    return screen;
}

}  // namespace trilens
