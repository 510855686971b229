#include "sweep/store/code_digest.h"

#include <elf.h>
#include <link.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>
#include <span>

#include "base/files/file_bytes.h"
#include "base/util/error.h"
#include "base/util/hash.h"

namespace trilens {
namespace {

constexpr const char* kProgram = "/proc/self/exe";
constexpr std::array kPixelLibraries = {"libembree", "libosd", "libm."};

std::string hexadecimal(std::span<const unsigned char> bytes) {
    std::string text;
    for (const unsigned char byte : bytes) {
        text += "0123456789abcdef"[byte >> 4];
        text += "0123456789abcdef"[byte & 15];
    }
    return text;
}

/// The build id among the notes of one segment, as ELF lays them out: sizes, type, then name and content,
/// each filled up to the segment's alignment.
std::optional<std::string> build_id_in(std::span<const unsigned char> notes, std::size_t alignment) {
    const auto filled = [&](std::size_t size) { return (size + alignment - 1) / alignment * alignment; };
    while (notes.size() >= sizeof(ElfW(Nhdr))) {
        ElfW(Nhdr) note;
        std::memcpy(&note, notes.data(), sizeof note);
        const std::size_t content = sizeof note + filled(note.n_namesz);
        if (content > notes.size() || note.n_descsz > notes.size() - content) break;
        if (note.n_type == NT_GNU_BUILD_ID && note.n_namesz == sizeof ELF_NOTE_GNU &&
            std::memcmp(notes.data() + sizeof note, ELF_NOTE_GNU, sizeof ELF_NOTE_GNU) == 0)
            return hexadecimal(notes.subspan(content, note.n_descsz));
        notes = notes.subspan(std::min(notes.size(), content + filled(note.n_descsz)));
    }
    return std::nullopt;
}

/// One mapped file, as dl_iterate_phdr tells it.
LoadedCode code_of(const dl_phdr_info& info) {
    const auto here = reinterpret_cast<std::uintptr_t>(&loaded_code);
    LoadedCode code{info.dlpi_name && *info.dlpi_name ? info.dlpi_name : kProgram, "", false};
    for (ElfW(Half) i = 0; i < info.dlpi_phnum; ++i) {
        const ElfW(Phdr)& segment = info.dlpi_phdr[i];
        const std::uintptr_t start = info.dlpi_addr + segment.p_vaddr;
        if (segment.p_type == PT_LOAD) code.is_ours |= here >= start && here - start < segment.p_memsz;
        if (segment.p_type != PT_NOTE || !code.build_id.empty()) continue;
        const std::span notes(reinterpret_cast<const unsigned char*>(start), segment.p_memsz);
        code.build_id = build_id_in(notes, segment.p_align == 8 ? 8 : 4).value_or("");
    }
    return code;
}

bool decides_pixels(const LoadedCode& code) {
    const std::string name = std::filesystem::path(code.file).filename().string();
    return code.is_ours || std::any_of(kPixelLibraries.begin(), kPixelLibraries.end(),
                                       [&](const char* start) { return name.rfind(start, 0) == 0; });
}

std::string identity_of(const LoadedCode& code) {
    if (!code.build_id.empty()) return "id " + code.build_id;
    const std::optional<std::string> bytes = read_whole_file(code.file);
    if (!bytes) throw InputError(code.file, "", "cannot be read, and has no build id to know it by");
    return "bytes " + hash_text(*bytes);
}

}  // namespace

std::vector<LoadedCode> loaded_code() {
    std::vector<LoadedCode> code;
    dl_iterate_phdr(
        [](dl_phdr_info* info, std::size_t, void* list) {
            static_cast<std::vector<LoadedCode>*>(list)->push_back(code_of(*info));
            return 0;
        },
        &code);
    return code;
}

std::string digest_of_code(std::vector<LoadedCode> code) {
    std::vector<std::string> identities;
    for (const LoadedCode& one : code)
        if (decides_pixels(one)) identities.push_back(identity_of(one));
    std::sort(identities.begin(), identities.end());
    std::string all;
    for (const std::string& identity : identities) all += identity + "\n";
    return hash_text(all);
}

const std::string& code_digest() {
    static const std::string digest = digest_of_code(loaded_code());
    return digest;
}

}  // namespace trilens
