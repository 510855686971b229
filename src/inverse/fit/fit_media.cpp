// What the cameras of a fit stand in.
#include <algorithm>
#include <functional>
#include <utility>

#include "base/util/format.h"
#include "inverse/fit/fit_problem.h"

namespace trilens {
namespace {

std::vector<Id> bodies_in(const Media& media) {
    std::vector<Id> bodies(media.optic.begin(), media.optic.begin() + media.count);
    std::sort(bodies.begin(), bodies.end());
    return bodies;
}

std::string words_of(const std::vector<Id>& bodies, const std::function<std::string(Id)>& name) {
    std::string words;
    for (const Id body : bodies) words += (words.empty() ? "" : " and ") + name(body);
    return words.empty() ? "air" : words;
}

}  // namespace

void ask_media(FitScene& scene) {
    const auto optics = std::make_shared<const std::vector<FitOptic>>(scene.optics);
    const LeavesBody leaves = [optics](Id body, const Ray& ray) {
        const FitOptic& optic = (*optics)[body];
        const Ray own = unmoved_ray(optic, ray);
        return leaves_at(optic.tracer->first_hit(own), own);
    };
    std::vector<GlassBody> bodies;
    for (std::size_t i = 0; i < scene.optics.size(); ++i) {
        const FitOptic& optic = scene.optics[i];
        if (optic.mirror) continue;
        std::vector<Vec3> outline = *optic.outline;
        if (optic.is_moved)
            for (Vec3& point : outline) point = map_point(optic.moved, point);
        bodies.push_back({static_cast<Id>(i), box_around(outline)});
    }
    scene.media.clear();
    for (const Camera& camera : scene.cameras) scene.media.push_back(camera_media_of(bodies, leaves, camera));
}

std::vector<Media> media_of_pairs(const FitScene& scene, std::span<const FitPair> pairs) {
    std::vector<Media> media;
    for (const FitPair& pair : pairs) {
        const std::optional<Ray> ray = exact_ray(scene.cameras[pair.camera], pair.pixel);
        media.push_back(ray ? scene.media[pair.camera].of(*ray) : Media());
    }
    return media;
}

std::vector<std::string> media_warnings(const Scene& scene, const FitProblem& problem,
                                        std::span<const Media> began) {
    const FitScene& now = problem.scene();
    const std::vector<Media> ends = media_of_pairs(now, problem.pairs());
    const auto name = [&](Id optic) {
        return fmt::format("\"{}\"", scene.meshes[now.optics[optic].mesh].name);
    };
    std::vector<std::string> warnings;
    for (std::size_t c = 0; c < now.cameras.size(); ++c) {
        std::size_t changed = 0, last = 0, of_camera = 0;
        for (std::size_t i = 0; i < ends.size(); ++i) {
            if (problem.pairs()[i].camera != c) continue;
            ++of_camera;
            if (bodies_in(began[i]) != bodies_in(ends[i])) ++changed, last = i;
        }
        if (of_camera == 0) continue;
        warn_of_unsure_media(now.media[c], name, [&](const std::string& what) { warnings.push_back(what); });
        if (changed == 0) continue;
        warnings.push_back(fmt::format(
            "/cameras/{} does not end in what it began in: rays of {} of its {} pairs start in {} now, and "
            "started in {}; whether that is right, the fit cannot tell",
            c, changed, of_camera, words_of(bodies_in(ends[last]), name),
            words_of(bodies_in(began[last]), name)));
    }
    return warnings;
}

}  // namespace trilens
