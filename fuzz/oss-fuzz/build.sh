#!/usr/bin/env bash
# Builds all fuzzers as OSS-Fuzz asks for it, from the folder of the source: with CC, CXX, CFLAGS, CXXFLAGS and
# LIB_FUZZING_ENGINE, in WORK, to OUT/NAME_fuzzer, their seeds and dictionaries beside them. scripts/fuzz --coverage runs it.
set -euo pipefail
source fuzz/targets.sh

# The system's libraries have GCC's standard library in their interfaces; libFuzzer hides its own.
export CFLAGS=${CFLAGS:-} CXXFLAGS=${CXXFLAGS:-}
CXXFLAGS=${CXXFLAGS//-stdlib=libc++/}
build=$WORK/trilens
cmake -G Ninja -S . -B "$build" -DCMAKE_BUILD_TYPE=None -DTRILENS_FUZZ=ON -DTRILENS_FUZZ_ENGINE="$LIB_FUZZING_ENGINE" \
    -DTRILENS_TESTS=OFF -DTRILENS_BENCH=OFF -DTRILENS_VIEWER=OFF -DTRILENS_INSTALL=OFF \
    -DCMAKE_EXE_LINKER_FLAGS="${LDFLAGS:-} -Wl,--disable-new-dtags,-rpath,'\$ORIGIN/lib'"
cmake --build "$build" --parallel "$(nproc)" --target trilens_fuzz

# Where fuzzers run there is no library but the C library: all others lie beside them (and are found by old tags, which hold for
# what libraries need, too), also those of the part that reads pictures, which is loaded when it is needed. Not executable, for
# whatever is counts as a fuzzer.
mkdir -p "$OUT/lib"
pictures=("$build"/libtrilens_pictures-*.so)
for file in "${pictures[@]}" $(ldd "$build/fuzz/trilens_fuzz" "${pictures[@]}" | sed -n 's/.* => \(\/[^ ]*\) .*/\1/p' | sort -u); do
    case ${file##*/} in
        libc.so.* | libm.so.* | libmvec.so.* | libdl.so.* | librt.so.* | libpthread.so.* | libresolv.so.* | ld-linux*) ;;
        *) install -m 644 "$file" "$OUT/lib" ;;
    esac
done

# The words of the schema are the dictionary of all that is JSON.
words=$WORK/json.dict
TRILENS_FUZZ_TARGET=schema "$build/fuzz/trilens_fuzz" | grep -o '"[A-Za-z0-9$_-]\{2,40\}"' | sort -u >"$words"

# One program, which knows by its name what it is to read.
for seeds in fuzz/seeds/*; do
    target=${seeds##*/}
    cp "$build/fuzz/trilens_fuzz" "$OUT/${target}_fuzzer"
    (cd "$seeds" && /usr/bin/python3 -m zipfile -c "$OUT/${target}_fuzzer_seed_corpus.zip" *)
    if is_json "$target"; then cp "$words" "$OUT/${target}_fuzzer.dict"; fi
    printf '[libfuzzer]\nmax_len = %s\n' "$(longest_of "$target")" >"$OUT/${target}_fuzzer.options"
done
