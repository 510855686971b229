// Memory that runs out, once, at every place where much is asked for; and pictures without end in one
// process.
#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <functional>
#include <new>
#include <string>
#include <vector>

#include "support/test.h"
#include "trilens/trilens.h"

using namespace trilens;

namespace {

/// Pieces of at least so many bytes are those whose size callers decide.
constexpr std::size_t kMuch = 2048;

std::atomic<long> countdown{0};       // the piece that is refused, counted down; 0 or less: none
std::atomic<long> asked{0}, live{0};  // of all such pieces: asked for, and there now

void* allocate(std::size_t size, std::size_t alignment) {
    if (size >= kMuch) {
        asked.fetch_add(1);
        if (countdown.load() > 0 && countdown.fetch_sub(1) == 1) return nullptr;
    }
    void* const piece = alignment > 0
                            ? std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment)
                            : std::malloc(size > 0 ? size : 1);
    if (piece != nullptr) live.fetch_add(1);
    return piece;
}

void* allocate_or_throw(std::size_t size, std::size_t alignment) {
    void* const piece = allocate(size, alignment);
    if (piece == nullptr) throw std::bad_alloc();
    return piece;
}

void release(void* piece) {
    if (piece == nullptr) return;
    live.fetch_sub(1);
    std::free(piece);
}

}  // namespace

void* operator new(std::size_t size) {
    return allocate_or_throw(size, 0);
}
void* operator new[](std::size_t size) {
    return allocate_or_throw(size, 0);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    return allocate_or_throw(size, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
    return allocate_or_throw(size, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
    return allocate(size, 0);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
    return allocate(size, 0);
}
void operator delete(void* piece) noexcept {
    release(piece);
}
void operator delete[](void* piece) noexcept {
    release(piece);
}
void operator delete(void* piece, std::size_t) noexcept {
    release(piece);
}
void operator delete[](void* piece, std::size_t) noexcept {
    release(piece);
}
void operator delete(void* piece, std::align_val_t) noexcept {
    release(piece);
}
void operator delete[](void* piece, std::align_val_t) noexcept {
    release(piece);
}
void operator delete(void* piece, std::size_t, std::align_val_t) noexcept {
    release(piece);
}
void operator delete[](void* piece, std::size_t, std::align_val_t) noexcept {
    release(piece);
}

namespace {

constexpr const char* kSmallRoom = R"({ "version": 1, "film": { "width": 24, "height": 18 },
  "cameras": [ { "name": "c", "yfov": 45, "lookAt": { "eye": [0.3, 0.8, 4], "at": [0, 0, 0] } } ],
  "background": { "color": [0.2, 0.3, 0.5] }, "render": { "maxDepth": 1 },
  "materials": [ { "name": "chrome", "metallicFactor": 1 }, { "name": "glass", "transmissionFactor": 1, "ior": 1.5 } ],
  "lights": [ { "type": "point", "position": [1, 3, 2], "intensity": 9, "shadows": true } ],
  "meshes": [ { "name": "ball", "role": "optic", "material": "glass", "resolution": 3,
      "primitive": { "type": "sphere", "center": [1, 0, 0], "radius": 0.6 } },
    { "name": "cage", "role": "optic", "material": "chrome", "resolution": 3,
      "points": [[-1.6,-0.6,0],[-0.4,-0.6,0],[-0.4,0.6,0],[-1.6,0.6,0]], "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3] },
    { "name": "floor", "role": "object", "points": [[-5,-1,-5],[5,-1,-5],[5,-1,5],[-5,-1,5]],
      "faceVertexCounts": [4], "faceVertexIndices": [3,2,1,0] } ] })";

struct Task {
    const char* name;
    std::function<std::string()> work;  // what comes of it, as bytes
};

std::string text_of(const std::vector<unsigned char>& bytes) {
    return {bytes.begin(), bytes.end()};
}

std::vector<Task> tasks(const std::string& folder) {
    const std::string file = folder + "/a.exr";
    return {
        {"draw", [] { return text_of(encode_image(Renderer(parse_scene(kSmallRoom)).draw({}).image)); }},
        {"trace",
         [] {
             PictureRequest request;
             request.engine = Engine::kLimitTruth;
             return text_of(Renderer(parse_scene(kSmallRoom)).draw_exr(request).bytes);
         }},
        {"project",
         [] {
             const Renderer renderer(parse_scene(kSmallRoom));
             const auto found = renderer.project(std::vector<Vec3>{{0.5, -0.9, 0.5}, {-1, -0.95, 1}});
             return std::to_string(found[0].images.size()) + std::to_string(found[1].images.size());
         }},
        {"lines", [] { return Renderer(parse_scene(kSmallRoom)).draw_lines({}).svg; }},
        {"write, read and compare",
         [file] {
             const Image image = Renderer(parse_scene(kSmallRoom)).draw({}).image;
             write_image(file, image);
             const Image read = read_image(file);
             return std::to_string(compare(image, read).metrics.max) +
                    std::to_string(total_seen(compare_layers(image, read)).pixels);
         }},
    };
}

/// Bytes that this process holds, whoever asked for them.
std::size_t held_bytes() {
    const struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
}

}  // namespace

TEST_CASE("where memory runs out once, an error comes of it, no leak, and all goes on",
          "[memory][bad-input][law][thorough]") {
    set_threads(1);
    for (const Task& task : tasks(trilens_test::scratch_dir("allocation"))) {
        const std::string expected = task.work();
        task.work();  // what is kept for the next call is there now
        asked = 0;
        const long before = live;
        REQUIRE(task.work() == expected);
        const long count = asked, kept = live - before;
        INFO(task.name << ": " << count << " pieces");
        CHECK(count > 20);
        CHECK(kept <= 0);
        std::size_t refused = 0;
        const long step = std::max(1L, count / 120);
        for (long k = 1; k <= count; k += step) {
            INFO("piece " << k);
            const long there = live;
            countdown = k;
            bool is_refused = false;
            std::string other;
            try {
                other = task.work();
            } catch (const Error&) {
                is_refused = true;
            } catch (const std::bad_alloc&) {
                is_refused = true;
            }
            countdown = 0;
            refused += is_refused;
            // What could do without the piece has the same answer.
            if (!is_refused && other != expected) FAIL_CHECK("another answer");
            other = {};
            if (live > there + 4) FAIL_CHECK(live - there << " pieces are left");
        }
        CHECK(refused > 10);
        CHECK(task.work() == expected);
    }
    set_threads(0);
}

namespace {

void draw_again(int count) {
    const Renderer kept(parse_scene(kSmallRoom));
    const auto draw = [&](int from, int to) {
        for (int i = from; i < to; ++i) {
            PictureRequest request;
            request.frame.resolution = 1 + i % 3;
            kept.draw(request);
            if (i % 4 == 0) Renderer(parse_scene(kSmallRoom)).draw(request);
        }
    };
    draw(0, count / 10);
    const std::size_t before = held_bytes();
    draw(count / 10, count);
    const std::size_t after = held_bytes();
    INFO(count << " pictures: " << before << " bytes, then " << after);
    CHECK(after < before + (1u << 20));
}

}  // namespace

TEST_CASE("three hundred pictures take no more memory than thirty", "[memory]") {
    draw_again(300);
}

TEST_CASE("ten thousand pictures take no more memory than a thousand", "[.long][memory]") {
    draw_again(10000);
}
