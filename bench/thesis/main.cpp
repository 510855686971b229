// Makes the scenes of the thesis' chapters 4 and 5: one facet and one triangle for each configuration of
// shapes.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>

#include "thesis/scene_file.h"
#include "thesis/search.h"

namespace {

using namespace trilens;

struct Figure {
    std::string number;           // of the thesis
    Configuration configuration;  // in the thesis' order
    std::uint64_t seed = 0;
    ScoreWeights weights;  // where the usual ones end in poor pictures
};

const Figure kFigures[] = {{"4.1", {2, 2, 2, 3}, 41, {}}, {"4.2", {3, 3, 3}, 42, {}},
                           {"4.3", {4, 2, 3}, 43, {}},    {"4.4", {4, 5}, 44, {}},
                           {"4.5", {6, 3}, 45, {}},       {"4.6", {2, 7}, 446, {}},
                           {"4.7", {9}, 47, {0.7, 0}},    {"8.1", {2, 3}, 81, {}}};

std::string file_name(const std::string& folder, const Figure& figure) {
    std::string name = folder + "/fig_" + figure.number.substr(0, 1) + "_" + figure.number.substr(2);
    if (!figure.configuration.empty()) name += "_";
    for (const std::size_t vertices : figure.configuration) name += std::to_string(vertices);
    return name + ".json";
}

bool make_configuration(const std::string& folder, const Figure& figure) {
    Configuration wanted = figure.configuration;
    std::sort(wanted.begin(), wanted.end());
    SearchParams params;
    params.weights = figure.weights;
    const Found found = search(wanted, figure.seed, params);
    if (found.framed.score == 0) {
        std::fprintf(stderr, "%s: not found in %ld draws\n", figure.number.c_str(), found.draws);
        return false;
    }
    const FacetScene scene = rounded(found.framed.scene);
    const std::vector<double> areas = visible_areas(scene);
    if (configuration_of(scene) != wanted || areas.size() != wanted.size()) {
        std::fprintf(stderr, "%s: rounding changed the configuration\n", figure.number.c_str());
        return false;
    }
    write_facet_scene(file_name(folder, figure), {figure.number, figure.seed, figure.configuration}, scene);
    std::printf("%s score %.4f, %ld draws, areas", figure.number.c_str(), found.framed.score, found.draws);
    for (const double area : areas) std::printf(" %.4f", area);
    std::printf("\n");
    return true;
}

constexpr double kBegin = 0.4;  // of the stretch that holds all shapes: about 0.2 to 0.9

/// A (4,5) as a whole, and the same when its rays begin inside a shape.
void make_behind(const std::string& folder) {
    const std::uint64_t seed = 411;
    FacetScene scene = search({4, 5}, seed).framed.scene;
    write_facet_scene(folder + "/fig_4_11_before.json", {"4.11", seed, {4, 5}}, rounded(scene));
    scene.facet = begun_at(scene.facet, kBegin);
    const Figure figure{"4.11", {}, seed, {}};
    write_facet_scene(file_name(folder, figure), {figure.number, seed, {}}, rounded(scene));
}

void make_borders(const std::string& folder) {
    const std::uint64_t seed = 51;
    const TwoFacets two = search_discontinuity(seed);
    write_two_facets(file_name(folder, {"5.1", {}, seed, {}}), {"5.1", seed, {}}, two);
    write_swept_edge(file_name(folder, {"5.2", {}, seed, {}}), {"5.2", seed, {}}, two);
    std::printf("5.1 gap %.3f of the shared edge\n", two.gap);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: thesis_scenes FOLDER\n");
        return 2;
    }
    try {
        bool all = true;
        for (const Figure& figure : kFigures) all &= make_configuration(argv[1], figure);
        make_behind(argv[1]);
        make_borders(argv[1]);
        return all ? 0 : 1;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 4;
    }
}
