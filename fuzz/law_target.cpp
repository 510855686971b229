// Fuzz target of laws: a random scene is drawn, and what holds for every scene is asked of its pictures.
#include <algorithm>
#include <cmath>
#include <map>

#include "base/util/parallel.h"
#include "fuzz/random_scene.h"
#include "fuzz/target.h"
#include "render/world/world.h"
#include "tests/laws/agreement.h"
#include "trilens/compare.h"
#include "trilens/image.h"
#include "trilens/project.h"
#include "trilens/render.h"
#include "trilens/scene.h"

using namespace trilens;

namespace trilens_fuzz {
namespace {

using Bytes = std::vector<unsigned char>;

PictureRequest picture(int resolution) {
    PictureRequest request;
    request.frame.resolution = resolution;
    return request;
}

/// The same bytes whatever the number of threads.
Bytes drawn(const Renderer& renderer, const PictureRequest& request) {
    const int before = thread_count();
    set_thread_count(1);
    const Bytes one = encode_image(renderer.draw(request).image);
    set_thread_count(3);
    const Bytes three = encode_image(renderer.draw(request).image);
    set_thread_count(before);
    require(one == three, "a picture depends on the number of threads");
    return one;
}

/// Every value is a number, and none is brighter than what shines.
void require_light(const Image& image, bool is_unlit) {
    for (const char* name : {"R", "G", "B"}) {
        const Channel* channel = image.find(name);
        require(channel != nullptr, "a picture without colour");
        for (const float value : channel->floats()) {
            require(std::isfinite(value) && value >= 0, "a pixel that is no light");
            require(!is_unlit || value <= 1 + 1e-4f, "a pixel brighter than all that shines");
        }
    }
}

/// The picture's own header draws it again.
void require_redrawn(const Image& image, const Bytes& bytes, const PictureRequest& request) {
    const std::string file =
        put_file("drawn.exr", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    SceneRequest drawn_scene;
    drawn_scene.file = file;
    const Renderer again(load_scene(drawn_scene));
    require(encode_image(again.draw(request).image) == bytes, "a picture's header draws another picture");
    std::map<std::string, std::string> said = image.metadata;
    std::erase_if(said, [](const auto& entry) { return entry.second.empty(); });  // they are not kept
    require(read_image(file).metadata == said, "a picture's header is another once it is read");
}

/// A part of the film is what the whole shows there.
void require_window(const Renderer& renderer, const Image& whole, PictureRequest request) {
    request.layers.x0 = whole.width / 3, request.layers.y0 = whole.height / 4;
    request.layers.x1 = whole.width - 1, request.layers.y1 = whole.height / 2;
    const Image part = renderer.draw(request).image;
    for (const Channel& channel : part.channels) {
        const Channel* other = whole.find(channel.name);
        require(other != nullptr, "a window has a channel that the whole lacks");
        for (int y = 0; y < part.data_height; ++y)
            for (int x = 0; x < part.data_width; ++x) {
                const auto in_part = static_cast<std::size_t>(y * part.data_width + x);
                const auto in_whole = static_cast<std::size_t>((part.y0 + y) * whole.width + part.x0 + x);
                const bool same = channel.is_id() ? channel.ids()[in_part] == other->ids()[in_whole]
                                                  : channel.floats()[in_part] == other->floats()[in_whole];
                require(same, "a window's " + channel.name + " is not the whole's");
            }
    }
}

/// Each point has its answer; an image's steps are its events, and its weights are shares of light.
void require_images(const Renderer& renderer, const Scene& scene) {
    std::vector<Vec3> points;
    for (const Mesh& mesh : scene.meshes)
        if (!mesh.object.points.empty()) points.push_back(mesh.object.points.front());
    if (points.empty()) return;
    ProjectRequest request;
    request.max_images = 6;
    const std::vector<PointProjection> found = renderer.project(points, request);
    require(found.size() == points.size(), "points without an answer");
    for (std::size_t p = 0; p < found.size(); ++p)
        for (const WorldImage& image : found[p].images) {
            require(image.steps.size() == image.events.size() || image.events.empty(),
                    "an image whose events are not its steps");
            for (int c = 0; c < 3; ++c)
                require(image.weight[c] >= 0 && image.weight[c] <= 1 + 1e-9, "a weight that is no share");
        }
}

}  // namespace

Answer random_scene(std::string_view bytes) {
    const RandomScene random = make_random_scene(bytes);
    return answer([&] {
        const Scene scene = parse_scene(random.json);
        const Renderer renderer(scene);
        const PictureRequest request = picture(0);
        const Bytes bytes_of_picture = drawn(renderer, request);
        const Image image = renderer.draw(request).image;
        require_light(image, random.is_unlit);
        require_redrawn(image, bytes_of_picture, request);
        require_window(renderer, image, request);

        const Image other = renderer.draw(picture(random.other_resolution)).image;
        require(compare(image, image).metrics.max == 0, "a picture differs from itself");
        require(compare(image, other).metrics.rmse == compare(other, image).metrics.rmse,
                "a and b are otherwise apart than b and a");

        const trilens_test::Agreement agreement = trilens_test::compare_engines(renderer.world());
        require(agreement.off_edge == 0,
                "the projector and the rays of its facets differ off edges: " + agreement.first_off_edge);
        require_images(renderer, scene);
    });
}

}  // namespace trilens_fuzz
