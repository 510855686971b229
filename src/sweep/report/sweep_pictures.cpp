#include "sweep/report/sweep_pictures.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/files/files.h"
#include "base/util/error.h"
#include "base/util/format.h"
#include "base/util/parallel.h"
#include "image/image_io.h"
#include "report/text.h"
#include "sweep/report/sweep_report.h"
#include "sweep/store/sweep_folder.h"

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
    // Where all but a hundredth are equal the few others decide.
    const double most = find_value(run.metrics, "rgb_p99").value_or(0);
    const double scale = difference_scale(most > 0 ? most : largest);
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

namespace {

constexpr std::size_t kMostOpen = 12;  // runs; of more only titles show until they are opened
constexpr std::size_t kBatch = 64;     // runs whose pictures are made at once

Facts run_facts(const RunRecord& run) {
    Facts facts;
    for (const OpticDisplacement& one : run.displacement) {
        if (run.displacement.size() > 1 && one.optic == kAllOptics) continue;
        const std::string mean = value_text(one.metrics, "disp_mean_px");
        facts.emplace_back(one.layer + ", " + one.optic,
                           mean.empty() ? "no displacement could be measured"
                                        : "mean " + mean + " px, 95 % of the pixels within " +
                                              value_text(one.metrics, "disp_p95_px") + " px");
        facts.emplace_back(one.layer + ", " + one.optic + ", measured", measured_text(one.metrics));
    }
    facts.emplace_back("RGB RMSE", value_text(run.metrics, "rgb_rmse"));
    facts.emplace_back("largest colour difference", value_text(run.metrics, "rgb_max"));
    const std::string traced = value_text(run.metrics, "t_trace_s");
    facts.emplace_back("time", value_text(run.metrics, "t_total_s") + " s" +
                                   (traced.empty() ? "" : ", the truth by ray tracing " + traced + " s"));
    return facts;
}

ReportRun run_section(const std::string& folder, const RunRecord& run, TruthPictures& truths,
                      KeptPictures* kept) {
    ReportRun section;
    section.title = point_text(run.plan.at);
    section.warnings = run.warnings;
    if (run.state == RunState::kFailed) {
        section.error = "failed (exit code " + std::to_string(run.exit_code) + "): " + run.error;
        return section;
    }
    if (run.state == RunState::kMissing) {
        section.error = "not done yet";
        return section;
    }
    std::optional<std::vector<PagePicture>> made;
    if (kept) made = kept->take(run.plan);
    section.pictures = made ? std::move(*made) : run_pictures(folder, run, truths);
    section.facts = run_facts(run);
    return section;
}

std::size_t bytes_of(const ReportRun& run) {
    std::size_t bytes = 0;
    for (const PagePicture& picture : run.pictures) bytes += picture.png.size() * 4 / 3;
    return bytes;
}

/// Pictures as files beside the page, which then links them.
void put_beside(const std::string& folder, std::span<const RunRecord> runs, std::span<ReportRun> sections,
                OwnReportFiles& own) {
    std::vector<std::string> names;
    std::vector<PagePicture*> pictures;
    for (std::size_t i = 0; i < runs.size(); ++i) {
        int count = 0;
        for (PagePicture& picture : sections[i].pictures) {
            if (picture.png.empty() || !picture.file.empty()) continue;
            names.push_back(fmt::format("{}-{}.png", runs[i].plan.id, ++count));
            pictures.push_back(&picture);
        }
    }
    own.will_write(names);
    for (std::size_t i = 0; i < names.size(); ++i) {
        pictures[i]->file = "pictures/" + names[i];
        replace_file(folder + "/" + pictures[i]->file, pictures[i]->png);
        pictures[i]->png.clear();
    }
}

}  // namespace

void fill_runs(const SweepSummary& summary, std::size_t most_bytes, Report& report, KeptPictures* kept) {
    const std::vector<RunRecord>& runs = summary.runs;
    report.runs.resize(runs.size());
    OwnReportFiles own(summary.folder, "pictures");
    TruthPictures truths(summary.folder);
    std::size_t bytes = 0, embedded = 0;
    for (std::size_t from = 0; from < runs.size(); from += kBatch) {
        const std::size_t to = std::min(runs.size(), from + kBatch);
        // Decoding and encoding pictures is most of a report's time.
        parallel_for(to - from, 1, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = from + first; i < from + last; ++i) {
                report.runs[i] = run_section(summary.folder, runs[i], truths, kept);
                report.runs[i].is_folded = runs.size() > kMostOpen;
                report.runs[i].row = static_cast<int>(i);
            }
        });
        for (std::size_t i = from; i < to; ++i) bytes += bytes_of(report.runs[i]);
        if (bytes <= most_bytes) continue;
        put_beside(summary.folder, std::span(runs).subspan(embedded, to - embedded),
                   std::span(report.runs).subspan(embedded, to - embedded), own);
        embedded = to;
    }
    own.remove_others();
    if (const std::size_t missing = summary.count(RunState::kMissing))
        report.warnings.push_back(std::to_string(missing) + " of the runs are not done yet");
    if (const std::size_t failed = summary.count(RunState::kFailed))
        report.warnings.push_back(std::to_string(failed) + " of the runs failed; each says why below");
    if (runs.size() > kMostOpen) report.pictures_note = "A click on a run shows its pictures. ";
    if (embedded > 0) report.pictures_note += "The pictures lie in the folder pictures beside this page. ";
}

}  // namespace trilens
