#include "view/display_stream.h"

namespace trilens {

namespace {

constexpr Vec3 kFacetColour{1, 1, 1}, kEdgeColour{0.2, 0.8, 1}, kFoldColour{1, 0.55, 0.1},
    kImageColour{1, 0.9, 0.2};
constexpr double kCross = 5;  // pixels from a cross's middle to its ends

}  // namespace

std::vector<DisplayLine> stage_lines(const StagePictures& stage) {
    std::vector<DisplayLine> lines;
    for (const FacetEdge& edge : stage.facet_edges) lines.push_back({{edge.from, edge.to}, kFacetColour});
    if (stage.drawn.edges)
        for (const EdgeLine& edge : *stage.drawn.edges) lines.push_back({edge.points, kEdgeColour});
    if (stage.drawn.folds)
        for (const FoldCurve& fold : *stage.drawn.folds) lines.push_back({fold.points, kFoldColour});
    if (stage.drawn.place_images)
        for (const PlaceImage& image : stage.drawn.place_images->images)
            for (const Vec2& arm : {Vec2(kCross, 0), Vec2(0, kCross)})
                lines.push_back({{image.pixel - arm, image.pixel + arm}, kImageColour});
    return lines;
}

DisplayStream::DisplayStream(const std::string& address, const std::string& name)
    : name_(name), server_(address, [this](const std::string& message) { failure_ = message; }) {}

void DisplayStream::send_picture(const std::string& name, const Image& image, Sent& before) {
    Sent now{image.data_width, image.data_height, {}};
    for (const Channel& channel : image.channels) now.channels.push_back(channel.name);
    const bool is_new =
        now.width != before.width || now.height != before.height || now.channels != before.channels;
    before = now;
    is_new ? server_.show(name, image) : server_.update(name, image);
}

void DisplayStream::send(const StagePictures& stage, std::vector<std::string>& warnings) {
    const auto now = std::chrono::steady_clock::now();
    const bool is_whole = stage.projected.data_width == stage.drawn.film_width &&
                          stage.projected.data_height == stage.drawn.film_height;
    const bool is_early = last_ && stage.drawn.stage < DrawStage::kFinest &&
                          std::chrono::duration<double>(now - *last_).count() < kDisplayPause;
    if (server_.is_connected() && is_whole && !is_early) {
        send_picture(name_, stage.projected, projected_);
        if (stage.truth.data_width > 0) send_picture(name_ + " (truth)", stage.truth, truth_);
        const std::vector<DisplayLine> lines = stage_lines(stage);
        if (!lines.empty() || has_lines_) server_.show_lines(name_, lines);
        has_lines_ = !lines.empty();
        last_ = std::chrono::steady_clock::now();
    }
    if (!failure_.empty()) warnings.push_back(failure_);
}

}  // namespace trilens
