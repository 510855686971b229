#include "sweep/report/sweep_pictures.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include "base/util/error.h"
#include "base/util/parallel.h"
#include "image/image_io.h"
#include "report/text.h"
#include "sweep/store/measure_run.h"

namespace trilens {
namespace {

PagePicture words_alone(const std::string& caption) {
    return {caption, 0, 0, {}, {}, false};
}

/// The picture, or its caption and the reason why there is none.
PagePicture picture_or_reason(const std::string& caption, const std::function<PagePicture()>& make) {
    try {
        return make();
    } catch (const InputError& error) {
        return words_alone(caption + ": " + error.what());
    }
}

/// On the one scale of all runs of all pages, so that pictures may be compared.
PagePicture displacement_of(const DisplacementMap& map, int width) {
    const bool is_zero = std::ranges::all_of(map.pixels, [](float value) { return !(std::abs(value) > 0); });
    const std::string caption = "displacement, " + map.layer;
    if (is_zero) return words_alone(caption + ": zero wherever it was measured");
    return displacement_picture(map.pixels, width, {}, caption + displacement_colours(map.pixels));
}

std::vector<PagePicture> displacement_pictures(const Image& diff) {
    std::vector<PagePicture> pictures;
    for (const DisplacementMap& map : displacement_maps(diff))
        pictures.push_back(displacement_of(map, diff.data_width));
    return pictures;
}

void append(std::vector<PagePicture> more, std::vector<PagePicture>& pictures) {
    pictures.insert(pictures.end(), std::make_move_iterator(more.begin()),
                    std::make_move_iterator(more.end()));
}

}  // namespace

PagePicture run_difference(const Image& image, const Image& truth, const RunRecord& run) {
    const double largest = find_value(run.metrics, "rgb_max").value_or(0);
    if (largest == 0) return words_alone("difference: none, every colour is the truth's");
    // The first that is not zero: where most are equal the few others decide.
    double decisive = largest;
    for (const char* name : {"rgb_p99", "rgb_p95"})
        if (const double value = find_value(run.metrics, name).value_or(0); value > 0) decisive = value;
    const double scale = difference_scale(decisive);
    return difference_picture(
        image, truth, scale,
        "|projected − truth| × " + shortest_text(scale) + ", largest " + rounded_text(largest, 2));
}

std::shared_ptr<const TruthPictures::Shown> TruthPictures::get(const std::string& hash) {
    const std::lock_guard guard(mutex_);
    if (last_ && hash == hash_) return last_;
    // Others wait meanwhile: the loops in here must not take up their work.
    run_isolated([&] {
        Image image = read_exr(truth_file(folder_, hash));
        PagePicture picture = beauty_picture(image, "truth");
        std::erase_if(image.channels, [](const Channel& channel) {
            return channel.name != "R" && channel.name != "G" && channel.name != "B";
        });
        last_ = std::make_shared<const Shown>(Shown{std::move(image), std::move(picture)});
    });
    hash_ = hash;
    return last_;
}

std::vector<PagePicture> run_pictures(const std::string& folder, const RunRecord& run,
                                      TruthPictures& truths) {
    const std::string home = run_folder(folder, run.plan.id);
    std::vector<PagePicture> pictures;
    std::optional<Image> image;
    std::shared_ptr<const TruthPictures::Shown> truth;
    pictures.push_back(picture_or_reason("projected", [&] {
        image = read_exr(home + "/image.exr");
        return beauty_picture(*image, "projected");
    }));
    pictures.push_back(picture_or_reason("truth", [&] {
        truth = truths.get(run.plan.truth);
        return truth->picture;
    }));
    pictures.back().is_over_previous = true;

    const PagePicture failed = picture_or_reason("displacement", [&] {
        append(displacement_pictures(read_exr(home + "/diff.exr")), pictures);
        return PagePicture{};
    });
    if (!failed.caption.empty()) pictures.push_back(failed);
    if (image && truth)
        pictures.push_back(
            picture_or_reason("difference", [&] { return run_difference(*image, truth->image, run); }));
    return pictures;
}

PagePicture KeptPictures::truth_picture(const RunRecord& run, const Image& truth) {
    {
        const std::lock_guard guard(mutex_);
        if (truth_ == run.plan.truth) return truth_picture_;
    }
    PagePicture picture = picture_or_reason("truth", [&] { return beauty_picture(truth, "truth"); });
    picture.is_over_previous = true;
    const std::lock_guard guard(mutex_);
    truth_ = run.plan.truth;
    return truth_picture_ = std::move(picture);
}

void KeptPictures::make(const RunRecord& run, const RunImages& images) {
    {
        const std::lock_guard guard(mutex_);
        if (bytes_ >= most_bytes_) return;
    }
    PagePicture projected, truth, difference;
    std::vector<PagePicture> displacement, all;
    run_side_by_side({[&] {
                          projected = picture_or_reason(
                              "projected", [&] { return beauty_picture(images.image, "projected"); });
                          truth = truth_picture(run, images.truth);
                      },
                      [&] { displacement = displacement_pictures(images.diff); },
                      [&] {
                          difference = picture_or_reason(
                              "difference", [&] { return run_difference(images.image, images.truth, run); });
                      }});
    all.push_back(std::move(projected));
    all.push_back(std::move(truth));
    append(std::move(displacement), all);
    all.push_back(std::move(difference));

    const std::lock_guard guard(mutex_);
    for (const PagePicture& picture : all) bytes_ += picture.png.size();
    runs_[run.plan.id] = {run.plan.hash, std::move(all)};
}

std::optional<std::vector<PagePicture>> KeptPictures::take(const PlannedRun& run) {
    const std::lock_guard guard(mutex_);
    const auto found = runs_.find(run.id);
    if (found == runs_.end() || found->second.hash != run.hash) return std::nullopt;
    std::vector<PagePicture> pictures = std::move(found->second.pictures);
    runs_.erase(found);
    return pictures;
}

}  // namespace trilens
