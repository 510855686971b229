// What the commands answer, as text, JSON and CSV.
#pragma once

#include <trilens/compare.h>
#include <trilens/fit.h>
#include <trilens/image.h>
#include <trilens/project.h>
#include <trilens/render.h>
#include <trilens/scene.h>
#include <trilens/suite.h>
#include <trilens/sweep.h>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "terminal/command.h"
#include "terminal/libraries.h"

namespace trilens {

// What `trilens compare` and `trilens test` answer, as text and JSON: how two images differ; what passed,
// what failed and why, and the exit code.

// Formats a comparison of two images as text and JSON.

struct CompareRequest {
    std::string reference, test, difference;  // files
    std::string layer_of_reference, layer_of_test;
    bool strict = false;
    std::vector<MetricLimit> limits;
    double scale = 1;  // of a difference in .png
    double radius = DisplacementOptions{}.radius;
    CompareOptions options;
    std::string display_server;  // "HOST:PORT"; empty: none
};

/// The two images with the channels that they share, and what was found.
struct ComparedInputs {
    CommonChannels images;
    Comparison comparison;
    std::vector<LayerComparison> layers;
    std::vector<float> flip;  // layer_flip of the images
};

/// The table and the verdict, and the fields of `trilens.compare/1`.
Answer compare_answer(const CompareRequest& request, const ComparedInputs& inputs);

// What `trilens test` answers: what passed, what failed and why, and the exit code.

/// A line for each test that did not pass or whose reference changed, the counts, and the fields of
/// `trilens.test/1`.
Answer answer_of(const SuiteRequest& request, const SuiteResult& result);

// What `trilens fit` answers.

/// Parameters, residuals and what the pairs do not fix, as text and as JSON.
Answer fit_answer(const FitResult& result, std::span<const Correspondence> pairs);

// What `trilens render` and `trace` answer of a picture, and where it goes: a file, or standard output.

/// Size, counts, what was left out and seconds: fields of `trilens.render/1` and `trilens.trace/1`.
Json picture_fields(const Renderer& renderer, const Picture& picture);

/// The same of a picture as lines, or, with caustics, of an OBJ.
Json drawing_fields(const Film& film, const LineChoice& choice, const LineDrawing& drawing);

/// One line for those who want to read along.
std::string picture_note(const Picture& picture);

// Where a command's picture goes: a file, or standard output.

struct OutputFormat {
    ImageFormat file = ImageFormat::kExr;
    ToneMapping tone;  // of kPng
};

/// Throws UsageError where `output` is an input, or is standard output and the JSON answer is there too;
/// OutputError where it could not be written. Before long work.
void check_output(const std::string& output, Console& console);

/// The same of a scene file. Throws UsageError, too, for a name with another ending than .json.
void check_scene_output(const std::string& output, Console& console);

/// The answer for a file that was written while it was drawn.
Answer name_output(const std::string& output, Console& console);

/// Writes the picture and answers with its name; on standard output with the bytes alone. Throws OutputError.
Answer write_output(const std::string& output, const Image& image, const OutputFormat& format,
                    Console& console);

/// The same for a picture that is encoded already.
Answer write_output(const std::string& output, std::span<const unsigned char> encoded, Console& console);

/// The same for text.
Answer write_output(const std::string& output, const std::string& text, Console& console);

// What `trilens project` and `explain` answer: images of points as JSON and as CSV, one pixel explained; the
// forms that answers share.

// What `trilens project` answers: the images of points, as JSON and as CSV.

/// A list with an entry per point, `images[p]` those of `points[p]`: the field `points` of
/// `trilens.project/1`.
Json points_json(const Renderer& renderer, std::span<const Vec3> points,
                 std::span<const PointProjection> images);

/// A header and a line per meeting with an optic, of refined images.
std::string point_steps_text(const Renderer& renderer, std::span<const PointProjection> images);

/// A header and a line per image.
std::string points_text(const Renderer& renderer, std::vector<PointProjection> images);

// One pixel explained, as JSON.

/// What the centre of the pixel shows, and how.
Json explanation_json(const Renderer& renderer, const EngineChoice& engine, const PixelExplanation& pixel);

// Forms that several answers share: vectors, ids, what may be missing, steps of a path.

/// [x, y, z].
Json vector_json(const Vec3& v);

/// Null where there is none.
Json optional_json(const std::optional<double>& value);
Json id_json(Id id);

/// The meetings with optics on the way, in their order.
Json steps_json(const Renderer& renderer, std::span<const Step> steps);

// What `trilens scene info` answers, what a scene holds; and `trilens info`, the build, its libraries and the
// machine.

// What `trilens scene info` answers: what a scene holds.

/// The film, counts and a line for each camera and mesh; the fields of `trilens.scene/1`. A camera's facets
/// are named after the general linear cameras of Yu and McMillan (2004). Throws as make_camera does.
Answer info_answer(const Scene& scene);

// What `trilens info` answers: the build, its libraries and the machine.

/// The fields of `trilens.info/1`, and a line for each.
Answer build_answer();

// What `trilens shoot` answers: rays and their meetings with optics, as JSON and as CSV.

/// A list with an entry per ray: the field `rays` of `trilens.shoot/1`.
Json shots_json(const Renderer& renderer, const ShotRays& shots);

/// A header and a line per ray.
std::string shots_text(const Renderer& renderer, const ShotRays& shots);

/// A header and a line per meeting.
std::string shot_events_text(const Renderer& renderer, const ShotRays& shots);

/// The same as fields of CSV, from optic to normal_z.
std::string event_csv(std::span<const OpticInfo> optics, const PathEvent& event);

/// One meeting with an optic, as JSON; `optics`: Renderer::optics().
Json event_json(std::span<const OpticInfo> optics, const PathEvent& event);

// What the sweep commands answer: a sweep's fits and failures, as text and as JSON.

/// `report`: the page to name, empty for none. `left_out`: scenes that are in none of the sweeps. The exit
/// code tells of failed runs.
Answer answer_of(const std::vector<SweepSummary>& summaries, const std::string& report,
                 const std::vector<LeftOutScene>& left_out = {});

/// The scenes with the reasons, as a list.
Json left_out_json(const std::vector<LeftOutScene>& left_out);

/// The same of sweeps that may not be done, with the parts that are missing: as the indices of a job array
/// with a part per run.
Answer status_answer(const std::vector<SweepSummary>& summaries, const std::string& folder,
                     const std::vector<LeftOutScene>& left_out);

}  // namespace trilens
