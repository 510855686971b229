// Names of an enumeration's values, one table for each, and spelling suggestions by edit distance (Damerau
// and Levenshtein): "did you mean".
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace trilens {

// The names that files, options and messages have for an enumeration's values: one table for each.

/// A value and its name.
template <typename E>
struct NamedValue {
    E value;
    const char* name;
};

/// Specialised beside each enumeration that has names: `static constexpr std::array kTable` of NamedValue<E>,
/// every value once, in the order in which choices are listed.
template <typename E>
struct EnumNames;

/// The value's name.
template <typename E>
constexpr const char* name_of(E value) {
    for (const NamedValue<E>& one : EnumNames<E>::kTable)
        if (one.value == value) return one.name;
    return "";
}

/// The value of that name; none where there is none.
template <typename E>
constexpr std::optional<E> find_named(std::string_view name) {
    for (const NamedValue<E>& one : EnumNames<E>::kTable)
        if (name == one.name) return one.value;
    return std::nullopt;
}

/// All names, in the table's order.
template <typename E>
std::vector<std::string> names_of() {
    std::vector<std::string> names;
    for (const NamedValue<E>& one : EnumNames<E>::kTable) names.emplace_back(one.name);
    return names;
}

// Spelling suggestions by edit distance (Damerau and Levenshtein): "did you mean".

/// `; did you mean 'X'?` with the known name of the smallest edit distance (insert, delete, replace, swap of
/// neighbours; letter case counts nothing), where that is at most a third of the longer name, rounded up;
/// else
/// `; known: a, b, c`, or "; there are none" for no known names.
std::string suggestion(const std::string& unknown, std::span<const std::string> known);

}  // namespace trilens
