"""Prints where Python packages go below the prefix given: relative to it."""
import os
import site
import sys
import sysconfig

prefix = os.path.abspath(sys.argv[1])
known = [folder for folder in site.getsitepackages() if folder.startswith(os.path.join(prefix, "lib"))]
usual = sysconfig.get_path("platlib", "posix_prefix", vars={"base": prefix, "platbase": prefix})
print(os.path.relpath(known[0] if known else usual, prefix))
