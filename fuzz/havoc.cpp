#include "fuzz/havoc.h"

#include <algorithm>
#include <array>
#include <random>
#include <string_view>
#include <utility>

#include "base/util/check.h"

namespace trilens_fuzz {
namespace {

/// What stands where a number was: those that readers overflow, divide by or fail to read.
constexpr std::array<std::string_view, 16> kNumbers{
    "0",     "-1",         "1",          "-0.0",
    "1e308", "1e-308",     "1e999",      "nan",
    "inf",   "2147483648", "4294967296", "18446744073709551616",
    "0.1",   "1e5",        "65536",      ""};
constexpr const char* kDigits = "0123456789";
constexpr std::size_t kLongestPiece = 64;
/// One, two, four, eight or sixteen changes.
constexpr std::uint64_t kDoublings = 5;

class Havoc {
  public:
    Havoc(std::span<const std::string> files, std::uint64_t seed)
        : files_(files), random_(seed), bytes_(any_file()) {}

    std::string run() && {
        const std::size_t longest = std::max(bytes_.size(), kLongestChanged);
        for (int left = 1 << below(kDoublings); left > 0; --left) change();
        if (bytes_.size() > longest) bytes_.resize(longest);
        return std::move(bytes_);
    }

  private:
    /// Of [0, count); 0 where that is empty.
    std::size_t below(std::uint64_t count) {
        return count == 0 ? 0 : static_cast<std::size_t>(random_() % count);
    }
    const std::string& any_file() { return files_[below(files_.size())]; }
    char any_byte() { return static_cast<char>(random_() >> 56); }

    std::string any_piece(std::string_view of) {
        const std::size_t from = below(of.size());
        return std::string(of.substr(from, 1 + below(std::min(kLongestPiece, of.size() - from))));
    }

    void change() {
        const std::size_t at = below(bytes_.size());
        switch (bytes_.empty() ? 0 : below(10)) {
            case 0:
                bytes_.insert(at, any_piece(any_file()));
                break;
            case 1:
                bytes_[at] = static_cast<char>(bytes_[at] ^ (1 << below(8)));
                break;
            case 2:
                bytes_[at] = any_byte();
                break;
            case 3:
            case 4:
                replace_number(at);
                break;
            case 5:
            case 6:
                replace_word(at);
                break;
            case 7:
                bytes_.erase(at, 1 + below(kLongestPiece));
                break;
            case 8:
                bytes_.insert(at, any_piece(bytes_));
                break;
            default:
                overwrite(at, any_piece(any_file()));
                break;
        }
    }

    void overwrite(std::size_t at, const std::string& piece) { bytes_.replace(at, piece.size(), piece); }

    /// The next one; where there is none, the byte becomes the largest, which a length's may be.
    void replace_number(std::size_t at) {
        const std::size_t first = bytes_.find_first_of(kDigits, at);
        if (first == std::string::npos) {
            bytes_[at] = '\xff';
            return;
        }
        const std::size_t end = bytes_.find_first_not_of(kDigits, first);
        bytes_.replace(first, std::min(end, bytes_.size()) - first, kNumbers[below(kNumbers.size())]);
    }

    /// From the place on, what stands between two quotes by what does so in any of the files: JSON stays
    /// JSON.
    void replace_word(std::size_t at) {
        const std::string& other = any_file();
        const std::string_view here = quoted(bytes_, at), there = quoted(other, below(other.size()));
        if (here.empty() || there.empty()) return replace_number(at);
        bytes_.replace(static_cast<std::size_t>(here.data() - bytes_.data()), here.size(), there);
    }

    /// With its quotes; empty where none follows.
    static std::string_view quoted(std::string_view text, std::size_t from) {
        const std::size_t first = text.find('"', from);
        const std::size_t last = first == std::string_view::npos ? first : text.find('"', first + 1);
        return last == std::string_view::npos ? std::string_view() : text.substr(first, last + 1 - first);
    }

    std::span<const std::string> files_;
    std::mt19937_64 random_;
    std::string bytes_;
};

}  // namespace

std::string changed_file(std::span<const std::string> files, std::uint64_t seed) {
    TRILENS_CHECK(!files.empty(), "a change needs a file");
    return Havoc(files, seed).run();
}

}  // namespace trilens_fuzz
