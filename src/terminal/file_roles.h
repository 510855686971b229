// Which files a command reads and which it writes, so that no output is ever an input.
#pragma once

#include <string>
#include <vector>

namespace trilens {

/// "-" is standard input or output, and no file.
bool is_standard_stream(const std::string& file);

class FileRoles {
  public:
    /// Files that are read. Throws UsageError where one is an output already.
    void reads(const std::vector<std::string>& files);

    /// A file that will be written. Throws as check_writable does, and UsageError where it is an input or
    /// another output. The empty name and "-" are no files.
    void writes(const std::string& file);

    /// Whether one of the outputs is there already, and so may be an input.
    bool has_old_outputs() const;

    const std::vector<std::string>& inputs() const { return inputs_; }

  private:
    std::vector<std::string> inputs_, outputs_;
};

/// Whether two names are one file that exists, or one name.
bool is_one_file(const std::string& one, const std::string& other);

}  // namespace trilens
