// Atomic writing: a temporary file beside the name, renamed once it is whole.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace trilens {

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

    std::string target_, name_;  // name_: empty once it has taken its place
    int descriptor_ = -1;        // -1: closed
};

}  // namespace trilens
