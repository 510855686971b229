// Why a library of pictures failed, in its own words.
#pragma once

#include <string>

namespace trilens {

/// A library's report as part of an Error's message: one line without a full stop; "unknown reason" where it
/// is empty.
std::string library_reason(const std::string& report);

}  // namespace trilens
