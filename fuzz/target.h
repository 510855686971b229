// Fuzz targets in the manner of libFuzzer: each takes bytes that a stranger wrote, and must answer or refuse.
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "base/util/error.h"
#include "base/util/parallel.h"

namespace trilens_fuzz {

/// What no input may bring about; leaves the target, which its caller takes for a crash.
class Defect : public std::logic_error {
  public:
    using std::logic_error::logic_error;
};

inline void require(bool holds, const std::string& law) {
    if (!holds) throw Defect(law);
}

/// How a target's input was taken: read and used, or refused in one line.
enum class Answer { kTaken, kRefused };

struct FuzzTarget {
    std::string_view name;  // of its folder in fuzz/seeds, too
    std::string_view what;  // it reads, for the list
    /// Throws Defect, or what else was never to be thrown.
    Answer (*run)(std::string_view bytes);
    bool makes = false;  // bytes are choices of what is made: none are refused
};

/// All of them, in the order of their names.
std::span<const FuzzTarget> fuzz_targets();

/// Null where there is none of that name.
const FuzzTarget* find_target(std::string_view name);

/// Why the last input of this thread was refused.
inline std::string& last_refusal() {
    thread_local std::string message;
    return message;
}

/// Runs `work`, which may refuse by trilens::Error alone, with a message of one line that says something.
template <class Work>
Answer answer(Work&& work) {
    try {
        work();
        return Answer::kTaken;
    } catch (const trilens::Error& error) {
        const std::string message = error.what();
        require(!message.empty(), "a refusal says nothing");
        require(message.find('\n') == std::string::npos, "a refusal has more than one line: " + message);
        last_refusal() = message;
        return Answer::kRefused;
    }
}

/// What `work` gives on so many threads; what comes after has as many as before.
template <class Work>
auto on_threads(int threads, Work&& work) {
    struct Back {
        int before = trilens::thread_count();
        ~Back() { trilens::set_thread_count(before); }
    } back;
    trilens::set_thread_count(threads);
    return work();
}

Answer scene_text(std::string_view bytes);
Answer scene_animation(std::string_view bytes);
Answer points_text(std::string_view bytes);
Answer pairs_text(std::string_view bytes);
Answer wish_text(std::string_view bytes);
Answer obj_text(std::string_view bytes);
Answer mtl_text(std::string_view bytes);
Answer vtk_text(std::string_view bytes);
Answer lens_text(std::string_view bytes);
Answer nrrd_text(std::string_view bytes);
Answer gltf_file(std::string_view bytes);
Answer exr_file(std::string_view bytes);
Answer png_file(std::string_view bytes);
Answer sweep_file(std::string_view bytes);
Answer test_file(std::string_view bytes);
Answer run_folder(std::string_view bytes);
Answer random_scene(std::string_view bytes);
Answer random_caustics(std::string_view bytes);
Answer random_fit(std::string_view bytes);
Answer random_maps(std::string_view bytes);
Answer random_terrain(std::string_view bytes);
Answer random_radiosity(std::string_view bytes);
Answer random_suite(std::string_view bytes);
Answer sweep_report(std::string_view bytes);

/// The JSON of two mirror balls before a wall, 8 x 6 pixels.
const char* small_scene();

/// A folder of this process' own for the files that targets read, in memory where the system has that.
const std::string& fuzz_folder();

/// Writes the bytes there under that name; returns the path.
std::string put_file(const std::string& name, std::string_view bytes);

/// What is in the file; empty where it cannot be read.
std::string file_text(const std::string& file);

}  // namespace trilens_fuzz
