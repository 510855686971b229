// Fuzz target of laws: a random scene is drawn, and what holds for every scene is asked of its pictures.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "fuzz/random_scene.h"
#include "fuzz/ray_laws.h"
#include "fuzz/target.h"
#include "projector/kernel/kernel.h"
#include "render/world/world.h"
#include "tests/laws/agreement.h"
#include "trilens/compare.h"
#include "trilens/image.h"
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

Bytes encoded(const Renderer& renderer, const PictureRequest& request) {
    return encode_image(renderer.draw(request).image);
}

/// The same bytes whatever the number of threads and the instruction set, and whether they are encoded while
/// they are drawn or afterwards.
Bytes drawn(const Renderer& renderer, const PictureRequest& request) {
    const Bytes one = on_threads(1, [&] { return encoded(renderer, request); });
    require(on_threads(3, [&] { return encoded(renderer, request); }) == one,
            "a picture depends on the number of threads");
    require(on_threads(3, [&] { return renderer.draw_exr(request).bytes; }) == one,
            "a picture that is encoded while it is drawn is another");
    const std::vector<std::string> sets = kernel_instruction_sets();
    for (std::size_t i = 1; i < sets.size(); ++i) {
        use_instruction_set(sets[i]);
        const bool same = encoded(renderer, request) == one;
        use_instruction_set("");
        require(same, "a picture is another with " + sets[i]);
    }
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
    require(encoded(again, request) == bytes, "a picture's header draws another picture");
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

/// A renderer that goes on with another scene, and back again, draws what a new one draws.
void require_changed(const Scene& scene, const PictureRequest& request, const Bytes& bytes) {
    Scene other = scene;
    const auto optics = std::ranges::count(other.meshes, Role::kOptic, &Mesh::role);
    if (optics > 1)
        other.meshes.erase(other.meshes.begin());
    else
        other.meshes.front().resolution = other.meshes.front().resolution % 7 + 2;
    const Bytes expected = encoded(Renderer(other), request);
    Renderer renderer(scene);
    encoded(renderer, request);
    renderer.change(other);
    require(encoded(renderer, request) == expected, "a renderer that is changed draws another picture");
    renderer.change(scene);
    require(encoded(renderer, request) == bytes, "a renderer that is changed back draws another picture");
}

/// A scene that is a power of two times as large looks the same, to the last bit.
void require_any_size(std::string_view bytes, const Image& image, const PictureRequest& request) {
    const Image large = Renderer(parse_scene(make_random_scene(bytes, 1024).json)).draw(request).image;
    for (const char* name : {"R", "G", "B"}) {
        const std::vector<float>&a = image.find(name)->floats(), &b = large.find(name)->floats();
        const auto off = std::ranges::mismatch(a, b);
        if (off.in1 == a.end()) continue;
        const auto at = static_cast<int>(off.in1 - a.begin());
        throw Defect(
            fmt::format("a scene that is larger looks otherwise: {} of pixel {},{} is {}, enlarged {}", name,
                        at % image.width, at / image.width, *off.in1, *off.in2));
    }
}

/// A picture is itself; what is measured of two is the same, whichever is the reference.
void require_measured(const Image& a, const Image& b) {
    require(compare(a, a).metrics.max == 0, "a picture differs from itself");
    const Metrics there = compare(a, b).metrics, back = compare(b, a).metrics;
    require(
        there.rmse == back.rmse && there.mae == back.mae && there.max == back.max && there.p95 == back.p95,
        "a and b are otherwise apart than b and a");
    require(std::fabs(there.flip - back.flip) <= 1e-6, "FLIP of a and b is not that of b and a");
    for (const LayerComparison& layer : compare_layers(a, a)) {
        if (layer.displacement && layer.displacement->summary)
            require(layer.displacement->summary->max == 0, "a picture is displaced against itself");
        if (layer.displacement)
            require(layer.displacement->lost == 0 && layer.displacement->missing == 0,
                    "a picture has lost something of itself");
    }
    const SeenMismatch seen = total_seen(compare_layers(a, b)), mirrored = total_seen(compare_layers(b, a));
    require(seen.pixels == mirrored.pixels && seen.coverage_mismatch == mirrored.coverage_mismatch &&
                seen.object_mismatch == mirrored.object_mismatch &&
                seen.primitive_mismatch == mirrored.primitive_mismatch,
            "what a and b show differs otherwise than what b and a do");
}

/// What facets show lies within the bounds that are proven of it.
void require_proofs(const Renderer& renderer, const Image& truth) {
    PictureRequest request = picture(0);
    request.frame.max_error = 0.5;
    request.frame.certify = true;
    request.frame.facets = FacetUse::kAll;
    const Picture proven = renderer.draw(request);
    require(proven.statistics.certified_error <= 0.5, "a proven pixel is off by more than was asked for");
    for (const LayerComparison& layer : compare_layers(truth, proven.image))
        require(!layer.bounds || layer.bounds->beyond == 0,
                "a pixel shows something farther off than is proven, " + layer.layer);
}

void require_laws(const RandomScene& random, std::string_view bytes) {
    const Scene scene = parse_scene(random.json);
    const Renderer renderer(scene);
    const PictureRequest request = picture(0);
    const Bytes bytes_of_picture = drawn(renderer, request);
    const Image image = renderer.draw(request).image;
    require_light(image, random.is_unlit);
    require_window(renderer, image, request);
    require_redrawn(image, bytes_of_picture, request);
    require_changed(scene, request, bytes_of_picture);
    if (random.has_exact_scales) require_any_size(bytes, image, request);
    require_measured(image, renderer.draw(picture(random.other_resolution)).image);

    PictureRequest exact = request;
    exact.engine = Engine::kLimitTruth;
    const Image truth = renderer.draw(exact).image;
    require_light(truth, random.is_unlit);
    require_proofs(renderer, truth);
    const trilens_test::Agreement agreement = trilens_test::compare_engines(renderer.world());
    require(agreement.off_edge == 0,
            "the projector and the rays of its facets differ off edges: " + agreement.first_off_edge);
    Scene short_paths = scene;  // all paths over several optics are searched, whose number grows with depth
    short_paths.render.max_depth = std::min(scene.render.max_depth, 1);
    const Renderer searching(short_paths);
    require_images(searching, short_paths);
    require_shots(renderer, scene, searching);
    renderer.explain(request, image.width / 2, image.height / 2);
    LineChoice lines;
    lines.folds = lines.facets = true;
    require(renderer.draw_lines(request.frame, lines).svg.ends_with("</svg>\n"), "a drawing without an end");
}

}  // namespace

Answer random_scene(std::string_view bytes) {
    const RandomScene random = make_random_scene(bytes);
    return answer([&] {
        try {
            require_laws(random, bytes);
        } catch (const ComputationError& error) {  // a legal scene has a picture
            throw Defect(std::string("a scene that was read is not drawn: ") + error.what());
        }
    });
}

}  // namespace trilens_fuzz
