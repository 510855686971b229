// Caustics beside a light tracer: random rays of a light over facets of the
// optics, by Embree (Arvo, Backward Ray Tracing, 1986); and beside the complete
// search for images of a point from the light.
//
//     bench_caustics SCENE.json LIGHT OBJECT WxH RAYS POINTS
//
// The object must be flat. JSON on standard output; seconds are of the
// processor, all threads together.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "base/util/parallel.h"
#include "inverse/maps/caustic_map.h"
#include "light_tracer.h"
#include "render/project/project.h"
#include "render/world/world.h"
#include "scene/load.h"
#include "shade/shade.h"

namespace {

using namespace trilens;

constexpr double kFewRays = 30;  // a cell of fewer does not know its noise
constexpr double kTrueTolerance = 1e-3 / 16;
constexpr double kFollowed = 1.0 / 200;  // beams leave fainter paths out

double cpu_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

void ignore(const std::string&) {}

/// Random ones of the cells whose noise is known.
std::vector<std::size_t> lit_cells(const Histogram& traced, std::size_t count) {
    std::vector<std::size_t> lit;
    for (std::size_t i = 0; i < traced.sum.size(); ++i)
        if (traced.count[i] >= kFewRays) lit.push_back(i);
    std::mt19937 random(1);
    std::shuffle(lit.begin(), lit.end(), random);
    lit.resize(std::min(lit.size(), count));
    return lit;
}

nlohmann::json compare_cells(const CausticMap& map, const Histogram& traced, double cell_area,
                             std::size_t points) {
    const std::vector<std::size_t> lit = lit_cells(traced, points);
    std::size_t within[3] = {};
    double z2 = 0, square = 0, noise2 = 0, mean = 0;
    for (const std::size_t i : lit) {
        const double value = traced.sum[i] / cell_area, noise = std::sqrt(traced.squares[i]) / cell_area;
        const double off = luminance(map.irradiance[i]) - value;
        z2 += off * off / (noise * noise), square += off * off, noise2 += noise * noise, mean += value;
        for (int k = 0; k < 3; ++k) within[k] += std::fabs(off) <= (k + 1) * noise;
    }
    const auto n = static_cast<double>(lit.size());
    return {{"cells", lit.size()},
            {"mean", mean / n},
            {"rms_in_sigmas", std::sqrt(z2 / n)},
            {"within_1_sigma", static_cast<double>(within[0]) / n},
            {"within_2_sigma", static_cast<double>(within[1]) / n},
            {"within_3_sigma", static_cast<double>(within[2]) / n},
            {"rms_difference", std::sqrt(square / n)},
            {"rms_noise", std::sqrt(noise2 / n)}};
}

/// Points of the rectangle, its middle nine tenths.
std::vector<Vec3> random_points(const FlatRectangle& rectangle, std::size_t count) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> unit(0.05, 0.95);
    std::vector<Vec3> points;
    while (points.size() < count) {
        const double u = unit(random);
        points.push_back(rectangle.origin + u * rectangle.u + unit(random) * rectangle.v);
    }
    return points;
}

Receiver receiver_at(const World& world, const Vec3& point, const Vec3& normal) {
    return {point, normal, normal, point + kShadowOffset * world.shading.size * normal, {}};
}

/// The histories of the beams as words, with what of each is to be asked.
std::map<std::string, std::size_t> words_of(const Beams& beams) {
    std::map<std::string, std::size_t> words;
    for (const LightHistory& history : beams.histories) {
        std::string word;
        for (const Step& step : history.steps) word += step.event == Event::kReflect ? 'R' : 'T';
        ++words[word];
    }
    return words;
}

std::string word_of(const std::vector<Step>& steps) {
    std::string word;
    for (const Step& step : steps)
        if (step.event != Event::kPass) word += step.event == Event::kReflect ? 'R' : 'T';
    return word;
}

/// Paths at random points, by beams and by the search for images of the points
/// from the light, in world `seen`, whose camera stands in the light.
nlohmann::json compare_paths(const World& seen, const BeamLight& light, const std::vector<Vec3>& points,
                             const Vec3& normal) {
    std::vector<std::map<std::string, std::size_t>> by_beams(points.size());
    parallel_for(points.size(), 4, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            for (const ExactArrival& one : light.exact_arrivals(receiver_at(seen, points[i], normal)))
                if (luminance(one.single.path.light) >= kFollowed * luminance(one.single.path.arriving))
                    ++by_beams[i][word_of(one.single.path.steps)];
    });
    nlohmann::json words = nlohmann::json::object();
    std::size_t paths = 0, missed = 0, more = 0;
    for (const auto& [word, histories] : words_of(light.beams())) {
        ProjectRequest request;
        request.path = EventWord(word);
        std::size_t of_word = 0, missed_here = 0, more_here = 0;
        const std::vector<PointProjection> found = project_points(seen, request, points);
        for (std::size_t i = 0; i < points.size(); ++i) {
            std::size_t images = 0;
            for (const WorldImage& image : found[i].images)
                images += image.visible && luminance(image.weight) >= kFollowed;
            const std::size_t beams = by_beams[i].contains(word) ? by_beams[i][word] : 0;
            of_word += images;
            missed_here += images - std::min(images, beams), more_here += beams - std::min(images, beams);
        }
        words[word] = {
            {"images", of_word}, {"missed_by_beams", missed_here}, {"missed_by_search", more_here}};
        paths += of_word, missed += missed_here, more += more_here;
    }
    return {{"points", points.size()},
            {"images", paths},
            {"missed_by_beams", missed},
            {"missed_by_search", more},
            {"by_word", words}};
}

/// Random lit cells, and their irradiance by beams divided by exact rays: the truth.
struct TrueCells {
    std::vector<std::size_t> cells;
    std::vector<double> irradiance;
    double cell_area = 0;
};

TrueCells true_cells(const World& world, const std::vector<std::unique_ptr<BeamLight>>& lights,
                     const Histogram& traced, std::size_t count) {
    const FlatRectangle& rectangle = traced.rectangle;
    const Vec3 du = rectangle.u / static_cast<double>(traced.width),
               dv = rectangle.v / static_cast<double>(traced.height);
    TrueCells truth{lit_cells(traced, count), {}, length(du) * length(dv)};
    truth.irradiance.resize(truth.cells.size());
    parallel_for(truth.cells.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const auto width = static_cast<std::size_t>(traced.width);
            const auto x = static_cast<double>(truth.cells[i] % width),
                       y = static_cast<double>(truth.cells[i] / width);
            Receiver there =
                receiver_at(world, rectangle.origin + (x + 0.5) * du + (traced.height - y - 0.5) * dv,
                            rectangle.normal());
            there.sides = {du, -dv};
            there.exact = true;
            truth.irradiance[i] = luminance(irradiance(lights, there));
        }
    });
    return truth;
}

/// Roots of mean squares over the true cells: what a map is off by, and what the tracer's noise is.
double map_rms(const TrueCells& truth, const CausticMap& map) {
    double square = 0;
    for (std::size_t i = 0; i < truth.cells.size(); ++i)
        square += std::pow(luminance(map.irradiance[truth.cells[i]]) - truth.irradiance[i], 2);
    return std::sqrt(square / static_cast<double>(truth.cells.size()));
}

double noise_rms(const TrueCells& truth, const Histogram& traced) {
    double square = 0;
    for (const std::size_t i : truth.cells) square += traced.squares[i] / std::pow(truth.cell_area, 2);
    return std::sqrt(square / static_cast<double>(truth.cells.size()));
}

/// The map against the truth, and the truth against the tracer.
nlohmann::json compare_exact(const TrueCells& truth, const CausticMap& map, const Histogram& traced) {
    std::vector<double> off(truth.cells.size());
    double z2 = 0;
    for (std::size_t i = 0; i < off.size(); ++i) {
        const std::size_t cell = truth.cells[i];
        off[i] = std::fabs(luminance(map.irradiance[cell]) - truth.irradiance[i]);
        const double noise = std::sqrt(traced.squares[cell]) / truth.cell_area;
        z2 += std::pow((truth.irradiance[i] - traced.sum[cell] / truth.cell_area) / noise, 2);
    }
    std::sort(off.begin(), off.end());
    return {{"cells", off.size()},
            {"rms_difference", map_rms(truth, map)},
            {"median_difference", off[off.size() / 2]},
            {"most_difference", off.back()},
            {"exact_in_sigmas_of_tracer", std::sqrt(z2 / static_cast<double>(off.size()))},
            {"rms_noise", noise_rms(truth, traced)}};
}

/// The map with finer and finer beams, each beside what the tracer's noise is after the same time.
nlohmann::json compare_in_equal_time(const World& world, CausticMapRequest request, const TrueCells& truth,
                                     double noise_after_a_second) {
    nlohmann::json rows = nlohmann::json::array();
    for (const double tolerance : {4e-3, 1e-3, 2.5e-4, 6.25e-5, 1.5625e-5}) {
        request.tolerance = tolerance;
        const double start = cpu_seconds();
        const CausticMap map = make_caustic_map(world, request);
        const double seconds = cpu_seconds() - start, rms = map_rms(truth, map),
                     noise = noise_after_a_second / std::sqrt(seconds);
        rows.push_back({{"tolerance", tolerance},
                        {"seconds", seconds},
                        {"beams", map.beams},
                        {"rms", rms},
                        {"tracer_rms", noise},
                        {"ratio", noise / rms}});
    }
    return rows;
}

std::unique_ptr<World> world_of(const std::string& file, const std::vector<SceneOverride>& overrides) {
    return make_world(load_scene(file, overrides, {}), ignore);
}

}  // namespace

int main(int count, char** words) {
    if (count != 7) {
        std::fprintf(stderr, "bench_caustics SCENE.json LIGHT OBJECT WxH RAYS POINTS\n");
        return 2;
    }
    const std::string file = words[1];
    const auto light = static_cast<std::size_t>(std::atoi(words[2]));
    const auto rays = static_cast<std::size_t>(std::atof(words[5])),
               points = static_cast<std::size_t>(std::atof(words[6]));
    const std::unique_ptr<World> world = world_of(file, {});
    CausticMapRequest request;
    request.light = light;
    request.target = parse_target(std::string(words[3]) + ":" + words[4], world->scene);
    const Target target(request.target, world->scene);
    const FlatRectangle rectangle = *target.rectangle();

    object_tracer(*world);
    double start = cpu_seconds();
    const CausticMap map = make_caustic_map(*world, request);
    const double map_seconds = cpu_seconds() - start;

    const FacetWorld facets(*world);
    const std::vector<BeamSource> sources =
        beam_sources(world->scene.lights[light], world->scene.background, world->shading.size);
    std::vector<Vec3> outline;
    for (const SurfaceGrid& grid : facets.grids)
        outline.insert(outline.end(), grid.points.begin(), grid.points.end());
    const LightTracer tracer{facets,
                             sources.front(),
                             windows_on(sources.front(), outline, world->shading.size),
                             request.target.object,
                             {}};
    start = cpu_seconds();
    const Histogram traced = tracer.trace(rays, rectangle, map.width, map.height);
    const double tracer_seconds = cpu_seconds() - start;

    const double cell_area = length(rectangle.u) * length(rectangle.v) / (map.width * map.height);
    const PathWorld optics = optics_for_lights(*world);
    const auto lights = make_beam_lights(*world, optics, light);
    // Borders of histories lie where the first beams have them: finely for the truth.
    const auto fine = make_beam_lights(*world, optics, light, BeamGridParams::within(kTrueTolerance));
    const TrueCells truth = true_cells(*world, fine, traced, points);
    const nlohmann::json cells = compare_cells(map, traced, cell_area, points);
    nlohmann::json answer = {
        {"scene", file},
        {"map", {{"seconds", map_seconds}, {"flux", luminance(map.flux_received)}, {"beams", map.beams}}},
        {"tracer", {{"rays", rays}, {"seconds", tracer_seconds}, {"flux", traced.all}}},
        {"against_tracer", cells},
        {"against_exact", compare_exact(truth, map, traced)},
        {"equal_time", compare_in_equal_time(*world, request, truth,
                                             noise_rms(truth, traced) * std::sqrt(tracer_seconds))}};
    if (!sources.front().is_parallel) {
        Vec3 middle(0);
        for (const Vec3& point : outline) middle += point / static_cast<double>(outline.size());
        const Vec3& eye = sources.front().position;
        const nlohmann::json camera = {
            {{"yfov", 100},
             {"lookAt", {{"eye", {eye.x, eye.y, eye.z}}, {"at", {middle.x, middle.y, middle.z}}}}}};
        const auto seen = world_of(file, {{"/cameras", camera.dump()}});
        answer["paths"] =
            compare_paths(*seen, *lights.front(), random_points(rectangle, points), rectangle.normal());
    }
    std::printf("%s\n", answer.dump(2).c_str());
}
