// One frame: the room, the mirror before it, and in the mirror the room again, projected through its facets.
#pragma once

#include <cstdint>
#include <vector>

#include "bent_mirror.h"
#include "little_room.h"

namespace trilens::browser {

/// What is drawn: rows [first_row, last_row) of the film.
struct Frame {
    int width = 640, height = 480, first_row = 0, last_row = 480;
    int side = 1;  // side x side samples per pixel
    int n = 8;     // n x n squares of the mirror
    Vec3 eye{0, 2, 6}, at{0, 1, 0};
    BentMirror mirror;
};

/// What is known of a frame's samples, kept from frame to frame for its memory alone.
struct FrameBuffers {
    std::vector<Hit> room, mirrored;  // seen by the camera, and through the mirror's facets
    std::vector<Visible> part;        // of the samples near the mirror: its facets
    std::vector<Id> mirror, owner;    // the facet before the room, and where it shows its front
    std::vector<std::uint8_t> rgba;   // of the rows' pixels, eight bits each, sRGB
};

/// Draws the rows into `seen.rgba`.
void draw_frame(const LittleRoom& room, const Frame& frame, FrameBuffers& seen);

/// The corners of the mirror's facets on the film, three x, y pairs for each, in pixels; facets that do not
/// lie before the camera are left out.
std::vector<float> facets_on_film(const Frame& frame);

/// Where on the mirror, 0..1 each, one looks at this film place; none where it is not the first thing seen
/// there.
std::optional<Vec2> mirror_place(const LittleRoom& room, const Frame& frame, const Vec2& at);

}  // namespace trilens::browser
