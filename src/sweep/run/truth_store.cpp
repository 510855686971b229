#include "sweep/run/truth_store.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <sstream>

#include "base/files/file_bytes.h"
#include "base/util/error.h"
#include "base/util/hash.h"
#include "base/util/progress.h"
#include "image/image_io.h"
#include "report/text.h"
#include "sweep/store/file_lock.h"

namespace trilens {
namespace {

/// Beside a truth: the seconds that tracing it took, and the hash of the image's bytes.
std::string seconds_file(const std::string& file) {
    return file + ".seconds";
}

/// None where it is not there or damaged: then it is traced again.
std::optional<Truth> read_truth(const std::string& file) {
    const std::optional<std::string> text = read_whole_file(seconds_file(file));
    if (!text) return std::nullopt;
    std::istringstream lines(*text);
    std::string seconds, hash;
    double value = 0;
    lines >> seconds >> hash;
    if (std::from_chars(seconds.data(), seconds.data() + seconds.size(), value).ec != std::errc())
        return std::nullopt;
    const std::optional<std::string> bytes = read_whole_file(file);
    if (!bytes || hash_text(*bytes) != hash) return std::nullopt;
    try {
        return Truth{read_exr(file), value};
    } catch (const InputError&) {
        return std::nullopt;
    }
}

}  // namespace

std::shared_ptr<const KeptTruth> TruthStore::find(const std::string& hash) {
    const std::lock_guard guard(mutex_);
    for (const auto& [known, truth] : kept_)
        if (known == hash) return truth;
    const auto failed = failures_.find(hash);
    if (failed != failures_.end()) std::rethrow_exception(failed->second);
    return nullptr;
}

std::shared_ptr<const KeptTruth> TruthStore::keep(const std::string& hash, Truth truth) {
    auto shared = std::make_shared<const KeptTruth>(std::move(truth));
    const std::lock_guard guard(mutex_);
    kept_.push_front({hash, shared});
    while (kept_.size() > kept_count_) kept_.pop_back();
    return shared;
}

std::shared_ptr<const KeptTruth> TruthStore::trace(const PlannedRun& run, const std::string& file) {
    const Stopwatch watch;
    Truth traced;
    try {
        traced.image = trace_(run);
    } catch (const Interrupted&) {
        throw;
    } catch (const Error&) {
        const std::lock_guard guard(mutex_);
        failures_.emplace(run.truth, std::current_exception());
        throw;
    }
    traced.seconds = watch.seconds();
    write_exr(file, traced.image);
    const std::string bytes = read_whole_file(file).value_or("");
    replace_text_file(seconds_file(file), shortest_text(traced.seconds) + "\n" + hash_text(bytes) + "\n");
    return keep(run.truth, std::move(traced));
}

std::shared_ptr<const KeptTruth> TruthStore::get(const PlannedRun& run, bool may_wait) {
    if (auto known = find(run.truth)) return known;
    const std::string file = truth_file(folder_, run.truth);
    if (std::optional<Truth> kept = read_truth(file)) return keep(run.truth, std::move(*kept));

    std::optional<FileLock> writer = FileLock::try_lock(file + ".lock", LockKind::kOne);
    if (!writer && !may_wait) return nullptr;
    if (!writer) writer = FileLock::wait(file + ".lock", LockKind::kOne, progress_);
    // Whoever held the lock may have traced it.
    if (auto known = find(run.truth)) return known;
    if (std::optional<Truth> kept = read_truth(file)) return keep(run.truth, std::move(*kept));
    return trace(run, file);
}

}  // namespace trilens
