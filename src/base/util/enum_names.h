// The names that files, options and messages have for an enumeration's values: one table for each.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace trilens {

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

}  // namespace trilens
