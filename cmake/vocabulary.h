// What nearly every unit reads, compiled once for all of them (see Rooms.cmake).
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#define GLM_FORCE_XYZW_ONLY  // as base/math/vec.h has it, and trilens/types.h
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
