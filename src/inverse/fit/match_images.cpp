// Matching of pairs to the images that project lists: the nearest, or the one that a pair names.
#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "inverse/fit/fit_problem.h"
#include "render/project/project.h"
#include "render/world/world.h"

namespace trilens {
namespace {

std::string word_of(const WorldImage& image) {
    if (image.path == Path::kDirect) return "D";
    std::string word;
    for (const Step& step : image.steps)
        if (step.event != Event::kPass) word += step.event == Event::kReflect ? 'R' : 'T';
    return word;
}

/// Whether an image's events are those that a word asks for.
bool fits(const std::string& word, const std::string& asked) {
    if (asked.empty()) return word != "D";
    if (word.size() != asked.size()) return false;
    return std::equal(word.begin(), word.end(), asked.begin(),
                      [](char is, char wanted) { return is == wanted || (wanted == '?' && is != 'D'); });
}

/// Whether the ray at an image's pixel goes over the optics that the image is over: of images over one optic
/// others may lie between.
bool is_followed(const World& world, const FitScene& scene, const FitPair& pair, const WorldImage& image) {
    const std::string word = word_of(image);
    if (word.empty()) return false;
    const std::optional<ShotPath> path = shoot_path(scene, pair.camera, image.pixel, word);
    if (!path) return false;
    std::size_t k = 0;
    for (const Step& step : image.steps)
        if (step.event != Event::kPass &&
            (k >= path->events.size() ||
             scene.optics[path->events[k++].optic].mesh != world.optics[step.optic].mesh))
            return false;
    return true;
}

/// Of the images that a pair may be, the nearest that is followed; where none is, the nearest.
const WorldImage* nearest_image(const World& world, const FitScene& scene, const FitPair& pair,
                                const std::vector<WorldImage>& images) {
    const WorldImage* best = nullptr;
    std::pair<bool, double> least;
    for (const WorldImage& image : images) {
        if (!fits(word_of(image), pair.word)) continue;
        const std::pair off(!is_followed(world, scene, pair, image), length(image.pixel - pair.pixel));
        if (!best || off < least) best = &image, least = off;
    }
    return best;
}

}  // namespace

void match_images(const World& world, std::span<const Correspondence> given, FitMatch match,
                  FitProblem& problem) {
    std::vector<FitPair>& pairs = problem.pairs();
    for (std::size_t c = 0; c < world.scene.cameras.size(); ++c) {
        std::vector<Vec3> points;
        std::vector<std::size_t> of_pair;
        for (std::size_t i = 0; i < pairs.size(); ++i)
            if (pairs[i].camera == c) points.push_back(pairs[i].point), of_pair.push_back(i);
        if (points.empty()) continue;
        ProjectRequest request;
        request.frame.camera = c;
        const std::vector<PointProjection> found = project_points(world, request, points);
        for (std::size_t k = 0; k < points.size(); ++k) {
            FitPair& pair = pairs[of_pair[k]];
            const auto wanted = static_cast<std::size_t>(given[of_pair[k]].image);
            const std::vector<WorldImage>& images = found[k].images;
            const WorldImage* best = match != FitMatch::kId
                                         ? nearest_image(world, problem.scene(), pair, images)
                                     : wanted < images.size() ? &images[wanted]
                                                              : nullptr;
            pair.is_lost = !best;
            if (!best) continue;
            pair.guess = best->pixel;
            pair.word = word_of(*best);
            pair.events = pair.word == "D" ? 0 : pair.word.size();
        }
    }
}

}  // namespace trilens
