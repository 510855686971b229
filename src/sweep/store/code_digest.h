// A digest of the machine code that decides pixels: results of one digest come from one engine.
#pragma once

#include <string>
#include <vector>

namespace trilens {

/// A file of machine code that this process has mapped.
struct LoadedCode {
    std::string file;      // its path; of the program itself "/proc/self/exe"
    std::string build_id;  // of its NT_GNU_BUILD_ID note, hexadecimal; empty where the linker left none
    bool is_ours = false;  // this library's own code lies in it
};

/// What the process has mapped now, in the order in which it was loaded.
std::vector<LoadedCode> loaded_code();

/// 16 hexadecimal digits over the file that holds this library and the libraries that its pixels come from
/// (Embree, OpenSubdiv, the C library's mathematics): over their build ids, or over the bytes of those
/// without one. Another build of any of them gives other digits; a rebuild that makes the same bytes, another
/// path or another process do not. What decodes textures is none of them: scene_digest has the texels
/// themselves. Taken once per process. Throws InputError where such a file cannot be read.
const std::string& code_digest();

/// The digest of exactly these files, in any order; what is not `is_ours` counts only where its name is one
/// of the libraries above.
std::string digest_of_code(std::vector<LoadedCode> code);

}  // namespace trilens
