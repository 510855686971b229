#include "base/files/files.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include "base/util/error.h"

namespace trilens {

std::string file_ending(const std::string& file) {
    std::string ending = std::filesystem::path(file).extension().string();
    for (char& letter : ending)
        if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
    return ending;
}

std::string output_target(const std::string& file) {
    namespace fs = std::filesystem;
    constexpr int kMostLinks = 40;  // as the system has it; a longer chain is a circle
    fs::path target = file;
    std::error_code error;
    for (int links = 0; fs::is_symlink(target, error); ++links) {
        if (links == kMostLinks) throw OutputError(file, "cannot be written: its links form a circle");
        const fs::path next = fs::read_symlink(target, error);
        if (error) throw OutputError(file, "cannot be written: " + error.message());
        target = target.parent_path() / next;
    }
    const fs::file_status status = fs::status(target, error);
    if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status))
        throw OutputError(file, "is a device or a pipe, not a file");
    return target.string();
}

void replace_file(const std::string& file, std::span<const unsigned char> bytes) {
    NewFile made(file);
    made.write(0, bytes);
    made.commit();
}

std::size_t readable_size(const std::string& file) {
    std::error_code error;
    if (std::filesystem::is_directory(file, error)) throw InputError(file, "", "is a folder, not a file");
    std::FILE* in = std::fopen(file.c_str(), "rb");
    if (!in) throw InputError(file, "", "cannot be read: " + std::generic_category().message(errno));
    std::fclose(in);
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    if (error) throw InputError(file, "", "cannot be read: " + error.message());
    return static_cast<std::size_t>(size);
}

// Text files that are either the old ones or the new ones, never half of one.

namespace fs = std::filesystem;

void replace_text_file(const std::string& file, const std::string& text) {
    replace_file(file, {reinterpret_cast<const unsigned char*>(text.data()), text.size()});
}

std::optional<std::string> read_whole_file(const std::string& file) {
    std::error_code failure;
    if (!fs::is_regular_file(file, failure)) return std::nullopt;
    std::ifstream in(file, std::ios::binary);
    if (!in) return std::nullopt;
    // As much as it has now; it may grow or shrink meanwhile.
    const std::uintmax_t size = fs::file_size(file, failure);
    std::string text(failure ? 0 : static_cast<std::size_t>(size) + 1, '\0');
    std::size_t filled = 0;
    while (in) {
        if (filled == text.size()) text.resize(2 * filled + 4096);
        in.read(text.data() + filled, static_cast<std::streamsize>(text.size() - filled));
        filled += static_cast<std::size_t>(in.gcount());
    }
    if (in.bad()) return std::nullopt;
    text.resize(filled);
    return text;
}

void make_folder(const std::string& folder) {
    if (folder.empty()) return;
    std::error_code failure;
    fs::create_directories(folder, failure);
    if (failure) throw OutputError(folder, "cannot be made: " + failure.message());
    if (!fs::is_directory(folder, failure)) throw OutputError(folder, "is not a folder");
}

void remove_file(const std::string& file) {
    std::error_code failure;
    fs::remove(file, failure);
    if (failure) throw OutputError(file, "cannot be removed: " + failure.message());
}

void check_writable(const std::string& file, const std::vector<std::string>& inputs) {
    const std::filesystem::path path(file);
    const std::filesystem::path folder =
        path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
    std::error_code code;
    if (file.empty()) throw OutputError(file, "the output has no name");
    if (!std::filesystem::is_directory(folder, code))
        throw OutputError(file, "there is no folder " + folder.string());
    if (std::filesystem::is_directory(path, code)) throw OutputError(file, "is a folder");
    output_target(file);
    for (const std::string& input : inputs)
        if (std::filesystem::equivalent(path, input, code))
            throw UsageError("the output " + file + " is the input " + input);
    if (access(folder.c_str(), W_OK) != 0)
        throw OutputError(file, "the folder " + folder.string() + " is not writable");
}

namespace {

std::string reason(int error_number) {
    return std::generic_category().message(error_number);
}

/// The names of files that are being written, where a signal's handler can read them.
class UnfinishedFiles {
  public:
    static constexpr std::size_t kMost = 64;

    /// Its place; kMost: there is no room for it.
    std::size_t add(const std::string& name) {
        if (name.size() >= kLongest) return kMost;
        for (std::size_t i = 0; i < kMost; ++i) {
            State free = State::kFree;
            if (!file_[i].state.compare_exchange_strong(free, State::kTaken)) continue;
            std::copy_n(name.c_str(), name.size() + 1, file_[i].name.data());
            file_[i].state = State::kNamed;
            return i;
        }
        return kMost;
    }
    void forget(std::size_t place) {
        if (place < kMost) file_[place].state = State::kFree;
    }
    void remove() noexcept {
        for (File& file : file_)
            if (file.state == State::kNamed) unlink(file.name.data());
    }

  private:
    static constexpr std::size_t kLongest = 4096;
    enum class State : unsigned char { kFree, kTaken, kNamed };
    static_assert(std::atomic<State>::is_always_lock_free, "a signal handler reads it");
    struct File {
        std::atomic<State> state = State::kFree;
        std::array<char, kLongest> name{};
    };
    std::array<File, kMost> file_;
};

constinit UnfinishedFiles unfinished_files;

}  // namespace

void remove_unfinished_files() noexcept {
    unfinished_files.remove();
}

NewFile::NewFile(const std::string& file) : target_(output_target(file)) {
    static std::atomic<unsigned> counter{0};
    constexpr int kMostTries = 1000;
    // Ids of processes come back, so that a name may be one that a killed process left: then the next one is
    // tried.
    int failed = EEXIST;
    for (int tries = 0; tries < kMostTries && failed == EEXIST; ++tries) {
        name_ = target_ + "." + std::to_string(getpid()) + "-" + std::to_string(counter++) + ".part";
        descriptor_ = open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        failed = descriptor_ < 0 ? errno : 0;
    }
    if (failed) fail(reason(failed));
    unfinished_ = unfinished_files.add(name_);
}

NewFile::~NewFile() {
    if (descriptor_ >= 0) close(descriptor_);
    if (name_.empty()) return;
    std::error_code nothing_more_to_do;
    std::filesystem::remove(name_, nothing_more_to_do);
    unfinished_files.forget(unfinished_);
}

void NewFile::fail(const std::string& why) const {
    throw OutputError(target_, "cannot be written: " + why);
}

void NewFile::write(std::uint64_t at, std::span<const unsigned char> bytes) {
    while (!bytes.empty()) {
        const ssize_t written = pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(at));
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) fail(reason(written < 0 ? errno : EIO));
        at += static_cast<std::uint64_t>(written);
        bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
}

void NewFile::commit() {
    // A full disk may speak only here.
    const int failed = close(descriptor_) != 0 ? errno : 0;
    descriptor_ = -1;
    if (failed) fail(reason(failed));
    std::error_code error;
    std::filesystem::rename(name_, target_, error);
    if (error) fail(error.message());
    unfinished_files.forget(unfinished_);
    name_.clear();
}

}  // namespace trilens
