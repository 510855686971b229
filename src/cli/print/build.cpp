#include "cli/print/build.h"

#include <trilens/version.h>
#include <string>
#include <vector>

namespace trilens {
namespace {

std::vector<std::string> instruction_sets() {
    std::vector<std::string> sets;
#if defined(__x86_64__)
    __builtin_cpu_init();
    if (__builtin_cpu_supports("sse4.2")) sets.push_back("sse4.2");
    if (__builtin_cpu_supports("avx")) sets.push_back("avx");
    if (__builtin_cpu_supports("avx2")) sets.push_back("avx2");
    if (__builtin_cpu_supports("fma")) sets.push_back("fma");
    if (__builtin_cpu_supports("avx512f")) sets.push_back("avx512f");
#endif
    return sets;
}

std::string compiler() {
#if defined(__clang__)
    return "clang " __clang_version__;
#else
    return "gcc " __VERSION__;
#endif
}

std::string join(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
    return text;
}

}  // namespace

Answer build_answer() {
    const std::vector<std::string> libraries = library_versions();
    Answer answer;
    answer.fields["version"] = version();
    answer.fields["compiler"] = compiler();
    answer.fields["build_type"] = TRILENS_BUILD_TYPE;
    answer.fields["libraries"] = libraries;
    answer.fields["instruction_sets"] = instruction_sets();
    answer.fields["threads"] = threads();
    answer.text = "trilens " + version() + "\ncompiler   " + compiler() + ", " + TRILENS_BUILD_TYPE;
    for (const std::string& library : libraries) answer.text += "\nlibrary    " + library;
    answer.text += "\nprocessor  " + join(instruction_sets()) + "\nthreads    " + std::to_string(threads());
    return answer;
}

}  // namespace trilens
