// The pictures of a sweep's runs: projected and truth, how far what is seen moved, how far the colours
// differ; a section of the report for each run.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/image/image.h"
#include "report/page.h"
#include "sweep/store/results.h"

namespace trilens {

/// The truths of a sweep as pictures: one that several runs share is read and encoded once. Thread-safe.
class TruthPictures {
  public:
    struct Shown {
        Image image;  // R, G and B
        PagePicture picture;
    };

    explicit TruthPictures(std::string folder) : folder_(std::move(folder)) {}

    /// By the truth's hash. Throws InputError where it cannot be read.
    std::shared_ptr<const Shown> get(const std::string& hash);

  private:
    std::string folder_;
    std::mutex mutex_;  // of what follows
    std::string hash_;
    std::shared_ptr<const Shown> last_;
};

/// The pictures of one finished run: projected with the truth over it, the displacement of each layer in
/// colours of its own range, and the difference times a factor of its own; ranges and factors are stated. A
/// picture that cannot be made is a caption that says why.
std::vector<PagePicture> run_pictures(const std::string& folder, const RunRecord& run, TruthPictures& truths);

/// The images of a run that is finished.
struct RunImages {
    const Image &image, &truth, &diff;
};

/// Pictures made while a run's images are in memory: a report then need not read them. Thread-safe.
class KeptPictures {
  public:
    /// Once they hold `most_bytes` no more are made.
    explicit KeptPictures(std::size_t most_bytes) : most_bytes_(most_bytes) {}

    /// Makes what run_pictures would make of the run's files.
    void make(const RunRecord& run, const RunImages& images);
    /// Those of this run; none where there are none, or they have been taken.
    std::optional<std::vector<PagePicture>> take(const PlannedRun& run);

  private:
    struct Entry {
        std::string hash;
        std::vector<PagePicture> pictures;
    };

    PagePicture truth_picture(const RunRecord& run, const Image& truth);

    std::size_t most_bytes_, bytes_ = 0;
    std::mutex mutex_;  // of all
    std::string truth_;
    PagePicture truth_picture_;
    std::map<std::string, Entry> runs_;  // by id
};

/// The difference of a run's image and its truth, times a power of two such that it is neither black nor
/// white all over, which the caption states; a caption alone where they are the same.
PagePicture run_difference(const Image& image, const Image& truth, const RunRecord& run);

// A section of a sweep's report for each run, with its pictures.

class KeptPictures;

/// Adds sections of all runs; where their pictures would take more bytes in the page than `most_bytes`, these
/// lie beside it, in the folder pictures, which is else removed. Pictures in `kept` are taken from there, all
/// others made of the runs' files. Throws OutputError.
void fill_runs(const SweepSummary& summary, std::size_t most_bytes, Report& report,
               KeptPictures* kept = nullptr);

}  // namespace trilens
