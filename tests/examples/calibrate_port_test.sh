#!/usr/bin/env bash
# calibrate_port_test.sh PROGRAM FOLDER: the example's pairs were made by rays refracted by hand, 0.02 pixels of noise added,
# through a flat port of normal (0.1, 0.1, 1) at 20 mm and a dome centred at (2, -1, -30) mm: both are found again.
set -euo pipefail
program=$1 folder=$2

found() {  # KIND CONDITION of awk over the first line's words
    "$program" "$folder/$1-port.yaml" "$folder/$1-pairs.csv" 2>/dev/null | tee /dev/stderr |
        awk "NR == 1 { good = ($2) } NR == 3 { good = good && \$2 < 0.035 && /, 0 lost/ } END { exit !good }"
}
# Within 0.04 degrees of the normal: its cosine with (0.1, 0.1, 1).
found flat '(0.1 * $2 + 0.1 * $3 + $4) / sqrt(1.02) > 0.99999976 && ($6 - 0.02) ^ 2 < 0.002 ^ 2'
found dome '($2 - 0.002) ^ 2 < 0.001 ^ 2 && ($3 + 0.001) ^ 2 < 0.001 ^ 2 && ($4 + 0.03) ^ 2 < 0.001 ^ 2'
if "$program" "$folder/nowhere.yaml" "$folder/flat-pairs.csv" 2>/dev/null; then exit 1; fi
echo "found a flat port and a dome"
