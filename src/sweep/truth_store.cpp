#include "sweep/truth_store.h"

#include <charconv>

#include "base/error.h"
#include "base/files.h"
#include "base/stopwatch.h"
#include "image/image_io.h"
#include "report/text.h"
#include "sweep/file_lock.h"

namespace trilens {
namespace {

std::string seconds_file(const std::string& file) {
    return file + ".seconds";
}

/// None where it is not there or damaged: then it is traced again.
std::optional<Truth> read_truth(const std::string& file) {
    const std::optional<std::string> text = read_whole_file(seconds_file(file));
    double seconds = 0;
    if (!text || std::from_chars(text->data(), text->data() + text->size(), seconds).ec != std::errc())
        return std::nullopt;
    try {
        return Truth{read_exr(file), seconds};
    } catch (const InputError&) {
        return std::nullopt;
    }
}

}  // namespace

const Truth& TruthStore::get(const PlannedRun& run) {
    if (truth_ && hash_ == run.truth) return *truth_;
    truth_.reset();
    hash_ = run.truth;
    const std::string file = truth_file(folder_, run.truth);
    const FileLock writer = FileLock::wait(file + ".lock", LockKind::kOne, progress_);
    truth_ = read_truth(file);
    if (truth_) return *truth_;

    const Stopwatch watch;
    Truth traced{trace_(run.n), 0};
    traced.seconds = watch.seconds();
    write_exr(file, traced.image);
    replace_text_file(seconds_file(file), shortest_text(traced.seconds) + "\n");
    return truth_.emplace(std::move(traced));
}

}  // namespace trilens
