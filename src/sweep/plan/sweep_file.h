// A sweep as a file that a repository can keep: what is swept, over what, against which truth.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "sweep/store/axis.h"

namespace trilens {

/// A sweep file as it is written; what it leaves out is empty.
struct SweepFile {
    std::vector<std::string> scenes;
    std::vector<AxisRequest> over;
    bool zip = false;
    std::string truth, camera, title;
    std::vector<std::pair<std::string, std::string>> set;  // JSON pointer, value as JSON text
    int repeats = 0;
};

/// Reads a sweep file: { "scenes": [...], "over": [{"axis": ..., "values": [...]}], "zip": false, "truth":
/// "limit", "camera": ..., "title": ..., "repeats": R, "set": {"/json/pointer": value} }; all but "over" and
/// "scenes" may be missing, scenes too where an axis names them. Values are JSON, or texts as --over takes
/// them ("1..64:x2"). Comments are allowed. Throws InputError with the file and the JSON pointer of the first
/// problem.
SweepFile read_sweep_file(const std::string& file);

/// Whether the file is meant as a sweep: a JSON object with "over" in it. False for what cannot be read.
bool is_sweep_file(const std::string& file);

}  // namespace trilens
