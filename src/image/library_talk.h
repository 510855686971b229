// What libpng prints on stderr by itself, kept from the user: the failure is told once, as our message.
#pragma once

#include <mutex>
#include <string>

namespace trilens {

/// While it lives, stderr of the whole process goes to memory; at its end what libpng said is dropped and
/// everything else (of other threads) is printed. One at a time: a second waits. Where the system refuses,
/// nothing is changed and libpng is heard.
class LibraryTalk {
  public:
    LibraryTalk();
    ~LibraryTalk();
    LibraryTalk(const LibraryTalk&) = delete;
    LibraryTalk& operator=(const LibraryTalk&) = delete;

  private:
    std::unique_lock<std::mutex> only_one_;
    int stderr_ = -1, memory_ = -1;
};

/// `text` without the lines that libpng writes ("libpng error: ...", "libpng warning: ...").
std::string without_libpng(const std::string& text);

}  // namespace trilens
