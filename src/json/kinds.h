// Settings of objects that are of one of several kinds: a struct with what all kinds have and `kind`, a
// std::variant of structs, each with its name (kName) and its own parameters.
#pragma once

#include <cstddef>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "json/fields.h"

namespace trilens {

/// The variant of a T's kinds.
template <typename T>
using KindOf = decltype(T::kind);

/// Calls use(kind) with each kind of the variant, at its defaults, in order.
template <typename Variant, typename Use>
void for_each_kind(const Use& use) {
    [&]<std::size_t... I>(std::index_sequence<I...>) {
        (use(std::variant_alternative_t<I, Variant>()), ...);
    }
    (std::make_index_sequence<std::variant_size_v<Variant>>());
}

/// Their names, of those for which has(kind).
template <typename Variant, typename Has>
std::vector<std::string> kinds_with(const Has& has) {
    std::vector<std::string> names;
    for_each_kind<Variant>([&](const auto& kind) {
        if (has(kind)) names.push_back(kind.kName);
    });
    return names;
}

template <typename Variant>
std::vector<std::string> kind_names() {
    return kinds_with<Variant>([](const auto&) { return true; });
}

/// The kind of that name, at its defaults; the first where there is none.
template <typename Variant>
Variant make_kind(const std::string& name) {
    Variant made;
    for_each_kind<Variant>([&](auto kind) {
        if (name == kind.kName) made = std::move(kind);
    });
    return made;
}

/// The setting "type"; it stands before those that the kinds have, since it makes the kind.
template <typename T>
Field<T> type_field() {
    Field<T> type = part<T>("type", word_of(kind_names<KindOf<T>>()));
    type.read = [](const Json& json, T& into) {
        into.kind = make_kind<KindOf<T>>(json.template get<std::string>());
    };
    return type;
}

/// Whether every object of the kinds that have it needs it.
enum class Need { kNo, kYes };

/// A setting of the kinds that have such a member: `member` gives it of one that does (TRILENS_MEMBER). Its
/// default is shown where all agree.
template <typename T, typename Member>
Field<T> of_kinds(const std::string& key, const Member& member, Json values, const std::string& help,
                  Need need = Need::kNo) {
    Field<T> field;
    field.key = key;
    for_each_kind<KindOf<T>>([&](auto kind) {
        if constexpr (requires { member(kind); }) {
            [[maybe_unused]] const bool first = field.kinds.empty();
            field.kinds.push_back(kind.kName);
            if (need == Need::kYes) {
                field.needed_by.push_back(kind.kName);
            } else if constexpr (requires { to_json_value(member(kind)); }) {
                const Json usual = to_json_value(member(kind));
                if (first) values["default"] = usual;
                if (values.contains("default") && values["default"] != usual) values.erase("default");
            }
        }
    });
    field.schema = described(std::move(values), help);
    field.read = [member](const Json& json, T& into) {
        std::visit(
            [&](auto& kind) {
                if constexpr (requires { member(kind); }) from_json_value(json, member(kind));
            },
            into.kind);
    };
    return field;
}

/// `member` for of_kinds(): the member of that name.
#define TRILENS_MEMBER(name) [](auto& kind) -> decltype((kind.name)) { return kind.name; }

/// A setting that one kind alone has. One that is needed has no default.
template <typename T, typename Kind>
Field<T> of_kind(Field<Kind> of_one, Need need = Need::kNo) {
    Field<T> field;
    static_cast<FieldSchema&>(field) = of_one;
    field.kinds = {Kind::kName};
    if (need == Need::kYes) {
        field.needed_by = {Kind::kName};
        field.schema.erase("default");
    }
    if (of_one.read)
        field.read = [read = of_one.read](const Json& json, T& into) {
            if (auto* kind = std::get_if<Kind>(&into.kind)) read(json, *kind);
        };
    return field;
}

}  // namespace trilens
