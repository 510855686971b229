#include "sweep/store/machine.h"

#include <elf.h>
#include <link.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <thread>

#include "base/description/digest.h"
#include "base/files/files.h"
#include "base/util/error.h"

namespace trilens {
namespace {

double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double seconds_of(const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

double own_seconds() {
    rusage use{};
    getrusage(RUSAGE_SELF, &use);
    return seconds_of(use.ru_utime) + seconds_of(use.ru_stime);
}

/// All that is not idle, waiting for input or taken by the host: user, nice, system, irq, softirq.
std::optional<double> busy_seconds() {
    std::ifstream file("/proc/stat");
    std::string name;
    double user = 0, nice = 0, system = 0, idle = 0, waiting = 0, irq = 0, softirq = 0;
    if (!(file >> name >> user >> nice >> system >> idle >> waiting >> irq >> softirq) || name != "cpu")
        return std::nullopt;
    return (user + nice + system + irq + softirq) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

/// The number behind `key` in a file of lines "key: number kB", in bytes.
std::optional<double> kilobytes(const char* file, const std::string& key) {
    std::ifstream lines(file);
    for (std::string word; lines >> word;) {
        double value = 0;
        if (word == key && lines >> value) return 1024 * value;
    }
    return std::nullopt;
}

std::optional<double> number_in(const char* file) {
    std::ifstream text(file);
    double value = 0;
    return text >> value ? std::optional(value) : std::nullopt;  // "max" is no number
}

}  // namespace

MachineWatch::MachineWatch() : busy_(busy_seconds()), own_(own_seconds()), started_(now()) {}

std::optional<double> MachineWatch::used_by_others() const {
    const std::optional<double> busy = busy_seconds();
    const double wall = now() - started_;
    if (!busy || !busy_ || !(wall > 0)) return std::nullopt;
    // The system counts in ticks of its clock: less than that is nothing.
    const double tick = 1 / static_cast<double>(sysconf(_SC_CLK_TCK));
    const double others = *busy - *busy_ - (own_seconds() - own_) - 2 * tick;
    return std::clamp(others / (wall * std::max(1u, std::thread::hardware_concurrency())), 0.0, 1.0);
}

bool reset_peak_memory() {
    std::ofstream file("/proc/self/clear_refs");
    file << "5" << std::flush;
    return file.good();
}

std::optional<double> peak_memory_mib() {
    const std::optional<double> bytes = kilobytes("/proc/self/status", "VmHWM:");
    return bytes ? std::optional(*bytes / (1 << 20)) : std::nullopt;
}

std::optional<double> available_memory() {
    std::optional<double> bytes = kilobytes("/proc/meminfo", "MemAvailable:");
    const std::optional<double> limit = number_in("/sys/fs/cgroup/memory.max"),
                                used = number_in("/sys/fs/cgroup/memory.current");
    if (limit && used) bytes = std::min(bytes.value_or(*limit), std::max(0.0, *limit - *used));
    return bytes;
}

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
