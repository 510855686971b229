// libFuzzer's entry: one program for all targets, chosen by TRILENS_FUZZ_TARGET, else by the program's name,
// TARGET_fuzzer; "schema" prints the schema of scenes, whose words are a dictionary.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string_view>

#include "base/util/parallel.h"
#include "fuzz/target.h"
#include "trilens/scene.h"

namespace {

const trilens_fuzz::FuzzTarget* target = nullptr;

std::string_view wanted_target(std::string_view program) {
    if (const char* name = std::getenv("TRILENS_FUZZ_TARGET")) return name;
    constexpr std::string_view kEnd = "_fuzzer";
    program.remove_prefix(program.rfind('/') + 1);
    if (!program.ends_with(kEnd)) return "";
    program.remove_suffix(kEnd.size());
    return program;
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char*** arguments) {
    const std::string_view name = wanted_target((*arguments)[0]);
    if (name == "schema") {
        std::puts(trilens::scene_schema());
        std::exit(0);
    }
    target = trilens_fuzz::find_target(name);
    if (target == nullptr) {
        std::fprintf(stderr, "TRILENS_FUZZ_TARGET, or the program's name before _fuzzer, is one of:\n");
        for (const trilens_fuzz::FuzzTarget& one : trilens_fuzz::fuzz_targets())
            std::fprintf(stderr, "  %-10.*s %.*s\n", static_cast<int>(one.name.size()), one.name.data(),
                         static_cast<int>(one.what.size()), one.what.data());
        std::exit(2);
    }
    trilens::set_thread_count(1);  // a coverage counter that two threads raise tells nothing
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        target->run({reinterpret_cast<const char*>(data), size});
    } catch (const std::exception& error) {
        std::fprintf(stderr, "defect: %s\n", error.what());
        std::abort();
    }
    return 0;
}
