// Random inputs for one target, by any compiler and without a look at coverage: for laws, whose scenes differ
// in every byte, the fastest way to many of them. hunt TARGET SECONDS [SEED [FOLDER]]: random bytes, or with
// a FOLDER its files changed at random; fails with the first seeds that break it. hunt TARGET FILE: those
// bytes alone. hunt show FILE [FACTOR]: prints the scene that they are for the target laws, enlarged. hunt
// list: names of the targets, and whether bytes, or files changed, are their inputs.
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "base/util/error.h"
#include "fuzz/havoc.h"
#include "fuzz/random_scene.h"
#include "fuzz/target.h"

using namespace trilens_fuzz;

namespace {

/// What breaks, in a word; empty where nothing does.
std::string broken(const FuzzTarget& target, const std::string& bytes, Answer& answer) {
    try {
        answer = target.run(bytes);
        return {};
    } catch (const std::exception& error) {
        return error.what();
    }
}

/// What kind of defect a message tells of: its words before the first colon.
std::string kind_of(const std::string& message) {
    return message.substr(0, message.find(':'));
}

constexpr double kSimplifying = 60;  // seconds for one input

/// Bytes that break the target in the same way and of which as many as possible are zero.
std::string simplified(const FuzzTarget& target, std::string bytes, const std::string& kind) {
    Answer unheard = Answer::kTaken;
    const trilens::Stopwatch watch;
    const auto still = [&](const std::string& tried) {
        return watch.seconds() < kSimplifying && kind_of(broken(target, tried, unheard)) == kind;
    };
    for (std::size_t half = bytes.size() / 2; half > 0; half /= 2)
        while (bytes.size() > half && still(bytes.substr(0, bytes.size() - half)))
            bytes.resize(bytes.size() - half);
    for (std::size_t i = bytes.size(); i-- > 0;) {
        if (bytes[i] == 0) continue;
        std::string tried = bytes;
        tried[i] = 0;
        if (still(tried)) bytes = tried;
    }
    return bytes;
}

std::string random_bytes(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::string bytes(400, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random() >> 56);
    return bytes;
}

std::string bytes_of(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// In the order of their names.
std::vector<std::string> files_of(const char* folder) {
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) paths.push_back(entry.path());
    std::sort(paths.begin(), paths.end());
    std::vector<std::string> files;
    for (const auto& path : paths) files.push_back(bytes_of(path));
    return files;
}

std::uint64_t number(const char* text) {
    std::uint64_t value = 0;
    std::from_chars(text, text + std::strlen(text), value);
    return value;
}

}  // namespace

int main(int count_of_words, char** words) {
    if (count_of_words == 2 && std::strcmp(words[1], "list") == 0) {
        for (const FuzzTarget& one : fuzz_targets())
            std::printf("%s %s\n", std::string(one.name).c_str(), one.makes ? "bytes" : "files");
        return 0;
    }
    if (count_of_words > 2 && std::strcmp(words[1], "show") == 0) {
        const double factor = count_of_words > 3 ? static_cast<double>(number(words[3])) : 1;
        std::puts(make_random_scene(bytes_of(words[2]), factor).json.c_str());
        return 0;
    }
    const FuzzTarget* target = count_of_words > 2 ? find_target(words[1]) : nullptr;
    if (target == nullptr) {
        std::fprintf(stderr,
                     "hunt TARGET SECONDS [SEED [FOLDER]] | hunt TARGET FILE | hunt show FILE [FACTOR] | "
                     "hunt list\n");
        return 2;
    }
    if (std::filesystem::is_regular_file(words[2])) {
        Answer answer = Answer::kTaken;
        const std::string message = broken(*target, bytes_of(words[2]), answer);
        const std::string said = !message.empty()             ? message
                                 : answer == Answer::kRefused ? "refused: " + last_refusal()
                                                              : "taken";
        std::puts(said.c_str());
        return message.empty() ? 0 : 1;
    }
    const std::uint64_t first = count_of_words > 3 ? number(words[3]) : 0;
    const std::vector<std::string> files =
        count_of_words > 4 ? files_of(words[4]) : std::vector<std::string>{};
    const auto seconds = static_cast<double>(number(words[2]));
    const trilens::Stopwatch watch;
    std::size_t refused = 0, defects = 0;
    std::uint64_t seed = first, slowest = first;
    double longest = 0;
    for (; watch.seconds() < seconds; ++seed) {
        const std::string bytes = files.empty() ? random_bytes(seed) : changed_file(files, seed);
        Answer answer = Answer::kTaken;
        const double began = watch.seconds();
        const std::string message = broken(*target, bytes, answer);
        if (watch.seconds() - began > longest) longest = watch.seconds() - began, slowest = seed;
        refused += message.empty() && answer == Answer::kRefused;
        if (message.empty()) continue;
        ++defects;
        const std::string file = "hunted-" + std::to_string(seed);
        std::printf("seed %llu: %s (%s)\n", static_cast<unsigned long long>(seed), message.c_str(),
                    file.c_str());
        std::fflush(stdout);
        std::ofstream(file, std::ios::binary) << bytes;
        const std::string small = simplified(*target, bytes, kind_of(message));
        std::ofstream(file, std::ios::binary) << small;
    }
    std::printf(
        "hunt %s: %llu inputs from seed %llu in %.0f s, %zu refused, %zu defects, the slowest took %.1f s "
        "(seed %llu)\n",
        words[1], static_cast<unsigned long long>(seed - first), static_cast<unsigned long long>(first),
        watch.seconds(), refused, defects, longest, static_cast<unsigned long long>(slowest));
    return defects > 0 ? 1 : 0;
}
