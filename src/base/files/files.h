// Files: read as a whole, and written atomically, beside their name, then renamed, so that a reader sees the
// old file or the whole new one.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace trilens {

/// What a file's name ends in, in small letters with its dot: ".exr" of "a/B.EXR"; empty where it has no
/// ending.
std::string file_ending(const std::string& file);

// Whole files read, and written in one step: beside their name, then renamed, so that a reader sees the old
// file or the whole new one.

/// Where writing to `file` ends: behind symbolic links, the file that they name. Throws OutputError for
/// devices and pipes, which a rename would destroy, and for links in a circle.
std::string output_target(const std::string& file);

/// Writes `bytes` to a new file beside output_target(file), then renames it: a reader sees the old file or
/// the whole new one. Leaves nothing behind on failure. Throws OutputError with the system's reason, and as
/// output_target does.
void replace_file(const std::string& file, std::span<const unsigned char> bytes);

/// The size of a file that can be read. Throws InputError: missing, a folder, not permitted.
std::size_t readable_size(const std::string& file);

/// Makes `text` the content of `file` in one step. Throws OutputError.
void replace_text_file(const std::string& file, const std::string& text);

/// The bytes of `file`; none where it cannot be read.
std::optional<std::string> read_whole_file(const std::string& file);

/// Makes `folder` and what it lies in; the empty name is the current folder, which is there. Throws
/// OutputError.
void make_folder(const std::string& folder);

/// Removes `file` where it exists. Throws OutputError.
void remove_file(const std::string& file);

/// Throws OutputError where a file of that name could not be created: its folder is missing or not writable,
/// or the name is a folder, a device or a pipe; UsageError where it is one of the files that are read.
void check_writable(const std::string& file, const std::vector<std::string>& inputs);

// Atomic writing: a temporary file beside the name, renamed once it is whole.

/// Until commit() a reader of the name sees the old file, or none; without it nothing is left behind.
class NewFile {
  public:
    /// Beside output_target(file). Throws OutputError with the system's reason, and as output_target does.
    explicit NewFile(const std::string& file);
    ~NewFile();
    NewFile(const NewFile&) = delete;
    NewFile& operator=(const NewFile&) = delete;

    /// Puts all bytes at this place of the file. Throws OutputError with the system's reason.
    void write(std::uint64_t at, std::span<const unsigned char> bytes);

    /// Once, last. Throws OutputError with the system's reason.
    void commit();

  private:
    [[noreturn]] void fail(const std::string& why) const;

    std::string target_, name_;   // name_: empty once it has taken its place
    int descriptor_ = -1;         // -1: closed
    std::size_t unfinished_ = 0;  // its place among those that remove_unfinished_files() removes
};

/// Removes the files of this program that are being written, as far as they are known (some dozens): for one
/// that ends at once. It may be called in a signal's handler.
void remove_unfinished_files() noexcept;

}  // namespace trilens
