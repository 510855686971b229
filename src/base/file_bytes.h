// Whole files as bytes: written beside their name and renamed, with the reason where that fails.
#pragma once

#include <cstddef>
#include <cstdio>
#include <span>
#include <string>

namespace trilens {

/// Where writing to `file` ends: behind symbolic links, the file that they name. Throws OutputError for
/// devices and pipes, which a rename would destroy, and for links in a circle.
std::string output_target(const std::string& file);

/// A new file beside output_target(file), written piece by piece, which takes its name when it is whole: a
/// reader sees the old file or the whole new one. Without commit() it leaves nothing behind. All throw
/// OutputError with the system's reason; the constructor also as output_target does.
class FileReplacement {
  public:
    explicit FileReplacement(const std::string& file);
    ~FileReplacement();
    FileReplacement(const FileReplacement&) = delete;
    FileReplacement& operator=(const FileReplacement&) = delete;

    void write(std::span<const unsigned char> bytes, std::size_t offset);
    void commit();

  private:
    [[noreturn]] void fail(const std::string& reason) const;

    std::string file_, temporary_;
    std::FILE* stream_ = nullptr;
    std::size_t at_ = 0;  // where the stream stands
    bool is_committed_ = false;
};

/// Writes `bytes` to a new file beside output_target(file), then renames it: a reader sees the old file or
/// the whole new one. Leaves nothing behind on failure. Throws OutputError with the system's reason, and as
/// output_target does.
void replace_file(const std::string& file, std::span<const unsigned char> bytes);

/// The size of a file that can be read. Throws InputError: missing, a folder, not permitted.
std::size_t readable_size(const std::string& file);

}  // namespace trilens
