#include "image/library_talk.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace trilens {
namespace {

std::mutex& the_mutex() {
    static std::mutex mutex;
    return mutex;
}

std::string whole(int file) {
    std::string text;
    char piece[4096];
    lseek(file, 0, SEEK_SET);
    for (ssize_t size = 0; (size = read(file, piece, sizeof piece)) > 0;)
        text.append(piece, static_cast<std::size_t>(size));
    return text;
}

}  // namespace

std::string without_libpng(const std::string& text) {
    std::string kept;
    for (std::size_t from = 0; from < text.size();) {
        const std::size_t end = std::min(text.find('\n', from), text.size() - 1) + 1;
        if (text.compare(from, 7, "libpng ") != 0) kept += text.substr(from, end - from);
        from = end;
    }
    return kept;
}

LibraryTalk::LibraryTalk() : only_one_(the_mutex()) {
    std::fflush(stderr);
    stderr_ = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3);
    memory_ = stderr_ < 0 ? -1 : memfd_create("stderr", MFD_CLOEXEC);
    if (memory_ >= 0) dup2(memory_, STDERR_FILENO);
}

LibraryTalk::~LibraryTalk() {
    if (memory_ >= 0) {
        std::fflush(stderr);
        dup2(stderr_, STDERR_FILENO);
        std::fputs(without_libpng(whole(memory_)).c_str(), stderr);
        close(memory_);
    }
    if (stderr_ >= 0) close(stderr_);
}

}  // namespace trilens
