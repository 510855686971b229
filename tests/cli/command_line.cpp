#include "cli/command_line.h"

#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "support/test.h"

namespace trilens_test {

std::string bytes_of(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
}

CommandRun run_trilens(const std::string& arguments) {
    static const std::string folder = scratch_dir("command_line");
    const std::string out = folder + "/out.txt", err = folder + "/err.txt";
    const std::string line =
        trilens_test::build_dir() + "/trilens " + arguments + " >" + out + " 2>" + err;
    const int status = std::system(line.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + status, bytes_of(out), bytes_of(err)};
}

std::string write_file(const std::string& folder, const std::string& name, const std::string& text) {
    std::ofstream(folder + "/" + name, std::ios::binary) << text;
    return folder + "/" + name;
}

std::string small_scene() {
    return R"({ "version": 1, "film": { "width": 32, "height": 24, "spp": 1 },
  "cameras": [ { "name": "main", "type": "perspective", "yfov": 40, "lookAt": { "eye": [0,0,4], "at": [0,0,0], "up": [0,1,0] } } ],
  "background": { "color": [0.2,0.3,0.5] },
  "materials": [ { "name": "chrome", "metallicFactor": 1, "roughnessFactor": 0 }, { "name": "red", "baseColorFactor": [0.8,0.1,0.1], "unlit": true } ],
  "meshes": [ { "name": "ball", "role": "optic", "material": "chrome", "resolution": 4, "primitive": { "type": "sphere", "center": [0,0,0], "radius": 1 } },
    { "name": "wall", "role": "object", "material": "red", "points": [[-4,-4,5],[4,-4,5],[4,4,5],[-4,4,5]], "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3] } ],
  "lights": [ { "type": "ambient", "color": [1,1,1] } ] })";
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    const std::size_t at = text.find(what);
    REQUIRE(at != std::string::npos);
    return text.replace(at, what.size(), by);
}

}  // namespace trilens_test
