// How far facets show things from their place: fitted against interpolated corner rays, uniform grids against
// facets divided for an error. CSV on standard output.
//
//     bench_fitted rays n,n,.. SCENE.json [/json/pointer=VALUE ..]
//     bench_fitted error PX n,n,.. SCENE.json [/json/pointer=VALUE ..]
#include <cstdio>
#include <ctime>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "image/image_io.h"
#include "measure/displacement.h"
#include "render/picture.h"
#include "render/world.h"
#include "scene/load.h"

namespace {

using namespace trilens;

/// Of all threads: other work on the machine does not count.
double cpu_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

void ignore(const std::string&) {}

std::vector<int> numbers(const std::string& text) {
    std::vector<int> values;
    std::stringstream in(text);
    for (std::string one; std::getline(in, one, ',');) values.push_back(std::stoi(one));
    return values;
}

struct Study {
    std::unique_ptr<World> world;
    std::string scene;
    Image truth;
    double trace_seconds = 0;

    Picture draw(const FrameParams& frame, Engine engine) const {
        PictureRequest request;
        request.frame = frame;
        request.engine = engine;
        request.layers.layers = {"optic", "reflect", "refract", "path", "stat"};
        return draw_picture(*world, request, {}, {});
    }

    void tell(const std::string& way, const FrameParams& frame) const {
        draw(frame, Engine::kExact);  // trees and grids once
        const double start = cpu_seconds();
        const Picture picture = draw(frame, Engine::kExact);
        const double seconds = cpu_seconds() - start;
        for (const char* layer : {"reflect", "refract"}) {
            const auto found = measure_displacement(truth, picture.image, layer);
            if (!found || !found->summary) continue;
            const LayerStatistics& counts = picture.statistics;
            std::printf("%s,%s,%d,%s,%.5f,%.4f,%.3f,%zu,%zu,%zu,%zu,%zu,%zu,%.3f,%.4f,%.4f\n", scene.c_str(),
                        way.c_str(), frame.resolution, layer, found->summary->mean, found->summary->p99,
                        found->summary->max, found->pixels, found->lost, counts.projected_facets,
                        counts.optic_pixels, counts.subdivided_pixels, counts.traced_pixels,
                        counts.predicted_error, seconds, trace_seconds);
            std::fflush(stdout);
        }
    }
};

Study make_study(const std::string& file, const std::vector<std::string>& settings) {
    std::vector<SceneOverride> overrides;
    for (const std::string& one : settings) {
        const std::size_t equals = one.find('=');
        overrides.push_back({one.substr(0, equals), one.substr(equals + 1)});
    }
    Study study;
    study.scene = file;
    for (const std::string& one : settings) study.scene += " " + one;
    study.world = make_world(load_scene(file, overrides, {read_texture, decode_texture}), ignore);
    study.draw({}, Engine::kLimitTruth);
    const double start = cpu_seconds();
    study.truth = study.draw({}, Engine::kLimitTruth).image;
    study.trace_seconds = cpu_seconds() - start;
    return study;
}

int run(const std::vector<std::string>& words) {
    if (words.size() < 3) throw std::runtime_error("rays N,N SCENE, or error PX N,N SCENE");
    const bool rays = words[0] == "rays";
    const std::size_t at = rays ? 1 : 2;
    const Study study =
        make_study(words.at(at + 1), {words.begin() + static_cast<std::ptrdiff_t>(at) + 2, words.end()});
    std::printf(
        "scene,way,n,layer,mean,p99,max,pixels,lost,facets,optic_pixels,subdivided,traced,predicted,"
        "cpu_s,trace_cpu_s\n");
    for (const int n : numbers(words[at]))
        for (const CornerRays way : {CornerRays::kInterpolated, CornerRays::kFitted}) {
            FrameParams frame;
            frame.resolution = n;
            frame.rays = way;
            frame.max_error = rays ? 0 : std::stod(words[1]);
            study.tell(corner_rays_name(way), frame);
        }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run({argv + 1, argv + argc});
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
