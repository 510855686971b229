#include "image/picture_library.h"

#include <dlfcn.h>

#include <filesystem>
#include <mutex>

#include "base/util/error.h"
#include "base/util/version.h"

namespace trilens {
namespace {

constexpr const char* kFile = TRILENS_PICTURES_FILE;

struct Loaded {
    std::mutex mutex;
    const PictureLibrary* library = nullptr;
    int threads = 0;
};

Loaded& loaded() {
    static Loaded one;
    return one;
}

/// The file of machine code that this function is in; empty where the system cannot tell.
std::filesystem::path own_file() {
    Dl_info info{};
    if (!dladdr(reinterpret_cast<const void*>(&picture_library), &info) || !info.dli_fname) return {};
    return info.dli_fname;
}

/// Opens the library, or says why the system could not.
void* open_library(std::string& reason) {
    std::error_code none;
    const std::filesystem::path beside = own_file().parent_path() / kFile;
    const bool is_there = std::filesystem::exists(beside, none);
    void* handle = dlopen(is_there ? beside.c_str() : kFile, RTLD_LAZY | RTLD_LOCAL);
    if (!handle) {
        const char* why = dlerror();
        reason = one_line(why ? why : "unknown reason");
    }
    return handle;
}

const PictureLibrary* load(std::string& reason) {
    void* handle = open_library(reason);
    if (!handle) return nullptr;
    const auto entry =
        reinterpret_cast<decltype(&trilens_picture_library)>(dlsym(handle, "trilens_picture_library"));
    const PictureLibrary* library = entry ? entry() : nullptr;
    if (library && std::string(library->version) == kVersion) return library;
    reason = std::string(kFile) +
             (library ? " is of version " + std::string(library->version) + ", not " + kVersion
                      : " is something else");
    dlclose(handle);
    return nullptr;
}

}  // namespace

const PictureLibrary* picture_library(std::string& reason) {
    Loaded& state = loaded();
    const std::lock_guard lock(state.mutex);
    if (!state.library) {
        state.library = load(reason);
        if (state.library && state.threads > 0) state.library->set_threads(state.threads);
    }
    return state.library;
}

void set_picture_threads(int threads) {
    Loaded& state = loaded();
    const std::lock_guard lock(state.mutex);
    state.threads = threads;
    if (state.library) state.library->set_threads(threads);
}

std::string library_reason(const std::string& report) {
    std::string line;
    for (const char c : report) {
        if (c != '\n' && c != '\r')
            line += c;
        else if (!line.empty() && line.back() != ' ')
            line += ' ';
    }
    while (!line.empty() && (line.back() == ' ' || line.back() == '.')) line.pop_back();
    return line.empty() ? "unknown reason" : line;
}

}  // namespace trilens
