// What callers may hand in that is no data: numbers, and the promise that errors alone come of them.
#pragma once

#include <array>
#include <exception>
#include <limits>
#include <new>
#include <string>
#include <vector>

#include "base/util/error.h"
#include "support/test.h"

namespace trilens_test {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Numbers that are none, or the last that are.
inline constexpr std::array kOddNumbers{0.0,   -1.0,   kNaN,   kInfinity, -kInfinity,
                                        1e308, -1e308, 1e-308, 1e30,      0.5};
inline constexpr std::array kOddInts{0,     -1,    1,     -2147483647 - 1, 2147483647, 65536,
                                     50000, 46341, 46340, 1 << 30,         -(1 << 30)};

/// Texts that are none, or nearly.
inline const std::vector<std::string> kOddTexts{"",   "#",   "\xff\xfe", "1e999", "nan",
                                                "-1", "a/b", "..",       "{",     std::string(3, '\0')};

/// Calls it: it may throw an Error or std::bad_alloc, and nothing else. A signal ends the test, which then
/// names `what`.
template <typename Call>
void only_errors(const std::string& what, const Call& call) {
    INFO(what);
    bool kept = true;
    try {
        call();
    } catch (const trilens::Error& error) {
        kept = std::string(error.what()).size() > 0;
    } catch (const std::bad_alloc&) {
    } catch (const std::exception& error) {
        UNSCOPED_INFO(error.what());
        kept = false;
    }
    CHECK(kept);
}

/// Calls it and returns the message of the InputError that it throws; "nothing is thrown" where there is
/// none.
template <typename Call>
std::string refusal(const Call& call) {
    try {
        call();
    } catch (const trilens::InputError& error) {
        return error.what();
    } catch (const std::exception& error) {
        return std::string("another exception: ") + error.what();
    }
    return "nothing is thrown";
}

}  // namespace trilens_test
