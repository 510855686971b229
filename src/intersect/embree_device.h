// What this room's doors to Embree share: one spelling for Embree 3 and 4, and a device that throws its
// errors. Internal: only .cpp files of this room include it.
#pragma once

#if TRILENS_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <mutex>
#include <string>

namespace trilens {

/// What a device is asked for, in Embree's words.
std::string embree_configuration(const std::string& isa);

/// An Embree device that keeps the first message of its errors.
class EmbreeDevice {
  public:
    /// `isa`: "sse2", "sse4.2", "avx", "avx2", "avx512", or empty for the best of this machine.
    /// Throws UsageError on other names, ComputationError where Embree makes no device.
    explicit EmbreeDevice(const std::string& isa);
    ~EmbreeDevice();
    EmbreeDevice(const EmbreeDevice&) = delete;
    EmbreeDevice& operator=(const EmbreeDevice&) = delete;

    RTCDevice get() const { return device_; }

    /// Throws ComputationError with Embree's message where something failed since the last check.
    void check(const std::string& doing);

  private:
    RTCDevice device_ = nullptr;
    std::mutex mutex_;     // Embree may report from any thread of a build
    std::string message_;  // empty: no error

    static void on_error(void* self, RTCError code, const char* message);
};

/// A device with one scene, both released at the end.
struct EmbreeTree {
    explicit EmbreeTree(const std::string& isa) : device(isa) {}
    ~EmbreeTree() {
        if (scene) rtcReleaseScene(scene);
    }
    EmbreeTree(const EmbreeTree&) = delete;
    EmbreeTree& operator=(const EmbreeTree&) = delete;

    EmbreeDevice device;
    RTCScene scene = nullptr;  // null: there is nothing to meet
};

/// What a query carries to its callbacks: derive from it and hand it to intersect_one.
#if TRILENS_EMBREE_MAJOR >= 4
using EmbreeContext = RTCRayQueryContext;
inline void init_context(EmbreeContext* context) {
    rtcInitRayQueryContext(context);
}
inline void intersect_one(RTCScene scene, EmbreeContext* context, RTCRayHit* ray) {
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = context;
    rtcIntersect1(scene, ray, &arguments);
}
#else
using EmbreeContext = RTCIntersectContext;
inline void init_context(EmbreeContext* context) {
    rtcInitIntersectContext(context);
}
inline void intersect_one(RTCScene scene, EmbreeContext* context, RTCRayHit* ray) {
    rtcIntersect1(scene, context, ray);
}
#endif

/// The widest packets that the device takes without splitting them: 16, 8 or 4 rays.
inline int native_packet_width(const EmbreeDevice& device) {
    if (rtcGetDeviceProperty(device.get(), RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED)) return 16;
    return rtcGetDeviceProperty(device.get(), RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) ? 8 : 4;
}

/// rtcIntersect and rtcOccluded for rays that travel together.
#if TRILENS_EMBREE_MAJOR >= 4
inline RTCIntersectArguments coherent_arguments() {
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    return arguments;
}
inline void intersect_coherent(const int* valid, RTCScene scene, RTCRayHit16* rays) {
    RTCIntersectArguments arguments = coherent_arguments();
    rtcIntersect16(valid, scene, rays, &arguments);
}
inline void intersect_coherent(const int* valid, RTCScene scene, RTCRayHit8* rays) {
    RTCIntersectArguments arguments = coherent_arguments();
    rtcIntersect8(valid, scene, rays, &arguments);
}
inline RTCOccludedArguments occluded_arguments(EmbreeContext* context) {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    arguments.context = context;
    return arguments;
}
inline void occluded_coherent(const int* valid, RTCScene scene, EmbreeContext* context, RTCRay16* rays) {
    RTCOccludedArguments arguments = occluded_arguments(context);
    rtcOccluded16(valid, scene, rays, &arguments);
}
inline void occluded_coherent(const int* valid, RTCScene scene, EmbreeContext* context, RTCRay8* rays) {
    RTCOccludedArguments arguments = occluded_arguments(context);
    rtcOccluded8(valid, scene, rays, &arguments);
}
inline void occluded_coherent(const int* valid, RTCScene scene, EmbreeContext* context, RTCRay4* rays) {
    RTCOccludedArguments arguments = occluded_arguments(context);
    rtcOccluded4(valid, scene, rays, &arguments);
}
#else
inline RTCIntersectContext coherent_context() {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    return context;
}
inline void intersect_coherent(const int* valid, RTCScene scene, RTCRayHit16* rays) {
    RTCIntersectContext context = coherent_context();
    rtcIntersect16(valid, scene, &context, rays);
}
inline void intersect_coherent(const int* valid, RTCScene scene, RTCRayHit8* rays) {
    RTCIntersectContext context = coherent_context();
    rtcIntersect8(valid, scene, &context, rays);
}
inline void occluded_coherent(const int* valid, RTCScene scene, EmbreeContext* context, RTCRay16* rays) {
    context->flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcOccluded16(valid, scene, context, rays);
}
inline void occluded_coherent(const int* valid, RTCScene scene, EmbreeContext* context, RTCRay8* rays) {
    context->flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcOccluded8(valid, scene, context, rays);
}
inline void occluded_coherent(const int* valid, RTCScene scene, EmbreeContext* context, RTCRay4* rays) {
    context->flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcOccluded4(valid, scene, context, rays);
}
#endif

}  // namespace trilens
