// What the page's scripts call: numbers of a frame in, pixels out.
#include <emscripten/emscripten.h>

#include <array>

#include "picture.h"

using namespace trilens;
using namespace trilens::browser;

namespace {

/// The numbers of a frame, in the order of kNumbers in the page's script.
std::array<double, 29> numbers{};
FrameBuffers seen;
std::vector<float> corners;
std::array<double, 2> place{};

const LittleRoom& room() {
    static const LittleRoom made = make_room();
    return made;
}

Frame frame_of_numbers() {
    Frame frame;
    std::size_t at = 0;
    const auto whole = [&] { return static_cast<int>(numbers[at++]); };
    frame.width = whole();
    frame.height = whole();
    frame.first_row = whole();
    frame.last_row = whole();
    frame.side = whole();
    frame.n = whole();
    for (int c = 0; c < 3; ++c) frame.eye[c] = numbers[at++];
    for (int c = 0; c < 3; ++c) frame.at[c] = numbers[at++];
    frame.mirror.turn = numbers[at++];
    for (double& bulge : frame.mirror.bulge) bulge = numbers[at++];
    return frame;
}

}  // namespace

extern "C" {

EMSCRIPTEN_KEEPALIVE double* frame_numbers() {
    return numbers.data();
}

EMSCRIPTEN_KEEPALIVE const std::uint8_t* draw() {
    draw_frame(room(), frame_of_numbers(), seen);
    return seen.rgba.data();
}

EMSCRIPTEN_KEEPALIVE std::size_t outline() {
    corners = facets_on_film(frame_of_numbers());
    return corners.size();
}
EMSCRIPTEN_KEEPALIVE const float* outline_corners() {
    return corners.data();
}

EMSCRIPTEN_KEEPALIVE const double* place_on_mirror(double x, double y) {
    const std::optional<Vec2> found = mirror_place(room(), frame_of_numbers(), {x, y});
    if (!found) return nullptr;
    place = {found->x, found->y};
    return place.data();
}
}
