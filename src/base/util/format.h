// Text with values in it: the door to libfmt.
#pragma once

#include <fmt/core.h>
