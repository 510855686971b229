// What measurements need to know of the machine and the program: who else used it, how much memory there is,
// and a digest of the machine code that decides pixels.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace trilens {

// What a measurement of time needs to know of the machine: who else used it, and how much memory there is.

/// Watches the machine from its construction on.
class MachineWatch {
  public:
    MachineWatch();

    /// The share of the machine's processor time, 0..1, that other processes used since then; none where the
    /// system does not say.
    std::optional<double> used_by_others() const;

  private:
    std::optional<double> busy_;  // seconds of all processors together
    double own_ = 0, started_ = 0;
};

/// Forgets the largest memory that this process had so far. False where the system cannot.
bool reset_peak_memory();

/// The largest memory that this process had since then, MiB; none where the system does not say.
std::optional<double> peak_memory_mib();

/// Bytes that this process may still take without pushing others out: of the machine, or of its control
/// group where that allows less. None where the system does not say.
std::optional<double> available_memory();

// A digest of the machine code that decides pixels: results of one digest come from one engine.

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
