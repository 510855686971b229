# Sourced first by the scripts here: with --help or -h prints what stands at their head, and ends.
case ${1:-} in -h | --help)
    sed -n '2,/^[^#]/{/^#/s/^# \{0,1\}//p}' "${BASH_SOURCE[1]}"
    exit 0
    ;;
esac
