// What an option is called and takes, in words: shared by messages, help, manual pages and completion.
#pragma once

#include <string>
#include <vector>

#include "terminal/command.h"

namespace trilens {

/// "-o" and "--output" of "-o,--output".
std::vector<std::string> option_names(const Option& option);

/// The longest name, dashes included.
std::string long_name(const Option& option);

/// "-o/--output": as messages call it.
std::string spoken_name(const Option& option);

bool is_argument(const Option& option);
bool is_flag(const Option& option);
bool takes_many(const Option& option);

/// What stands for the value in a synopsis: "WxH", "N", "exact|classic".
std::string value_name(const Option& option);

/// What the option takes, as a sentence goes on: "an integer from 1 to 1024"; "exact, classic or auto".
std::string takes(const Option& option);

/// The option of that name; null where there is none.
const Option* find_option(const Command& command, const std::string& name);

/// Sets the target. Throws UsageError, in our words, for values that it does not take.
void set_option(const Option& option, const std::vector<std::string>& values);

/// Options one behind the other.
std::vector<Option> joined(std::vector<std::vector<Option>> parts);

/// Integers separated by `separator`. Throws UsageError naming `option` unless there are exactly `count`.
std::vector<int> parse_integers(const std::string& text, char separator, std::size_t count,
                                const std::string& option);

/// "a, b or c".
std::string one_of(const std::vector<std::string>& words);

}  // namespace trilens
