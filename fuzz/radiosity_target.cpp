// Fuzz target of radiosity: random scenes whose light is baked; power is neither made nor lost, light is the
// same with any number of threads, and the scene that keeps it reads and draws as any other.
#include <fmt/format.h>

#include <cmath>

#include "fuzz/random_scene.h"
#include "fuzz/target.h"
#include "trilens/image.h"
#include "trilens/maps.h"
#include "trilens/render.h"
#include "trilens/scene.h"

using namespace trilens;

namespace trilens_fuzz {
namespace {

/// The first byte's bits say how; so few patches that a bake takes tenths of a second.
BakeRequest random_request(std::string_view& bytes) {
    const auto take = [&] {
        const unsigned char byte = bytes.empty() ? 0 : static_cast<unsigned char>(bytes.front());
        bytes.remove_prefix(bytes.empty() ? 0 : 1);
        return byte;
    };
    const unsigned char how = take(), size = take();
    BakeRequest request;
    request.solver = how & 1 ? RadiositySolver::kGaussSeidel : RadiositySolver::kProgressive;
    request.form_factors = how & 2 ? FormFactorMethod::kRays : FormFactorMethod::kHemicube;
    request.keeps_lights = how & 4;
    request.hemicube_resolution = 2 + 2 * (how >> 5);
    request.rays = 16 << (how >> 5);
    request.tolerance = how & 8 ? 1e-3 : 0.05;
    request.patch_size = how & 16 ? 0.5 : 1;
    request.smallest_size = 0.125 + size / 1024.0;
    request.contrast = 0.05 + size / 256.0;
    request.most_elements = 400;
    request.checked_vertices = 4;
    return request;
}

/// On a small film, by its JSON, which the baked scene keeps.
Scene small_scene(const std::string& json) {
    SceneRequest request;
    request.file = put_file("radiosity.json", json);
    request.overrides = {{"/film/width", "8"}, {"/film/height", "6"}, {"/film/spp", "1"}};
    request.resolution = 2;
    return load_scene(request);
}

/// What comes goes somewhere, in each colour.
void require_balance(const RadiosityBalance& balance) {
    for (int c = 0; c < 3; ++c) {
        const double came = balance.emitted[c] + balance.from_lights[c],
                     went = balance.absorbed[c] + balance.blocked[c] + balance.escaped[c] + balance.unshot[c];
        require(std::isfinite(came) && std::isfinite(went) && came >= 0, "a power that is none");
        for (const double part :
             {balance.absorbed[c], balance.blocked[c], balance.escaped[c], balance.unshot[c]})
            require(part >= -1e-9 * came, "less than no power goes somewhere");
        require(std::fabs(came - went) <= 1e-6 * came,
                fmt::format("of a power of {} {} is found", came, went));
    }
}

Image picture_of(const Scene& scene) {
    return Renderer(scene).draw({}).image;
}

void require_kept(const Scene& baked) {
    const Image image = picture_of(baked);
    for (const char* name : {"R", "G", "B"})
        for (const float value : image.find(name)->floats())
            require(std::isfinite(value) && value >= 0, "a pixel with baked light that is no light");
    const Image again = picture_of(parse_scene(baked.resolved));
    for (const Channel& channel : image.channels)
        require(again.find(channel.name)->values == channel.values,
                "a baked scene reads back as another: " + channel.name);
}

}  // namespace

Answer random_radiosity(std::string_view bytes) {
    const BakeRequest request = random_request(bytes);
    const RandomScene random = make_random_scene(bytes);
    if (random.is_unlit) return Answer::kTaken;
    return answer([&] {
        const Scene scene = small_scene(random.json);
        const auto baked = [&] { return bake_light(Renderer(scene), request); };
        const Bake one = on_threads(1, baked);
        const std::string other = on_threads(3, baked).scene.resolved;
        require(other == one.scene.resolved, "baked light depends on the number of threads");
        require_balance(one.report.balance);
        require(!one.report.convergence.empty(), "a solver that says nothing");
        require(convergence_plot(one.report, "a.svg").find("</svg>") != std::string::npos,
                "a plot that is none");
        require_kept(one.scene);
    });
}

}  // namespace trilens_fuzz
