// What `trilens sweep run`, `plan` and `submit` take, and the sweeps that it asks for.
#pragma once

#include <trilens/sweep.h>
#include <string>
#include <vector>

#include "cli/scene_options.h"
#include "terminal/option.h"

namespace trilens {

struct SweepOptions {
    SceneOptions scene;
    std::vector<std::string> scenes;
    std::vector<std::string> over;
    std::string output;
    std::string truth;
    std::string shard = "0/1";
    bool zip = false, replace = false;
    int jobs = 1, repeats = 0;
    double memory = 0;  // MiB
};

/// The options as data; `options` must outlive them.
std::vector<Option> sweep_options(SweepOptions& options);

/// The words of the command that makes a sweep again, without the parts that are defaults; `scene` may be
/// empty.
std::vector<std::string> command_words(const SweepOptions& options, const std::string& scene);

/// One sweep per scene, one for a sweep file, one for scenes that are an axis. Throws UsageError where they
/// are named twice or not at all, or two have one name.
std::vector<SweepRequest> sweep_requests(const SweepOptions& options);

}  // namespace trilens
