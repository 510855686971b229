// trilens compare: error metrics and a verdict.
#include <trilens/compare.h>
#include <trilens/display.h>
#include <trilens/image.h>
#include <trilens/utilities.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "cli/print/print.h"
#include "terminal/command.h"
#include "terminal/libraries.h"

namespace trilens {
namespace {

constexpr double kNotGiven = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kNoCount = std::numeric_limits<std::size_t>::max();

CompareOptions not_given() {
    CompareOptions rules;
    rules.fail = rules.failrelative = rules.failpercent = rules.hardfail = kNotGiven;
    rules.warn = rules.warnpercent = kNotGiven;
    rules.allowfailures = kNoCount;
    return rules;
}

/// The command line's words.
struct CompareCommand {
    CompareRequest request;
    std::vector<std::string> limits;  // "METRIC=VALUE"
    long long mask = -1;

    // Rules of colour as they are given; no number, or the largest: not given.
    CompareOptions rules = not_given();
};

bool is_png(const std::string& file) {
    return file_ending(file) == ".png";
}

/// Without those of one layer.
std::vector<std::string> common_metric_names() {
    std::vector<std::string> names = metric_names();
    std::erase_if(names, [](const std::string& name) { return name.find('.') != std::string::npos; });
    return names;
}

/// Throws UsageError for what is no METRIC=VALUE, and for metrics that do not exist.
std::vector<MetricLimit> limits_of(const CompareCommand& command) {
    const std::vector<std::string> known = metric_names();
    std::vector<MetricLimit> limits;
    for (const std::string& text : command.limits) {
        const std::size_t equals = std::min(text.find('='), text.size());
        const std::string metric = text.substr(0, equals);
        if (std::find(known.begin(), known.end(), metric) == known.end())
            throw UsageError("--max: there is no metric \"" + metric + "\"" + suggestion(metric, known));
        double value = 0;
        const char* end = text.data() + text.size();
        const char* begin = text.data() + std::min(equals + 1, text.size());
        const auto [stop, error] = std::from_chars(begin, end, value);
        if (error != std::errc() || stop != end || !std::isfinite(value))
            throw UsageError("--max takes METRIC=VALUE with a finite number, not \"" + text + "\"");
        limits.push_back({metric, value});
    }
    return limits;
}

Image read_input(const CompareRequest& request, bool is_reference, Console& console) {
    const Stopwatch watch;
    const std::string& file = is_reference ? request.reference : request.test;
    const std::string red = request.options.layer + ".R";
    Image image = request.strict ? read_image(file)
                                 : read_compared_image(file, is_reference ? request.layer_of_reference
                                                                          : request.layer_of_test);
    if (!request.options.layer.empty() && !image.find(red))
        throw InputError(file, red, "there is no such channel");
    console.note_stage(
        fmt::format("read {}: {} x {}, {} channels", file, image.width, image.height, image.channels.size()),
        watch);
    return image;
}

Image difference_of(const CompareRequest& request, const ComparedInputs& inputs) {
    Image difference = make_difference(inputs.images.reference, inputs.images.test,
                                       {request.options.layer, request.options.mask_object}, inputs.flip);
    add_shifts(inputs.layers, difference);
    return difference;
}

/// Reference, test and difference in a viewer that compares pictures side by side.
void show(const CompareRequest& request, const ComparedInputs& inputs, DisplayServer& display) {
    if (display.show(request.reference, inputs.images.reference) &&
        display.show(request.test, inputs.images.test))
        display.show("difference", difference_of(request, inputs));
}

/// The difference as a file: all of it as .exr, its magnitude times the scale as .png.
void write_difference(const CompareRequest& request, const ComparedInputs& inputs, Console& console) {
    const Stopwatch watch;
    Image difference = difference_of(request, inputs);
    if (is_png(request.difference)) {
        for (const char* colour : {"R", "G", "B"}) {
            std::vector<float>& values = difference.find(colour)->floats();
            for (float& value : values) value = static_cast<float>(request.scale * std::abs(value));
        }
    }
    write_image(request.difference, difference);
    console.note_stage("wrote " + request.difference, watch);
}

void check_options(const CompareRequest& request, Console& console) {
    const std::string ending = file_ending(request.difference);
    if (!request.difference.empty() && ending != ".exr" && ending != ".png")
        throw UsageError("a difference is written as .exr or .png, not \"" + request.difference + "\"");
    if (request.scale != 1 && !is_png(request.difference))
        throw UsageError("--scale is for a difference in .png: add -o DIFF.png");
    if (request.strict && !(request.layer_of_reference + request.layer_of_test).empty())
        throw UsageError("--strict compares files as they are, without --ref-layer and --test-layer");
    console.files().reads({request.reference, request.test});
    for (const std::string& file : {request.reference, request.test})
        if (request.strict && is_png(file))
            throw InputError(file, "", "is no OpenEXR image: --strict compares those, channel by channel");
    console.files().writes(request.difference);
}

ComparedInputs read_inputs(const CompareRequest& request, Console& console) {
    Image reference = read_input(request, true, console), test = read_input(request, false, console);
    if (request.strict) return {{std::move(reference), std::move(test), {}, {}}, {}, {}, {}};
    return {keep_common_channels(std::move(reference), std::move(test)), {}, {}, {}};
}

/// A broken limit is a failure, beside whatever else is.
void judge_limits(const CompareRequest& request, ComparedInputs& inputs) {
    Comparison& comparison = inputs.comparison;
    for (std::string& reason : broken_limits(request.limits, named_metrics(comparison, inputs.layers))) {
        comparison.verdict = Verdict::kFailure;
        comparison.reasons.push_back(std::move(reason));
    }
}

Answer run(const CompareRequest& request, Console& console) {
    check_options(request, console);
    std::optional<DisplayServer> display;
    if (!request.display_server.empty()) display.emplace(request.display_server, console.warner());
    ComparedInputs inputs = read_inputs(request, console);
    const Stopwatch watch;
    const CommonChannels& images = inputs.images;
    try {
        inputs.flip = layer_flip(images.reference, images.test, request.options.layer);
        inputs.comparison = compare(images.reference, images.test, request.options, &inputs.flip);
        inputs.layers =
            compare_layers(images.reference, images.test, {request.radius, request.options.mask_object});
    } catch (const InputError& error) {
        throw InputError(request.reference + " and " + request.test, "", error.what());
    }
    judge_limits(request, inputs);
    console.note_stage(fmt::format("compared {} channels", images.reference.channels.size()), watch);
    if (display) show(request, inputs, *display);
    if (!request.difference.empty()) write_difference(request, inputs, console);
    if (inputs.comparison.verdict == Verdict::kWarning)
        for (const std::string& reason : inputs.comparison.reasons) console.warn(reason);
    return compare_answer(request, inputs);
}

/// The rules of colour: those given, else the usual ones. Where limits are given, and none of these, the
/// limits judge alone; what they count is counted as usual.
void set_rules(const CompareOptions& given, const std::vector<MetricLimit>& limits, CompareOptions& rules) {
    for (double CompareOptions::*const rule :
         {&CompareOptions::fail, &CompareOptions::failrelative, &CompareOptions::failpercent,
          &CompareOptions::hardfail, &CompareOptions::warn, &CompareOptions::warnpercent})
        if (!std::isnan(given.*rule)) rules.*rule = given.*rule;
    if (given.allowfailures != kNoCount) rules.allowfailures = given.allowfailures;
    // A pixel beyond a larger difference that is allowed is no failure by itself.
    if (!std::isnan(given.fail) && std::isnan(given.hardfail))
        rules.hardfail = std::max(rules.hardfail, given.fail);
    if (limits.empty()) return;

    const auto is_limited = [&](const char* metric) {
        return std::ranges::any_of(limits, [&](const MetricLimit& one) { return one.metric == metric; });
    };
    const bool by_hard = !std::isnan(given.hardfail),
               by_fail = given.allowfailures != kNoCount || !std::isnan(given.fail) ||
                         !std::isnan(given.failrelative) || !std::isnan(given.failpercent),
               by_warn = !std::isnan(given.warn) || !std::isnan(given.warnpercent);
    if (!by_fail && !by_hard) rules.allowfailures = kNoCount;
    if (!by_fail && !is_limited("fail")) {
        rules.fail = INFINITY;
        if (!by_hard && !is_limited("hard")) rules.hardfail = INFINITY;
    }
    if (by_warn) return;
    if (is_limited("warn"))
        rules.warnpercent = 100;
    else
        rules.warn = INFINITY;
}

Answer run(const CompareCommand& command, Console& console) {
    CompareRequest request = command.request;
    request.limits = limits_of(command);
    set_rules(command.rules, request.limits, request.options);
    if (command.mask >= 0) request.options.mask_object = static_cast<Id>(command.mask);
    return run(request, console);
}

std::vector<Option> image_options(CompareCommand& command) {
    return {
        {.names = "REF",
         .target = &command.request.reference,
         .help = "the reference: .exr, .png or any other picture",
         .offer = Offer::kImage,
         .is_required = true},
        {.names = "TEST",
         .target = &command.request.test,
         .help = "the image in question",
         .offer = Offer::kImage,
         .is_required = true},
        {.names = "-o,--output",
         .target = &command.request.difference,
         .help = "difference to write: .exr (signed, magnitude, shifts) or .png (magnitude, sRGB)",
         .value = "DIFF",
         .offer = Offer::kImage},
        {.names = "--scale",
         .target = &command.request.scale,
         .help = ".png: so many times the difference",
         .value = "S",
         .range = {0}},
        {.names = "--display-server",
         .target = &command.request.display_server,
         .help = "show reference, test and difference in the viewer tev (it listens at 127.0.0.1:14158)",
         .value = "HOST:PORT"},
        {.names = "--layer",
         .target = &command.request.options.layer,
         .help = "compare this layer (direct, reflect, refract, or another that both images have) instead "
                 "of the beauty",
         .value = "L"},
        {.names = "--ref-layer",
         .target = &command.request.layer_of_reference,
         .help = "the reference's channels L.R, L.G, L.B, or its part L, are its beauty",
         .value = "L"},
        {.names = "--test-layer",
         .target = &command.request.layer_of_test,
         .help = "the same of the test",
         .value = "L"},
        {.names = "--strict",
         .target = &command.request.strict,
         .help = "OpenEXR files of one part, whose channels match by name and type (numbers, half or float, "
                 "or ids)"},
        {.names = "--mask-object",
         .target = &command.mask,
         .help = "only pixels whose optic.object is this id",
         .value = "ID",
         .range = {0, 4294967294.0}}};
}

std::vector<Option> tolerance_options(CompareCommand& command) {
    return {
        {.names = "--max",
         .target = &command.limits,
         .help =
             "fail where a metric is beyond VALUE (ssim, psnr_db, coverage: below it); may be given several "
             "times: " +
             one_of(common_metric_names()) +
             "; of what is seen and displaced also for one layer: refract.lost_percent. Without a rule of "
             "colour beside "
             "it (--fail and so on) colours are not judged",
         .value = "METRIC=VALUE"},
        {.names = "--fail",
         .target = &command.rules.fail,
         .help = "difference beyond which a pixel fails",
         .range = {0}},
        {.names = "--failpercent",
         .target = &command.rules.failpercent,
         .help = "percentage of pixels that may fail",
         .range = {0, 100}},
        {.names = "--hardfail",
         .target = &command.rules.hardfail,
         .help = "difference that no pixel may exceed",
         .range = {0}},
        {.names = "--failrelative",
         .target = &command.rules.failrelative,
         .help = "a failing pixel must also differ by this share",
         .range = {0}},
        {.names = "--allowfailures",
         .target = &command.rules.allowfailures,
         .help = "so many pixels may differ by any amount",
         .range = {0}},
        {.names = "--warn",
         .target = &command.rules.warn,
         .help = "difference worth a warning",
         .range = {0}},
        {.names = "--warnpercent",
         .target = &command.rules.warnpercent,
         .help = "percentage of pixels that may be so",
         .range = {0, 100}},
        {.names = "--radius",
         .target = &command.request.radius,
         .help = "how far displaced points are looked for, pixels",
         .range = {1, 4096}}};
}

}  // namespace

Command compare_command() {
    auto compared = std::make_shared<CompareCommand>();
    Command command{
        .name = "compare",
        .summary = "error metrics between two images and a verdict: exit 0 within tolerance, 1 beyond",
        .options = joined({image_options(*compared), tolerance_options(*compared)}),
        .schema = "compare"};
    command.body = [compared](Console& console) { return run(*compared, console); };
    return command;
}

}  // namespace trilens
