"""Imported first by the scripts here: with --help or -h prints what stands at their head, and ends."""
import sys

import __main__

if {"-h", "--help"} & set(sys.argv[1:]):
    print(__main__.__doc__)
    raise SystemExit(0)
