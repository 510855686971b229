#include "suite/update_reference.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "base/files/file_bytes.h"
#include "base/util/error.h"
#include "base/util/format.h"
#include "image/image_io.h"
#include "suite/judge.h"

namespace trilens {
namespace {

/// The first channel that differs in a bit, and in how many pixels; empty where all is one.
std::string first_difference(const Image& a, const Image& b) {
    if (a.width != b.width || a.height != b.height || a.pixels() != b.pixels()) return "the size differs";
    if (a.channels.size() != b.channels.size()) return "the channels differ";
    for (const Channel& channel : a.channels) {
        const Channel* other = b.find(channel.name);
        if (!other || other->is_id() != channel.is_id())
            return "channel " + channel.name + " is in one alone";
        std::size_t differing = 0;
        for (std::size_t i = 0; i < a.pixels(); ++i)
            differing += channel.is_id()
                             ? channel.ids()[i] != other->ids()[i]
                             : std::memcmp(&channel.floats()[i], &other->floats()[i], sizeof(float)) != 0;
        if (differing > 0) return fmt::format("channel {} differs in {} pixels", channel.name, differing);
    }
    return "";
}

Image draw_reference(const RenderTest& test, const SuiteCallbacks& callbacks) {
    const SuiteScene scene = callbacks.open(test, {});
    const int finest = test.resolutions.empty() ? 0 : test.resolutions.back();
    Image image = test.reference_maker == ReferenceMaker::kTruth    ? scene.draw("limit", 0)
                  : test.reference_maker == ReferenceMaker::kFacets ? scene.draw("facets", finest)
                                                                    : scene.draw(test.engine, finest);
    // What depends on the machine and the day stays out of a file that a repository keeps.
    std::erase_if(image.metadata, [](const auto& entry) {
        return entry.first != "trilens:version" && entry.first != "trilens:engine" &&
               entry.first != "trilens:resolution" && entry.first != "trilens:camera";
    });
    return image;
}

std::string change_text(const RenderTest& test, const SuiteCallbacks& callbacks, const Image& image) {
    std::error_code none;
    if (!std::filesystem::exists(test.reference, none)) return "new";
    try {
        const Image old = callbacks.read(test.reference);
        const std::string difference = first_difference(old, image);
        if (difference.empty()) return "unchanged";
        RenderTest any = test;
        any.max.clear();
        const Judgement judgement = judge(any, old, {{0, image}});
        const std::string metrics = metrics_text(judgement.metrics);
        return "changed: " + difference + (metrics.empty() ? "" : "; " + metrics);
    } catch (const InputError& error) {
        return std::string("changed: the old one could not be read (") + error.what() + ")";
    }
}

}  // namespace

std::string update_reference(const RenderTest& test, const SuiteCallbacks& callbacks) {
    const bool is_stored =
        std::find(test.against.begin(), test.against.end(), Against::kGolden) != test.against.end();
    if (!is_stored || test.reference_maker == ReferenceMaker::kElsewhere) return "";
    const Image image = draw_reference(test, callbacks);
    const std::string unrepeated = first_difference(image, draw_reference(test, callbacks));
    if (!unrepeated.empty())
        throw ComputationError(test.reference + " is left as it is: two pictures of the same scene differ (" +
                               unrepeated + ")");
    const std::string change = change_text(test, callbacks, image);
    if (change == "unchanged") return change;
    make_folder(std::filesystem::path(test.reference).parent_path().string());
    write_exr(test.reference, image);
    return change;
}

}  // namespace trilens
