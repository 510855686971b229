// How far facets show things from their place: fitted against interpolated corner rays and the usual
// approximations, uniform grids against facets divided for an error; and which projected pixels are off by
// more than a pixel though no fold is near. CSV on standard output.
//
//     bench_fitted rays n,n,.. SCENE.json [/json/pointer=VALUE ..]
//     bench_fitted error PX n,n,.. SCENE.json [/json/pointer=VALUE ..]
//     bench_fitted silent n,n,.. SCENE.json [/json/pointer=VALUE ..]
#include <cmath>
#include <cstdio>
#include <ctime>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "image/image_io.h"
#include "measure/displacement/displacement.h"
#include "measure/field/position_field.h"
#include "render/picture/picture.h"
#include "render/world/world.h"
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

    void tell(const std::string& way, const FrameParams& frame, Engine engine = Engine::kExact) const {
        draw(frame, engine);  // trees and grids once
        const double start = cpu_seconds();
        const Picture picture = draw(frame, engine);
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

    /// Projected pixels alone: none that was traced.
    void tell_silent(const std::string& way, const FrameParams& frame) const {
        const Image image = draw(frame, Engine::kExact).image;
        const std::vector<Id>& method = image.find("stat.method")->ids();
        for (const char* layer : {"reflect", "refract"}) {
            const auto found = measure_displacement(truth, image, layer);
            auto field = make_seen_field(truth, layer);
            if (!found || !found->summary || !field) continue;
            link_neighbours(*field);
            const std::vector<std::uint8_t> fold = near_folds(*field);
            std::size_t count[2] = {0, 0}, off[2] = {0, 0}, lost[2] = {0, 0}, worst_at = 0;
            double worst[2] = {0, 0};
            for (std::size_t p = 0; p < method.size(); ++p) {
                if (method[p] == 2 || found->state[p] == Shift::kNothing) continue;
                const std::size_t near = fold[p];
                ++count[near];
                lost[near] += found->state[p] != Shift::kFound;
                const double shift = std::hypot(found->shift_x[p], found->shift_y[p]);
                off[near] += shift > 1;
                if (shift > worst[near] && near == 0) worst_at = p;
                worst[near] = std::max(worst[near], shift);
            }
            std::printf("%s,%s,%d,%s,%zu,%zu,%zu,%.3f,%zu,%zu,%zu,%zu,%zu,%.3f\n", scene.c_str(), way.c_str(),
                        frame.resolution, layer, count[0], off[0], lost[0], worst[0],
                        worst_at % static_cast<std::size_t>(image.width),
                        worst_at / static_cast<std::size_t>(image.width), count[1], off[1], lost[1],
                        worst[1]);
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
    study.world =
        make_world(load_scene(file, overrides, {read_texture, decode_texture, read_heights}), ignore);
    study.draw({}, Engine::kLimitTruth);
    const double start = cpu_seconds();
    study.truth = study.draw({}, Engine::kLimitTruth).image;
    study.trace_seconds = cpu_seconds() - start;
    return study;
}

int run(const std::vector<std::string>& words) {
    if (words.size() < 3)
        throw std::runtime_error("rays N,N SCENE, or error PX N,N SCENE, or silent N,N SCENE");
    const bool rays = words[0] == "rays", silent = words[0] == "silent";
    const std::size_t at = rays || silent ? 1 : 2;
    const Study study =
        make_study(words.at(at + 1), {words.begin() + static_cast<std::ptrdiff_t>(at) + 2, words.end()});
    std::puts(
        silent ? "scene,way,n,layer,pixels,over_1px,lost,max,max_x,max_y,fold_pixels,fold_over_1px,fold_lost,"
                 "fold_max"
               : "scene,way,n,layer,mean,p99,max,pixels,lost,facets,optic_pixels,subdivided,traced,predicted,"
                 "cpu_s,trace_cpu_s");
    for (const int n : numbers(words[at])) {
        for (const CornerRays way : {CornerRays::kInterpolated, CornerRays::kFitted}) {
            FrameParams frame;
            frame.resolution = n;
            frame.rays = way;
            frame.max_error = rays || silent ? 0 : std::stod(words[1]);
            if (silent)
                study.tell_silent(name_of(way), frame);
            else
                study.tell(name_of(way), frame);
        }
        for (const Engine engine : {Engine::kEnvironment, Engine::kPlanar}) {
            if (!rays) break;
            FrameParams frame;
            frame.resolution = n;
            study.tell(engine_name(engine), frame, engine);
        }
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
