"""Machines that are refused by name when the source is configured: big-endian ones, and those of 32 bits.

    refused_machines.py SOURCE FOLDER

Clang compiles for all of them; without it the test is skipped (77)."""
import pathlib
import shutil
import subprocess
import sys

SOURCE, FOLDER = map(pathlib.Path, sys.argv[1:3])
WORDS = {"powerpc64-linux-gnu": "big-endian", "s390x-linux-gnu": "big-endian", "i386-linux-gnu": "64 bits", "armv7-linux-gnueabihf": "64 bits"}


def configured(target):
    """What CMake says; nothing is linked, so no library of that machine is needed."""
    folder = FOLDER / target
    shutil.rmtree(folder, ignore_errors=True)
    return subprocess.run(["cmake", "-G", "Ninja", "-S", SOURCE, "-B", folder, "-DCMAKE_SYSTEM_NAME=Generic", "-DCMAKE_TRY_COMPILE_TARGET_TYPE=STATIC_LIBRARY",
                           "-DCMAKE_C_COMPILER=clang", "-DCMAKE_CXX_COMPILER=clang++", f"-DCMAKE_C_COMPILER_TARGET={target}",
                           f"-DCMAKE_CXX_COMPILER_TARGET={target}"], capture_output=True, text=True)


if not shutil.which("clang++"):
    print("skipped: no clang")
    sys.exit(77)
for target, word in WORDS.items():
    run = configured(target)
    said = " ".join(run.stderr.split())
    assert run.returncode != 0 and "CMake Error at CMakeLists.txt" in said and word in said, (target, run.returncode, said[-600:])
# What is not refused here goes on to look for libraries.
said = configured("riscv64-linux-gnu").stderr
assert "big-endian" not in said and "64 bits" not in said, said
print("refused by name:", ", ".join(WORDS))
