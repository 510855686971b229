// Devices, threads and version of Embree.
#include "intersect/embree_device.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <string_view>

#include "base/util/error.h"
#include "intersect/tracer.h"

namespace trilens {
namespace {

std::atomic<int> g_threads{0};

const char* error_name(RTCError code) {
    switch (code) {
        case RTC_ERROR_INVALID_ARGUMENT:
            return "invalid argument";
        case RTC_ERROR_INVALID_OPERATION:
            return "invalid operation";
        case RTC_ERROR_OUT_OF_MEMORY:
            return "out of memory";
        case RTC_ERROR_UNSUPPORTED_CPU:
            return "this processor lacks the instruction set";
        case RTC_ERROR_CANCELLED:
            return "cancelled";
        default:
            return "unknown error";
    }
}

// Embree takes a name that it does not know for no name at all.
void check_isa(const std::string& isa) {
    constexpr std::array<std::string_view, 6> known{"", "sse2", "sse4.2", "avx", "avx2", "avx512"};
    if (std::find(known.begin(), known.end(), isa) != known.end()) return;
    throw UsageError("no instruction set '" + isa + "': sse2, sse4.2, avx, avx2 or avx512");
}

}  // namespace

// Files of the user's that Embree would read are ignored: they could change results behind our back.
std::string embree_configuration(const std::string& isa) {
    std::string text = "ignore_config_files=1";
#ifdef TRILENS_PLAIN_THREADS
    // Trees are built where they are asked for: the thread sanitizer does not see what orders TBB's threads.
    text += ",threads=1";
#else
    if (const int threads = g_threads.load(); threads > 0) text += ",threads=" + std::to_string(threads);
#endif
    if (!isa.empty()) text += ",isa=" + isa;
    return text;
}

EmbreeDevice::EmbreeDevice(const std::string& isa) {
    check_isa(isa);
    const std::string text = embree_configuration(isa);
    device_ = rtcNewDevice(text.c_str());
    if (!device_) {
        throw ComputationError("Embree makes no device (" + text +
                               "): " + error_name(rtcGetDeviceError(nullptr)));
    }
    rtcSetDeviceErrorFunction(device_, &EmbreeDevice::on_error, this);
}

EmbreeDevice::~EmbreeDevice() {
    rtcReleaseDevice(device_);
}

void EmbreeDevice::check(const std::string& doing) {
    const std::lock_guard lock(mutex_);
    const RTCError code = rtcGetDeviceError(device_);
    if (code == RTC_ERROR_NONE && message_.empty()) return;
    const std::string message = message_.empty() ? error_name(code) : message_;
    message_.clear();
    throw ComputationError("Embree, " + doing + ": " + message);
}

void EmbreeDevice::on_error(void* self, RTCError code, const char* message) {
    EmbreeDevice& device = *static_cast<EmbreeDevice*>(self);
    const std::lock_guard lock(device.mutex_);
    if (!device.message_.empty()) return;
    device.message_ = error_name(code);
    if (message) device.message_ += std::string(": ") + message;
}

void set_tracer_threads(int threads) {
    g_threads.store(threads);
}

std::string tracer_library_version() {
    EmbreeDevice device("");
    const auto part = [&](RTCDeviceProperty property) {
        return std::to_string(rtcGetDeviceProperty(device.get(), property));
    };
    return "Embree " + part(RTC_DEVICE_PROPERTY_VERSION_MAJOR) + "." +
           part(RTC_DEVICE_PROPERTY_VERSION_MINOR) + "." + part(RTC_DEVICE_PROPERTY_VERSION_PATCH);
}

}  // namespace trilens
