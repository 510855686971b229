#include "sweep/store/machine.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <string>
#include <thread>

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

}  // namespace trilens
