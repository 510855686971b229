// Room that is overwritten: what is left of it where there is no memory.
#include <cstdint>
#include <new>

#include "base/util/overwritten.h"
#include "support/test.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)  // GCC's
#define TRILENS_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)  // Clang's
#define TRILENS_SANITIZED
#endif
#endif

using namespace trilens;

TEST_CASE("overwritten room that finds no memory is empty, and may be asked again", "[base]") {
    Overwritten<std::uint8_t> room(4);
    room[3] = 7;
    room.resize(2);
    CHECK(room.size() == 2);
    room.resize(4);
    CHECK(room[3] == 7);
#ifdef TRILENS_SANITIZED
    TRILENS_SKIP("a sanitizer ends a program that asks for too much memory");
#endif
    CHECK_THROWS_AS(room.resize(PTRDIFF_MAX), std::bad_alloc);
    CHECK(room.size() == 0);
    CHECK(room.begin() == room.end());
    room.resize(5);
    room[4] = 9;
    CHECK(room.size() == 5);
    CHECK(room[4] == 9);
}
