#include "inverse/unwrap/unwrap.h"

#include <algorithm>
#include <cmath>

#include "base/util/error.h"
#include "base/util/format.h"
#include "base/util/parallel.h"
#include "inverse/maps/film_images.h"
#include "inverse/maps/film_witness.h"
#include "inverse/maps/proxy.h"
#include "inverse/maps/sampled_map.h"
#include "inverse/unwrap/photo.h"
#include "render/world/world.h"

namespace trilens {
namespace {

void check_photo(const World& world, const UnwrapPhoto& photo) {
    const Film& film = world.scene.film;
    if (!photo.picture) throw UsageError("a photograph is missing");
    if (photo.camera >= world.scene.cameras.size()) throw UsageError("there is no such camera");
    if (photo.picture->width != film.width || photo.picture->height != film.height)
        throw InputError(
            photo.name, "",
            fmt::format("has {} x {} pixels and the film {} x {}: give --size {}x{} where the camera "
                        "is the same",
                        photo.picture->width, photo.picture->height, film.width, film.height,
                        photo.picture->width, photo.picture->height));
    if (photo.mask && (photo.mask->width != film.width || photo.mask->height != film.height))
        throw InputError(photo.name, "mask", "is not of the photograph's size");
    if (!(photo.exposure > 0) || !std::isfinite(photo.exposure))
        throw UsageError("a photograph's exposure is a positive number");
}

/// The output while photograph after photograph comes in.
struct Canvas {
    std::size_t width = 0;
    std::vector<float> red, green, blue, least, most, rank, x, y;
    std::vector<Id> count, photo;
    std::vector<double> sum;  // of the blend's weights

    explicit Canvas(const TargetDescription& to) : width(static_cast<std::size_t>(to.width)) {
        const std::size_t pixels = width * static_cast<std::size_t>(to.height);
        for (std::vector<float>* values : {&red, &green, &blue, &least, &most, &rank})
            values->assign(pixels, 0);
        x.assign(pixels, -1);
        y.assign(pixels, -1);
        count.assign(pixels, 0);
        photo.assign(pixels, kNone);
        sum.assign(pixels, 0);
    }
};

struct Candidate {
    const MapImage* image = nullptr;
    Resolution resolution;
    double rank = 0;  // the larger the better
};

/// Draws one photograph into the canvas.
class PhotoDrawer {
  public:
    PhotoDrawer(const UnwrapRequest& request, const UnwrapPhoto& photo, const Target& target, Id index)
        : request_(request), photo_(photo), target_(target), index_(index) {}

    void draw(int px, int py, std::span<const MapImage> images, Canvas& canvas) const {
        if (images.empty()) return;
        const std::optional<TargetPlace> place = target_.place({px + 0.5, py + 0.5});
        if (!place) return;
        std::vector<Candidate> seen;
        for (const MapImage& image : images) {
            if (!may_take(image)) continue;
            Resolution r = resolution_of(image.jacobian, place->dx, place->dy);
            if (place->is_direction) r = {glm::radians(r.least), glm::radians(r.most)};
            if (r.least >= request_.min_resolution) seen.push_back({&image, r, rank_of(image, r)});
        }
        const std::size_t at = static_cast<std::size_t>(py) * canvas.width + static_cast<std::size_t>(px);
        canvas.count[at] += static_cast<Id>(seen.size());
        std::stable_sort(seen.begin(), seen.end(),
                         [](const Candidate& a, const Candidate& b) { return a.rank > b.rank; });
        if (request_.images == UnwrapImages::kBlend) return blend(seen, at, canvas);
        if (seen.size() < static_cast<std::size_t>(request_.rank)) return;
        take(seen[static_cast<std::size_t>(request_.rank - 1)], at, canvas);
    }

  private:
    bool may_take(const MapImage& image) const {
        return !photo_.mask ||
               sample_usable(*photo_.picture, *photo_.mask, image.position, image.jacobian).share >= 0.5;
    }

    /// Longer exposures are less noisy; what has clipped pixels in it comes last.
    double rank_of(const MapImage& image, const Resolution& resolution) const {
        constexpr double kClipped = 1e-9;
        const double rank = resolution.least * std::sqrt(photo_.exposure);
        if (!(photo_.white > 0)) return rank;
        const float brightest = brightest_in_footprint(*photo_.picture, image.position, image.jacobian);
        return brightest >= static_cast<float>(photo_.white) ? kClipped * rank : rank;
    }

    Vec3 colour(const MapImage& image) const {
        Vec3 colour =
            photo_.mask ? sample_usable(*photo_.picture, *photo_.mask, image.position, image.jacobian).colour
                        : sample_footprint(*photo_.picture, image.position, image.jacobian);
        colour /= photo_.exposure;
        if (request_.divide_weight) colour /= glm::max(image.weight, Vec3(kLeastDivisor));
        return colour;
    }

    /// Where this photograph resolves the pixel better than those before.
    bool note_best(const Candidate& seen, std::size_t at, Canvas& canvas) const {
        if (canvas.photo[at] != kNone && canvas.rank[at] >= static_cast<float>(seen.rank)) return false;
        canvas.rank[at] = static_cast<float>(seen.rank);
        canvas.least[at] = static_cast<float>(seen.resolution.least);
        canvas.most[at] = static_cast<float>(seen.resolution.most);
        canvas.x[at] = static_cast<float>(seen.image->position.x);
        canvas.y[at] = static_cast<float>(seen.image->position.y);
        canvas.photo[at] = index_;
        return true;
    }

    void take(const Candidate& seen, std::size_t at, Canvas& canvas) const {
        if (!note_best(seen, at, canvas)) return;
        const Vec3 c = colour(*seen.image);
        canvas.red[at] = static_cast<float>(c.x);
        canvas.green[at] = static_cast<float>(c.y);
        canvas.blue[at] = static_cast<float>(c.z);
    }

    void blend(const std::vector<Candidate>& seen, std::size_t at, Canvas& canvas) const {
        for (const Candidate& one : seen) {
            const double w = std::pow(one.rank, 4) / photo_.exposure;
            if (!(w > 0)) continue;
            note_best(one, at, canvas);
            const Vec3 c = colour(*one.image);
            const double whole = canvas.sum[at] + w, old = canvas.sum[at] / whole, now = w / whole;
            canvas.red[at] = static_cast<float>(old * canvas.red[at] + now * c.x);
            canvas.green[at] = static_cast<float>(old * canvas.green[at] + now * c.y);
            canvas.blue[at] = static_cast<float>(old * canvas.blue[at] + now * c.z);
            canvas.sum[at] = whole;
        }
    }

    const UnwrapRequest& request_;
    const UnwrapPhoto& photo_;
    const Target& target_;
    Id index_;
};

void measure(const Target& target, const Canvas& canvas, Unwrapped& result) {
    double all = 0, seen = 0;
    std::vector<float> least;
    for (std::size_t p = 0; p < canvas.photo.size(); ++p) {
        const auto place = target.place(
            {static_cast<double>(p % canvas.width) + 0.5, static_cast<double>(p / canvas.width) + 0.5});
        if (!place) continue;
        const double share = target.measure(*place);
        all += share;
        if (canvas.photo[p] == kNone) continue;
        seen += share;
        least.push_back(canvas.least[p]);
    }
    result.coverage = all > 0 ? seen / all : 0;
    if (least.empty()) return;
    const auto middle = least.begin() + static_cast<std::ptrdiff_t>(least.size() / 2);
    std::nth_element(least.begin(), middle, least.end());
    result.resolution_median = *middle;
}

Image image_of(Canvas canvas, const TargetDescription& to, bool of_several) {
    Image image;
    image.width = image.data_width = to.width;
    image.height = image.data_height = to.height;
    std::vector<float> alpha(canvas.photo.size());
    for (std::size_t p = 0; p < alpha.size(); ++p) alpha[p] = canvas.photo[p] == kNone ? 0.0f : 1.0f;
    image.channels = {{"R", std::move(canvas.red)},
                      {"G", std::move(canvas.green)},
                      {"B", std::move(canvas.blue)},
                      {"A", std::move(alpha)},
                      {"res.min", std::move(canvas.least)},
                      {"res.max", std::move(canvas.most)},
                      {"src.X", std::move(canvas.x)},
                      {"src.Y", std::move(canvas.y)},
                      {"image.count", std::move(canvas.count)}};
    if (of_several) image.channels.push_back({"image.photo", std::move(canvas.photo)});
    return image;
}

}  // namespace

Unwrapped unwrap(const World& world, const UnwrapRequest& request, const std::vector<UnwrapPhoto>& photos,
                 const Progress& progress) {
    if (photos.empty()) throw UsageError("there is no photograph to unwrap");
    check_target_request(world, request);
    if (request.rank < 1) throw UsageError("images are counted from 1, the best");
    for (const UnwrapPhoto& photo : photos) check_photo(world, photo);
    const Target target(request.target, world.scene);
    const Proxy proxy(request.proxy, world, center_of_directions(world, request.center, request.optic));

    Unwrapped result;
    Canvas canvas(request.target);
    for (std::size_t i = 0; i < photos.size(); ++i) {
        FilmImagesParams params{request.frame, request.optic, request.path,
                                !target.has_directions() || proxy.is_hidden_by_objects()};
        params.frame.camera = photos[i].camera;
        params.cancel = progress.cancel;
        const double share = 1 / double(photos.size());
        const SampledMap map = map_onto_film(world, places_on_film(params, request, target, proxy),
                                             progress.part(double(i) * share, share));
        result.exact_places += map.exact_count();
        result.worst_accepted = std::max(result.worst_accepted, map.worst_accepted());
        const PhotoDrawer drawer(request, photos[i], target, static_cast<Id>(i));
        map.for_each_pixel(
            [&](int x, int y, std::span<const MapImage> images) { drawer.draw(x, y, images, canvas); });
    }
    measure(target, canvas, result);
    if (result.coverage == 0)
        throw InputError(photos[0].name, "",
                         "shows nothing of the target: no image of it lies on the film within an optic");
    result.image = image_of(std::move(canvas), request.target, photos.size() > 1);
    return result;
}

}  // namespace trilens
