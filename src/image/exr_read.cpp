// OpenEXR files as Images, strictly.
#include <fstream>
#include <set>
#include <string_view>

#include "base/files/file_bytes.h"
#include "base/util/error.h"
#include "image/exr_file.h"
#include "image/image_io.h"

namespace trilens {
namespace {

Image read_part(ExrFile& in, int part, const std::string& file) {
    const ExrWindows shape = in.windows(part);
    if (shape.display_x != 0 || shape.display_y != 0)
        throw InputError(file, "", "its display window does not start at (0, 0)");
    return in.read(part);
}

}  // namespace

Image read_exr(const std::string& file) {
    ExrFile in(file);
    if (in.parts() > 1) throw InputError(file, "", "has more than one part");
    return read_part(in, 0, file);
}

std::vector<std::pair<std::string, Image>> read_exr_parts(const std::string& file) {
    ExrFile in(file);
    std::vector<std::pair<std::string, Image>> parts;
    std::set<std::string> names;
    for (int part = 0; part < in.parts(); ++part) {
        const std::string name = in.part_name(part);
        if (!names.insert(name).second) throw InputError(file, "", "has two parts called \"" + name + "\"");
        parts.emplace_back(name, read_part(in, part, file));
    }
    return parts;
}

bool is_exr_file(const std::string& file) {
    if (readable_size(file) < 4) return false;
    std::ifstream in(file, std::ios::binary);
    char start[4] = "";
    in.read(start, sizeof start);
    return in && std::string_view(start, sizeof start) == "\x76\x2f\x31\x01";
}

}  // namespace trilens
