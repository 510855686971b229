#include "terminal/command.h"

#include <trilens/utilities.h>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <type_traits>

#include "terminal/libraries.h"

namespace trilens {
namespace {

bool is_whole(const Option& option) {
    return std::holds_alternative<int*>(option.target) || std::holds_alternative<long long*>(option.target) ||
           std::holds_alternative<std::size_t*>(option.target);
}

bool is_number(const Option& option) {
    return is_whole(option) || std::holds_alternative<double*>(option.target);
}

std::string number_words(double value) {
    return fmt::format("{}", value);
}

std::string range_words(const Range& range) {
    const bool from = std::isfinite(range.least), to = std::isfinite(range.most);
    if (from && to) return " from " + number_words(range.least) + " to " + number_words(range.most);
    if (from) return " of at least " + number_words(range.least);
    return to ? " of at most " + number_words(range.most) : "";
}

[[noreturn]] void refuse(const Option& option, const std::string& value) {
    std::string message = spoken_name(option) + " takes " + takes(option) + ", not \"" + value + "\"";
    if (!option.choices.empty()) {
        const std::string nearest = suggestion(value, option.choices);
        if (nearest.find("did you mean") != std::string::npos) message += nearest;
    }
    throw UsageError(message);
}

template <typename Number>
Number number_of(const Option& option, const std::string& text) {
    const char *begin = text.data() + (text.size() > 1 && text[0] == '+'), *end = text.data() + text.size();
    Number value{};
    const auto [stop, error] = std::from_chars(begin, end, value);
    const double size = static_cast<double>(value);
    if (error != std::errc() || stop != end || !(size >= option.range.least && size <= option.range.most))
        refuse(option, text);
    return value;
}

}  // namespace

std::vector<std::string> option_names(const Option& option) {
    std::vector<std::string> names;
    std::size_t from = 0;
    while (from <= option.names.size()) {
        const std::size_t comma = std::min(option.names.find(',', from), option.names.size());
        names.push_back(option.names.substr(from, comma - from));
        from = comma + 1;
    }
    return names;
}

std::string long_name(const Option& option) {
    return option_names(option).back();
}

std::string spoken_name(const Option& option) {
    std::string name = option.names;
    std::replace(name.begin(), name.end(), ',', '/');
    return name;
}

bool is_argument(const Option& option) {
    return option.names[0] != '-';
}

bool is_flag(const Option& option) {
    return std::holds_alternative<bool*>(option.target);
}

bool takes_many(const Option& option) {
    return std::holds_alternative<std::vector<std::string>*>(option.target);
}

std::string value_name(const Option& option) {
    if (is_flag(option)) return "";
    if (!option.value.empty()) return option.value;
    if (is_argument(option)) return option.names;
    if (!option.choices.empty()) {
        std::string names;
        for (const std::string& choice : option.choices) names += (names.empty() ? "" : "|") + choice;
        return names;
    }
    return is_whole(option) ? "N" : is_number(option) ? "X" : "TEXT";
}

std::string one_of(const std::vector<std::string>& words) {
    std::string text;
    for (std::size_t k = 0; k < words.size(); ++k)
        text += (k == 0 ? "" : k + 1 == words.size() ? " or " : ", ") + words[k];
    return text;
}

std::string takes(const Option& option) {
    if (is_flag(option)) return "no value";
    if (!option.choices.empty()) return one_of(option.choices);
    if (is_number(option)) return (is_whole(option) ? "an integer" : "a number") + range_words(option.range);
    return value_name(option);
}

const Option* find_option(const Command& command, const std::string& name) {
    for (const Option& option : command.options)
        for (const std::string& known : option_names(option))
            if (known == name && !is_argument(option)) return &option;
    return nullptr;
}

void set_option(const Option& option, const std::vector<std::string>& values) {
    if (values.empty()) return;
    if (is_flag(option)) {
        *std::get<bool*>(option.target) = true;
        return;
    }
    if (values.size() > 1 && !takes_many(option))
        throw UsageError(spoken_name(option) + " takes one value and is given " +
                         std::to_string(values.size()) + " times");
    if (option.check) option.check(values);
    for (const std::string& value : values) {
        if (value.empty()) throw UsageError(spoken_name(option) + " takes " + takes(option) + ", not \"\"");
        if (!option.choices.empty() &&
            std::find(option.choices.begin(), option.choices.end(), value) == option.choices.end())
            refuse(option, value);
    }
    std::visit(
        [&](auto* target) {
            using Value = std::remove_pointer_t<decltype(target)>;
            if constexpr (std::is_same_v<Value, std::vector<std::string>>)
                *target = values;
            else if constexpr (std::is_same_v<Value, std::string>)
                *target = values[0];
            else if constexpr (!std::is_same_v<Value, bool>)
                *target = number_of<Value>(option, values[0]);
        },
        option.target);
}

std::vector<int> parse_integers(const std::string& text, char separator, std::size_t count,
                                const std::string& option) {
    std::vector<int> values;
    const char *at = text.data(), *end = at + text.size();
    while (at <= end) {
        int value = 0;
        const auto [next, error] = std::from_chars(at, end, value);
        if (error != std::errc()) break;
        values.push_back(value);
        at = next;
        if (at == end) break;
        if (*at != separator) break;
        ++at;
    }
    if (at != end || values.size() != count)
        throw UsageError(option + " needs " + std::to_string(count) + " integers separated by '" + separator +
                         "', not \"" + text + "\"");
    return values;
}

std::vector<Option> joined(std::vector<std::vector<Option>> parts) {
    std::vector<Option> all;
    for (std::vector<Option>& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
}

}  // namespace trilens
