// The command room's door to libfmt.
#pragma once

#include <fmt/core.h>
