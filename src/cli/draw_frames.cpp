#include "cli/draw_frames.h"
#include "cli/print/output.h"

#include <trilens/animation.h>
#include <trilens/stopwatch.h>
#include <optional>
#include <set>

#include "terminal/format.h"

namespace trilens {
namespace {

/// One frame after the other, each in a file of its own, or all in one animated picture.
class FrameSequence {
  public:
    FrameSequence(const RenderOptions& options, const std::string& format, const PictureRequest& request,
                  Console& console)
        : options_(options), format_(format), request_(request), console_(console) {}

    Answer draw() {
        const std::vector<int> frames = parse_frames(
            options_.frames.frames.empty() ? "0.." + std::to_string(options_.frames.turntable - 1)
                                           : options_.frames.frames);
        const Scene scene = load_scene(options_.scene, console_);
        const std::optional<AnimationInfo> animation = find_animation(scene);
        request_.frame.camera = find_camera(scene, options_.scene.camera);
        if (!animation && options_.frames.turntable == 0)
            throw UsageError("--frames: the scene has no animation; add --turntable K, or an \"animation\"");
        std::vector<std::string> outputs;
        for (const int frame : frames) {
            outputs.push_back(is_apng() ? options_.output : frame_file(options_.output, frame));
            if (!is_apng() || outputs.size() == 1) check_output(outputs.back(), console_);
        }
        Answer answer;
        answer.is_report = true;
        answer.fields = Json{{"engine", engine_name(request_.engine.engine)}, {"frames", Json::array()}};
        for (std::size_t k = 0; k < frames.size(); ++k)
            answer.fields["frames"].push_back(draw_frame(scene, frames[k], outputs[k]));
        if (is_apng()) write_apng(animation ? animation->fps : AnimationInfo().fps);
        answer.text =
            is_apng() || frames.size() == 1 ? outputs.back() : outputs.front() + " .. " + outputs.back();
        return answer;
    }

  private:
    bool is_apng() const { return format_ == "apng"; }

    Scene scene_of(const Scene& scene, int frame) const {
        const int turn = options_.frames.turntable;
        return scene_at_frame(
            scene, frame,
            turn > 0 ? turntable(scene, request_.frame.camera, frame, turn) : std::vector<SceneOverride>());
    }

    Json draw_frame(const Scene& scene, int frame, const std::string& output) {
        const Stopwatch watch;
        SceneReuse kept;
        if (renderer_)
            kept = renderer_->change(scene_of(scene, frame), once());
        else
            renderer_.emplace(scene_of(scene, frame), once());
        const double scene_seconds = watch.seconds();
        const std::string job = fmt::format("frame {}", frame);
        const bool is_exr = format_ == "exr";
        const Picture picture = is_exr
                                    ? renderer_->write_exr(output, request_, console_.progress(job), once())
                                    : renderer_->draw(request_, console_.progress(job), once());
        if (is_exr) name_output(output, console_);
        if (is_apng())
            pngs_.push_back(encode_image_as(picture.image, ImageFormat::kPng, options_.written_tones()));
        else if (!is_exr)
            write_output(output, picture.image, {ImageFormat::kPng, options_.written_tones()}, console_);
        console_.note(
            fmt::format("{}: scene {:.3f} s ({} and {} optics kept), prepared in {:.3f} s, drawn in {:.3f} s",
                        job, scene_seconds, kept.objects ? "objects" : "no objects", kept.optics,
                        picture.prepare_seconds, picture.draw_seconds));
        return {{"frame", frame},
                {"output", output},
                {"kept_objects", kept.objects},
                {"kept_optics", kept.optics},
                {"scene_seconds", scene_seconds},
                {"prepare_seconds", picture.prepare_seconds},
                {"draw_seconds", picture.draw_seconds},
                {"seconds", watch.seconds()}};
    }

    void write_apng(double fps) const { write_output(options_.output, encode_apng(pngs_, fps), console_); }

    /// What every frame would say is said once.
    Warn once() {
        return [this](const std::string& warning) {
            if (told_.insert(warning).second) console_.warner()(warning);
        };
    }

    const RenderOptions& options_;
    std::string format_;
    PictureRequest request_;
    Console& console_;
    std::optional<Renderer> renderer_;
    std::vector<std::vector<unsigned char>> pngs_;
    std::set<std::string> told_;
};

}  // namespace

Answer draw_frames(const RenderOptions& options, const std::string& format, const PictureRequest& request,
                   Console& console) {
    return FrameSequence(options, format, request, console).draw();
}

}  // namespace trilens
